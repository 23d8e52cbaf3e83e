//! Clumps of spheres, as their user meets them: against closed forms of rigid bodies, and beside single spheres.

use std::fs;

use serde_json::Value;

use crate::common::{Workplace, files_below, history, resumed, run};
use crate::ranks::{on_ranks, options};

/// A material, a floor at z = 0 and what is put in.
fn case(material: &str, bodies: &str, rest: &str) -> String {
    format!(
        r#"fractum = 1
title = "Clumps"
[materials.stone]
density = "2500 kg/m^3"
young_modulus = "10 MPa"
poisson_ratio = 0.25
contact = {{ {material} }}
{bodies}
[[bodies]]
name = "floor"
kind = "rigid"
shape = "plane"
normal = "z"
contact = {{ {material} }}
{rest}
"#
    )
}

/// A body of clumps: where it comes from, and its spheres (x, y, z and radius, in mm).
fn grains(from: &str, spheres: &[[f64; 4]]) -> String {
    let sphere =
        |[x, y, z, r]: &[f64; 4]| format!("{{ at = [\"{x} mm\", \"{y} mm\", \"{z} mm\"], radius = \"{r} mm\" }}");
    let list: Vec<String> = spheres.iter().map(sphere).collect();
    format!(
        "[[bodies]]\nname = \"grains\"\nkind = \"particles\"\nmaterial = \"stone\"\n{from}\nclump = [{}]\n",
        list.join(", ")
    )
}

/// Two spheres of 1 mm that touch, along x.
const DUMBBELL: [[f64; 4]; 2] = [[-1.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]];

fn last(found: &Value, probe: &str) -> f64 {
    found["probes"][probe]["final"].as_f64().unwrap()
}

fn residual(found: &Value) -> f64 {
    found["energy"]["residual_max_relative"].as_f64().unwrap()
}

const MOTION: &str = r#"
[[probes]]
name = "vx"
velocity = { group = "grains", along = "x" }
[[probes]]
name = "vz"
velocity = { group = "grains", along = "z" }
[[probes]]
name = "turn"
angular_momentum = { along = "y" }
[[probes]]
name = "kinetic"
energy = "kinetic"
"#;

/// Each sphere bears half of the clump: it rebounds as a single sphere of that mass does.
#[test]
fn a_clump_that_falls_flat_bounces_by_the_restitution_of_its_material() {
    let bounce = |body: String| {
        // The same step for both, which ask for different ones.
        let rest = format!("{MOTION}[solver]\nend = \"1 ms\"\nstep = \"0.5 us\"");
        let place = Workplace::new(&case("friction = 0, restitution = 0.6", &body, &rest));
        let found = run(&place, "one", "1");
        assert!(residual(&found) < 1e-3, "{}", found["energy"]);
        last(&found, "vz")
    };
    let fall = "centre = [\"0 mm\", \"0 mm\", \"1.01 mm\"]\ninitial_velocity = { z = \"-0.5 m/s\" }";
    let clump = bounce(grains(fall, &DUMBBELL));
    let sphere = bounce(format!(
        "[[bodies]]\nname = \"grains\"\nkind = \"particles\"\nmaterial = \"stone\"\n{fall}\nparticle_radius = \"1 mm\"\n"
    ));
    assert!((clump / 0.5 - 0.6).abs() < 2e-3, "{clump} m/s");
    assert!((clump / sphere - 1.0).abs() < 1e-9, "{clump} and {sphere} m/s");
}

/// A small sphere under a large one bears the whole clump, and counts with a third of its mass: the figures of docs/case-file.md.
#[test]
fn a_clump_that_falls_on_one_small_sphere_rebounds_little_faster_than_its_material() {
    let spheres = [[0.0, 0.0, 0.0, 1.0], [0.0, 0.0, -1.0, 0.2]];
    let from = "centre = [\"0 mm\", \"0 mm\", \"1.25 mm\"]\ninitial_velocity = { z = \"-0.1 m/s\" }";
    for (restitution, most) in [(0.3, 0.46), (0.6, 0.73), (0.9, 0.94)] {
        let material = format!("friction = 0, restitution = {restitution}");
        let rest = format!("{MOTION}[solver]\nend = \"4 ms\"\nsafety = 0.2\n");
        let found = run(&Workplace::new(&case(&material, &grains(from, &spheres), &rest)), "one", "1");
        let rebound = last(&found, "vz") / 0.1;
        assert!(rebound > restitution && rebound < most + 5e-3, "{restitution}: {rebound}");
        assert!(residual(&found) < 1e-3, "{}", found["energy"]);
    }
}

