//! Gauges of experiments: tables on a grid for every frame, and extensometers.

use std::fs;

use crate::common::{BONDED_BAR, FLYING, Workplace, files_below, history, run};

/// A bar without lateral contraction that is stretched by 1.5e-4 along x.
const STRETCHED: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
supports = [{ group = "x-", fix = "xyz" }, { group = "x+", displacement = { x = "0.06 mm*t/1 s" } }]
solver = { kind = "static", end = "1 s" }
probes = [
  { name = "clip", extensometer = { group = "body", from = ["5 cm", 0, 0], to = ["30 cm", "4 cm", 0] } },
  { name = "foil", extensometer = { group = "body", from = ["10 cm", "12 cm", "6 cm"], to = ["20 cm", "12 cm", "6 cm"], foot = "9 cm" } },
]
[materials.cork]
density = "200 kg/m^3"
young_modulus = "30 MPa"
poisson_ratio = 0
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "cork"
[[output.gauges]]
name = "inside"
group = "body"
from = [0, 0, 0]
to = ["40 cm", "12 cm", "12 cm"]
spacing = "6 cm"
length = "15 cm"
[[output.gauges]]
name = "side"
group = "y-"
from = [0, 0, 0]
to = ["50 cm", 0, "12 cm"]
spacing = "6 cm"
length = "15 cm"
"#;

const HEAD: &str = "time [s],x [m],y [m],z [m],points,ux [m],uy [m],uz [m],exx,eyy,ezz,exy,eyz,ezx";

/// The rows of the last table of a grid, and how many tables there are.
fn last(place: &Workplace, name: &str) -> (Vec<[f64; 14]>, usize) {
    let files = files_below(&place.path("out/gauges"), ".csv");
    let own = |file: &&std::path::PathBuf| file.file_name().unwrap().to_string_lossy().starts_with(name);
    let text = fs::read_to_string(files.iter().rfind(own).unwrap()).unwrap();
    assert_eq!(text.lines().next(), Some(HEAD));
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        <[f64; 14]>::try_from(numbers).unwrap()
    };
    (text.lines().skip(1).map(row).collect(), files.iter().filter(own).count())
}

#[test]
fn a_stretched_bar_has_its_strain_at_every_place_and_between_the_feet_of_extensometers() {
    let place = Workplace::new(STRETCHED);
    let summary = run(&place, "out", "2");
    let strain = 0.06e-3 / 0.4;
    let (inside, frames) = last(&place, "inside");
    assert_eq!(inside.len(), 8 * 3 * 3);
    assert_eq!(frames, files_below(&place.path("out/fields"), ".vtu").len());
    for [time, x, _, _, points, ux, uy, uz, exx, others @ ..] in inside {
        assert!(time == 1.0 && points > 5.0, "{time} {points}");
        assert!((ux - strain * x).abs() < 1e-12 && uy.abs() < 1e-12 && uz.abs() < 1e-12, "{x}: {ux} {uy} {uz}");
        assert!((exx - strain).abs() < 1e-10 * strain, "{exx}");
        assert!(others.iter().all(|other| other.abs() < 1e-10 * strain), "{others:?}");
    }
    // Places further away than half the gauge length have none; nor has any a strain across the face.
    let (side, _) = last(&place, "side");
    assert!(side.len() < 10 * 3 && side.iter().all(|row| row[1] < 0.475), "{} places", side.len());
    for [.., exx, eyy, ezz, exy, eyz, ezx] in side {
        assert!((exx - strain).abs() < 1e-6 * strain && ezz.abs() < 1e-6 * strain && ezx.abs() < 1e-6 * strain);
        assert!([eyy, exy, eyz].iter().all(|across| across.is_nan()), "{eyy} {exy} {eyz}");
    }
    let found = |name: &str| summary["probes"][name]["final"].as_f64().unwrap();
    let along = 0.25 / 0.04f64.hypot(0.25);
    assert!((found("clip") / (strain * along * along) - 1.0).abs() < 1e-3, "{}", found("clip"));
    assert!((found("foil") / strain - 1.0).abs() < 1e-6, "{}", found("foil"));
}

