//! Bonded bodies that break, as their user meets them.

use std::fs;

use crate::common::{Workplace, resumed, run, summary};
use serde_json::Value;

/// A bar that is pulled apart fast, from the state of uniform motion.
const BAR: &str = r#"fractum = 1
title = "A bonded bar, pulled apart"

[parameters]
length = "2 mm"
rate = "20 m/s"

[materials.glass]
density = "2500 kg/m^3"
young_modulus = "72 GPa"
poisson_ratio = 0.23
[materials.glass.fracture]
criterion_strength = "60 MPa"
[materials.glass.contact]
friction = 0.4
damping_ratio = 0.05

[[bodies]]
name = "bar"
kind = "bonded"
material = "glass"
shape = "box"
size = ["length", "1 mm", "1 mm"]
particles = 600
coordination = 8
initial_velocity = { x = "rate*x/length" }

[[supports]]
group = "bar.x-"
fix = "x"
[[supports]]
group = "bar.x+"
velocity = { x = "rate" }

[solver]
end = "0.3 us"

[[probes]]
name = "pull"
reaction = { group = "bar.x+", along = "x" }
[[probes]]
name = "broken"
count = "broken_bonds"

[output]
fields = { every = "0.1 us" }
history = { every = "5 ns" }
checkpoint = { steps = 20 }
"#;

#[test]
fn a_bonded_body_breaks_with_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let place = Workplace::new(BAR);
    let one = run(&place, "one", "1");
    let broken = one["counts"]["broken_bonds"].as_u64().unwrap();
    assert!(broken > 100, "{}", one["counts"]);
    let energy = |name: &str| one["energy"][name].as_f64().unwrap();
    assert!(energy("removed") > 0.0 && energy("residual_max_relative") < 1e-3, "{}", one["energy"]);
    let fracture = &one["fracture"][0];
    assert_eq!((fracture["body"].as_str(), fracture["broken_bonds"].as_u64()), (Some("bar"), Some(broken)));
    assert!(fracture["largest_ratio"].as_f64().unwrap() >= 1.0, "{fracture}");

    // One line per broken bond, in the order of time; the energies of those that broke before the end are what the ledger
    // has removed by then.
    let table = fs::read_to_string(place.path("one/cracks.csv")).unwrap();
    let mut lines = table.lines();
    let columns: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = |name: &str| columns.iter().position(|c| *c == name).unwrap();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let number = |row: &[&str], name: &str| row[column(name)].parse::<f64>().unwrap();
    assert_eq!(rows.len() as u64, broken);
    assert!(rows.windows(2).all(|w| number(&w[0], "time [s]") <= number(&w[1], "time [s]")));
    let before = |row: &&Vec<&str>| number(row, "time [s]") < 0.3e-6 * (1.0 - 1e-9);
    let sum: f64 = rows.iter().filter(before).map(|row| number(row, "energy [J]")).sum();
    assert!((sum / energy("removed") - 1.0).abs() < 1e-9, "{sum:e} of {:e}", energy("removed"));
    assert!(place.path("one/cracks.vtp").is_file() && place.path("one/pictures/broken_bonds.png").is_file());

    for threads in ["2", "7"] {
        let other = run(&place, threads, threads);
        assert_eq!((&other["state_hash"], &other["energy"]), (&one["state_hash"], &one["energy"]), "{threads} threads");
    }
    let resumed = resumed(&place, "2");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
    assert_eq!(resumed["fracture"], one["fracture"]);
    assert_eq!(fs::read_to_string(place.path("2/cracks.csv")).unwrap(), table);
}

#[test]
fn stress_at_walls_breaks_bonds_with_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let place = Workplace::new(&BAR.replace("\"60 MPa\"", "\"60 MPa\"\nat_walls = true"));
    let one = run(&place, "one", "1");
    let told = fs::read_to_string(place.path("one/run.log")).unwrap();
    assert!(told.contains("at walls the stress of the wall"), "{told}");
    assert!(one["counts"]["broken_bonds"].as_u64().unwrap() > 100, "{}", one["counts"]);
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", one["energy"]);
    assert_eq!(run(&place, "2", "2")["state_hash"], one["state_hash"]);
    assert_eq!(resumed(&place, "2")["state_hash"], one["state_hash"]);
}

