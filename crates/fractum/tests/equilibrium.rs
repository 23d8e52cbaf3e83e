//! Quasi-static runs as their user starts them: path and opening control, crack probes, the gate, the advice of `check`.

mod common;

use common::{Workplace, run};

/// A bar with a weak slab in its middle, pulled apart at equilibrium.
const BAR: &str = r#"fractum = 1
title = "A bar at equilibrium"

[mesh]
file = "bar.msh"

[materials.concrete]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0.2
[materials.concrete.damage]
tensile_strength = "3 MPa"
fracture_energy = "100 J/m^2"
crack_plane_gate = true

[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "concrete"
strength_factor = "if(abs(x - 20 cm) < 3 cm, 0.5, 1.0)"

[[supports]]
group = "x-"
fix = "xyz"
[[supports]]
group = "x+"
displacement = { x = "0.4 mm*t/1 s" }

[solver]
kind = "static"
end = "1 s"
stop_when = { probe = "load", below = 0.2 }

[[probes]]
name = "load"
reaction = { group = "x+", along = "x" }
[[probes]]
name = "angle"
crack = { measure = "angle", along = "x" }
[[probes]]
name = "place"
crack = { measure = "centre", along = "x", where = "y < 6 cm" }
"#;

#[test]
fn a_bar_parts_at_its_weak_slab_whatever_controls_the_path() {
    let by_damage = Workplace::new(BAR);
    let opening = r#"kind = "static"
control = "opening"
opening = { group = "x+", against = "x-", along = "x", step = "2 um", end = "0.2 mm" }"#;
    let by_opening = Workplace::new(&BAR.replace("kind = \"static\"", opening));
    let probe = |summary: &serde_json::Value, name: &str, of: &str| summary["probes"][name][of].as_f64().unwrap();
    let first = run(&by_damage, "one", "1");
    assert_eq!(first["state_hash"], run(&by_damage, "two", "2")["state_hash"]);
    let second = run(&by_opening, "one", "1");
    for summary in [&first, &second] {
        let peak = probe(summary, "load", "max") / (0.12 * 0.12);
        assert!((peak / 1.5e6 - 1.0).abs() < 0.08, "{peak} Pa");
        // The crack lies in the middle, rather across the bar than along it: three elements cannot tell better.
        assert!(probe(summary, "angle", "final") > 45f64.to_radians(), "{}", summary["probes"]["angle"]);
        assert!((probe(summary, "place", "final") - 0.2).abs() < 0.02, "{}", summary["probes"]["place"]);
        assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    }
    let peaks = [&first, &second].map(|summary| probe(summary, "load", "max"));
    // A uniform slab may part in more than one way.
    assert!((peaks[0] / peaks[1] - 1.0).abs() < 0.05, "{peaks:?}");
}

#[test]
fn check_compares_motion_and_equilibrium() {
    let place = Workplace::new(BAR);
    let checked = place.fractum(&["check", "case.toml"]);
    assert_eq!(checked.code, Some(0), "{}", checked.stderr);
    for words in ["period ", "periods of motion are", "for slow loading take kind = \""] {
        assert!(checked.stdout.contains(words), "{words}: {}", checked.stdout);
    }
    // A free body has no period of its own.
    let free = BAR.replace("fix = \"xyz\"", "fix = \"x\"").replace("kind = \"static\"", "kind = \"explicit\"");
    let place = Workplace::new(&free);
    let checked = place.fractum(&["check", "case.toml"]);
    assert!(checked.stdout.contains("kind = \"explicit\": a body is free to move"), "{}", checked.stdout);
}

#[test]
fn gate_and_opening_are_refused_where_they_cannot_act() {
    let body = "strength_factor";
    for (from, to, words) in [
        (body, "formulation = \"standard\"\nstrength_factor", "crack_plane_gate = true with the standard formulation"),
        ("kind = \"static\"", "kind = \"static\"\ncontrol = \"opening\"", "solver.opening is missing"),
        (
            "kind = \"static\"",
            "kind = \"static\"\nopening = { group = \"x+\", against = \"x-\", along = \"x\", step = 1e-6, end = 1e-4 }",
            "solver.opening has no effect without control = \"opening\"",
        ),
        ("\"y < 6 cm\"", "\"y > 6 m\"", "no edge of a body that may be damaged fulfils the condition"),
    ] {
        let place = Workplace::new(&BAR.replacen(from, to, 1));
        let ended = place.fractum(&["check", "case.toml"]);
        let found: String = ended.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(ended.code == Some(1) && found.contains(words), "{words}: {}", ended.stderr);
    }
}
