//! Small inputs that gave wrong numbers without a word: each is told, or right.

use std::fs;

use fractum::{Options, Simulation};
use fractum_math::Vec3;
use fractum_mesh::generate::{structured_box, structured_rectangle};
use fractum_mesh::{Group, MshFormat};

use crate::common::{BONDED_BAR, Workplace, bar, history, mesh_bytes, run, summary};
use crate::warnings::{BAR, listed};

/// A bead between a floor and a press, or shot at the floor.
pub(crate) const BEAD: &str = r#"fractum = 1
[materials.stuff]
density = "2500 kg/m^3"
young_modulus = "5 MPa"
poisson_ratio = 0.3
[[bodies]]
name = "bead"
kind = "particles"
material = "stuff"
file = "bead.csv"
[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"
[[bodies]]
name = "press"
kind = "rigid"
shape = "plane"
normal = "-z"
point = [0, 0, "20 mm"]
velocity = { z = "-1 m/s" }
[solver]
safety = 0.2
end = "19 ms"
"#;

#[test]
fn a_bead_pressed_flat_is_told_once_with_its_share_of_the_radius() {
    let place = Workplace::new(BEAD);
    fs::write(place.path("bead.csv"), "0,0,0.01,0.01\n").unwrap();
    let pressed = run(&place, "out", "1");
    let all = listed(&place, "out");
    let [[code, site, text]] = all.as_slice() else { panic!("{all:?}") };
    assert_eq!(code, "deep-overlap");
    assert!(
        site.starts_with("particle 0 of body \"bead\" at (0.0000e0, 0.0000e0, ") && site.contains("t = "),
        "{all:?}"
    );
    // A tenth of the radius on each side is reached after 2 ms, and looked for every 20 steps.
    assert!(text.starts_with("the overlap is 10"), "{text}");
    let remedy = pressed["warnings"][0]["remedy"].as_str().unwrap();
    assert!(remedy.contains("contact.young_modulus"), "a key that there is: {remedy}");
    let light = BEAD.replace("\"19 ms\"", "\"1.5 ms\"");
    fs::write(place.path("case.toml"), light).unwrap();
    let light = run(&place, "light", "1");
    assert_eq!(listed(&place, "light"), [[""; 3]; 0]);
    // The summary tells how deep it was: half of the way of the press, warned of or not.
    let largest = |summary: &serde_json::Value| {
        let found = &summary["largest_overlap"];
        assert!(found["where"].as_str().unwrap().starts_with("particle 0 of body \"bead\""), "{found}");
        [&found["share"], &found["time"]].map(|number| number.as_f64().unwrap())
    };
    let ([flat, _], [most, late]) = (largest(&pressed), largest(&light));
    assert!(flat > 0.5 && (most - 0.075).abs() < 0.01 && late <= 1.5e-3, "{flat} {most} {late}");
    assert!(light["warnings"].as_array().unwrap().is_empty());
    // A resumed run goes on from it.
    fs::write(place.path("case.toml"), BEAD.replace("\"19 ms\"", "\"1.6 ms\"")).unwrap();
    let longer = place.fractum(&["run", "case.toml", "-o", "light", "--resume", "--quiet"]);
    assert_eq!(longer.code, Some(0), "{}", longer.stderr);
    let [more, _] = largest(&summary(&place, "light"));
    assert!((more - 0.08).abs() < 0.01 && more > most, "{more} {most}");
}

#[test]
fn a_run_in_which_nothing_touches_or_moves_is_told() {
    let probe = "[[probes]]\nname = \"push\"\nreaction = { group = \"floor\", along = \"z\" }\n[solver]";
    let pressed = BEAD.replace("\"19 ms\"", "\"1.5 ms\"").replace("[solver]", probe);
    for (case, code) in [(pressed.replace("\"-1 m/s\"", "\"1 m/s\""), Some("misses")), (pressed, None)] {
        let place = Workplace::new(&case);
        fs::write(place.path("bead.csv"), "0,0,0.01,0.01\n").unwrap();
        run(&place, "out", "1");
        let all = listed(&place, "out");
        assert_eq!(all.iter().map(|[code, ..]| code.as_str()).collect::<Vec<_>>(), Vec::from_iter(code), "{all:?}");
    }
    // The pressure acts on the side that is held.
    let taken = BAR.replace("PLANE", "xyz");
    let support = &taken[taken.rfind("[[supports]]").unwrap()..taken.find("[solver]").unwrap()];
    let probe = "[[loads]]\ngroup = \"x-\"\npressure = \"1 MPa\"\n[[probes]]\nname = \"moved\"\ndisplacement = { group = \"x+\", along = \"x\" }\n";
    let place = Workplace::new(&taken.replace(support, probe));
    fs::write(place.path("bar.msh"), mesh_bytes(&bar(), MshFormat::V4_1Binary)).unwrap();
    run(&place, "out", "1");
    let all = listed(&place, "out");
    let [[before, _, load], [after, _, text]] = all.as_slice() else { panic!("{all:?}") };
    assert!(before == "no-effect" && load.contains("take the load at once"), "{all:?}");
    assert!(after == "no-effect" && text.contains("all was zero throughout (moved)"), "{all:?}");
}

#[test]
fn a_bonded_body_that_is_strained_too_far_is_told() {
    let elastic = BONDED_BAR.replace("fracture = { criterion_strength = \"60 MPa\" }\n", "");
    for (way, codes) in [("6 um", &[][..]), ("300 um", &["large-strain"])] {
        let place = Workplace::new(&elastic.replace("6 um", way));
        run(&place, "out", "1");
        let all = listed(&place, "out");
        assert_eq!(all.iter().map(|[code, ..]| code.as_str()).collect::<Vec<_>>(), codes, "{way}: {all:?}");
    }
}

/// A bead so fast that it ends within a few steps, before the second row of the history.
const SHOT: &str = r#"fractum = 1
[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
contact = { restitution = 0.9 }
[[bodies]]
name = "bead"
kind = "particles"
material = "stone"
file = "bead.csv"
initial_velocity = { z = "-20 km/s" }
[[bodies]]
name = "floor"
kind = "rigid"
shape = "box"
point = ["-10 mm", "-10 mm", "-1 mm"]
size = ["20 mm", "20 mm", "1 mm"]
[solver]
end = "0.2 us"
"#;

#[test]
fn the_balance_of_the_last_step_is_judged() {
    let place = Workplace::new(SHOT);
    fs::write(place.path("bead.csv"), "0,0,0.004,0.004\n").unwrap();
    let ended = run(&place, "out", "1");
    let residual = ended["energy"]["residual_max_relative"].as_f64().unwrap();
    let told = listed(&place, "out").iter().any(|[code, ..]| code == "energy-balance");
    assert!(residual > 1e-3 && told, "{residual}: {:?}", listed(&place, "out"));
}

/// A strip whose upper half is cooled, so that it bends.
const STRIP: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.steel]
density = "8000 kg/m^3"
young_modulus = "200 GPa"
poisson_ratio = 0.0
[materials.steel.thermal]
conductivity = "50 W/(m K)"
heat_capacity = "500 J/(kg K)"
expansion = "1e-5 1/K"
[[bodies]]
name = "strip"
kind = "solid"
group = "body"
material = "steel"
plane = "stress"
formulation = "smoothed"
[heat]
initial_temperature = "300 K"
[[heat.conditions]]
where = "x > -1 m"
temperature = "300 K - if(y > MIDDLE, 100 K, 0 K)*t/END"
[[supports]]
group = "x-"
fix = "x"
[[supports]]
where = "x < 0.01 mm && y < 0.01 mm"
fix = "y"
[solver]
end = "END"
[[probes]]
name = "tip"
displacement = { group = "x+", along = "y" }
[output]
history = { every = "0.1 ms" }
[damping]
local = LOCAL
"#;

#[test]
fn local_damping_does_not_brake_what_expands_slowly() {
    let strip = |cells: [u32; 2], size: [f64; 2], local: &str, end: &str| {
        let mesh = structured_rectangle(cells, size, None);
        let middle = format!("{} mm", 500.0 * size[1]);
        let case = STRIP.replace("LOCAL", local).replace("MIDDLE", &middle).replace("END", end);
        let place = Workplace::with_mesh(&case, &mesh_bytes(&mesh, MshFormat::V4_1Binary));
        run(&place, "out", "1");
        let tip = history(&place, "out", &["tip"]).last().unwrap()[0];
        (tip, listed(&place, "out").iter().any(|[code, ..]| code == "damping"))
    };
    let slow = |local| strip([60, 4], [0.06, 0.004], local, "10 ms");
    let [(free, untold), (damped, _)] = ["0", "0.2"].map(slow);
    assert!((damped / free - 1.0).abs() < 0.03 && !untold, "{free} {damped}");
    // A few periods only: what is braked visibly is told.
    let fast = |local| strip([30, 4], [0.03, 0.002], local, "2 ms");
    let [(free, untold), (damped, told)] = ["0", "0.2"].map(fast);
    assert!(damped < 0.9 * free && told && !untold, "{free} {damped}");
}

/// A free body that turns.
const TURNING: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
DAMAGE
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "stone"
KINEMATICS
initial_velocity = { x = "-1000 1/s*(y - 10 mm)", y = "1000 1/s*(x - 50 mm)" }
[[probes]]
name = "stretch"
extensometer = { group = "body", from = [0, "10 mm", "10 mm"], to = ["100 mm", "10 mm", "10 mm"] }
[solver]
end = "0.35 ms"
[output]
history = { every = "50 us" }
"#;

/// Stations along a bar that a pulse runs through in 60 us.
const STATIONS: &str = r#"fractum = 1
[mesh]
file = "bar.msh"
[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "stone"
thickness = "10 mm"
[[loads]]
group = "x-"
pressure = { pulse = "half-sine", peak = "1 MPa", duration = "10 us" }
[solver]
end = "60 us"
[[output.ppv]]
name = "axis"
hole = "x-"
centre = ["-10 mm", "10 mm", 0]
line = { from = ["10 mm", "10 mm", 0], to = ["150 mm", "10 mm", 0], stations = 10 }
"#;

/// The wave of a plane pulse keeps its velocity, so that b is zero: stations that it had not passed made b 8 and more, without a word.
#[test]
fn stations_that_the_wave_has_not_passed_are_told_and_make_no_law() {
    let mesh = mesh_bytes(&structured_rectangle([100, 10], [0.2, 0.02], None), MshFormat::V4_1Binary);
    for (end, late) in [("60 us", false), ("30 us", true)] {
        let place = Workplace::with_mesh(&STATIONS.replace("60 us", end), &mesh);
        let summary = run(&place, "out", "1");
        let told = listed(&place, "out").into_iter().filter(|[code, ..]| code == "ends-early").collect::<Vec<_>>();
        assert_eq!(told.len(), usize::from(late), "{end}: {told:?}");
        assert!(told.iter().all(|[_, site, text]| site == "output.ppv" && text.contains("\"axis\"")), "{told:?}");
        let exponent = summary["ppv"][0]["exponent"].as_f64().unwrap();
        assert!(exponent.abs() < 0.05, "{end}: b = {exponent}");
    }
}

/// A bonded bar at rest whose ends are turned together.
const TURNED_AT_REST: &str = r#"fractum = 1
[parameters]
turn = "30 deg"
[materials.stone]
density = "2500 kg/m^3"
young_modulus = "50 GPa"
poisson_ratio = 0.2
[materials.stone.bonds]
coordination = 8
convention = "all"
radius_ratio = 0.5
young_modulus = "60 GPa"
[[bodies]]
name = "bar"
kind = "bonded"
material = "stone"
shape = "box"
size = ["40 mm", "10 mm", "10 mm"]
particles = 400
[[supports]]
where = "x < 5 mm || x > 35 mm"
group = "bar"
displacement = { x = "(x*(cos(turn) - 1) - y*sin(turn))*t/1 s", y = "(x*sin(turn) + y*(cos(turn) - 1))*t/1 s", z = "0 m" }
[solver]
kind = "static"
end = "1 s"
"#;

/// Beams at rest know small rotations alone: 30 degrees stretched them by 13 %, without a word.
#[test]
fn a_bonded_body_that_turns_at_rest_is_told() {
    for (turn, told) in [("30 deg", true), ("3 deg", false)] {
        let place = Workplace::new(&TURNED_AT_REST.replace("30 deg", turn));
        run(&place, "out", "1");
        let found = listed(&place, "out").into_iter().filter(|[code, ..]| code == "rotation").collect::<Vec<_>>();
        assert_eq!(found.len(), usize::from(told), "{turn}: {found:?}");
        assert!(
            found.iter().all(|[_, site, text]| site.contains("body \"bar\"") && text.contains("turned by")),
            "{found:?}"
        );
    }
}

#[test]
fn a_body_that_turns_is_corotational_by_itself() {
    const DAMAGE: &str = "damage = { tensile_strength = \"30 MPa\", fracture_energy = \"200 N/m\" }";
    let mesh = mesh_bytes(&structured_box([20, 4, 4], Vec3::new(0.1, 0.02, 0.02), None), MshFormat::V4_1Binary);
    let stretched = |damage: &str, kinematics: &str| {
        let case = TURNING.replace("DAMAGE", damage).replace("KINEMATICS", kinematics);
        let place = Workplace::with_mesh(&case, &mesh);
        let ended = run(&place, "out", "1");
        let stretch = history(&place, "out", &["stretch"]).iter().fold(0.0, |most: f64, row| most.max(row[0].abs()));
        let log = fs::read_to_string(place.path("out/run.log")).unwrap();
        let told = listed(&place, "out").iter().any(|[code, ..]| code == "rotation");
        (place, ended, stretch, log.contains("\"bar\" begins to turn"), told)
    };
    for damage in ["", DAMAGE] {
        let (place, ended, stretch, turns, told) = stretched(damage, "");
        assert!(stretch < 4e-4 && turns && !told, "{stretch}");
        let residual = ended["energy"]["residual_max_relative"].as_f64().unwrap();
        assert!(residual < 1e-4, "{residual}");
        // Resumed before and after it has begun to turn.
        let advance = |folder: &str, resume: bool, until: u64| {
            let options = Options { output: Some(place.path(folder)), resume, quiet: true, ..Options::default() };
            let mut simulation = Simulation::open(&place.path("case.toml"), &options).unwrap();
            while simulation.steps() < until {
                simulation.step().unwrap();
                simulation.record().unwrap();
            }
            let hash = simulation.state_hash();
            simulation.stop().unwrap();
            simulation.finish().unwrap();
            hash
        };
        let whole = advance("whole", false, 100);
        for saved in [3, 60] {
            let folder = format!("from-{saved}");
            advance(&folder, false, saved);
            assert_eq!(advance(&folder, true, 100), whole, "from step {saved}");
        }
        let (_, _, stretch, turns, told) = stretched(damage, "kinematics = \"small\"");
        assert!(stretch > 0.05 && !turns && told, "{stretch}");
    }
}

#[test]
fn expressions_of_probes_without_a_value_are_told() {
    let probes = r#"[[probes]]
name = "held"
displacement = { group = "x-", along = "x" }
[[probes]]
name = "pulled"
reaction = { group = "x-", along = "-x" }
[[probes]]
name = "none"
expression = "final(held)/max(held)"
unit = "1"
[[probes]]
name = "endless"
expression = "pulled/held"
unit = "N/m"
[[probes]]
name = "after"
expression = "2*none"
unit = "1"
[[probes]]
name = "crack"
crack = { measure = "front", along = "x" }
[solver]"#;
    let place = Workplace::new(&BAR.replace("PLANE", "xyz").replacen("[solver]", probes, 1));
    fs::write(place.path("bar.msh"), mesh_bytes(&bar(), MshFormat::V4_1Binary)).unwrap();
    run(&place, "out", "1");
    let all = listed(&place, "out");
    let told: Vec<&str> =
        all.iter().filter(|[code, ..]| code == "undefined").map(|[_, place, _]| place.as_str()).collect();
    assert_eq!(told, ["probe \"none\"", "probe \"endless\"", "probe \"crack\""], "{all:?}");
}

/// Bars of one mesh: two cracks share a part that is weak over 30 mm (1.8 times the fracture energy), one runs where it is weak over 6 mm (1.0), plain elements take
/// 0.75 of it there, and a bar that is equally strong parts along its clamp.
#[test]
fn cracks_that_do_not_cost_their_fracture_energy_are_told() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let bar = fs::read_to_string(format!("{folder}/cases/tension-bar-plane/aligned-coarse.toml")).unwrap();
    let bar =
        bar.replace("../../meshes/tension-bar-plane/aligned-coarse.msh", "bar.msh").replace("phase-field\"", "none\"");
    let kind = "kind = \"solid\"";
    let plain = format!("{kind}\nformulation = \"standard\"");
    let (wide, narrow) = ("if(abs(x) < 15 mm, 0.9, 1)", "if(abs(x) < 3 mm, 0.9, 1)");
    for (weak, formulation, told) in [
        (wide, kind, Some(("crack-energy", "1.8", "beside cracks"))),
        (narrow, kind, None),
        (narrow, &plain, Some(("crack-energy", "75", "of the fracture energy"))),
        ("1", kind, Some(("crack-area", "1.7 times", "shows one face"))),
    ] {
        assert!(bar.contains(wide) && bar.contains(kind));
        let place = Workplace::new(&bar.replace(wide, weak).replace(kind, formulation));
        fs::copy(format!("{folder}/meshes/tension-bar-plane/aligned-coarse.msh"), place.path("bar.msh")).unwrap();
        run(&place, "out", "1");
        let all = listed(&place, "out");
        match told {
            None => assert_eq!(all, [[""; 3]; 0]),
            Some((code, first, second)) => {
                let [[found, _, text]] = all.as_slice() else { panic!("{all:?}") };
                assert!(found == code && text.contains(first) && text.contains(second), "{all:?}");
            }
        }
    }
}

/// A rigid ball that is pressed into a block by 50 um.
const PRESSED_BALL: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
[parameters]
R = "4 m"
[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.3
[[bodies]]
name = "block"
kind = "solid"
group = "body"
material = "stone"
formulation = "smoothed"
[[bodies]]
name = "ball"
kind = "rigid"
shape = "sphere"
point = ["20 mm", "20 mm", "R + 20 mm"]
radius = "R"
velocity = { z = "-50 mm/s" }
[[supports]]
group = "z-"
fix = "xyz"
[solver]
kind = "static"
end = "1 ms"
"#;

/// One node of a mesh gave 1.2 to 3.6 times the force of Hertz, without a word.
#[test]
fn a_ball_that_presses_on_few_nodes_is_told() {
    let mesh = mesh_bytes(&structured_box([8, 8, 4], Vec3::new(0.04, 0.04, 0.02), None), MshFormat::V4_1Binary);
    for (radius, kind, told) in [("4 m", "static", false), ("0.1 m", "static", true), ("0.1 m", "explicit", true)] {
        let case =
            PRESSED_BALL.replace("\"4 m\"", &format!("\"{radius}\"")).replace("\"static\"", &format!("\"{kind}\""));
        let place = Workplace::with_mesh(&case, &mesh);
        run(&place, "out", "1");
        let found = listed(&place, "out").into_iter().filter(|[code, ..]| code == "coarse-mesh").collect::<Vec<_>>();
        assert_eq!(found.len(), usize::from(told), "{radius}, {kind}: {found:?}");
        for [_, site, text] in found {
            assert!(site == "body \"block\"" && text.contains("\"ball\" presses on 1 node of \"block\""), "{text}");
        }
    }
    // A quarter of a block has a quarter of the nodes: it is told where the whole block is.
    let quarter = mesh_bytes(&structured_box([8, 8, 8], Vec3::new(0.02, 0.02, 0.02), None), MshFormat::V4_1Binary);
    let symmetry = "[[supports]]\ngroup = \"x-\"\nfix = \"x\"\n[[supports]]\ngroup = \"y-\"\nfix = \"y\"\n[solver]";
    for (radius, words) in [("0.66 m", None), ("0.1 m", Some("3 nodes of \"block\""))] {
        let case = PRESSED_BALL.replace("4 m", radius).replace("\"20 mm\", \"20 mm\"", "\"0 m\", \"0 m\"");
        let place = Workplace::with_mesh(&case.replace("[solver]", symmetry), &quarter);
        run(&place, "out", "1");
        let found = listed(&place, "out").into_iter().find(|[code, ..]| code == "coarse-mesh");
        assert_eq!(found.is_some(), words.is_some(), "{radius}: {found:?}");
        assert!(found.is_none_or(|[.., text]| text.contains(words.unwrap())), "{radius}");
    }
    // A thin plate on its rim bends, and how it gives way beside the ball counts for little.
    let plate = mesh_bytes(&structured_box([8, 8, 3], Vec3::new(0.04, 0.04, 0.002), None), MshFormat::V4_1Binary);
    let case = PRESSED_BALL.replace("\"4 m\"", "\"5 mm\"").replace("R + 20 mm", "R + 2 mm");
    let case = case.replace("group = \"z-\"", "where = \"x < 0.1 mm || x > 39.9 mm\"");
    let place = Workplace::with_mesh(&case, &plate);
    run(&place, "out", "1");
    assert!(!listed(&place, "out").iter().any(|[code, ..]| code == "coarse-mesh"), "{:?}", listed(&place, "out"));
}

/// Two halves of a bar whose elastic energy at the peak is that of their face.
const SNAPS_BACK: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[[bodies]]
name = "left"
kind = "solid"
group = "left"
material = "stone"
[[bodies]]
name = "right"
kind = "solid"
group = "right"
material = "stone"
[[interfaces]]
between = ["left", "right"]
tensile_strength = "3 MPa"
fracture_energy = "30 J/m^2"
[[supports]]
group = "x-"
fix = "x"
[[supports]]
group = "y-"
fix = "y"
[[supports]]
group = "z-"
fix = "z"
[[supports]]
group = "x+"
displacement = { x = "40 um*t/1 ms" }
[solver]
kind = "static"
end = "1 ms"
control = "time"
step = "0.5 ms"
"#;

/// A step of time went from the peak to two parted halves, and booked the energy that they set free as fracture, without a word.
#[test]
fn a_step_over_a_snap_back_is_told() {
    let mut mesh = structured_box([8, 2, 2], Vec3::new(0.2, 0.02, 0.02), None);
    let middle = |nodes: &[u32; 4]| nodes.iter().map(|&n| mesh.nodes[n as usize].x).sum::<f64>() / 4.0;
    let halves: Vec<Vec<u32>> = [true, false]
        .map(|left| {
            (0u32..).zip(&mesh.tetrahedra).filter(|(_, n)| (middle(n) < 0.1) == left).map(|own| own.0).collect()
        })
        .into();
    for (tag, (name, tetrahedra)) in (20..).zip(["left", "right"].into_iter().zip(halves)) {
        mesh.groups.push(Group { name: name.into(), dimension: 3, tag, tetrahedra, ..Group::default() });
    }
    let mesh = mesh_bytes(&mesh, MshFormat::V4_1Binary);
    for (control, told) in [("control = \"time\"\nstep = \"0.5 ms\"", true), ("control = \"path\"", false)] {
        let case = SNAPS_BACK.replace("control = \"time\"\nstep = \"0.5 ms\"", control);
        let place = Workplace::with_mesh(&case, &mesh);
        let ended = run(&place, "out", "1");
        let taken = ended["energy"]["interface_fracture"].as_f64().unwrap() / (30.0 * 4e-4);
        assert!((taken - if told { 2.0 } else { 1.0 }).abs() < 2e-3, "{taken}");
        let found = listed(&place, "out").into_iter().filter(|[code, ..]| code == "crack-energy").collect::<Vec<_>>();
        assert_eq!(found.len(), usize::from(told), "{control}: {found:?}");
        assert!(found.iter().all(|[_, _, text]| text.contains("2.00 times the fracture energy")), "{found:?}");
    }
}
