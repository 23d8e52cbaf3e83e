//! Boxes through whose sides particles meet: against the same particles away from the sides, the stress of lattices, gases, and what cannot
//! be beside them.

use std::fs;

use serde_json::Value;

use crate::common::{Ended, Workplace, files_below, history, resumed, run};

/// Young's modulus [Pa], Poisson's ratio and radius [m] of the particles of lattices.
const ELASTIC: (f64, f64, f64) = (10e6, 0.3, 1e-3);

/// A case of beads from `beads.csv` in a box of 10 mm; `MORE` is put in.
const BEADS: &str = r#"fractum = 1
[materials.soft]
density = "2500 kg/m^3"
young_modulus = "10 MPa"
poisson_ratio = 0.3
contact = { friction = 0.4, restitution = 0.7, rolling_friction = 0.1 }
[[bodies]]
name = "beads"
kind = "particles"
material = "soft"
file = "beads.csv"
unit = "mm"
velocity_unit = "m/s"
MORE
[[probes]]
name = "force"
periodic_box = "stress_xx"
[[probes]]
name = "shear"
periodic_box = "stress_xy"
[[probes]]
name = "swirl"
velocity = { group = "beads", where = "z < 5.1 mm", along = "y" }
[output]
history = { every = "20 us" }
"#;

fn beads(more: &str, places: &[[f64; 3]], velocities: &[[f64; 3]]) -> Workplace {
    of_beads(&BEADS.replace("MORE", more), places, velocities)
}

fn of_beads(case: &str, places: &[[f64; 3]], velocities: &[[f64; 3]]) -> Workplace {
    let place = Workplace::new(case);
    let row = |([x, y, z], [u, v, w]): (&[f64; 3], &[f64; 3])| format!("{x},{y},{z},1,{u},{v},{w}\n");
    let rows: String = places.iter().zip(velocities).map(row).collect();
    fs::write(place.path("beads.csv"), format!("x,y,z,radius,vx,vy,vz\n{rows}")).unwrap();
    place
}

#[test]
fn two_beads_meet_through_sides_as_they_do_in_the_middle() {
    let more = "[periodic]\nsize = [\"10 mm\", \"10 mm\", \"10 mm\"]\n[solver]\nend = \"8 ms\"";
    // Numbers that binary fractions hold: images are no rounding away.
    let (apart, velocities) = ([2.0, 0.625, 0.375], [[0.1, 0.02, -0.03], [-0.2, 0.01, 0.05]]);
    let columns = ["force", "shear", "swirl", "kinetic", "contact", "friction", "damping"];
    let of = |first: [f64; 3]| {
        let second = [0, 1, 2].map(|k| (first[k] + apart[k]) % 10.0);
        let place = beads(more, &[first, second], &velocities);
        run(&place, "out", "1");
        history(&place, "out", &columns)
    };
    let middle = of([4.0, 5.0, 5.0]);
    let largest = |k: usize| middle.iter().map(|row| row[k].abs()).fold(0.0, f64::max);
    assert!((0..columns.len()).all(|k| largest(k) > 0.0), "they touch and rub");
    for first in [[9.0, 5.0, 5.0], [9.0, 9.75, 5.0], [4.0, 5.0, 9.875]] {
        let through = of(first);
        assert_eq!(through.len(), middle.len());
        for (row, other) in through.iter().zip(&middle) {
            for k in (0..columns.len()).filter(|&k| k != 2 || first[2] == 5.0) {
                assert!((row[k] - other[k]).abs() < 1e-9 * largest(k), "{}: {} and {}", columns[k], row[k], other[k]);
            }
        }
    }
}

/// A face-centred lattice of beads that just touch: three cells along each axis, in mm.
fn lattice() -> Vec<[f64; 3]> {
    let width = 2.0 * 2f64.sqrt();
    let base = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let cells = (0..27).map(|n| [n % 3, n / 3 % 3, n / 9].map(f64::from));
    cells.flat_map(|cell| base.map(|own| [0, 1, 2].map(|k| (cell[k] + own[k]) * width))).collect()
}

