//! Heat, as its user meets it.

use std::collections::BTreeSet;
use std::fs;

use fractum_math::Vec3;
use fractum_mesh::generate::{structured_box, structured_rectangle};
use fractum_mesh::{Group, Mesh, MshFormat};
use fractum_output::frames::read_collection;

use crate::common::{Workplace, history, mesh_bytes, resumed, run, summary};

/// A clamped bar of elements and a free bonded box, both heated by 15 K.
const HOT: &str = r#"fractum = 1
title = "A clamped bar and a free box get hot"

[mesh]
file = "bar.msh"

[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.stone.thermal]
conductivity = "3 W/(m K)"
heat_capacity = "800 J/(kg K)"
expansion = "1e-5 1/K"
[materials.stone.bonds]
coordination = 8
convention = "all"
radius_ratio = 0.5
young_modulus = "60 GPa"

[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "stone"

[[bodies]]
name = "box"
kind = "bonded"
material = "stone"
shape = "box"
point = ["1 m", "0 m", "0 m"]
size = ["0.3 m", "0.3 m", "0.3 m"]
particles = 300

[[supports]]
group = "x-"
fix = "x"

[[supports]]
group = "x+"
fix = "x"

[heat]
initial_temperature = "293 K"
stress_free_temperature = "293 K"

[[heat.conditions]]
group = "body"
source = { ramp = [["0 s", "0 W/m^3"], ["1 ms", "19.2 GW/m^3"], ["3 ms", "0 W/m^3"]] }

[[heat.conditions]]
group = "box"
source = { ramp = [["0 s", "0 W/m^3"], ["1 ms", "19.2 GW/m^3"], ["3 ms", "0 W/m^3"]] }

[damping]
mass = "3000 1/s"

[solver]
end = "6 ms"

[[probes]]
name = "push"
reaction = { group = "x+", along = "-x" }

[[probes]]
name = "bar_temperature"
temperature = { group = "body" }

[[probes]]
name = "box_temperature"
temperature = { group = "box" }

[[probes]]
name = "left"
displacement = { group = "box.x-", along = "x" }

[[probes]]
name = "right"
displacement = { group = "box.x+", along = "x" }

[[probes]]
name = "bond_energy"
energy = "bond_tension"

[[probes]]
name = "work"
heat = "expansion_work"

[output]
history = { every = "0.1 ms" }
checkpoint = { steps = 860 }
"#;

/// The table that bodies need to conduct.
const THERMAL: &str = "[materials.stone.thermal]
conductivity = \"3 W/(m K)\"
heat_capacity = \"800 J/(kg K)\"
expansion = \"1e-5 1/K\"
";

#[test]
fn clamped_bodies_are_pressed_and_free_ones_grow_with_the_same_bits_on_any_threads() {
    let place = Workplace::new(HOT);
    let one = run(&place, "one", "1");
    let last = |name: &str| one["probes"][name]["final"].as_f64().unwrap();
    // The source puts in 19.2 GW/m3 over 1.5 ms at half of that: 28.8 MJ/m3 over 1.92 MJ/(m3 K), 15 K.
    for name in ["bar_temperature", "box_temperature"] {
        assert!((last(name) - 308.0).abs() < 0.05, "{name}: {}", last(name));
    }
    // E α ΔT A, without stress across.
    let pressed = 30e9 * 1e-5 * 15.0 * 0.12 * 0.12;
    assert!((last("push") / pressed - 1.0).abs() < 0.01, "{} N of {pressed} N", last("push"));
    let grown = (last("right") - last("left")) / (1e-5 * 15.0 * 0.3);
    // The walls of the sets are a radius inside the box.
    assert!((0.85..1.0).contains(&grown), "{grown}");
    let stored = 0.5 * 30e9 * (1e-5f64 * 15.0).powi(2) * 0.3f64.powi(3);
    assert!(last("bond_energy") < 1e-2 * stored, "{} J of {stored} J", last("bond_energy"));
    assert!(last("work") > 0.9 * 0.5 * pressed * 1e-5 * 15.0 * 0.4, "{} J", last("work"));
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", one["energy"]);
    for row in history(&place, "one", &["heat_stored", "heat_residual"]) {
        assert!(row[1].abs() < 1e-10 * 28.8e6 * 0.03, "{row:?}");
    }
    for threads in ["2", "7"] {
        let other = run(&place, threads, threads);
        assert_eq!((&other["state_hash"], &other["energy"]), (&one["state_hash"], &one["energy"]), "{threads} threads");
    }
    let resumed = resumed(&place, "2");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
}

/// The bonded body by itself, in equilibrium.
fn at_rest() -> String {
    let part = |from: &str, to: &str| &HOT[HOT.find(from).unwrap()..HOT.find(to).unwrap()];
    let materials = part("[materials.stone]", "[[bodies]]\nname = \"bar\"");
    let body = part("[[bodies]]\nname = \"box\"", "[[supports]]");
    format!(
        "fractum = 1\n{materials}{body}[[supports]]\ngroup = \"box.x-\"\nfix = \"xyz\"\n[[supports]]\ngroup = \"box.x+\"\n\
         velocity = {{ x = \"1 mm/s\" }}\n[heat]\ninitial_temperature = \"293 K\"\n[solver]\nkind = \"static\"\nend = \"6 ms\"\n"
    )
}

/// The same bodies without motion: prescribed temperature, flux, convection.
fn alone(steps: &str) -> String {
    let conditions = r#"[[heat.conditions]]
group = "x-"
temperature = "400 K"

[[heat.conditions]]
group = "x+"
convection = { coefficient = "100 W/(m^2 K)", ambient = "250 K" }

[[heat.conditions]]
group = "box.y+"
flux = "2 kW/m^2"
area = "0.09 m^2"

[solver]
kind = "heat"
end = "2000 s"
"#;
    let [before, after] = [HOT.find("[[heat.conditions]]"), HOT.find("[[probes]]")].map(Option::unwrap);
    let text = [&HOT[..before], steps, "\n", conditions, &HOT[after..]].concat();
    text.replace("history = { every = \"0.1 ms\" }", "history = { every = \"100 s\" }\nfields = { every = \"500 s\" }")
        .replace("steps = 860", "steps = 600")
        .replace("reaction = { group = \"x+\", along = \"-x\" }", "count = \"bonds\"")
}

#[test]
fn heat_alone_keeps_its_balance_by_explicit_and_implicit_steps() {
    let mut ends = Vec::new();
    for steps in ["step = \"2 s\"", "scheme = \"implicit\"\nstep = \"2 s\""] {
        let place = Workplace::new(&alone(steps));
        let one = run(&place, "one", "1");
        assert!(
            place.path("one/pictures/temperature.png").is_file() && !place.path("one/pictures/stress.png").exists()
        );
        let rows = history(&place, "one", &["time", "heat_stored", "heat_brought", "heat_residual"]);
        assert_eq!(rows.len(), 21, "{rows:?}");
        let frames = read_collection(&place.path("one/fields.pvd")).unwrap().entries;
        let solid: Vec<_> = frames.iter().filter(|entry| entry.name == "solid").collect();
        let files: BTreeSet<&str> = solid.iter().map(|entry| entry.file.as_str()).collect();
        let times: Vec<f64> = solid.iter().map(|entry| entry.time.round()).collect();
        assert_eq!((times, files.len()), (vec![0.0, 500.0, 1000.0, 1500.0, 2000.0], 5));
        assert_eq!(one["time"]["at_rest"], false);
        let last = &rows[20];
        assert!((last[0] - 2000.0).abs() < 1e-6 && last[1] > 4e5, "{last:?}");
        assert!(rows.iter().all(|row| row[3].abs() < 1e-10 * last[1]), "{rows:?}");
        let two = run(&place, "two", "2");
        assert_eq!(two["state_hash"], one["state_hash"]);
        assert_eq!(resumed(&place, "two")["state_hash"], one["state_hash"]);
        // A run that ended earlier goes on to the later end.
        let whole = fs::read_to_string(place.path("case.toml")).unwrap();
        fs::write(place.path("case.toml"), whole.replace("end = \"2000 s\"", "end = \"1200 s\"")).unwrap();
        run(&place, "longer", "2");
        fs::write(place.path("case.toml"), whole).unwrap();
        let longer = place.fractum(&["run", "case.toml", "-o", "longer", "--threads", "2", "--resume", "--quiet"]);
        assert_eq!(longer.code, Some(0), "{}", longer.stderr);
        assert_eq!(summary(&place, "longer")["state_hash"], one["state_hash"]);
        ends.push(last[1]);
    }
    assert!((ends[0] / ends[1] - 1.0).abs() < 5e-3, "{ends:?}");
}

#[test]
fn what_heat_cannot_do_is_told_with_its_remedy() {
    let hot = alone("");
    for (text, words) in [
        (hot.replace(THERMAL, ""), "[materials.stone.thermal] with"),
        (HOT.replace("[heat]\n", "[other]\n"), "is not a key"),
        (alone("scheme = \"implicit\""), "with scheme = \"implicit\""),
        (alone("step = \"1e6 s\""), "is above the stable step"),
        (
            hot.replace(
                "group = \"x+\"\nconvection",
                "group = \"x-\"\ntemperature = 300\n[[heat.conditions]]\ngroup = \"x+\"\nconvection",
            ),
            "shares points",
        ),
        (hot.replace("area = \"0.09 m^2\"\n", ""), "particles have no surface of their own"),
        (hot.replace("kind = \"heat\"", "kind = \"auto\""), "is conducted in motion, at rest, or alone"),
        (
            hot.replace("kind = \"heat\"", "kind = \"static\"\ncontrol = \"path\""),
            "does not flow back along a path of equilibrium",
        ),
        (hot.replace("\"400 K\"", "\"400 C\""), "400 C"),
        (at_rest(), "beside a bonded body at rest"),
    ] {
        let place = Workplace::new(&text);
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{words}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
}

#[test]
fn of_conduction_alone_nothing_is_asked_and_nothing_said_that_moves() {
    let from = HOT.find("[damping]").unwrap();
    let to = HOT.find("[[probes]]\nname = \"bar_temperature\"").unwrap();
    let end = HOT.find("[[probes]]\nname = \"left\"").unwrap();
    let body = HOT.find("[[bodies]]\nname = \"box\"").unwrap();
    let supports = HOT.find("[[supports]]").unwrap();
    let heat = HOT.find("[heat]").unwrap();
    let source = HOT.rfind("[[heat.conditions]]").unwrap();
    let alone = format!(
        "{}{}[solver]\nkind = \"heat\"\nend = \"6 ms\"\n\n{}",
        &HOT[..body],
        &HOT[heat..source],
        HOT[to..end].split("[[probes]]\nname = \"box").next().unwrap()
    );
    let ended = Workplace::new(&alone).fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let physics: Vec<&str> = ended.stdout.lines().filter(|line| line.starts_with("physics")).collect();
    assert_eq!(physics, ["physics      conduction of heat"]);
    let says_too_much = |line: &&str| line.starts_with("load") || line.starts_with("skipped");
    assert_eq!(ended.stdout.lines().find(says_too_much), None);
    // What acts on motion alone is refused.
    let moving = "initial_velocity = { x = \"1 m/s\" }\n";
    let with = [
        (format!("{alone}{}", &HOT[from..HOT.find("[solver]").unwrap()]), "damping.mass has no effect"),
        (format!("{alone}[[loads]]\ngroup = \"y+\"\npressure = \"1 kPa\"\n"), "loads has no effect"),
        (format!("{alone}[in_situ]\nstress = {{ xx = \"-1 MPa\" }}\n"), "in_situ has no effect"),
        (
            alone.replace("group = \"body\"\nmaterial", &format!("{moving}group = \"body\"\nmaterial")),
            "bodies[0].initial_velocity has no effect",
        ),
    ];
    for (case, says) in &with {
        let ended = Workplace::new(case).fractum(&["check", "case.toml"]);
        assert_eq!((ended.code, ended.stderr.lines().count()), (Some(1), 1), "{}", ended.stderr);
        let right = ended.stderr.contains(*says) && ended.stderr.contains("nothing moves; remove it");
        assert!(right, "{says}: {}", ended.stderr);
    }
    // Supports may stay: they say where the body will be held once it moves.
    let held = format!("{alone}{}", &HOT[supports..heat]);
    let ended = Workplace::new(&held).fractum(&["check", "case.toml"]);
    let said = ended.stdout.contains("warning: supports has no effect");
    assert!(ended.code == Some(0) && said, "{} {}", ended.stdout, ended.stderr);
    // A switch of the solver from the command line leaves what the file says.
    let moved = with[0].0.replace("kind = \"heat\"", "kind = \"explicit\"");
    let ended = Workplace::new(&moved).fractum(&["check", "case.toml", "--set", "solver.kind=heat"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("warning: damping.mass has no effect"), "{}", ended.stdout);
}

/// A cantilever of two layers at rest, the upper one of another stiffness and expansion, cooled slowly.
const LAYERS: &str = r#"fractum = 1
[mesh]
file = "bar.msh"

[materials.low]
density = "8000 kg/m^3"
young_modulus = "200 GPa"
poisson_ratio = NU
[materials.low.thermal]
conductivity = "50 W/(m K)"
heat_capacity = "500 J/(kg K)"

[materials.up]
density = "8000 kg/m^3"
young_modulus = "70 GPa"
poisson_ratio = NU
[materials.up.thermal]
conductivity = "50 W/(m K)"
heat_capacity = "500 J/(kg K)"
expansion = "1e-5 1/K"

[[bodies]]
name = "low"
kind = "solid"
group = "body"
material = "low"
plane = "stress"
thickness = "1 mm"
formulation = "smoothed"

[[bodies]]
name = "up"
kind = "solid"
group = "up"
material = "up"
plane = "stress"
thickness = "1 mm"
formulation = "smoothed"

[heat]
initial_temperature = "300 K"
scheme = "implicit"
step = "10 s"

[[heat.conditions]]
where = "x > -1 m"
temperature = { ramp = [["0 s", "300 K"], ["1000 s", "200 K"]] }

[[supports]]
where = "x < 0.01 mm"
fix = "x"
[[supports]]
where = "x < 0.01 mm && y < 0.01 mm"
fix = "y"

[solver]
kind = "static"
end = "1000 s"
step = "50 s"

[[probes]]
name = "tip"
displacement = { where = "x > 59.99 mm", along = "y" }

[output]
checkpoint = { steps = 12 }
"#;

/// Two layers of 2 mm, 60 mm long, that have nodes in common.
///
/// - `cells`: along them, and through both
pub(crate) fn layers(cells: [u32; 2]) -> Mesh {
    let mut mesh = structured_rectangle(cells, [0.06, 0.004], None);
    let body = mesh.groups.iter().position(|group| group.name == "body").unwrap();
    let is_up = |triangle: u32| {
        mesh.triangles[triangle as usize].iter().map(|&node| mesh.nodes[node as usize].y).sum::<f64>() > 3.0 * 0.002
    };
    let (up, low) = mesh.groups[body].triangles.iter().partition(|&&triangle| is_up(triangle));
    mesh.groups[body].triangles = low;
    let above = Group { name: "up".into(), tag: 99, triangles: up, ..mesh.groups[body].clone() };
    mesh.groups.push(above);
    mesh
}

#[test]
fn layers_at_rest_bend_as_timoshenko_says() {
    let mesh = mesh_bytes(&layers([120, 16]), MshFormat::V4_1Binary);
    // Timoshenko (1925): curvature of layers of one thickness, n the ratio of their moduli.
    let (n, height) = (200.0 / 70.0, 4e-3);
    let curvature = 6.0 * 1e-5 * 100.0 * 4.0 / (height * (12.0 + (1.0 + n) * (1.0 + 1.0 / n)));
    let tip = 0.5 * curvature * 0.06f64.powi(2);
    for nu in ["0", "0.3", "0.45"] {
        let case = LAYERS.replace("NU", nu);
        let place = Workplace::with_mesh(&case, &mesh);
        let one = run(&place, "one", "1");
        let found = one["probes"]["tip"]["final"].as_f64().unwrap();
        assert!((found / tip - 1.0).abs() < 0.01, "nu {nu}: {found} m of {tip} m");
        assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-8, "{}", one["energy"]);
        assert_eq!(one["time"]["at_rest"], false, "instants are seconds, no load factors");
    }
    let place = Workplace::with_mesh(&LAYERS.replace("NU", "0.3"), &mesh);
    let one = run(&place, "one", "1");
    for other in [run(&place, "two", "2"), resumed(&place, "two")] {
        assert_eq!((&other["state_hash"], &other["energy"]), (&one["state_hash"], &one["energy"]));
    }
}

/// Layers that were without stress at another temperature have the state and the energy of layers that were cooled from it, and their balance closes.
#[test]
fn layers_that_were_free_of_stress_at_another_temperature_have_the_energy_of_cooled_ones() {
    let mesh = mesh_bytes(&layers([60, 8]), MshFormat::V4_1Binary);
    let cooled = LAYERS.replace("NU", "0.3");
    let ramp = "{ ramp = [[\"0 s\", \"300 K\"], [\"1000 s\", \"200 K\"]] }";
    let start = "initial_temperature = \"200 K\"\nstress_free_temperature = \"300 K\"";
    let stressed = cooled.replace(ramp, "\"200 K\"").replace("initial_temperature = \"300 K\"", start);
    let of = |case: &str| {
        let place = Workplace::with_mesh(case, &mesh);
        let summary = run(&place, "out", "1");
        assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-8, "{}", summary["energy"]);
        assert!(!format!("{}", summary["warnings"]).contains("energy-balance"), "{}", summary["warnings"]);
        let elastic = summary["energy"]["elastic"].as_f64().unwrap();
        // The first row is no state in which bodies are held at their temperature.
        let first = &history(&place, "out", &["tip", "elastic"])[0];
        assert_eq!(first[..], [0.0, 0.0], "{first:?}");
        [summary["probes"]["tip"]["final"].as_f64().unwrap(), elastic]
    };
    let (slow, at_once) = (of(&cooled), of(&stressed));
    assert!(slow.iter().zip(at_once).all(|(a, b)| (b / a - 1.0).abs() < 1e-6), "{slow:?} {at_once:?}");
}

/// A bar that is held at both ends and cooled.
const COOLED: &str = r#"fractum = 1
[mesh]
file = "bar.msh"

[materials.stone]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = NU
[materials.stone.thermal]
conductivity = "3 W/(m K)"
heat_capacity = "800 J/(kg K)"
expansion = "1e-5 1/K"
[materials.stone.damage]
tensile_strength = "3 MPa"
fracture_energy = "100 J/m^2"

[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "stone"
strength_factor = "if(abs(x - 20 mm) < 4 mm, 0.9, 1)"

[heat]
initial_temperature = "300 K"
scheme = "implicit"
step = "1 s"

[[heat.conditions]]
where = "x > -1 m"
temperature = { ramp = [["0 s", "300 K"], ["100 s", "ENDS"]] }

[[supports]]
group = "x-"
fix = "x"
[[supports]]
group = "x+"
fix = "x"
[[supports]]
where = "x < 1 um && hypot(y, z) < 1 um"
fix = "yz"
[[supports]]
where = "x < 1 um && y > 7.99 mm && z < 1 um"
fix = "z"

[solver]
kind = "static"
end = "100 s"
step = "0.1 s"

[[probes]]
name = "pull"
reaction = { group = "x+", along = "x" }
"#;

#[test]
fn what_cools_between_walls_bears_its_strength_and_cracks() {
    let mesh = mesh_bytes(&structured_box([10, 2, 2], Vec3::new(0.04, 0.008, 0.008), None), MshFormat::V4_1Binary);
    for nu in ["0", "0.3"] {
        let case = COOLED.replace("NU", nu).replace("ENDS", "200 K");
        let place = Workplace::with_mesh(&case, &mesh);
        let ended = run(&place, "one", "1");
        let peak = ended["probes"]["pull"]["max"].as_f64().unwrap() / (0.9 * 3e6 * 64e-6);
        assert!((peak - 1.0).abs() < 0.02, "nu {nu}: {peak} of the strength of the weakest section");
        let left = ended["probes"]["pull"]["final"].as_f64().unwrap();
        assert!(left < 0.5 * 0.9 * 3e6 * 64e-6, "nu {nu}: {left} N at the end");
        assert!(ended["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", ended["energy"]);
    }
}

#[test]
fn a_free_body_that_is_heated_evenly_grows_without_stress_at_rest() {
    let mesh = mesh_bytes(&layers([30, 4]), MshFormat::V4_1Binary);
    let low = "conductivity = \"50 W/(m K)\"\nheat_capacity = \"500 J/(kg K)\"\n\n[materials.up]";
    let expansion = low.replace("\n\n", "\nexpansion = \"1e-5 1/K\"\n\n");
    let held = "[\"500 s\", \"200 K\"], [\"1000 s\", \"200 K\"]";
    let elastic =
        LAYERS.replace("NU", "0.3").replace("[\"1000 s\", \"200 K\"]", held).replace(low, &expansion).replace(
            "displacement = { where = \"x > 59.99 mm\", along = \"y\" }",
            "displacement = { where = \"x > 59.99 mm\", along = \"x\" }",
        );
    let damage = |name: &str| {
        format!(
            "[materials.{name}.damage]\ntensile_strength = \"10 MPa\"\nfracture_energy = \"100 J/m^2\"\n[materials.{name}.thermal]"
        )
    };
    let breakable = ["low", "up"]
        .iter()
        .fold(elastic.clone(), |case, name| case.replace(&format!("[materials.{name}.thermal]"), &damage(name)));
    for case in [elastic, breakable] {
        let place = Workplace::with_mesh(&case, &mesh);
        let summary = run(&place, "out", "1");
        assert!(!format!("{}", summary["warnings"]).contains("energy-balance"), "{}", summary["warnings"]);
        let found = summary["probes"]["tip"]["final"].as_f64().unwrap();
        assert!((found / (-1e-5 * 100.0 * 0.06) - 1.0).abs() < 1e-6, "{found}");
    }
}
