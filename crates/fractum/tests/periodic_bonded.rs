//! Bonded bodies in a box that repeats: at rest and moving through its sides, strained, broken and closed again, and what they cannot be beside.

use std::fs;

use fractum_vtk::Arrays;

use crate::common::{Ended, Workplace, files_below, history, resumed, run};

/// A cube of glass without walls; `MORE` is put in.
const GLASS: &str = r#"fractum = 1
[parameters]
E = "72 GPa"
nu = 0.23
rho = "2500 kg/m^3"
side = "2 mm"
transit = "side*sqrt(rho/E)"
[materials.glass]
density = "rho"
young_modulus = "E"
poisson_ratio = "nu"
BEAMS
FRACTURE
[[bodies]]
name = "cube"
kind = "bonded"
material = "glass"
shape = "box"
point = ["-side/2", "-side/2", "-side/2"]
size = ["side", "side", "side"]
particles = 800
seed = 1
VELOCITY
[periodic]
point = ["-side/2", "-side/2", "-side/2"]
size = ["side", "side", "side"]
MORE
[[probes]]
name = "xx"
periodic_box = "stress_xx"
[[probes]]
name = "yy"
periodic_box = "stress_yy"
[[probes]]
name = "zz"
periodic_box = "stress_zz"
[[probes]]
name = "xy"
periodic_box = "stress_xy"
[[probes]]
name = "volume"
periodic_box = "volume"
[[probes]]
name = "long"
periodic_box = "strain_xx"
[[probes]]
name = "angle"
periodic_box = "strain_xy"
[[probes]]
name = "momentum"
momentum = { along = "x" }
"#;

/// Beams that give it the moduli of glass.
const BEAMS: &str =
    r#"bonds = { radius_ratio = 0.4418, young_modulus = "610.8 GPa", coordination = 8, convention = "interior" }"#;

fn glass(more: &str, velocity: &str, fracture: &str) -> Workplace {
    let case =
        GLASS.replace("MORE", more).replace("BEAMS", BEAMS).replace("VELOCITY", velocity).replace("FRACTURE", fracture);
    Workplace::new(&case)
}

/// Mass of the cube [kg].
const MASS: f64 = 2500.0 * 8e-9;

#[test]
fn a_body_without_walls_keeps_its_rest_and_its_motion_through_the_sides() {
    let more = "[solver]\nend = \"30*transit\"\n[output]\nfields = { every = \"15*transit\", xyz = true }\nhistory = { every = \"transit\" }";
    let still = glass(more, "", "");
    let summary = run(&still, "out", "1");
    // Places are rounded by 1e-16 of the way, each of some thousand times: strains of 1e-12 at most.
    let rounding = 72e9 * 8e-9 * 1e-24;
    assert!(["kinetic", "elastic"].iter().all(|name| summary["energy"][*name].as_f64().unwrap() < rounding));
    // Several times through the box, along all axes.
    let moving = glass(
        more,
        "initial_velocity = { x = \"0.2*side/transit\", y = \"-0.1*side/transit\", z = \"0.07*side/transit\" }",
        "",
    );
    run(&moving, "out", "1");
    let rows = history(&moving, "out", &["kinetic", "elastic", "xx", "xy", "momentum"]);
    let [kinetic, momentum] = [0, 4].map(|k| rows[0][k]);
    for row in &rows {
        assert!((row[0] / kinetic - 1.0).abs() < 1e-12 && (row[4] / momentum - 1.0).abs() < 1e-12, "{row:?}");
        assert!(row[1] < rounding && row[2].abs() < 72e9 * 1e-12 && row[3].abs() < 72e9 * 1e-12, "{row:?}");
    }
    let lines = drawn(&moving);
    assert!(lines.len() > 1000 && lines.iter().all(|length| *length < 0.5e-3), "{}", lines.len());
}

