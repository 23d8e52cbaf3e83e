//! Rigid bodies that press with a given force, as their user meets them.

use crate::common::{Workplace, resumed, run};

/// Beads between two planes and fixed walls: a floor, and a lid that presses.
const OEDOMETER: &str = r#"fractum = 1
title = "Beads pressed by a lid"

[materials.soft]
density = "2500 kg/m^3"
young_modulus = "5 MPa"
poisson_ratio = 0.25
contact = { friction = 0.3, restitution = 0.5 }

[[bodies]]
name = "beads"
kind = "particles"
material = "soft"
shape = "box"
size = ["12 mm", "12 mm", "14 mm"]
particle_radius = "1 mm"
dispersion = 0.3
seed = SEED

[[bodies]]
name = "walls"
kind = "rigid"
shape = "box"
inside = true
point = [0, 0, "-10 mm"]
size = ["12 mm", "12 mm", "60 mm"]
contact = { friction = 0 }

[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"

[[bodies]]
name = "lid"
kind = "rigid"
shape = "plane"
point = [0, 0, "14 mm"]
normal = "-z"
[bodies.servo]
pressure = PRESSURE
area = "144 mm^2"
speed = "100 mm/s"

[solver]
end = "0.2 s"

[[probes]]
name = "lid"
reaction = { group = "lid", along = "-z" }
[[probes]]
name = "way"
displacement = { group = "lid", along = "-z" }
[[probes]]
name = "pressure"
expression = "lid/144 mm^2"
unit = "Pa"
[[probes]]
name = "held"
expression = "at(pressure, 0.17 s)"

[output]
history = { every = "1 ms" }
fields = { every = "50 ms" }
checkpoint = { steps = 23000 }
"#;

fn oedometer(pressure: &str, seed: &str) -> String {
    OEDOMETER.replace("PRESSURE", pressure).replace("SEED", seed)
}

#[test]
fn a_lid_reaches_its_pressure_and_holds_it_with_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let case = oedometer(r#"{ smooth_ramp = [["0 s", "200 Pa"], ["0.1 s", "5 kPa"]] }"#, "1");
    let place = Workplace::new(&case);
    let one = run(&place, "one", "1");
    let value = |name: &str| one["probes"][name]["final"].as_f64().unwrap();
    assert!((value("pressure") / 5e3 - 1.0).abs() < 0.01, "{}", one["probes"]);
    assert!((one["probes"]["held"]["final"].as_f64().unwrap() / 5e3 - 1.0).abs() < 0.01, "{}", one["probes"]);
    assert!(value("way") > 1e-3, "{}", one["probes"]);
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", one["energy"]);
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    let resumed = resumed(&place, "two");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
}

#[test]
fn another_packing_and_another_pressure_are_held_as_well() {
    for (pressure, seed) in [(1e3, "2"), (2e4, "3")] {
        let case =
            oedometer(&format!(r#"{{ smooth_ramp = [["0 s", {}], ["0.1 s", {pressure}]] }}"#, 0.05 * pressure), seed);
        let place = Workplace::new(&case);
        let one = run(&place, "one", "1");
        let reached = one["probes"]["pressure"]["final"].as_f64().unwrap();
        assert!((reached / pressure - 1.0).abs() < 0.01, "{pressure} {seed}: {reached}");
        assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", one["energy"]);
    }
}

/// A bar of bonded particles between a fixed plate and one that presses with 20 N shortens by F L/(E A).
#[test]
fn a_plate_loads_a_bonded_bar() {
    const BAR: &str = r#"fractum = 1
title = "A bar under a plate"
[materials.soft]
density = "2500 kg/m^3"
young_modulus = "1 GPa"
poisson_ratio = 0.2
[[bodies]]
name = "bar"
kind = "bonded"
material = "soft"
shape = "box"
size = ["20 mm", "10 mm", "10 mm"]
particles = 600
[[bodies]]
name = "base"
kind = "rigid"
shape = "plane"
normal = "x"
contact = { friction = 0 }
[[bodies]]
name = "plate"
kind = "rigid"
shape = "box"
point = ["20 mm", "-5 mm", "-5 mm"]
size = ["2 mm", "20 mm", "20 mm"]
contact = { friction = 0 }
[bodies.servo]
along = "-x"
force = { smooth_ramp = [["0 s", "0 N"], ["3 ms", "20 N"]] }
speed = "0.1 m/s"
[solver]
end = "4 ms"
[damping]
local = 0.2
[[probes]]
name = "force"
reaction = { group = "plate", along = "-x" }
[[probes]]
name = "way"
displacement = { group = "plate", along = "-x" }
"#;
    let place = Workplace::new(BAR);
    let one = run(&place, "one", "1");
    let value = |name: &str| one["probes"][name]["final"].as_f64().unwrap();
    assert!((value("force") / 20.0 - 1.0).abs() < 0.01, "{}", one["probes"]);
    // Two faces take 1.8 % of it: 600 particles are some 9 across.
    let shortening = 20.0 * 20e-3 / (1e9 * 100e-6);
    assert!((value("way") / shortening - 1.0).abs() < 0.05, "{} of {shortening}", value("way"));
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", one["energy"]);
}

#[test]
fn a_servo_that_finds_nothing_to_press_is_told() {
    let place = Workplace::new(&oedometer("\"5 kPa\"", "1").replace("\"14 mm\"]\nnormal", "\"44 mm\"]\nnormal"));
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--quiet", "--set", "solver.end=5 ms"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    for words in ["[servo]", "\"lid\"", "presses with 0 N at the end, and 720 mN are asked for", "servo.speed"] {
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
}