/// An elastic impact without friction, at a distance d from the centre of mass: impulse J = 2 v/(1/m + d²/I), and afterwards velocity J/m − v
/// and angular momentum J d.
#[test]
fn a_clump_that_falls_on_one_end_turns_by_the_closed_form_of_an_impact() {
    let speed = 0.1;
    let from = "centre = [\"0 mm\", \"0 mm\", \"1.72 mm\"]\norientation = { axis = \"y\", angle = \"45 deg\" }\ninitial_velocity = { z = \"-0.1 m/s\" }";
    let rest = format!("{MOTION}[solver]\nend = \"0.7 ms\"\nsafety = 0.4");
    // A stiffer one, which hardly turns while it touches.
    let text = case("friction = 0, restitution = 1.0", &grains(from, &DUMBBELL), &rest).replace("10 MPa", "10 GPa");
    let found = run(&Workplace::new(&text), "one", "1");
    let mass = 2.0 * 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-9;
    let inertia = mass * (0.4 + 1.0) * 1e-6;
    let arm = 1e-3 * 0.5f64.sqrt();
    let impulse = 2.0 * speed / (1.0 / mass + arm * arm / inertia);
    let (velocity, momentum) = (impulse / mass - speed, impulse * arm);
    // The end at +x is below, and is pushed up: it turns about −y.
    assert!((last(&found, "vz") / velocity - 1.0).abs() < 5e-3, "{} m/s, {velocity}", last(&found, "vz"));
    assert!((last(&found, "turn") / -momentum - 1.0).abs() < 2e-3, "{}, {momentum}", last(&found, "turn"));
    assert!(residual(&found) < 1e-3, "{}", found["energy"]);
}

/// A rod of five spheres, which does not roll along its axis.
fn rod() -> Vec<[f64; 4]> {
    (-2..=2).map(|k| [1.5 * f64::from(k), 0.0, 0.0, 1.0]).collect()
}

#[test]
fn a_rod_slides_to_rest_by_coulombs_law() {
    let from = "centre = [\"0 mm\", \"0 mm\", \"0.9999 mm\"]\ninitial_velocity = { x = \"0.2 m/s\" }";
    let rest = r#"
[[loads]]
gravity = { z = "-9.81 m/s^2" }
[solver]
end = "60 ms"
[[probes]]
name = "slowing"
expression = "slope(vx, 40 ms)"
[[probes]]
name = "way"
displacement = { group = "grains", along = "x" }
[output]
history = { every = "0.1 ms" }
"#;
    let text = case("friction = 0.4, restitution = 0.3", &grains(from, &rod()), &format!("{MOTION}{rest}"));
    let found = run(&Workplace::new(&text), "one", "1");
    // v²/(2 μ g), in 51 ms.
    let way = 0.04 / (2.0 * 0.4 * 9.81);
    assert!((last(&found, "way") / way - 1.0).abs() < 5e-3, "{} m, {way}", last(&found, "way"));
    assert!(last(&found, "vx").abs() < 1e-4, "{}", last(&found, "vx"));
    assert!(residual(&found) < 1e-3, "{}", found["energy"]);
}

/// Below the angle of friction a rod stays where it is, along the slope and across it; a rod across would roll.
#[test]
fn a_clump_rests_on_a_slope_below_its_friction_and_slides_above() {
    for (tangent, slides) in [(0.25, false), (0.45, true)] {
        let cosine = 1.0 / (1.0f64 + tangent * tangent).sqrt();
        let (down, press) = (9.81 * tangent * cosine, 9.81 * cosine);
        let rest = format!(
            "{MOTION}[[loads]]\ngravity = {{ x = \"{down} m/s^2\", z = \"-{press} m/s^2\" }}\n[solver]\nend = \"50 ms\"\n"
        );
        let from = "centre = [\"0 mm\", \"0 mm\", \"0.9999 mm\"]";
        let text = case("friction = 0.35, restitution = 0.3", &grains(from, &rod()), &rest);
        let found = run(&Workplace::new(&text), "one", "1");
        let free = (down - 0.35 * press) * 0.05;
        let speed = last(&found, "vx");
        if slides {
            assert!((speed / free - 1.0).abs() < 0.01, "{speed} m/s, {free}");
        } else {
            assert!(speed.abs() < 1e-4, "{speed} m/s");
        }
    }
}