/// Lengths of the bonds that the last frame draws, where its particles are [m].
fn drawn(place: &Workplace) -> Vec<f64> {
    let file = files_below(&place.path("out/bonds"), ".vtp").pop().unwrap();
    let arrays =
        Arrays::read(&fs::read(file).unwrap(), &["Points", "displacement", "connectivity", "offsets"]).unwrap();
    let places = arrays.vectors("Points").into_iter().zip(arrays.vectors("displacement"));
    let places: Vec<[f64; 3]> = places.map(|(x, u)| [0, 1, 2].map(|k| x[k] + u[k])).collect();
    let length = |[i, j]: [u32; 2]| {
        let [a, b] = [i, j].map(|i| places[i as usize]);
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    };
    arrays.cells::<2>().into_iter().map(length).collect()
}

#[test]
fn a_body_is_stretched_and_sheared_with_its_moduli_and_the_work_of_its_box() {
    let more = r#"[periodic.strain_rate]
xx = "1e-4/(20*transit)*(1 - cos(2*pi*t/(20*transit)))"
xy = "1e-4/(20*transit)*(1 - cos(2*pi*t/(20*transit)))"
[solver]
end = "20*transit"
[output]
history = { every = "transit/20" }"#;
    let place = glass(more, "", "");
    let summary = run(&place, "out", "2");
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    let rows = history(&place, "out", &["xx", "yy", "zz", "xy", "volume", "long", "angle", "periodic_box", "elastic"]);
    let last = rows.last().unwrap();
    let (young, nu) = (72e9, 0.23);
    let along = young * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu));
    let aside = along * nu / (1.0 - nu);
    let shear = young / (2.0 * (1.0 + nu));
    for (found, expected) in [(last[0], along), (last[1], aside), (last[2], aside), (last[3], shear)] {
        assert!((found / (1e-4 * expected) - 1.0).abs() < 0.06, "{found} {expected}");
    }
    // Σ V σ : L Δt by rows.
    let work = rows.windows(2).map(|pair| {
        let mean = |k: usize| 0.5 * (pair[0][k] + pair[1][k]);
        mean(4) * (mean(0) * (pair[1][5] - pair[0][5]) + mean(3) * (pair[1][6] - pair[0][6]))
    });
    let (work, booked) = (work.sum::<f64>(), last[7]);
    // Strains are those of a step after the stresses.
    assert!((work / booked - 1.0).abs() < 0.01 && (last[8] / booked - 1.0).abs() < 1e-6, "{work} {booked} {}", last[8]);
}

/// Pulled along x until it parts, and pushed together again.
const TORN: &str = r#"[periodic.strain_rate]
xx = "if(t < 20*transit, 2.5, -4)*7e-4/(20*transit)"
[periodic.servo]
stress = { yy = "0 Pa", zz = "0 Pa" }
rate = "10*7e-4/(20*transit)"
[solver]
end = "40*transit"
[[probes]]
name = "broken"
count = "broken_bonds"
[output]
checkpoint = { steps = 500 }
fields = { every = "10*transit" }
history = { every = "transit/10" }"#;