#[test]
fn a_body_that_holds_says_how_close_it_came() {
    let place = Workplace::new(&BAR.replace("60 MPa", "6 GPa"));
    let ended = place.fractum(&["run", "case.toml", "-o", "out"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    assert!(ended.stdout.contains("no bond broke; the largest load was"), "{}", ended.stdout);
    let fracture: Value = summary(&place, "out")["fracture"][0].clone();
    let ratio = fracture["largest_ratio"].as_f64().unwrap();
    assert!(ratio > 0.01 && ratio < 1.0, "{fracture}");
    assert!(fracture["largest_at"][0].as_f64().unwrap() < 2e-3 && fracture["first_break"].is_null(), "{fracture}");
}

#[test]
fn criteria_take_only_keys_that_belong_to_them() {
    let cases = [
        ("criterion = \"beam\"\nlevel = 1", "materials.glass.fracture.level", "with this criterion"),
        ("criterion = \"hydrostatic\"\ncompressive_strength = \"1 GPa\"", "fracture.compressive_strength", "criterion"),
        ("moments = \"largest\"", "materials.glass.fracture.moments", "with this criterion"),
        ("level = 3", "materials.glass.fracture.level", "0, 1 or 2"),
        ("criterion = \"beam\"\nat_walls = true", "materials.glass.fracture.at_walls", "on single beams"),
        ("compressive_strength = \"10 MPa\"", "fracture.compressive_strength", "more than the tensile strength"),
        ("tensile_strength = \"10 MPa\"", "fracture.tensile_strength", "beside criterion_strength"),
        ("criterion = \"principle\"", "materials.glass.fracture.criterion", "principal"),
    ];
    for (lines, key, words) in cases {
        let place =
            Workplace::new(&BAR.replace("[materials.glass.contact]", &format!("{lines}\n[materials.glass.contact]")));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{lines}: {}", ended.stderr);
        assert!(ended.stderr.contains(key) && ended.stderr.contains(words), "{lines}: {}", ended.stderr);
    }
    let every = [
        ("criterion = \"beam\"\nmoments = \"largest\"", "the largest principal stress in the beam: 60 MPa"),
        ("criterion = \"hydrostatic\"", "the mean virial stress of the particle: 60 MPa"),
        ("level = 2\ncompressive_strength = \"700 MPa\"", "two rings of neighbours: 60 MPa in tension, 700 MPa"),
        ("criterion = \"mohr-coulomb\"\nfriction_angle = \"30 deg\"", "friction angle 30.0 deg"),
        ("criterion = \"drucker-prager\"\nlevel = 0", "Drucker-Prager on the virial stress of each particle: 60 MPa"),
    ];
    for (lines, words) in every {
        let place =
            Workplace::new(&BAR.replace("[materials.glass.contact]", &format!("{lines}\n[materials.glass.contact]")));
        let ended = place.fractum(&["check", "case.toml"]);
        assert!(ended.stdout.contains(words), "{lines}: {}{}", ended.stdout, ended.stderr);
    }
}

#[test]
fn a_strength_in_compression_that_is_not_given_is_not_calibrated() {
    let lines = "tensile_strength = \"60 MPa\"\ncriterion = \"mohr-coulomb\"";
    let place = Workplace::new(&BAR.replace("criterion_strength = \"60 MPa\"", lines));
    let checked = place.fractum(&["check", "case.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    let words = "strength in compression is not calibrated, as no compressive_strength is given";
    assert!(checked.stdout.contains(words) && !checked.stdout.contains("prisms"), "{}", checked.stdout);
}

/// The bar at rest: the same case but for the solver and for velocities that only motion has.
fn at_rest() -> String {
    let bar = BAR.replace("initial_velocity = { x = \"rate*x/length\" }\n", "");
    let probes = r#"
[[probes]]
name = "front"
crack = { measure = "front", along = "x", where = "z > 0.5 mm" }
"#;
    let bar = bar + probes;
    bar.replace("end = \"0.3 us\"", "end = \"0.3 us\"\nkind = \"static\"")
}

#[test]
fn the_same_case_breaks_at_rest_from_break_to_break() {
    let place = Workplace::new(&at_rest());
    let one = run(&place, "one", "1");
    let energy = |name: &str| one["energy"][name].as_f64().unwrap();
    let broken = one["counts"]["broken_bonds"].as_u64().unwrap();
    assert!(broken > 50 && energy("kinetic") == 0.0, "{one}");
    assert!(energy("residual_max_relative") < 1e-4 && energy("removed") > 0.0, "{}", one["energy"]);
    assert!(energy("damping") > 0.0, "what sudden equilibria set free: {}", one["energy"]);
    assert_eq!(one["fracture"][0]["broken_bonds"].as_u64(), Some(broken));
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));

    // The load before the first break is the stiffness times the stretch: no motion, no wave.
    let history = fs::read_to_string(place.path("one/history.csv")).unwrap();
    let mut rows = history.lines();
    let columns: Vec<&str> = rows.next().unwrap().split(',').collect();
    assert!(rows.next().unwrap().starts_with("0,"), "the history begins at rest");
    let first: Vec<f64> = rows.next().unwrap().split(',').map(|v| v.parse().unwrap()).collect();
    let column = |name: &str| columns.iter().position(|c| c.starts_with(name)).unwrap();
    let strain = 20.0 * first[column("time")] / 2e-3;
    let young = first[column("pull")] / (1e-6 * strain);
    assert!((young / 72e9 - 1.0).abs() < 0.1, "{young:e}");
    let load = fs::read_to_string(place.path("one/cracks.csv")).unwrap();
    let time = load.lines().nth(1).unwrap().split(',').nth(5).unwrap().parse::<f64>().unwrap();
    assert!((time / first[column("time")] - 1.0).abs() < 1e-12, "the first row after it is the first break");

    // Probes look at the broken bonds: nothing before the first, then the farthest of those that count.
    let cracks = load.lines().skip(1).map(|line| line.split(',').collect::<Vec<&str>>());
    let places = cracks.map(|row| [6, 8].map(|k| row[k].parse::<f64>().unwrap()));
    let front = places.filter(|[_, z]| *z > 0.5e-3).map(|[x, _]| x).fold(f64::NAN, f64::max);
    assert_eq!(one["probes"]["front"]["final"].as_f64(), Some(front));
    assert!(first[column("front")].is_nan());
}

#[test]
fn helix_and_cone_have_an_axis_and_the_other_measures_have_none() {
    let probe = |text: &str| format!("{BAR}\n[[probes]]\nname = \"shape\"\ncrack = {{ {text} }}\n");
    let point = r#"point = ["0 m", "0 m", "1 mm"]"#;
    for measure in ["helix", "cone", "cone_share"] {
        let place = Workplace::new(&probe(&format!("measure = \"{measure}\", along = \"z\", {point}")));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(0), "{measure}: {}", ended.stderr);
    }
    let place = Workplace::new(&probe(&format!("measure = \"angle\", along = \"z\", {point}")));
    let ended = place.fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("no effect with this measure"), "{}", ended.stderr);
    let place = Workplace::new(&probe("measure = \"cone\", along = \"z\", where = \"z > 1 m\""));
    let ended = place.fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("no bond that may break"), "{}", ended.stderr);
}