/// With friction and spin, over several impacts.
#[test]
fn a_clump_of_one_sphere_is_that_sphere() {
    let from = "centre = [\"0 mm\", \"0 mm\", \"2 mm\"]\ninitial_velocity = { x = \"0.3 m/s + 50 1/s*z\", z = \"-0.4 m/s - 30 1/s*y\" }";
    let rest = format!(
        "{MOTION}[[probes]]\nname = \"way\"\ndisplacement = {{ group = \"grains\", along = \"x\" }}\n[[probes]]\nname = \"rise\"\n\
         displacement = {{ group = \"grains\", along = \"z\" }}\n[[loads]]\ngravity = {{ z = \"-9.81 m/s^2\" }}\n[solver]\nend = \"100 ms\"\n"
    );
    let material = "friction = 0.4, rolling_friction = 0.1, restitution = 0.8";
    let sphere = format!(
        "[[bodies]]\nname = \"grains\"\nkind = \"particles\"\nmaterial = \"stone\"\n{from}\nparticle_radius = \"1 mm\"\n"
    );
    let [one, other] = [grains(from, &[[3.0, 2.0, 1.0, 1.0]]), sphere].map(|body| {
        let found = run(&Workplace::new(&case(material, &body, &rest)), "one", "1");
        assert!(residual(&found) < 1e-3, "{}", found["energy"]);
        ["way", "rise", "vx", "vz", "turn", "kinetic"].map(|probe| last(&found, probe))
    });
    for (clump, sphere) in one.into_iter().zip(other) {
        assert!((clump - sphere).abs() < 1e-9 * sphere.abs(), "{one:?}\n{other:?}");
    }
}

/// Space that both spheres cover weighs once: the lens of spheres of radius r whose centres are r apart is 5/12 π r³.
#[test]
fn the_plan_tells_clumps_and_the_mass_of_their_union() {
    let spheres = [[0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 1.0]];
    let from = "shape = \"box\"\npoint = [\"0 mm\", \"0 mm\", \"0 mm\"]\nsize = [\"20 mm\", \"20 mm\", \"20 mm\"]\nparticles = 7";
    let text = case(
        "friction = 0.4",
        &grains(from, &spheres),
        "[[loads]]\ngravity = { z = \"-9.81 m/s^2\" }\n[solver]\nend = \"1 ms\"",
    );
    let ended = Workplace::new(&text).fractum(&["check", "case.toml"]);
    assert_eq!(ended.code, Some(0), "{}", ended.stderr);
    // 7 · 2500 kg/m³ · (8/3 − 5/12) π mm³
    assert!(
        ended.stdout.contains("grains: 7 clumps of 2 spheres, in all 14 of radius 1 mm to 1 mm, stone, mass 123.7 mg"),
        "{}",
        ended.stdout
    );
}

/// Grains of three spheres fall into a box under a free plate; two are thrown up beyond it, and leave.
const HEAP: &str = r#"
[[bodies]]
name = "thrown"
kind = "particles"
material = "stone"
clump = [{ at = ["0 mm", "0 mm", "0 mm"], radius = "1 mm" }, { at = ["1 mm", "0 mm", "0 mm"], radius = "1 mm" }]
file = "thrown.csv"
unit = "mm"
initial_velocity = { z = "1 m/s + 20 1/s*x" }
[[bodies]]
name = "walls"
kind = "rigid"
shape = "box"
inside = true
point = ["-8 mm", "-8 mm", "-10 mm"]
size = ["16 mm", "16 mm", "100 mm"]
contact = { friction = 0.4, restitution = 0.5 }
[[bodies]]
name = "plate"
kind = "rigid"
shape = "box"
material = "stone"
point = ["-7 mm", "-7 mm", "46 mm"]
size = ["14 mm", "14 mm", "2 mm"]
free = "z"
mass = "2 g"
[[loads]]
gravity = { z = "-9.81 m/s^2" }
[solver]
end = "80 ms"
domain = { min = ["-30 mm", "-30 mm", "-10 mm"], max = ["30 mm", "30 mm", "60 mm"] }
[[probes]]
name = "floor_force"
reaction = { group = "floor", along = "z" }
[[probes]]
name = "plate_fall"
displacement = { group = "plate", along = "-z" }
[[probes]]
name = "gone"
count = "left_pieces"
[output]
history = { every = "1 ms" }
fields = { every = "40 ms", xyz = true }
checkpoint = { steps = 500 }
"#;

