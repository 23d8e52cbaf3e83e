//! Loose particles and rigid bodies, as their user meets them.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use crate::common::{Workplace, files_below, resumed, run, summary};

/// Beads fall on a floor within walls; a free plate presses on them, and a driven paddle stirs.
const HEAP: &str = r#"fractum = 1
title = "A small heap"

[materials.soft]
density = "2500 kg/m^3"
young_modulus = "1 MPa"
poisson_ratio = 0.25
contact = { friction = 0.4, rolling_friction = 0.05, restitution = 0.6 }

[[bodies]]
name = "beads"
kind = "particles"
material = "soft"
shape = "box"
point = ["-10 mm", "-10 mm", "7 mm"]
size = ["20 mm", "20 mm", "25 mm"]
particle_radius = "2 mm"
dispersion = 0.3

[[bodies]]
name = "more"
kind = "particles"
material = "soft"
file = "more.csv"
unit = "mm"
initial_velocity = { z = "-0.1 m/s" }

[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"

[[bodies]]
name = "walls"
kind = "rigid"
shape = "box"
inside = true
point = ["-10 mm", "-10 mm", "-10 mm"]
size = ["20 mm", "20 mm", "100 mm"]

[[bodies]]
name = "plate"
kind = "rigid"
shape = "box"
material = "soft"
point = ["-9 mm", "-9 mm", "38 mm"]
size = ["18 mm", "18 mm", "2 mm"]
free = "z"
mass = "5 g"
force = { z = "-0.02 N" }

[[bodies]]
name = "paddle"
kind = "rigid"
shape = "stl"
file = "paddle.stl"
unit = "mm"
spin = { z = { smooth_ramp = [["0 s", "0 rad/s"], ["20 ms", "10 rad/s"]] } }

[[loads]]
gravity = { z = "-9.81 m/s^2" }

[solver]
end = "0.1 s"

[[probes]]
name = "floor_force"
reaction = { group = "floor", along = "z" }
[[probes]]
name = "plate_fall"
displacement = { group = "plate", along = "-z" }
[[probes]]
name = "swirl"
angular_momentum = { along = "z" }
[[probes]]
name = "touching"
count = "contacts"

[output]
history = { every = "1 ms" }
fields = { every = "50 ms" }
checkpoint = { steps = 3000 }
"#;

/// A thin upright wedge about the axis, closed.
fn paddle() -> String {
    let corners =
        [[-6.0, -0.7, -1.0], [6.0, -0.7, -1.0], [0.0, 0.7, -1.0], [-6.0, -0.7, 6.0], [6.0, -0.7, 6.0], [0.0, 0.7, 6.0]];
    let facets = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]];
    let mut text = String::from("solid paddle\n");
    for facet in facets {
        text += "facet normal 0 0 0\nouter loop\n";
        for corner in facet {
            let [x, y, z]: [f64; 3] = corners[corner];
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid paddle\n"
}

fn place(case: &str) -> Workplace {
    let place = Workplace::new(case);
    fs::write(place.path("more.csv"), "x, y, z, r\n0, 0, 35, 1.5\n5 5 35 1.5 # a corner\n").unwrap();
    fs::write(place.path("paddle.stl"), paddle()).unwrap();
    place
}

#[test]
fn a_heap_runs_with_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let place = place(HEAP);
    let one = run(&place, "one", "1");
    let value = |name: &str| one["probes"][name]["final"].as_f64().unwrap();
    assert!(one["counts"]["particles"].as_u64().unwrap() > 25, "{}", one["counts"]);
    assert!(value("touching") > 10.0 && value("floor_force") > 0.0, "{}", one["probes"]);
    assert!(value("plate_fall") > 5e-3, "the plate fell by {}", value("plate_fall"));
    assert!(value("swirl") > 0.0, "the paddle turns them by {}", value("swirl"));
    let energy = |name: &str| one["energy"][name].as_f64().unwrap();
    assert!(energy("friction") > 0.0 && energy("damping") > 0.0);
    assert!(energy("residual_max_relative") < 1e-3, "{}", one["energy"]);
    assert_eq!(files_below(&place.path("one").join("particles"), ".vtp").len(), 3);
    let listed = std::fs::read_to_string(place.path("one/fields.pvd")).unwrap();
    assert!(listed.contains("name=\"loose particles\"") && !listed.contains("name=\"bonded"), "{listed}");
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    let resumed = resumed(&place, "two");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
}