#[test]
fn the_laboratory_lists_the_fragments_at_rest_and_in_motion() {
    let place = Workplace::new(BAR);
    let sample = ["--box", "2 mm,1 mm,1 mm", "--count", "300", "--density", "2000 kg/m^3", "-o", "out"];
    let ended = place.fractum(&[&["lab", "break", "tension", "--transits", "5"][..], &sample].concat());
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for (file, moves) in [("out/fragments.csv", false), ("out/motion-fragments.csv", true)] {
        let text = fs::read_to_string(place.path(file)).unwrap();
        let rows: Vec<Vec<f64>> =
            text.lines().skip(1).map(|line| line.split(',').map(|v| v.parse().unwrap()).collect()).collect();
        assert!(rows.len() > 1 && rows.windows(2).all(|w| w[0][1] >= w[1][1]), "{text}");
        assert_eq!((rows[0][0], rows.iter().map(|row| row[3]).sum::<f64>()), (1.0, 300.0));
        // The measured body is that of the packing's faces, a little off the box.
        let mass: f64 = rows.iter().map(|row| row[1]).sum();
        assert!((mass / 4e-6 - 1.0).abs() < 0.1, "{mass:e}");
        assert!(rows.iter().all(|row| (row[1] / row[2] / 2000.0 - 1.0).abs() < 1e-9));
        assert_eq!(rows.iter().any(|row| row[8..11].iter().any(|v| *v != 0.0)), moves);
    }
}

#[test]
fn what_cannot_be_solved_from_break_to_break_says_why() {
    let cases = [
        (
            "velocity = { x = \"rate\" }",
            "velocity = { x = \"rate*t/1 us\" }",
            "does not move along x in proportion to time",
        ),
        ("[solver]", "[[loads]]\ngravity = { z = \"-9.81 m/s^2*sin(t/0.1 us)\" }\n[solver]", "in proportion to time"),
        ("kind = \"static\"", "kind = \"static\"\ncontrol = \"path\"", "from break to break"),
        ("coordination = 8", "coordination = 8\ninitial_velocity = { x = \"1 m/s\" }", "a body at rest"),
    ];
    for (from, to, words) in cases {
        let place = Workplace::new(&at_rest().replace(from, to));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{to}: {}", ended.stderr);
        assert!(ended.stderr.contains(words) && ended.stderr.contains("solver.kind"), "{to}: {}", ended.stderr);
    }
}

#[test]
fn strength_is_calibrated_with_the_stress_of_walls_where_that_is_asked() {
    let place = Workplace::new("");
    let calibrate = |folder: &str, more: &[&str]| {
        let asked =
            ["calibrate", "--young", "72 GPa", "--poisson", "0.23", "--strength", "50 MPa", "--particles", "400"];
        place.fractum(&[&asked[..], &["-o", folder], more].concat())
    };
    let strength = |folder: &str| {
        let text = fs::read_to_string(place.path(folder).join("material.toml")).unwrap();
        let line = text.lines().find(|line| line.starts_with("criterion_strength")).unwrap().to_owned();
        (line.split('"').nth(1).unwrap().trim_end_matches(" Pa").parse::<f64>().unwrap(), text)
    };
    assert_eq!(calibrate("inside", &[]).code, Some(0));
    assert_eq!(calibrate("at-walls", &["--at-walls"]).code, Some(0));
    let ((inside, without), (at_walls, with)) = (strength("inside"), strength("at-walls"));
    assert!(with.contains("at_walls = true") && !without.contains("at_walls"), "{with}");
    // The stress at the wall is the larger one, and needs the larger strength.
    assert!(at_walls > inside && at_walls < 1.5 * inside, "{inside} {at_walls}");
    let beams = calibrate("beams", &["--at-walls", "--criterion", "beam"]);
    assert!(beams.code == Some(1) && beams.stderr.contains("no effect on single beams"), "{}", beams.stderr);
}
