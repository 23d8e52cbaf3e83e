//! Loose particles that stick.

use std::f64::consts::PI;
use std::fs;

use serde_json::Value;

use crate::common::{Workplace, resumed, run};

/// Beads below a roof, or on their way to it.
const BEADS: &str = r#"fractum = 1
title = "Beads that stick"
[materials.m]
density = "2500 kg/m^3"
young_modulus = "5 MPa"
poisson_ratio = 0.3
contact = { damping_ratio = DAMPING, work_of_adhesion = "WORK J/m^2" }
[[bodies]]
name = "bead"
kind = "particles"
material = "m"
file = "beads.csv"
initial_velocity = { z = "SPEED m/s" }
[[bodies]]
name = "roof"
kind = "rigid"
ROOF
contact = { damping_ratio = DAMPING, work_of_adhesion = "ROOF_WORK J/m^2" }
[[loads]]
gravity = { z = "GRAVITY m/s^2" }
[solver]
end = "END s"
safety = SAFETY
[[probes]]
name = "way"
displacement = { group = "bead", along = "z" }
[[probes]]
name = "speed"
velocity = { group = "bead", along = "z" }
[[probes]]
name = "damped"
energy = "damping"
[[probes]]
name = "kinetic"
energy = "kinetic"
"#;
const PLANE: &str = "shape = \"plane\"\nnormal = \"-z\"";
const DENSITY: f64 = 2500.0;
const MODULUS: f64 = 5e6 / (1.0 - 0.09);

/// What differs between the cases.
#[derive(Clone, Copy)]
struct Beads<'a> {
    damping: f64,
    work: f64,
    roof_work: f64,
    speed: f64,
    gravity: f64,
    end: f64,
    safety: f64,
    roof: &'a str,
}

impl Beads<'_> {
    const STILL: Beads<'static> = Beads {
        damping: 0.3,
        work: 0.5,
        roof_work: 0.5,
        speed: 0.0,
        gravity: -9.81,
        end: 0.15,
        safety: 0.4,
        roof: PLANE,
    };

    fn place(&self, beads: &[[f64; 4]]) -> Workplace {
        let numbers = [
            ("DAMPING", self.damping),
            ("ROOF_WORK", self.roof_work),
            ("WORK", self.work),
            ("SPEED", self.speed),
            ("GRAVITY", self.gravity),
            ("END", self.end),
            ("SAFETY", self.safety),
        ];
        let case = numbers.iter().fold(BEADS.to_owned(), |case, (name, value)| case.replace(name, &value.to_string()));
        let place = Workplace::new(&case.replace("ROOF", self.roof));
        let row = |[x, y, z, radius]: &[f64; 4]| format!("{x},{y},{z},{radius}\n");
        fs::write(place.path("beads.csv"), beads.iter().map(row).collect::<String>()).unwrap();
        place
    }

    fn run(&self, beads: &[[f64; 4]]) -> Value {
        run(&self.place(beads), "one", "1")
    }
}

fn last(summary: &Value, probe: &str) -> f64 {
    summary["probes"][probe]["final"].as_f64().unwrap()
}

/// Mass [kg], pull [N] and reach [m] of a bead at a plane.
fn at_plane(radius: f64, work: f64) -> (f64, f64, f64) {
    let pull = 2.0 * PI * work * radius;
    let reach = (pull / (4.0 / 3.0 * MODULUS * radius.sqrt())).powf(2.0 / 3.0);
    (DENSITY * 4.0 / 3.0 * PI * radius.powi(3), pull, reach)
}

/// Radius of a bead that hangs by a pull of 2 pi W R* with R* = `share` R: 4/3 pi R^3 rho g.
fn critical(work: f64, share: f64) -> f64 {
    (1.5 * work * share / (DENSITY * 9.81)).sqrt()
}

