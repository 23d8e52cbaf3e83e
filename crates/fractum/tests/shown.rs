//! Pressures and loads on bonded bodies, as their user meets them.

use crate::common::{Workplace, resumed, run};

const CYLINDER: &str = r#"fractum = 1
title = "A cylinder under pressure"
[materials.rock]
density = "2600 kg/m^3"
young_modulus = "20 GPa"
poisson_ratio = 0.2
[[bodies]]
name = "core"
kind = "bonded"
material = "rock"
shape = "cylinder"
length = "40 mm"
radius = "12 mm"
particles = 1500
coordination = 10
LOADS
[solver]
SOLVER
[[probes]]
name = "yy"
strain = { group = "core", where = "abs(x - 20 mm) < 10 mm", component = "yy" }
[[probes]]
name = "zz"
strain = { group = "core", where = "abs(x - 20 mm) < 10 mm", component = "zz" }
[[probes]]
name = "xx"
strain = { group = "core", where = "abs(x - 20 mm) < 10 mm", component = "xx" }
[[probes]]
name = "drift"
momentum = { along = "y" }
[output]
fields = { every = "1 s" }
"#;

const AT_REST: &str = "kind = \"static\"\nend = \"1 s\"";
const HELD: &str = "[[supports]]\ngroup = \"core.x-\"\nfix = \"x\"\n";

fn case(loads: &str, solver: &str) -> String {
    CYLINDER.replace("LOADS", loads).replace("SOLVER", solver).replace("fields = { every = \"1 s\" }\n", "")
}

/// The strain across is (1 - ν) p/E under a pressure on the side, that along 2 ν p/E; under a pressure from everywhere all are (1 - 2ν) p/E.
#[test]
fn pressures_at_rest_have_the_strains_of_hooke() {
    for (group, across, along) in [("core.radius", -0.8, 0.4), ("core", -0.6, -0.6)] {
        let loads = format!("[[loads]]\ngroup = \"{group}\"\npressure = \"10 MPa*t/1 s\"\n{HELD}");
        let place = Workplace::new(&case(&loads, AT_REST));
        let one = run(&place, "one", "1");
        let unit = 10e6 / 20e9;
        let strain = |name: &str| one["probes"][name]["final"].as_f64().unwrap() / unit;
        let mean = 0.5 * (strain("yy") + strain("zz"));
        println!("{group}: {} {} {}", strain("yy"), strain("zz"), strain("xx"));
        assert!((mean / across - 1.0).abs() < 0.06, "{group}: {mean} for {across}");
        assert!((strain("xx") / along - 1.0).abs() < 0.08, "{group}: {} for {along}", strain("xx"));
        assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-6, "{}", one["energy"]);
        let two = run(&place, "two", "2");
        assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    }
}

/// A constant pressure p holds from the start: under a platen that comes nearer by ε the axial stress is -2 ν p - E ε. The work of the platen
/// and of the pressure is what the body stores.
#[test]
fn a_constant_confinement_at_rest_stands_beside_a_platen_that_moves() {
    let platen = "[[supports]]\ngroup = \"core.x+\"\ndisplacement = { x = \"-0.04 mm*t/1 s\" }\n";
    let push = "[[probes]]\nname = \"push\"\nreaction = { group = \"core.x-\", along = \"x\" }\n";
    let area = std::f64::consts::PI * 0.012 * 0.012;
    let stress = |pressure: &str, platen: &str| {
        let loads = format!("[[loads]]\ngroup = \"core.radius\"\npressure = \"{pressure}\"\n{HELD}{platen}{push}");
        let place = Workplace::new(&case(&loads, AT_REST));
        let one = run(&place, "one", "1");
        assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-6, "{}", one["energy"]);
        let two = run(&place, "two", "2");
        assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
        one["probes"]["push"]["final"].as_f64().unwrap() / area
    };
    let held = "[[supports]]\ngroup = \"core.x+\"\nfix = \"x\"\n";
    let (alone, pressed, both) = (stress("10 MPa", held), stress("0 Pa", platen), stress("10 MPa", platen));
    println!("{alone} {pressed} {both}");
    assert!((alone / 4e6 - 1.0).abs() < 0.12 && (pressed / 20e6 - 1.0).abs() < 0.06, "{alone} {pressed}");
    assert!((both - alone - pressed).abs() < 1e-6 * both, "{both} for {alone} + {pressed}");
    // What grows to the same load has the same equilibrium.
    let growing = stress("10 MPa*t/1 s", platen);
    assert!((both - growing).abs() < 1e-6 * both, "{both} {growing}");
}