#[test]
fn particles_have_gauges_too_and_a_new_run_leaves_no_table_of_an_old_one() {
    let grid = "[[output.gauges]]\nname = \"face\"\ngroup = \"bar\"\nwhere = \"z > 0.8 mm\"\nfrom = [0, 0, \"1 mm\"]\n\
                to = [\"2 mm\", \"1 mm\", \"1 mm\"]\nspacing = \"0.25 mm\"\nlength = \"0.8 mm\"\n";
    let place = Workplace::new(&format!("{BONDED_BAR}{grid}"));
    run(&place, "out", "1");
    let (rows, frames) = last(&place, "face");
    assert!(frames > 1 && rows.len() == 9 * 5, "{frames} frames, {} places", rows.len());
    let moved = |end: f64| rows.iter().filter(|row| row[1] == end).map(|row| row[5]).sum::<f64>();
    assert!(moved(2e-3) > moved(0.0), "the pulled end has moved");
    let old = place.path("out/gauges/face-99999.csv");
    fs::write(&old, "old").unwrap();
    let ended = place.fractum(&["run", "case.toml", "-o", "out", "--overwrite", "--quiet"]);
    assert!(ended.code == Some(0) && !old.exists(), "{}", ended.stderr);
}

#[test]
fn probes_have_no_value_once_their_points_have_left_the_domain() {
    let solid = ["strain", "clip", "way", "speed"].map(|name| format!("solid_{name}"));
    let bonded = ["strain", "satake", "clip", "way", "speed", "turn", "stress"].map(|name| format!("bonded_{name}"));
    let [solid, bonded] = [&solid[..], &bonded[..]].map(|names| names.iter().map(String::as_str).collect::<Vec<_>>());
    for (body, leaving, staying) in [("solid", &solid[..], &bonded[..]), ("bonded", &bonded[..], &solid[..])] {
        let (before, after) = FLYING.split_at(FLYING.find(&format!("name = \"{body}\"\n")).unwrap());
        let place = Workplace::new(&format!("{before}{}", after.replacen("\"0 m/s\"", "\"600 m/s\"", 1)));
        run(&place, "out", "1");
        let rows = |names: &[&str]| history(&place, "out", &[&["left_pieces"], names].concat());
        assert!(rows(staying).iter().flatten().all(|value| value.is_finite()), "{body}");
        let mut counts = [0, 0];
        for row in rows(leaving) {
            counts[usize::from(row[0] > 0.0)] += 1;
            assert!(row[1..].iter().all(|value| value.is_nan() == (row[0] > 0.0)), "{body}: {row:?}");
        }
        assert!(counts.iter().all(|&count| count > 10), "{body}: rows before and after it has left: {counts:?}");
    }
}

/// A bar without lateral contraction that is stretched everywhere at one rate.
const UNIFORM: &str = r#"fractum = 1
parameters = { rate = "RATE/1 s" }
mesh = { file = "bar.msh" }
supports = [{ group = "x-", velocity = { x = "rate*x" } }, { group = "x+", velocity = { x = "rate*x" } }]
solver = { kind = "explicit", end = "2e-4/rate", safety = SAFETY }
output = { history = { every = "1 ns" } }
probes = [{ name = "stress", stress = { group = "body", component = "xx" } }, { name = "pull", reaction = { group = "x+", along = "x" } }]
[materials.rock]
density = "2400 kg/m^3"
young_modulus = "30 GPa"
poisson_ratio = 0
damage = { tensile_strength = "3 MPa", fracture_energy = "1 kJ/m^2" }
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "rock"
formulation = "FORMULATION"
initial_velocity = { x = "rate*x" }
"#;

#[test]
fn stress_never_passes_the_strength_however_fast_it_comes() {
    for formulation in ["smoothed", "standard"] {
        for (rate, safety) in [("1", 0.8), ("10", 0.8), ("10", 0.3)] {
            let case = UNIFORM.replace("RATE", rate).replace("SAFETY", &safety.to_string());
            let place = Workplace::new(&case.replace("FORMULATION", formulation));
            let summary = run(&place, "out", "1");
            let most = |probe: &str| summary["probes"][probe]["max"].as_f64().unwrap();
            let (stress, pull) = (most("stress"), most("pull"));
            assert!(stress <= 3e6 * (1.0 + 1e-9) && stress > 2.8e6, "{formulation} at {rate}/s: {stress} Pa");
            let area = 0.0144;
            assert!((pull / area / stress - 1.0).abs() < 1e-9, "{formulation} at {rate}/s: {pull} N and {stress} Pa");
        }
    }
}