#[test]
fn a_bead_hangs_from_a_plane_up_to_its_critical_size() {
    for work in [0.1, 0.5, 2.0] {
        for (share, hangs) in [(0.995, true), (1.005, false)] {
            let radius = share * critical(work, 1.0);
            let beads = Beads { work, roof_work: work, ..Beads::STILL };
            let way = last(&beads.run(&[[0.0, 0.0, -radius, radius]]), "way");
            assert_eq!(way > -1e-3 * radius, hangs, "{work} J/m2, {share}: {way} m");
        }
    }
}

#[test]
fn beads_that_stick_have_the_same_bits_on_any_threads_and_after_a_checkpoint() {
    // One hangs, one comes nearer and sticks, one hangs below both.
    let beads = Beads { speed: 0.01, end: 0.01, ..Beads::STILL };
    let place = beads.place(&[[0.0, 0.0, -2e-3, 2e-3], [4e-3, 0.0, -2.02e-3, 2e-3], [2e-3, 0.0, -5.47e-3, 2e-3]]);
    let case = fs::read_to_string(place.path("case.toml")).unwrap();
    fs::write(place.path("case.toml"), case + "[output]\ncheckpoint = { steps = 900 }\n").unwrap();
    let one = run(&place, "one", "1");
    let two = run(&place, "two", "2");
    assert_eq!((&two["state_hash"], &two["probes"]), (&one["state_hash"], &one["probes"]));
    let resumed = resumed(&place, "two");
    assert_eq!((&resumed["state_hash"], &resumed["probes"]), (&one["state_hash"], &one["probes"]));
    assert!(one["counts"]["contacts"].as_u64().unwrap() > 3, "{}", one["counts"]);
}

#[test]
fn a_bead_hangs_from_balls_and_other_beads_by_the_reduced_radius() {
    let work: f64 = 0.5;
    // A ball that bulges to the bead with twice its radius: R* is two thirds of the bead's.
    for (share, hangs) in [(0.995, true), (1.005, false)] {
        let radius = share * critical(work, 2.0 / 3.0);
        let ball = format!("shape = \"sphere\"\npoint = [0, 0, {}]\nradius = {}", 2.0 * radius, 2.0 * radius);
        let way = last(&Beads { roof: &ball, ..Beads::STILL }.run(&[[0.0, 0.0, -radius, radius]]), "way");
        assert_eq!(way > -1e-3 * radius, hangs, "ball, {share}: {way} m");
        // A bead of the same size above it, which sticks to the plane by much more.
        let radius = share * critical(work, 0.5);
        // Both begin where they rest, or just touch.
        let (mass, from_plane, at_roof) = at_plane(radius, (4.0f64 * work).sqrt());
        let from_bead = PI * work * radius;
        let at_bead = (from_bead / (2.0 / 3.0 * MODULUS * (0.5 * radius).sqrt())).powf(2.0 / 3.0);
        let left = |pull: f64, beads: f64| (1.0 - beads * mass * 9.81 / pull).max(0.0).powf(2.0 / 3.0);
        let upper = at_roof * left(from_plane, 2.0) - radius;
        let lower = upper - 2.0 * radius + at_bead * left(from_bead, 1.0);
        let pair = [[0.0, 0.0, upper, radius], [0.0, 0.0, lower, radius]];
        let way = last(&Beads { roof_work: 4.0, ..Beads::STILL }.run(&pair), "way");
        assert_eq!(way > -1e-3 * radius, hangs, "bead, {share}: {way} m");
    }
}

#[test]
fn a_bead_hangs_from_facets_their_edges_and_points_as_from_a_plane() {
    // Four triangles around a point in one plane, and the places of a bead in one, on a common edge and at the common point.
    let corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]];
    let vertex = |[x, y]: [i32; 2]| format!("vertex {x} {y} 0\n");
    let facet = |k: usize| {
        let ring = [[0, 0], corners[(k + 1) % 4], corners[k]].map(vertex).concat();
        format!("facet normal 0 0 -1\nouter loop\n{ring}endloop\nendfacet\n")
    };
    let stl = format!("solid roof\n{}endsolid roof\n", [0, 1, 2, 3].map(facet).concat());
    let roof = "shape = \"stl\"\nfile = \"roof.stl\"";
    for (share, hangs) in [(0.995, true), (1.005, false)] {
        let radius = share * critical(0.5, 1.0);
        for at in [[0.5, -0.3], [0.2, 0.2], [0.0, 0.0]] {
            let place = Beads { roof, ..Beads::STILL }.place(&[[at[0], at[1], -radius, radius]]);
            fs::write(place.path("roof.stl"), &stl).unwrap();
            let way = last(&run(&place, "one", "1"), "way");
            assert_eq!(way > -1e-3 * radius, hangs, "{at:?}, {share}: {way} m");
        }
    }
}