/// Pressure of the lattice under an isotropic compression e, and its shear modulus under it [Pa], by the forces of Hertz and the stiffnesses of
/// Hertz and Mindlin over a cell of four beads with 24 contacts.
fn stress_of_lattice(e: f64) -> (f64, f64) {
    let (young, nu, radius) = ELASTIC;
    let (e_star, g_star) = (young / (2.0 * (1.0 - nu * nu)), young / (4.0 * (1.0 + nu) * (2.0 - nu)));
    let overlap = 2.0 * radius * e;
    let distance = 2.0 * radius - overlap;
    let volume = (distance * 2f64.sqrt()).powi(3);
    let root = (0.5 * radius * overlap).sqrt();
    let force = 4.0 / 3.0 * e_star * root * overlap;
    let (normal, tangential) = (2.0 * e_star * root, 8.0 * g_star * root);
    // Along (1, ±1, 0) shear changes the overlap, along (0, 1, ±1) it slides; what is pressed already turns.
    let pressure = 24.0 * force * distance / (3.0 * volume);
    (pressure, 2.0 * distance * distance / volume * (normal + tangential))
}

#[test]
fn a_lattice_has_the_stress_of_its_contacts() {
    for e in [1e-4, 4e-4] {
        let more = format!(
            r#"[periodic]
size = ["6 mm*sqrt(2)", "6 mm*sqrt(2)", "6 mm*sqrt(2)"]
[periodic.strain_rate]
xx = "if(t < 20 ms, log(1 - {e})/(20 ms), 0/(1 s))"
yy = "if(t < 20 ms, log(1 - {e})/(20 ms), 0/(1 s))"
zz = "if(t < 20 ms, log(1 - {e})/(20 ms), 0/(1 s))"
xy = "if(t < 20 ms, 0/(1 s), 0.01*{e}/(20 ms)*(1 - cos(2*pi*(t - 20 ms)/(20 ms))))"
[solver]
end = "40 ms"
[[probes]]
name = "pressure"
periodic_box = "pressure"
[[probes]]
name = "strain"
periodic_box = "strain_xx"
[[probes]]
name = "angle"
periodic_box = "strain_xy"
[[probes]]
name = "coordination"
periodic_box = "coordination""#
        );
        let places = lattice();
        let place = beads(&more, &places, &vec![[0.0; 3]; places.len()]);
        let summary = run(&place, "out", "1");
        let value = |name: &str| summary["probes"][name]["final"].as_f64().unwrap();
        // The rate ends within a step, of which the middle counts.
        let half_a_step = 0.5 * summary["time"]["dt"].as_f64().unwrap();
        assert!((value("strain") / -e - 1.0).abs() < 1.01 * half_a_step / 20e-3, "{}", value("strain"));
        assert_eq!(value("coordination"), 12.0);
        let (pressure, modulus) = stress_of_lattice(-value("strain"));
        assert!((value("pressure") / pressure - 1.0).abs() < 1e-3, "{} and {pressure}", value("pressure"));
        let shear = modulus * value("angle");
        assert!((value("shear") / shear - 1.0).abs() < 1e-3, "{} and {shear}", value("shear"));
        assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    }
}

/// Beads that bounce without loss, and rub nowhere.
const GAS: &str = r#"fractum = 1
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "20 MPa"
poisson_ratio = 0.3
contact = { friction = 0, restitution = 1 }
[[bodies]]
name = "beads"
kind = "particles"
material = "glass"
file = "beads.csv"
unit = "mm"
velocity_unit = "m/s"
[periodic]
size = ["20 mm", "20 mm", "20 mm"]
[solver]
end = "0.4 s"
[[probes]]
name = "pressure"
periodic_box = "pressure"
[[probes]]
name = "fraction"
periodic_box = "solid_fraction"
[[probes]]
name = "px"
momentum = { along = "x" }
[[probes]]
name = "py"
momentum = { along = "y" }
[[probes]]
name = "pz"
momentum = { along = "z" }
[output]
history = { every = "20 us" }
"#;