#[test]
fn a_body_that_parts_and_closes_again_has_the_same_bits_and_keeps_its_balance() {
    let fracture = "fracture = { criterion_strength = \"67.7 MPa\" }";
    let place = glass(TORN, "", fracture);
    let one = run(&place, "one", "1");
    assert!(one["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", one["energy"]);
    let rows = history(&place, "one", &["xx", "broken", "momentum", "friction", "removed"]);
    let peak = rows.iter().map(|row| row[0]).fold(0.0, f64::max);
    assert!((peak / 50e6 - 1.0).abs() < 0.2, "{peak} Pa");
    let last = rows.last().unwrap();
    assert!(last[1] > 100.0 && last[3] > 0.0 && last[4] > 0.0, "{last:?}");
    // Faces meet through the sides.
    assert!(last[0] < -10e6, "{last:?}");
    assert!(rows.iter().all(|row| row[2].abs() < 1e-12 * MASS), "no momentum comes in");
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    let resumed = resumed(&place, "two");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
}

/// Particles of a file on a cubic grid through all sides, with given beams; the corner of the box is within one of them.
const GRID: &str = r#"fractum = 1
[materials.grid]
density = "2500 kg/m^3"
young_modulus = "19.6 GPa"
poisson_ratio = 0
bonds = { radius_ratio = 0.5, young_modulus = "100 GPa", coordination = 6, convention = "all" }
[[bodies]]
name = "grid"
kind = "bonded"
material = "grid"
file = "grid.csv"
unit = "mm"
bond_gap = "0.1 mm"
[periodic]
size = ["5 mm", "5 mm", "5 mm"]
strain_rate = { AXIS = "10 1/s" }
[solver]
end = "10 us"
[[probes]]
name = "stress"
periodic_box = "stress_AXIS"
[[probes]]
name = "strain"
periodic_box = "strain_AXIS"
[[probes]]
name = "bonds"
periodic_box = "coordination"
"#;

#[test]
fn a_grid_from_a_file_has_the_stiffness_of_its_beams_along_every_axis() {
    for axis in ["xx", "yy", "zz"] {
        let place = Workplace::new(&GRID.replace("AXIS", axis));
        let rows = (0..125).map(|n| [n % 5, n / 5 % 5, n / 25]).map(|[x, y, z]| format!("{x},{y},{z},0.5\n"));
        fs::write(place.path("grid.csv"), format!("x,y,z,radius\n{}", rows.collect::<String>())).unwrap();
        let summary = run(&place, "out", "1");
        let last = |name: &str| summary["probes"][name]["final"].as_f64().unwrap();
        assert_eq!(last("bonds"), 6.0);
        // One beam of radius 0.25 mm for each square millimetre; the stress is that of a step before the strain.
        let young = 100e9 * std::f64::consts::PI * 0.25 * 0.25;
        let step = summary["time"]["dt"].as_f64().unwrap() * 10.0;
        let strain = last("strain") - step;
        assert!((last("stress") / (young * strain) - 1.0).abs() < 5e-4, "{axis}: {} {strain}", last("stress"));
        assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    }
}

fn refused(more: &str, velocity: &str, fracture: &str, words: &[&str]) {
    let place = glass(more, velocity, fracture);
    let ended: Ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(1), "{more}: {}", ended.stderr);
    words.iter().for_each(|word| assert!(ended.stderr.contains(word), "expected {word}: {}", ended.stderr));
}

#[test]
fn what_a_bonded_body_in_a_periodic_box_cannot_be_is_refused_by_name() {
    let end = "[solver]\nend = \"transit\"";
    refused(&format!("axes = [\"x\", \"y\"]\n{end}"), "", "", &["does not repeat along all axes", "no periodic.axes"]);
    let beside = "[[bodies]]\nname = \"bead\"\nkind = \"particles\"\nmaterial = \"glass\"\nparticle_radius = \"1 um\"\ncentre = [\"0 m\", \"0 m\", \"0 m\"]";
    refused(end, beside, "", &["\"cube\" is bonded and not alone", "one bonded body"]);
    refused(end, "wall_stiffening = 0.1", "", &["wall_stiffening and no walls"]);
    let at_walls = "fracture = { criterion_strength = \"67.7 MPa\", at_walls = true }";
    refused(end, "", at_walls, &["at_walls is true without walls"]);
    let statics = "[solver]\nkind = \"static\"\nend = \"transit\"";
    refused(statics, "", "", &["is not explicit, and the box is periodic"]);
    let held = format!("{end}\n[[supports]]\ngroup = \"cube.x-\"\nfix = \"x\"");
    refused(&held, "", "", &["a set of particles of \"cube\": cube;", "without walls in its periodic box"]);
    let nonlocal = GLASS.replace("seed = 1", "seed = 1\nbond = \"local-nonlocal\"").replace("MORE", end);
    let nonlocal = nonlocal.replace("VELOCITY", "").replace("FRACTURE", "").replace("BEAMS", "");
    let ended = Workplace::new(&nonlocal).fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("mean strain of particles"), "{}", ended.stderr);
    let deforms = format!("strain_rate = {{ xy = \"1 1/s\" }}\n[damping]\nlocal = 0.1\n{end}");
    refused(&deforms, "", "", &["damping would act on its mean flow"]);
    let moved = GLASS.replacen("point = [\"-side/2\", \"-side/2\", \"-side/2\"]", "point = [0, 0, 0]", 1);
    let moved = moved.replace("MORE", end).replace("BEAMS", BEAMS).replace("VELOCITY", "").replace("FRACTURE", "");
    let ended = Workplace::new(&moved).fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("a bonded body fills it"), "{}", ended.stderr);
}