#[test]
fn a_heap_of_clumps_has_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    let spheres = [[0.0, 0.0, 0.0, 1.0], [1.2, 0.0, 0.0, 0.8], [0.3, 1.0, 0.2, 0.6]];
    let from = "shape = \"box\"\npoint = [\"-7 mm\", \"-7 mm\", \"1 mm\"]\nsize = [\"14 mm\", \"14 mm\", \"44 mm\"]\ndispersion = 0.3\nparticles = 80";
    let text = case("friction = 0.4, rolling_friction = 0.02, restitution = 0.5", &grains(from, &spheres), HEAP);
    let place = Workplace::new(&text);
    fs::write(place.path("thrown.csv"), "x, y, z, r\n-4, 0, 52, 1.4\n4, 4, 52, 1.4\n").unwrap();
    let one = run(&place, "one", "1");
    assert_eq!(one["counts"]["particles"].as_u64(), Some(240), "{}", one["counts"]);
    assert_eq!(last(&one, "gone"), 2.0);
    assert!(last(&one, "floor_force") > 0.0 && last(&one, "plate_fall") > 5e-3, "{}", one["probes"]);
    let energy = |name: &str| one["energy"][name].as_f64().unwrap();
    assert!(energy("friction") > 0.0 && energy("damping") > 0.0 && energy("left") > 0.0, "{}", one["energy"]);
    assert!(residual(&one) < 1e-3, "{}", one["energy"]);
    let frame = &files_below(&place.path("one/particles"), ".xyz")[0];
    let text = fs::read_to_string(frame).unwrap();
    let clump = |line: &str| line.split_whitespace().next_back().unwrap().parse::<i32>().unwrap();
    let of: Vec<i32> = text.lines().skip(2).map(clump).collect();
    assert!(text.contains(":clump:I:1") && of[..6] == [0, 0, 0, 1, 1, 1] && of[243] == 81, "{of:?}");
    let loose = fs::read(place.path("one/particles/loose-00000.vtp")).unwrap();
    assert!(String::from_utf8_lossy(&loose).contains("Name=\"clump\""));
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    let resumed = resumed(&place, "two");
    assert_eq!((&resumed["state_hash"], &resumed["energy"]), (&one["state_hash"], &one["energy"]));
}

/// A free clump spins about an axis that is none of its own: it tumbles, and keeps what a rigid body keeps.
#[test]
fn a_clump_in_free_flight_keeps_its_energy_and_angular_momentum() {
    let spheres = [[0.0, 0.0, 0.0, 1.0], [1.6, 0.0, 0.0, 0.9], [0.3, 1.2, 0.0, 0.6]];
    let from = "centre = [\"0 mm\", \"0 mm\", \"100 mm\"]\ninitial_velocity = { x = \"1 m/s - 300 1/s*y\", y = \"300 1/s*x\", z = \"100 1/s*y\" }";
    let rest = format!("{MOTION}[solver]\nend = \"200 ms\"\n[output]\nhistory = {{ every = \"1 ms\" }}");
    let place = Workplace::new(&case("friction = 0", &grains(from, &spheres), &rest));
    let found = run(&place, "one", "1");
    let rows = history(&place, "one", &["kinetic", "turn"]);
    let spread = |column: usize| {
        let values = rows.iter().map(|row| row[column]);
        let most = values.clone().fold(f64::NEG_INFINITY, f64::max);
        (most - values.fold(f64::INFINITY, f64::min)) / most.abs()
    };
    assert!(spread(0) < 1e-6, "{}", spread(0));
    assert!(spread(1) < 1e-9, "{}", spread(1));
    assert!(residual(&found) < 1e-6, "{}", found["energy"]);
}

/// Under a roof a dumbbell hangs by both of its spheres, each with 2 π W r, or falls.
#[test]
fn a_clump_sticks_by_all_of_its_spheres() {
    let weight = 2.0 * 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-9 * 9.81;
    let holds = weight / (2.0 * 2.0 * std::f64::consts::PI * 1e-3);
    for (share, falls) in [(0.9, true), (1.1, false)] {
        let material = format!("restitution = 0.3, work_of_adhesion = \"{} J/m^2\"", share * holds);
        let rest = format!("{MOTION}[[loads]]\ngravity = {{ z = \"-9.81 m/s^2\" }}\n[solver]\nend = \"20 ms\"\n");
        let body = grains("centre = [\"0 mm\", \"0 mm\", \"-1 mm\"]", &DUMBBELL);
        let text = case(&material, &body, &rest).replace("normal = \"z\"", "normal = \"-z\"");
        let found = run(&Workplace::new(&text), "one", "1");
        assert_eq!(last(&found, "vz") < -1e-3, falls, "{share}: {} m/s", last(&found, "vz"));
        assert!(residual(&found) < 1e-3, "{}", found["energy"]);
    }
}