/// Carnahan and Starling (1969): p V/(N k T) of hard spheres at a solid fraction φ is (1 + φ + φ² - φ³)/(1 - φ)³.
#[test]
fn a_gas_keeps_its_energy_and_has_the_pressure_of_hard_spheres() {
    let places: Vec<[f64; 3]> = (0..100).map(|n| [4 * (n % 5), 4 * (n / 5 % 5), 5 * (n / 25)].map(f64::from)).collect();
    let wave = |n: usize, k: usize| 0.4 * (1.0 + 7.3 * n as f64 + (31 * n + 11) as f64 * 0.77 * (k + 1) as f64).sin();
    let velocities: Vec<[f64; 3]> = (0..100).map(|n| [0, 1, 2].map(|k| wave(n, k))).collect();
    let place = of_beads(GAS, &places, &velocities);
    let summary = run(&place, "out", "2");
    assert!(summary["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", summary["energy"]);
    let rows = history(&place, "out", &["kinetic", "contact", "pressure", "px", "py", "pz"]);
    let start = rows[0][0];
    assert!(rows.iter().all(|row| ((row[0] + row[1]) / start - 1.0).abs() < 1e-3));
    let mass = 100.0 * 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-9;
    let momentum = (2.0 * start * mass).sqrt();
    assert!(rows.iter().all(|row| (3..6).all(|k| (row[k] - rows[0][k]).abs() < 1e-10 * momentum)));
    let phi = summary["probes"]["fraction"]["final"].as_f64().unwrap();
    assert!((phi - mass / 2500.0 / 8e-6).abs() < 1e-9);
    // Without the motion of the centre of mass.
    let common = (3..6).map(|k| rows[0][k] * rows[0][k]).sum::<f64>() / (2.0 * mass);
    let mean = |k: usize| rows.iter().map(|row| row[k]).sum::<f64>() / rows.len() as f64;
    let hard = (1.0 + phi + phi * phi - phi.powi(3)) / (1.0 - phi).powi(3);
    let expected = 2.0 / 3.0 * (mean(0) - common) / 8e-6 * hard;
    assert!((mean(2) / expected - 1.0).abs() < 0.03, "{} and {expected} Pa", mean(2));
}

/// Beads that are pressed together and sheared.
const SHEAR: &str = r#"fractum = 1
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "5 MPa"
poisson_ratio = 0.3
contact = { friction = 0.5, restitution = 0.5 }
[[bodies]]
name = "beads"
kind = "particles"
material = "glass"
shape = "box"
size = ["12 mm", "12 mm", "12 mm"]
particle_radius = "1 mm"
dispersion = 0.2
[periodic]
size = ["12 mm", "12 mm", "12 mm"]
[periodic.strain_rate]
xy = { ramp = [["0 s", "20 1/s"], ["0.1 s", "30 1/s"]] }
xz = "5 1/s"
[periodic.servo]
stress = { xx = "-1 kPa", yy = "-1 kPa", zz = "-1 kPa" }
rate = "20 1/s"
[solver]
end = "0.1 s"
[[probes]]
name = "pressure"
periodic_box = "pressure"
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
name = "xz"
periodic_box = "stress_xz"
[[probes]]
name = "volume"
periodic_box = "volume"
[[probes]]
name = "long"
periodic_box = "strain_xx"
[[probes]]
name = "high"
periodic_box = "strain_yy"
[[probes]]
name = "wide"
periodic_box = "strain_zz"
[[probes]]
name = "momentum"
momentum = { along = "x" }
[output]
history = { every = "20 us" }
fields = { every = "0.1 s", xyz = true }
checkpoint = { steps = 11000 }
"#;

/// Σ V σ : L Δt over rows of volume, stresses xx yy zz xy xz and stretches along x, y, z [J].
fn work_of_box(rows: &[Vec<f64>], step: f64) -> f64 {
    let mut work = 0.0;
    for (index, pair) in rows.windows(2).enumerate() {
        let mean: Vec<f64> = pair[0].iter().zip(&pair[1]).map(|(a, b)| 0.5 * (a + b)).collect();
        let stretch = |k: usize| ((1.0 + pair[1][k]) / (1.0 + pair[0][k])).ln();
        let time = (index as f64 + 0.5) * step;
        let shear = [20.0 + 100.0 * time, 5.0].map(|rate| rate * step);
        let normal: f64 = (0..3).map(|k| mean[1 + k] * stretch(6 + k)).sum();
        work += mean[0] * (normal + mean[4] * shear[0] + mean[5] * shear[1]);
    }
    work
}

#[test]
fn a_bed_is_sheared_with_the_same_bits_and_its_box_does_the_work_of_its_stress() {
    let place = Workplace::new(SHEAR);
    let one = run(&place, "one", "1");
    let energy = |name: &str| one["energy"][name].as_f64().unwrap();
    assert!(energy("residual_max_relative") < 1e-3, "{}", one["energy"]);
    let names = ["volume", "xx", "yy", "zz", "xy", "xz", "long", "high", "wide", "periodic_box", "momentum", "kinetic"];
    let rows = history(&place, "one", &names);
    let late = &rows[rows.len() / 2..];
    let held = [1, 2, 3].map(|k| late.iter().map(|row| row[k]).sum::<f64>() / late.len() as f64);
    assert!(held.iter().all(|stress| (stress / -1e3 - 1.0).abs() < 0.05), "{held:?} Pa");
    let (work, booked) = (work_of_box(&rows, 20e-6), energy("periodic_box"));
    assert!((work / booked - 1.0).abs() < 0.01, "{work} and {booked} J");
    let mass = 2500.0 * 0.25 * 12e-3f64.powi(3);
    assert!(rows.iter().all(|row| row[10].abs() < 1e-12 * mass), "no momentum comes in: {:?}", rows.last());
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    let resumed = resumed(&place, "two");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
    shown_within(&place);
}

/// The last frame has the box and all particles in it.
fn shown_within(place: &Workplace) {
    let files = files_below(&place.path("one").join("particles"), ".xyz");
    let text = fs::read_to_string(files.last().unwrap()).unwrap();
    let mut lines = text.lines().skip(1);
    let header = lines.next().unwrap();
    let of = |name: &str| -> Vec<f64> {
        let start = header.find(name).unwrap() + name.len() + 2;
        header[start..].split('"').next().unwrap().split(' ').map(|v| v.parse().unwrap()).collect()
    };
    let (edges, corner) = (of("Lattice"), of("Origin"));
    assert!(header.contains("pbc=\"T T T\"") && edges[3].abs() <= 0.5001 * edges[0], "{header}");
    for line in lines {
        let place: Vec<f64> = line.split(' ').skip(2).take(3).map(|v| v.parse().unwrap()).collect();
        let [x, y, z] = [0, 1, 2].map(|k| place[k] - corner[k]);
        let up = z / edges[8];
        let deep = (y - up * edges[7]) / edges[4];
        let along = (x - up * edges[6] - deep * edges[3]) / edges[0];
        assert!([along, deep, up].iter().all(|part| (-1e-9..=1.0 + 1e-9).contains(part)), "{line}");
    }
}

#[test]
fn a_bead_slides_on_a_plane_through_the_sides() {
    let more = r#"[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"
contact = { friction = 0 }
[[loads]]
gravity = { z = "-9.81 m/s^2" }
[periodic]
axes = ["x", "y"]
size = ["10 mm", "10 mm", "10 mm"]
[solver]
end = "0.2 s"
[[probes]]
name = "way"
displacement = { group = "beads", along = "x" }"#;
    let place = beads(more, &[[1.0, 9.0, 0.999]], &[[0.4, 0.0, 0.0]]);
    let summary = run(&place, "out", "1");
    let way = summary["probes"]["way"]["final"].as_f64().unwrap();
    assert!((way - 0.08).abs() < 1e-6, "{way} m: eight times through the box");
}

fn refused(more: &str, words: &[&str]) {
    let place = beads(more, &[[1.0, 1.0, 1.0], [4.0, 4.0, 4.0]], &[[0.0; 3]; 2]);
    let ended: Ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(1), "{more}: {}", ended.stderr);
    words.iter().for_each(|word| assert!(ended.stderr.contains(word), "expected {word}: {}", ended.stderr));
}