/// The first bond breaks where all loads in proportion to those of that moment break it, and the run has the same bits after a checkpoint.
#[test]
fn bonds_break_beside_constant_loads_at_the_load_that_breaks_them() {
    let bar = CYLINDER
        .replace(
            "[[bodies]]",
            "[materials.rock.fracture]\ntensile_strength = \"10 MPa\"\ncriterion = \"principal\"\n[[bodies]]",
        )
        .replace("particles = 1500", "particles = 400");
    // One folder, so that packing and strengths are found once.
    let place = Workplace::new("");
    let first = |folder: &str, pressure: &str, expected: Option<f64>| {
        let pull = "0.06 mm";
        let loads = format!(
            "[[loads]]\ngroup = \"core.radius\"\npressure = \"{pressure}\"\n{HELD}\
             [[supports]]\ngroup = \"core.x+\"\ndisplacement = {{ x = \"{pull}*t/1 s\" }}\n"
        );
        let text = bar.replace("LOADS", &loads).replace("SOLVER", "kind = \"static\"\nend = \"1 s\"\nmax_steps = 12");
        let text = text.replace("fields = { every = \"1 s\" }\n", "[output.checkpoint]\nsteps = 7\n");
        std::fs::write(place.path("case.toml"), text.replace("[output]\n", "")).unwrap();
        let one = run(&place, folder, "1");
        assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-4, "{}", one["energy"]);
        let time = one["fracture"][0]["first_break"].as_f64().unwrap();
        if expected.is_none() {
            let two = run(&place, "two", "2");
            let resumed = resumed(&place, "two");
            assert_eq!((&two["state_hash"], &two["energy"]), (&one["state_hash"], &one["energy"]));
            assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
        }
        time
    };
    let free = first("free", "0 Pa", Some(1.0));
    let confined = first("confined", "6 MPa", None);
    let together = first("together", &format!("6 MPa*t/{confined:.17e} s"), Some(confined));
    println!("{free} {confined} {together}");
    assert!((together / confined - 1.0).abs() < 1e-5, "{together} for {confined}");
    assert!((free / confined - 1.0).abs() > 0.01, "{free} {confined}");
}

/// In motion nothing holds the body, and it stays where it is: the pressure is in equilibrium.
#[test]
fn a_pressure_in_motion_drives_nothing_away_and_has_the_same_bits_after_a_checkpoint() {
    let loads =
        "[[loads]]\ngroup = \"core.radius\"\npressure = { smooth_ramp = [[\"0 s\", 0], [\"0.4 ms\", \"10 MPa\"]] }\n";
    let text = case(loads, "end = \"0.5 ms\"") + "[output.checkpoint]\nsteps = 720\n";
    let place = Workplace::new(&text.replace("[output]\n", ""));
    let one = run(&place, "one", "1");
    let value = |name: &str| one["probes"][name]["final"].as_f64().unwrap();
    let unit = 10e6 / 20e9;
    let mean = 0.5 * (value("yy") + value("zz")) / unit;
    println!("{mean}");
    assert!((mean / -0.8 - 1.0).abs() < 0.06, "{mean}");
    // The area of a disc under the pressure, for the whole time, is 0.2 kg m/s.
    assert!(value("drift").abs() < 1e-9, "{}", value("drift"));
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", one["energy"]);
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    let resumed = resumed(&place, "two");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
}

#[test]
fn loads_that_a_bonded_body_cannot_have_are_told() {
    let told = |loads: &str, solver: &str| {
        let place = Workplace::new(&case(loads, solver));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{}", ended.stdout);
        ended.stderr
    };
    let loads = format!("[[loads]]\ngroup = \"core.radius\"\npressure = \"10 MPa*(t/1 s)^2\"\n{HELD}");
    assert!(told(&loads, AT_REST).contains("neither is constant nor grows in proportion to time"));
    let text = told("[[loads]]\ngroup = \"core.radius\"\npressure = 1\nin_cracks = true\n", "end = \"1 ms\"");
    assert!(text.contains("with in_cracks"), "{text}");
    let text = told(
        "[bodies.groups]\nmiddle = \"hypot(y, z) < 3 mm && abs(x - 20 mm) < 5 mm\"\n[[loads]]\ngroup = \"core.middle\"\npressure = 1\n",
        "end = \"1 ms\"",
    );
    assert!(text.contains("none of its particles lies at a wall"), "{text}");
}

/// Beyond its strength a body under forces has no equilibrium: the run ends, and its last state is that of small displacements.
#[test]
fn a_body_that_gives_way_under_its_loads_is_told() {
    let bar = CYLINDER
        .replace(
            "[[bodies]]",
            "[materials.rock.fracture]\ntensile_strength = \"10 MPa\"\ncriterion = \"principal\"\n[[bodies]]",
        )
        .replace("particles = 1500", "particles = 800");
    let loads = "[[supports]]\ngroup = \"core.x-\"\nfix = \"xyz\"\n\
                 [[loads]]\ngroup = \"core.x+\"\nforce = { x = \"9 kN*t/1 s\" }\n\
                 [[probes]]\nname = \"way\"\ndisplacement = { group = \"core.x+\", along = \"x\" }\n";
    let place = Workplace::new(&bar.replace("LOADS", loads).replace("SOLVER", AT_REST));
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(
        ended.stderr.contains("gave way under its loads at") && ended.stderr.contains("[gave-way]"),
        "{}",
        ended.stderr
    );
    let summary = crate::common::summary(&place, "out");
    // Strength times length over Young's modulus is 20 um.
    let way = summary["probes"]["way"]["final"].as_f64().unwrap();
    assert!((1e-5..4e-4).contains(&way), "{way}");
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-4, "{}", summary["energy"]);
}