/// A force on one of its spheres, which is 1 mm from the centre of mass, for 1 ms.
#[test]
fn a_load_on_a_sphere_pushes_and_turns_its_clump() {
    let from = "centre = [\"0 mm\", \"0 mm\", \"50 mm\"]\ngroups = { end = \"x > 0 mm\" }";
    let rest = format!(
        "{MOTION}[[loads]]\ngroup = \"grains.end\"\nforce = {{ z = \"1 uN\" }}\n[solver]\nend = \"1 ms\"\n[[probes]]\n\
         name = \"work\"\nenergy = \"external\"\n"
    );
    let found = run(&Workplace::new(&case("friction = 0", &grains(from, &DUMBBELL), &rest)), "one", "1");
    let mass = 2.0 * 2500.0 * 4.0 / 3.0 * std::f64::consts::PI * 1e-9;
    let close = |probe: &str, expected: f64, tolerance: f64| {
        let found = last(&found, probe);
        assert!((found / expected - 1.0).abs() < tolerance, "{probe}: {found}, {expected}");
    };
    // Velocities are those of half a step later.
    close("vz", 1e-9 / mass, 2e-3);
    close("turn", -1e-12, 2e-3);
    close("work", 0.5 * (1e-18 / mass + 1e-24 / (1.4e-6 * mass)), 2e-3);
    assert!(residual(&found) < 1e-3, "{}", found["energy"]);
}

/// A dumbbell falls on an elastic bar with one end: solids feel its spheres, and the energies add up.
#[test]
fn a_clump_rebounds_from_a_solid() {
    let from = "centre = [\"200 mm\", \"60 mm\", \"136 mm\"]\norientation = { axis = \"y\", angle = \"30 deg\" }\n\
                initial_velocity = { z = \"-2 m/s\" }\nparticle_radius = \"20 mm\"";
    let bar = "[mesh]\nfile = \"bar.msh\"\n[[bodies]]\nname = \"bar\"\nkind = \"solid\"\ngroup = \"body\"\nmaterial = \"stone\"\n";
    let text = case(
        "friction = 0.3, restitution = 0.8",
        &format!("{bar}{}", grains(from, &DUMBBELL)),
        "[solver]\nend = \"8 ms\"\n",
    );
    let text = text.replace("normal = \"z\"", "normal = \"z\"\npoint = [\"0 m\", \"0 m\", \"-1 m\"]");
    let found = run(&Workplace::new(&format!("{text}{MOTION}")), "one", "1");
    assert!(last(&found, "vz") > 0.1 && last(&found, "turn").abs() > 1e-3, "{}", found["probes"]);
    assert!(residual(&found) < 1e-3, "{}", found["energy"]);
}

#[test]
fn clumps_are_refused_beside_what_knows_single_spheres_only() {
    let from = "shape = \"box\"\nsize = [\"20 mm\", \"20 mm\", \"20 mm\"]";
    let rest = "[[loads]]\ngravity = { z = \"-9.81 m/s^2\" }\n[solver]\nend = \"1 ms\"\n";
    let text = case("friction = 0.4", &grains(from, &DUMBBELL), rest);
    for (old, new, words) in [
        (
            "radius = \"1 mm\" }]",
            "radius = \"1 mm\" }, { at = [\"9 mm\", \"0 mm\", \"0 mm\"], radius = \"1 mm\" }]",
            "does not hang together: sphere 2",
        ),
        (
            "clump =",
            "inlet = { number_rate = \"10 1/s\", until = \"1 s\" }\nclump =",
            "clump has no effect beside inlet",
        ),
        ("end = \"1 ms\"", "end = \"1 ms\"\nkind = \"static\"", "clumps only move"),
        ("[solver]", "[damping]\ntchamwa_wielgosz = 1.1\n[solver]", "tchamwa_wielgosz does not act on clumps"),
        (
            "[solver]",
            "[[supports]]\ngroup = \"grains\"\nfix = \"x\"\n[solver]",
            "spheres of clumps, which no support holds",
        ),
        (
            "[solver]",
            "[periodic]\npoint = [\"0 m\", \"0 m\", \"0 m\"]\nsize = [\"20 mm\", \"20 mm\", \"20 mm\"]\n[solver]",
            "clumps know no periodic box",
        ),
        ("clump =", "orientation = { axis = \"x\" }\nclump =", "orientation.angle is missing"),
    ] {
        assert!(text.contains(old), "{old}");
        let ended = Workplace::new(&text.replacen(old, new, 1)).fractum(&["check", "case.toml"]);
        assert_eq!(ended.code, Some(1), "{new}: {}", ended.stdout);
        assert!(ended.stderr.contains(words), "{new}: {}", ended.stderr);
    }
    let place = Workplace::new(&text);
    let shared = on_ranks(&place, 2, &options(&place, "shared"));
    let words = shared[0].as_ref().unwrap_err().to_string();
    assert!(words.contains("clumps of spheres cannot be run by several"), "{words}");
}
