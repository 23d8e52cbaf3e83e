//! Particles from files of other programs, and from the frames of an earlier run.

use std::fs;

use crate::common::{Workplace, resumed, run};

/// Two beads above a floor.
const BEADS: &str = r#"fractum = 1
title = "Beads of a file"
[materials.m]
density = "2500 kg/m^3"
young_modulus = "1 MPa"
poisson_ratio = 0.2
[[bodies]]
name = "grains"
kind = "particles"
material = "m"
file = "FILE"
unit = "mm"
MORE
[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"
[[loads]]
gravity = { z = "-9.81 m/s^2" }
[solver]
end = "20 ms"
[[probes]]
name = "bears"
reaction = { group = "floor", along = "z" }
[[probes]]
name = "sink"
displacement = { group = "grains", along = "z" }
[[probes]]
name = "speed"
velocity = { group = "grains", along = "z" }
[output]
fields = { every = "10 ms", xyz = true }
checkpoint = { steps = 900 }
"#;

const FILES: [(&str, &str); 5] = [
    ("a table", "x,y,z,radius\n1,1,1,0.5\n3,1,1,0.5\n"),
    ("a text export of YADE", "#format x_y_z_r\n1.0\t1.0\t1.0\t0.5\n3.0\t1.0\t1.0\t0.5\n"),
    (
        "LAMMPS data file",
        "LAMMPS data file\n\n2 atoms\n1 atom types\n\n0 10 xlo xhi\n0 10 ylo yhi\n0 10 zlo zhi\n\nAtoms # sphere\n\n1 1 1.0 2500 1.0 1.0 1.0\n2 1 1.0 2500 3.0 1.0 1.0\n",
    ),
    (
        "LAMMPS dump",
        "ITEM: TIMESTEP\n100\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp ff\n0 10\n0 10\n0 10\nITEM: ATOMS id type x y z radius\n2 1 3 1 1 0.5\n1 1 1 1 1 0.5\n",
    ),
    ("extended xyz", "2\nProperties=species:S:1:pos:R:3:radius:R:1\nA 1 1 1 0.5\nA 3 1 1 0.5\n"),
];

fn place(file: &str, more: &str, content: &str) -> Workplace {
    let place = Workplace::new(&BEADS.replace("FILE", file).replace("MORE", more));
    fs::write(place.path(file), content).unwrap();
    place
}

#[test]
fn beads_in_millimetres_that_are_read_in_metres_are_told() {
    for (unit, told) in [("unit = \"mm\"\n", false), ("", true), ("unit = \"m\"\n", false)] {
        let place = Workplace::new(&BEADS.replace("FILE", "beads.csv").replace("unit = \"mm\"\nMORE\n", unit));
        fs::write(place.path("beads.csv"), "x,y,z,radius\n1,1,1,1\n4,1,1,1\n").unwrap();
        let ended = place.fractum(&["check", "case.toml"]);
        let warned = ended.stdout.contains("mean radius of 1 m") && ended.stdout.contains("[unit-of-length]");
        assert_eq!((ended.code, warned), (Some(0), told), "{}{}", ended.stdout, ended.stderr);
    }
}

#[test]
fn particles_of_every_format_move_alike() {
    let mut first = None;
    for (format, content) in FILES {
        let place = place("beads.dat", "", content);
        let told = place.fractum(&["check", "case.toml"]);
        assert!(told.stdout.contains(format) && told.stdout.contains("2 particles"), "{format}: {}", told.stdout);
        let found = run(&place, "one", "1")["probes"].clone();
        assert!(found["sink"]["min"].as_f64().unwrap() < -0.4e-3, "{found}");
        assert_eq!(*first.get_or_insert(found.clone()), found, "{format}");
    }
}

#[test]
fn a_run_goes_on_from_the_frame_of_another() {
    let whole = place("beads.dat", "", FILES[0].1);
    let whole_run = run(&whole, "one", "1");
    let frames = |place: &Workplace, number: &str| {
        fs::read_to_string(place.path(&format!("one/particles/particles-{number}.xyz"))).unwrap()
    };
    // Both frames in one file; the first is that at 10 ms.
    let both = frames(&whole, "00001") + &frames(&whole, "00002");
    let more = "velocity_unit = \"m/s\"\nframe = 0\nspecies = \"grains\"";
    let rest = place("both.xyz", more, &both);
    let case = fs::read_to_string(rest.path("case.toml")).unwrap();
    fs::write(rest.path("case.toml"), case.replace("unit = \"mm\"\n", "").replace("\"20 ms\"", "\"10 ms\"")).unwrap();
    let one = run(&rest, "one", "1");
    let speed = |summary: &serde_json::Value| summary["probes"]["speed"]["final"].as_f64().unwrap();
    assert!((speed(&one) / speed(&whole_run) - 1.0).abs() < 2e-3, "{} {}", speed(&one), speed(&whole_run));
    let two = run(&rest, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    let resumed = resumed(&rest, "two");
    assert_eq!((&resumed["state_hash"], &resumed["probes"]), (&one["state_hash"], &one["probes"]));
}

#[test]
fn wrong_files_of_particles_are_explained() {
    let table = FILES[0].1;
    for (more, content, words) in [
        ("frame = 1", table, "bodies[0].file = \"beads.dat\": is a table, which has no frames"),
        ("species = \"sand\"", FILES[4].1, "no particles of the type \"sand\"; it has A"),
        ("velocity_unit = \"m/s\"", table, "is a table, without velocities of all particles"),
        ("velocity_unit = \"m\"", table, "expected a unit of a velocity"),
        ("velocity_unit = \"m/s\"\ninitial_velocity = { z = \"1 m/s\" }", table, "bodies[0].initial_velocity"),
        ("", "2\nProperties=species:S:1:pos:R:3\nA 1 1 1\nA 3 1 1\n", "line 2: has no radius among its properties"),
        ("", &FILES[2].1.replace("3.0 1.0 1.0\n", "3.0 1.0 one\n"), "line 13: `one`; expected a number"),
    ] {
        let ended = place("beads.dat", more, content).fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{more}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{more}: {}", ended.stderr);
    }
    let cloud = BEADS.replace(
        "file = \"FILE\"\nunit = \"mm\"\nMORE",
        "shape = \"sphere\"\nradius = \"5 mm\"\nparticle_radius = \"1 mm\"\nspecies = \"A\"",
    );
    let ended = Workplace::new(&cloud).fractum(&["check", "case.toml"]);
    assert!(ended.code == Some(1) && ended.stderr.contains("bodies[0].species"), "{}", ended.stderr);
}

/// A bar of touching balls in a cubic grid, 12 x 4 x 4 of 1 mm, as LAMMPS data, with bonds along x alone if asked.
fn grid(bonds: bool) -> String {
    let (mut atoms, mut pairs) = (String::new(), String::new());
    let mut count = 0;
    for x in 0..12 {
        for (y, z) in (0..4).flat_map(|y| (0..4).map(move |z| (y, z))) {
            count += 1;
            let at = [x, y, z].map(|k| f64::from(k) + 0.5);
            atoms += &format!("{count} 1 1.0 2500 {} {} {}\n", at[0], at[1], at[2]);
            if bonds && x > 0 {
                pairs += &format!("{count} 1 {} {count}\n", count - 16);
            }
        }
    }
    let head = format!("a grid\n\n{count} atoms\n\nAtoms # sphere\n\n{atoms}");
    if bonds { format!("{head}\nBonds\n\n{pairs}") } else { head }
}

/// The bar is pulled at its ends.
const PULLED: &str = r#"fractum = 1
title = "A bar of own particles"
[materials.m]
density = "2500 kg/m^3"
young_modulus = "1 GPa"
poisson_ratio = 0.1
BONDS
[[bodies]]
name = "bar"
kind = "bonded"
material = "m"
file = "bar.data"
unit = "mm"
MORE
[[supports]]
group = "bar.x-"
fix = "x"
[[supports]]
where = "x < 0.6 mm"
group = "bar"
fix = "yz"
fix_rotation = "xyz"
[[supports]]
group = "bar.x+"
displacement = { x = "1 um*t/1 s" }
[solver]
kind = "static"
end = "1 s"
[[probes]]
name = "pull"
reaction = { group = "bar.x+", along = "x" }
"#;

fn bar(bonds: &str, more: &str, content: &str) -> Workplace {
    let place = Workplace::new(&PULLED.replace("BONDS", bonds).replace("MORE", more));
    fs::write(place.path("bar.data"), content).unwrap();
    place
}

const BEAMS: &str =
    "bonds = { coordination = 6, convention = \"interior\", radius_ratio = 0.5, young_modulus = \"2 GPa\" }";

#[test]
fn a_bonded_body_of_own_particles_has_the_stiffness_of_its_bonds() {
    // Eleven bonds of 1 mm along each of sixteen rows: EA/L with beams of radius 0.25 mm.
    let right = 16.0 * 2e9 * std::f64::consts::PI * 0.25e-3f64.powi(2) / 11e-3 * 1e-6;
    for (more, bonds, words) in [
        ("", true, "with the 176 bonds of the file"),
        ("bond_gap = \"0.1 mm\"", false, "464 bonds across gaps below 100 µm"),
        (
            "shape = \"box\"\nsize = [\"12 mm\", \"4 mm\", \"4 mm\"]\nbond_gap = \"0.1 mm\"",
            true,
            "without the 176 bonds of the file",
        ),
    ] {
        let place = bar(BEAMS, more, &grid(bonds));
        let told = place.fractum(&["check", "case.toml"]);
        assert!(told.stdout.contains(words) && told.stdout.contains("52 %"), "{} {}", told.stdout, told.stderr);
        let one = run(&place, "one", "1");
        let pull = one["probes"]["pull"]["final"].as_f64().unwrap();
        assert!((pull / right - 1.0).abs() < 1e-6, "{words}: {pull} N for {right}");
        let two = run(&place, "two", "2");
        assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    }
}

#[test]
fn a_bonded_body_of_own_particles_that_cannot_be_is_explained() {
    let pair = "two\n\n2 atoms\n\nAtoms # sphere\n\n1 1 1.0 2500 0 0 0\n2 1 1.0 2500 1 0 0\n\nBonds\n\n1 1 1 2\n";
    let far = grid(true).replace("1 1 1 17\n", "") + "9 1 1 192\n";
    for (bonds, more, content, words) in [
        ("", "", pair, "its 2 particles are too few to find beams"),
        (BEAMS, "", &pair.replace("1 0 0\n\nB", "9 9 9\n\nB"), "of the box around them"),
        (BEAMS, "", &far, "beyond twice their radii"),
        (BEAMS, "bond_gap = \"0.1 mm\"\ncoordination = 6", &grid(true), "bodies[0].coordination"),
        (BEAMS, "shape = \"sphere\"\nradius = \"3 mm\"", &grid(true), "outside of the shape"),
        (BEAMS, "particles = 500", &grid(true), "bodies[0].particles"),
    ] {
        let ended = bar(bonds, more, content).fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{words}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
}