/// At the step of the program two beads keep their energy when they meet, each with a hundredth of √(E/ρ) or less: Hertz' impact takes some fifty
/// steps or more.
#[test]
fn an_impact_of_beads_is_resolved_without_asking_for_it() {
    const IMPACT: &str = r#"fractum = 1
title = "Two beads meet"

[parameters]
speed = "SPEED m/s"

[materials.soft]
density = "1000 kg/m^3"
young_modulus = "1 MPa"
poisson_ratio = 0.25
contact = { restitution = 1.0 }

[[bodies]]
name = "left"
kind = "particles"
material = "soft"
file = "left.csv"
unit = "mm"
initial_velocity = { x = "speed" }

[[bodies]]
name = "right"
kind = "particles"
material = "soft"
file = "right.csv"
unit = "mm"
initial_velocity = { x = "-speed" }

[solver]
end = "END s"

[[probes]]
name = "force"
contact_force = { on = "left", from = "right", along = "-x" }
[[probes]]
name = "rebound"
velocity = { group = "right", along = "x" }

[output]
history = { every = "END s/1000" }
"#;
    // Of the pair: radius [m], modulus [Pa] and mass [kg].
    let (radius, modulus) = (1e-3f64, 1e6 / (2.0 * (1.0 - 0.25f64.powi(2))));
    let mass = 0.5 * 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * 2e-3f64.powi(3);
    for (share, most) in [(1e-4, 1e-3), (1e-3, 1e-3), (1e-2, 1e-3), (1e-1, 5e-3)] {
        let speed = share * 1000f64.sqrt();
        // Hertz: what is left of the motion at the largest depth is elastic energy, 8/15 E √R δ^(5/2).
        let depth = (15.0 / 16.0 * mass * (2.0 * speed).powi(2) / (modulus * radius.sqrt())).powf(0.4);
        let force = 4.0 / 3.0 * modulus * radius.sqrt() * depth.powf(1.5);
        let duration = 2.943 * depth / (2.0 * speed);
        let end = 5e-6 / speed + 1.5 * duration;
        let place = Workplace::new(&IMPACT.replace("SPEED", &speed.to_string()).replace("END", &end.to_string()));
        for (name, x) in [("left.csv", -2.005), ("right.csv", 2.005)] {
            fs::write(place.path(name), format!("x, y, z, r\n{x}, 0, 0, 2\n")).unwrap();
        }
        let found = run(&place, "one", "1");
        let residual = found["energy"]["residual_max_relative"].as_f64().unwrap();
        let log = fs::read_to_string(place.path("one/run.log")).unwrap();
        let steps = log.lines().find_map(|line| line.strip_prefix("completed: ")?.split_once(" steps")).unwrap().0;
        let in_touch = steps.parse::<f64>().unwrap() * duration / end;
        println!("{share} of the speed of waves: {in_touch:.0} steps in touch, balance {residual:.1e}");
        assert!(residual < most, "{share}: {residual}");
        let rebound = found["probes"]["rebound"]["final"].as_f64().unwrap();
        assert!((rebound / speed - 1.0).abs() < most, "{share}: {rebound} m/s");
        let largest = found["probes"]["force"]["max"].as_f64().unwrap();
        assert!((largest / force - 1.0).abs() < 5e-3, "{share}: {largest} N, {force} N");
    }
}

