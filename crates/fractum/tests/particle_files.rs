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
checkpoint = { every = "5 ms" }
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