#[test]
fn without_losses_a_bead_leaves_as_it_came() {
    for radius in [1e-3, 5e-3, 2e-2] {
        for work in [0.02, 0.5, 5.0] {
            let (mass, pull, reach) = at_plane(radius, work);
            let speed = 2.0 * (pull * reach / mass).sqrt();
            let errors = [0.4, 0.2].map(|safety| {
                let beads = Beads { damping: 0.0, work, roof_work: work, gravity: 0.0, speed, safety, ..Beads::STILL };
                let end = 25.0 * reach / speed;
                let free = Beads { end, ..beads }.run(&[[0.0, 0.0, -radius - 2.0 * reach, radius]]);
                let residual = free["energy"]["residual_max_relative"].as_f64().unwrap();
                assert!(residual < 5e-3, "{radius} m, {work} J/m2: {residual}");
                last(&free, "speed") / speed + 1.0
            });
            assert!(errors[0].abs() < 2e-3 && errors[1].abs() < 1e-3, "{radius} m, {work} J/m2: {errors:?}");
        }
    }
}

/// Speed over sqrt(F h/m) below which a bead sticks with the damping ratio `zeta`: the motion x'' = 1 - x^(3/2) - sqrt(5) zeta x^(1/4) x', by the
/// overlap in reaches, is followed by the method of Runge and Kutta.
fn sticking(zeta: f64) -> f64 {
    let acceleration = |x: f64, v: f64| {
        if x <= 0.0 {
            return (1.0 + x).max(0.0);
        }
        let elastic = x.powf(1.5);
        1.0 - elastic - (5f64.sqrt() * zeta * x.powf(0.25) * v).max(-elastic)
    };
    let leaves = |speed: f64| {
        let (mut x, mut v, dt) = (-1.0, speed, 1e-3);
        for _ in 0..40_000 {
            let a1 = acceleration(x, v);
            let (v2, a2) = (v + 0.5 * dt * a1, acceleration(x + 0.5 * dt * v, v + 0.5 * dt * a1));
            let (v3, a3) = (v + 0.5 * dt * a2, acceleration(x + 0.5 * dt * v2, v + 0.5 * dt * a2));
            let (v4, a4) = (v + dt * a3, acceleration(x + dt * v3, v + dt * a3));
            x += dt * (v + 2.0 * v2 + 2.0 * v3 + v4) / 6.0;
            v += dt * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0;
            if x < -1.0 {
                return true;
            }
        }
        false
    };
    let (mut low, mut high) = (0.01, 10.0);
    while high - low > 1e-3 * high {
        let middle = 0.5 * (low + high);
        (low, high) = if leaves(middle) { (low, middle) } else { (middle, high) };
    }
    0.5 * (low + high)
}