#[test]
fn wrong_particles_and_bodies_are_explained() {
    for (old, new, words) in [
        ("file = \"more.csv\"", "file = \"paddle.stl\"", "expected rows of x, y, z, radius"),
        ("particle_radius = \"2 mm\"", "particle_radius = \"2 m\"", "has room in the region"),
        ("particle_radius = \"2 mm\"", "particle_radius = \"2 mm\"\nparticles = 200", "there is room for 1"),
        ("particle_radius = \"2 mm\"", "particle_radius = \"2 mm\"\nparticles = 100000", "than any random packing"),
        ("particle_radius = \"2 mm\"", "particle_radius = \"2 mm\"\nsolid_fraction = 0.66", "end at 0.5"),
        ("particle_radius = \"2 mm\"", "particle_radius = \"12 mm\"\nsolid_fraction = 0.6", "has no room for"),
        ("file = \"paddle.stl\"", "file = \"more.csv\"", "bodies[5].file"),
    ] {
        assert!(HEAP.contains(old), "{old}");
        let place = place(&HEAP.replacen(old, new, 1));
        let ended = place.fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{new}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{new}: {}", ended.stderr);
    }
    // Two beads in one place: said, with the pair and the depth.
    let place = place(HEAP);
    fs::write(place.path("more.csv"), "0 0 35 1.5\n0 1 35 1.5\n").unwrap();
    let ended = place.fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    let said = format!("{}{}", ended.stdout, ended.stderr);
    assert!(said.contains("particle 0 of more and particle 1 of more, by 2 mm"), "{said}");
}

/// Beads that fill a container densely at once.
const DENSE: &str = r#"fractum = 1
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "10 MPa"
poisson_ratio = 0.25
contact = { friction = 0.5, restitution = 0.3 }
[[bodies]]
name = "beads"
kind = "particles"
material = "glass"
SHAPE
[[bodies]]
name = "container"
kind = "rigid"
CONTAINER
inside = true
LOADS
[solver]
end = "50 ms"
[[probes]]
name = "settled"
displacement = { group = "beads", along = "z" }
[[probes]]
name = "speed"
velocity = { group = "beads", along = "z" }
"#;

#[test]
fn a_dense_cloud_begins_at_rest_and_settles_by_little() {
    let shapes = [
        (
            "shape = \"box\"\nsize = [\"16 mm\", \"16 mm\", \"16 mm\"]\nparticle_radius = \"1 mm\"\nsolid_fraction = 0.57",
            "shape = \"box\"\nsize = [\"16 mm\", \"16 mm\", \"16 mm\"]",
            16e-3,
        ),
        (
            "shape = \"cylinder\"\naxis = \"z\"\nlength = \"20 mm\"\nradius = \"10 mm\"\nsizes = { passing = [[\"1 mm\", 0], [\"2 mm\", 0.5], [\"3 mm\", 1]] }\nsolid_fraction = 0.58",
            "shape = \"cylinder\"\naxis = \"z\"\nlength = \"20 mm\"\nradius = \"10 mm\"",
            20e-3,
        ),
    ];
    for (shape, container, height) in shapes {
        let text = DENSE.replace("SHAPE", shape).replace("CONTAINER", container);
        let place = Workplace::new(&text.replace("LOADS", "").replace("50 ms", "5 ms"));
        let still = run(&place, "still", "1");
        for part in ["kinetic", "contact", "friction", "damping"] {
            assert_eq!(still["energy"][part].as_f64(), Some(0.0), "{part}: {}", still["energy"]);
        }
        assert_eq!(run(&place, "again", "2")["state_hash"], still["state_hash"]);
        let place = Workplace::new(&text.replace("LOADS", "[[loads]]\ngravity = { z = \"-9.81 m/s^2\" }"));
        let fallen = run(&place, "fallen", "2");
        let value = |name: &str| fallen["probes"][name]["final"].as_f64().unwrap();
        println!("settled by {:.4} of the height, {:.1e} m/s", value("settled") / height, value("speed"));
        assert!((-0.04 * height..0.0).contains(&value("settled")), "{}", value("settled"));
        assert!(fallen["energy"]["residual_max_relative"].as_f64().unwrap() < 1e-3, "{}", fallen["energy"]);
    }
}