#[test]
fn what_a_periodic_box_cannot_be_beside_is_refused_by_name() {
    let with = |box_of: &str, rest: &str| format!("{rest}\n[periodic]\n{box_of}\n[solver]\nend = \"1 ms\"");
    let size = "size = [\"10 mm\", \"10 mm\", \"10 mm\"]";
    refused(&with("size = [\"10 mm\", \"4 mm\", \"10 mm\"]", ""), &["periodic.size", "along y", "4.4 mm or more"]);
    refused(&with("", ""), &["periodic.size", "missing"]);
    refused(&with(&format!("{size}\naxes = [\"w\"]"), ""), &["periodic.axes", "\"w\" is no axis"]);
    refused(&with(&format!("{size}\naxes = []"), ""), &["repeats along no axis"]);
    let rates = |of: &str| format!("{size}\naxes = [\"x\", \"z\"]\nstrain_rate = {{ {of} }}");
    refused(
        &with(&rates("xy = \"1 1/s\""), ""),
        &["periodic.strain_rate.xy", "along y, along which it does not repeat"],
    );
    let both = "strain_rate = { xx = \"1 1/s\" }\nservo = { stress = { xx = \"-1 kPa\" }, rate = \"1 1/s\" }";
    refused(&with(&format!("{size}\n{both}"), ""), &["periodic.servo.stress.xx", "strain_rate gives its rate too"]);
    let deforms = format!("{size}\nstrain_rate = {{ xy = \"1 1/s\" }}");
    refused(&with(&deforms, "[damping]\nlocal = 0.1"), &["damping would act on its mean flow"]);
    refused(&with(&deforms, "[[supports]]\ngroup = \"beads\"\nfix = \"x\""), &["supports would hold particles"]);
    let floor = "[[bodies]]\nname = \"floor\"\nkind = \"rigid\"\nshape = \"plane\"\nnormal = \"z\"";
    refused(&with(size, floor), &["\"floor\"", "would cross sides of the periodic box"]);
    let bonded = "[[bodies]]\nname = \"rock\"\nkind = \"bonded\"\nmaterial = \"soft\"\nshape = \"box\"\nsize = [\"1 mm\", \"1 mm\", \"1 mm\"]";
    refused(&with(size, bonded), &["\"rock\" is bonded and not alone"]);
    let domain =
        format!("[periodic]\n{size}\n[solver]\nend = \"1 ms\"\ndomain = {{ min = [0, 0, 0], max = [1, 1, 1] }}");
    refused(&domain, &["which nothing leaves"]);
    let without = "[solver]\nend = \"1 ms\"";
    refused(without, &["the case has no periodic box", "a table [periodic]"]);
}

#[test]
fn free_fall_in_a_periodic_box_is_told() {
    let more = "[periodic]\nsize = [\"10 mm\", \"10 mm\", \"10 mm\"]\n[solver]\nend = \"0.1 ms\"\n[[loads]]\ngravity = { z = \"-9.81 m/s^2\" }";
    let place = beads(more, &[[1.0, 1.0, 1.0], [4.0, 4.0, 4.0]], &[[0.0; 3]; 2]);
    let summary: Value = run(&place, "out", "1");
    let told = summary["warnings"].as_array().unwrap().iter().any(|warning| warning["code"] == "free-fall");
    assert!(told, "{}", summary["warnings"]);
}