#[test]
fn a_collision_sticks_below_a_speed_that_damping_gives() {
    // To first order in the damping ratio, sqrt(2 I zeta) with I = 2 sqrt(5) times the integral of x^(1/4) sqrt(1 + 2 x - 0.8 x^(5/2)), 11.317.
    assert!((sticking(1e-3) / (2.0 * 11.317 * 1e-3f64).sqrt() - 1.0).abs() < 0.01, "{}", sticking(1e-3));
    for damping in [0.03, 0.2] {
        let factor = sticking(damping);
        for (radius, work) in [(1e-3, 0.02), (1e-3, 5.0), (5e-3, 0.5), (2e-2, 0.02), (2e-2, 5.0)] {
            let (mass, pull, reach) = at_plane(radius, work);
            for (share, sticks) in [(0.98, true), (1.02, false)] {
                let speed = share * factor * (pull * reach / mass).sqrt();
                let end = 60.0 * (mass * reach / pull).sqrt();
                let beads = Beads { damping, work, roof_work: work, gravity: 0.0, speed, end, ..Beads::STILL };
                let way = last(&beads.run(&[[0.0, 0.0, -radius - 1.1 * reach, radius]]), "way");
                assert_eq!(way > 0.0, sticks, "{damping}, {radius} m, {work} J/m2, {share}: {way} m");
            }
        }
    }
}

#[test]
fn damping_takes_the_motion_and_what_binds() {
    let (radius, work, speed) = (5e-3, 0.5, 0.02);
    let (mass, pull, reach) = at_plane(radius, work);
    let beads = Beads { damping: 0.4, gravity: 0.0, speed, end: 0.1, ..Beads::STILL };
    let stuck = beads.run(&[[0.0, 0.0, -radius - 2.0 * reach, radius]]);
    let right = 0.5 * mass * speed * speed + 1.1 * pull * reach;
    assert!(last(&stuck, "kinetic") < 1e-4 * right, "{}", stuck["probes"]);
    assert!((last(&stuck, "damped") / right - 1.0).abs() < 0.01, "{} J for {right}", last(&stuck, "damped"));
    assert!((last(&stuck, "way") / (3.0 * reach) - 1.0).abs() < 0.01, "{} m", last(&stuck, "way"));
}

#[test]
fn adhesion_without_effect_is_told() {
    let beads = Beads { work: 0.0, ..Beads::STILL };
    let place = beads.place(&[[0.0, 0.0, -0.1, 0.01]]);
    let told = place.fractum(&["check", "case.toml"]);
    let said = format!("{}{}", told.stdout, told.stderr);
    assert!(
        said.contains("= \"roof\": the work_of_adhesion of its contact has no effect: no loose particles"),
        "{said}"
    );
    // Solids and bonded bodies of the same material do not stick; loose beads do.
    let place = Beads::STILL.place(&[[0.0, 0.0, -0.1, 0.01]]);
    let more = r#"
[materials.m.bonds]
coordination = 3
convention = "all"
radius_ratio = 0.5
young_modulus = "5 MPa"
[[bodies]]
name = "bar"
kind = "solid"
group = "body"
material = "m"
[[bodies]]
name = "block"
kind = "bonded"
material = "m"
file = "block.csv"
bond_gap = "1 mm"
[mesh]
file = "bar.msh"
"#;
    let case = fs::read_to_string(place.path("case.toml")).unwrap();
    fs::write(place.path("case.toml"), case + more).unwrap();
    let at = |k: u32, bit: u32| f64::from(k >> bit & 1) * 0.02;
    let row = |k: u32| format!("{},{},{},0.01\n", 1.0 + at(k, 0), at(k, 1), at(k, 2) - 1.0);
    fs::write(place.path("block.csv"), (0..8).map(row).collect::<String>()).unwrap();
    let told = place.fractum(&["check", "case.toml"]);
    let said = format!("{}{}", told.stdout, told.stderr);
    assert!(said.contains("= \"block\": the work_of_adhesion of its contact has no effect: bonded bodies"), "{said}");
    assert!(said.contains("= \"bar\": the work_of_adhesion of its contact has no effect: solids"), "{said}");
    assert!(!said.contains("= \"roof\": the work_of_adhesion"), "{said}");
    assert!(said.contains("work of adhesion 500 mJ/m²"), "{said}");
    let wrong = Beads { work: -0.5, ..Beads::STILL }.place(&[[0.0, 0.0, -0.1, 0.01]]);
    let ended = wrong.fractum(&["check", "case.toml"]);
    let found = ended.stderr.contains("materials.m.contact.work_of_adhesion");
    assert!(ended.code == Some(1) && found, "{}", ended.stderr);
}