/// Beads that fill what a file gives.
const FILLED: &str = r#"fractum = 1
MESH
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "10 MPa"
poisson_ratio = 0.25
[[bodies]]
name = "beads"
kind = "particles"
material = "glass"
SHAPE
solid_fraction = 0.5
[solver]
end = "1 ms"
"#;

#[test]
fn mesh_groups_and_closed_surfaces_are_filled() {
    let mesh = "[mesh]\nfile = \"bar.msh\"";
    let group = "shape = \"group\"\ngroup = \"body\"\nparticle_radius = \"6 mm\"\ndispersion = 0.2";
    let surface = "shape = \"stl\"\nfile = \"paddle.stl\"\nunit = \"mm\"\nparticle_radius = \"0.1 mm\"";
    // A bar, and a wedge of 12 x 1.4 x 7 mm; the mean of r³ at a dispersion of 0.2.
    let cases = [
        (mesh, group, 0.4 * 0.12 * 0.12, 6e-3f64.powi(3) * 1.01),
        ("", surface, 0.5 * 12e-3 * 1.4e-3 * 7e-3, 1e-4f64.powi(3)),
    ];
    for (mesh, shape, volume, cube) in cases {
        let place = place(&FILLED.replace("MESH", mesh).replace("SHAPE", shape));
        let found = run(&place, "out", "1");
        let count = found["counts"]["particles"].as_f64().unwrap();
        let expected = 0.5 * volume / (4.0 / 3.0 * std::f64::consts::PI * cube);
        assert!((count / expected - 1.0).abs() < 1e-2, "{count} of {expected}");
        assert_eq!(found["energy"]["contact"].as_f64(), Some(0.0), "{}", found["energy"]);
    }
    for (mesh, shape, words) in [
        ("", group, "mesh.file is missing"),
        (mesh, &group.replace("\"body\"", "\"bdy\""), "expected a physical group"),
        (mesh, &group.replace("\"body\"", "\"x-\""), "not closed"),
        ("", &surface.replace("0.1 mm", "3 mm"), "has no room for"),
        ("", &format!("{surface}\ninlet = {{ number_rate = \"1 1/s\", until = \"1 s\" }}"), "expected \"box\""),
    ] {
        let ended = place(&FILLED.replace("MESH", mesh).replace("SHAPE", shape)).fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{shape}: {}", ended.stderr);
        assert!(ended.stderr.contains(words), "{words}: {}", ended.stderr);
    }
}

/// Two overlapping beads on a floor that they overlap too, and a solid bar with a corner in a rigid sphere.
const TIGHT: &str = r#"fractum = 1
title = "Too tight"
[mesh]
file = "bar.msh"
[materials.soft]
density = "2500 kg/m^3"
young_modulus = "1 MPa"
poisson_ratio = 0.25
contact = { friction = 0.4, damping_ratio = 0 }
[[bodies]]
name = "beads"
kind = "particles"
material = "soft"
file = "beads.csv"
unit = "mm"
[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
point = ["0 mm", "0 mm", "-10.3 mm"]
normal = "z"
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "soft"
[[bodies]]
name = "ball"
kind = "rigid"
shape = "sphere"
point = ["-10 mm", "-10 mm", "-10 mm"]
radius = "25 mm"
[solver]
end = "2 ms"
initial_overlap = "keep"
[[probes]]
name = "kinetic"
energy = "kinetic"
[[probes]]
name = "contact"
energy = "contact"
"#;

#[test]
fn what_overlaps_at_the_start_is_told_and_may_be_kept() {
    let place = Workplace::new(TIGHT);
    fs::write(place.path("beads.csv"), "-200,-200,-1.9,3\n-200,-200,-7.5,3\n").unwrap();
    let told = place.fractum(&["check", "case.toml"]);
    let said = format!("{}{}", told.stdout, told.stderr);
    for words in [
        "2 contacts overlap at the start, deepest particle 0 of beads and particle 1 of beads, by 400 µm",
        "1 node of a solid is within rigid body ball at the start, deepest that at (0 m, 0 m, 0 m)",
    ] {
        assert!(said.contains(words), "{said}");
    }
    let largest = |folder: &str, overlap: &str| {
        let set = format!("solver.initial_overlap={overlap}");
        let ended = place.fractum(&["run", "case.toml", "-o", folder, "--quiet", "--set", &set]);
        assert!(folder == "pushed" || ended.code == Some(0), "{}", ended.stderr);
        let summary = summary(&place, folder);
        ["kinetic", "contact"].map(|probe| summary["probes"][probe]["max"].as_f64().unwrap())
    };
    assert_eq!(largest("kept", "keep"), [0.0, 0.0]);
    assert!(largest("pushed", "push").iter().all(|energy| *energy > 0.0));
}

/// Share of the pixels of a picture that have a colour.
fn coloured(path: &Path) -> f64 {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    assert_eq!(frame.color_type, png::ColorType::Rgb);
    let is_coloured = |rgb: &&[u8]| rgb.iter().max().unwrap() - rgb.iter().min().unwrap() > 40;
    pixels.chunks_exact(3).filter(is_coloured).count() as f64 / (pixels.len() / 3) as f64
}

#[test]
fn pictures_over_time_show_what_is_in_a_container() {
    let place = place(HEAP);
    run(&place, "one", "2");
    let pictures = files_below(&place.path("one/pictures"), ".png");
    let strip = || pictures.iter().filter(|path| path.file_name().unwrap().to_string_lossy().starts_with("strip"));
    assert!(strip().count() > 1 && pictures.len() > strip().count(), "{pictures:?}");
    for picture in strip() {
        assert!(coloured(picture) > 0.02, "{}: {}", picture.display(), coloured(picture));
    }
}

/// A ball that flies at a wall of its own material.
const AT_A_WALL: &str = r#"fractum = 1
[materials.ball]
density = "2600 kg/m^3"
young_modulus = "100 MPa"
poisson_ratio = 0.3
contact = { friction = 0.35, restitution = 0.5 }
[materials.dull]
density = "2600 kg/m^3"
young_modulus = "100 MPa"
poisson_ratio = 0.3
contact = { friction = 0.35, restitution = 0.2 }
[[bodies]]
name = "ball"
kind = "particles"
material = "ball"
file = "ball.csv"
unit = "mm"
initial_velocity = { z = "-1 m/s" }
[[bodies]]
name = "wall"
kind = "rigid"
shape = "plane"
normal = "z"
material = "ball"
[solver]
end = "4 ms"
[[probes]]
name = "speed"
velocity = { group = "ball", along = "z" }
"#;

#[test]
fn the_contact_of_its_material_counts_for_a_rigid_body_unless_it_has_its_own() {
    let rebound = |case: &str| {
        let place = Workplace::new(case);
        fs::write(place.path("ball.csv"), "0,0,5.1,5\n").unwrap();
        run(&place, "out", "1")["probes"]["speed"]["final"].as_f64().unwrap()
    };
    let same = rebound(AT_A_WALL);
    assert!((same - 0.5).abs() < 0.01, "{same}");
    // The mean damping ratio of both counts.
    let mixed = [0.5, 0.2].map(fractum_scene::damping_of_restitution).iter().sum::<f64>() / 2.0;
    let low = rebound(&AT_A_WALL.replace("normal = \"z\"\nmaterial = \"ball\"", "normal = \"z\"\nmaterial = \"dull\""));
    let between = |rebound: f64| (fractum_scene::damping_of_restitution(rebound) - mixed).abs() < 0.02;
    assert!(low < 0.4 && between(low), "{low}");
    let own = rebound(&AT_A_WALL.replace("normal = \"z\"", "normal = \"z\"\ncontact = { restitution = 0.2 }"));
    assert!(between(own) && (own - low).abs() < 1e-3, "{own} {low}");
}

/// A bead strikes a free box beside its middle.
const STRUCK: &str = r#"fractum = 1

[materials.steel]
density = "7850 kg/m^3"
young_modulus = "1 GPa"
poisson_ratio = 0.3
contact = { friction = 0, restitution = 1.0 }

[[bodies]]
name = "box"
kind = "rigid"
shape = "box"
point = ["-30 mm", "-10 mm", "-10 mm"]
size = ["60 mm", "20 mm", "20 mm"]
free = "xyz"
free_rotation = true
mass = "100 g"
contact = { friction = 0, restitution = 1.0 }

[[bodies]]
name = "bead"
kind = "particles"
material = "steel"
file = "bead.csv"
unit = "mm"
initial_velocity = { z = "-2 m/s" }

[solver]
end = "3 ms"

[[probes]]
name = "turning"
angular_momentum = { along = "y" }
[[probes]]
name = "bead"
velocity = { group = "bead", along = "z" }
"#;

#[test]
fn the_angular_momentum_of_a_scene_counts_free_rigid_bodies() {
    let place = Workplace::new(STRUCK);
    fs::write(place.path("bead.csv"), "20, 0, 16, 5\n").unwrap();
    let summary = run(&place, "out", "1");
    let value = |name: &str, what: &str| summary["probes"][name][what].as_f64().unwrap();
    assert!(value("bead", "final") > 1.0, "it bounces: {}", summary["probes"]);
    let [least, most] = ["min", "max"].map(|what| value("turning", what));
    assert!(least > 0.0 && most / least - 1.0 < 1e-6, "{}", summary["probes"]["turning"]);
}

#[test]
fn a_rigid_body_that_falls_into_another_one_is_told() {
    let floor = "[[bodies]]\nname = \"floor\"\nkind = \"rigid\"\nshape = \"plane\"\nnormal = \"z\"\npoint = [0, 0, \"-11 mm\"]\n";
    let fall = format!("{floor}[[loads]]\ngravity = {{ z = \"-9.81 m/s^2\" }}\n[solver]\n");
    for (end, is_told) in [("60 ms", true), ("30 ms", false)] {
        let place = Workplace::new(&STRUCK.replace("[solver]\n", &fall).replace("3 ms", end));
        fs::write(place.path("bead.csv"), "200, 0, 16, 5\n").unwrap();
        let told = format!("{}", run(&place, "out", "1")["warnings"]);
        assert_eq!(told.contains("\\\"box\\\" has moved into \\\"floor\\\""), is_told, "{told}");
    }
}

/// A bat turns at 10/s and hits a ball that waits 0.1 m from its axis, at first with nearly no work: twice its speed there.
#[test]
fn a_bat_that_turns_hits_a_ball() {
    const CASE: &str = r#"fractum = 1
[materials.glass]
density = "2500 kg/m^3"
young_modulus = "1 GPa"
poisson_ratio = 0.25
contact = { friction = 0, restitution = 1 }
[[bodies]]
name = "ball"
kind = "particles"
material = "glass"
particle_radius = "5 mm"
centre = ["100 mm", "6.1 mm", "0 mm"]
[[bodies]]
name = "bat"
kind = "rigid"
shape = "box"
point = ["-120 mm", "-1 mm", "-10 mm"]
size = ["240 mm", "2 mm", "20 mm"]
spin = { z = "10 1/s" }
contact = { friction = 0, restitution = 1 }
[solver]
end = "1 ms"
[[probes]]
name = "speed"
velocity = { group = "ball", along = "y" }
[[probes]]
name = "work"
work = { group = "bat" }
"#;
    let told = run(&Workplace::new(CASE), "out", "1");
    let value = |name: &str| told["probes"][name]["final"].as_f64().unwrap();
    let mass = 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.005f64.powi(3);
    assert!((value("speed") / 2.0 - 1.0).abs() < 0.01, "{}", value("speed"));
    assert!((value("work") / (2.0 * mass) - 1.0).abs() < 0.01, "{}", value("work"));
}
