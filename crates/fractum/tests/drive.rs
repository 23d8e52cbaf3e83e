//! Simulations that a program drives: forces that it sets, and an end that it chooses.

use fractum::{Options, Simulation};
use fractum_math::Vec3;
use fractum_output::summary::Status;
use fractum_scene::{EnergyKind, Population};

use crate::common::Workplace;

/// A bar that nothing holds.
const FREE_BAR: &str = r#"fractum = 1
mesh = { file = "bar.msh" }
bodies = [{ name = "bar", kind = "solid", group = "body", material = "soft", kinematics = "small" }]
solver = { kind = "explicit", end = "20 ms" }
output = { history = { every = "0.1 ms" } }
loads = [{ gravity = { y = "0 m/s^2" } }]
[materials.soft]
density = "1000 kg/m^3"
young_modulus = "1 MPa"
poisson_ratio = 0.2
"#;

fn open(place: &Workplace) -> Simulation {
    let options = Options { output: Some(place.path("out")), quiet: true, ..Options::default() };
    Simulation::open(&place.path("case.toml"), &options).unwrap()
}

#[test]
fn given_forces_give_their_impulse_and_their_work() {
    let place = Workplace::new(FREE_BAR);
    let mut simulation = open(&place);
    let force = Vec3::new(3.0, -1.0, 2.0);
    let forces = [(0, force * 0.25), (5, force * 0.5), (0, force * 0.25)];
    simulation.add_forces(Population::Nodes, [(7, force * 100.0)]).unwrap();
    simulation.clear_forces();
    simulation.add_forces(Population::Nodes, forces).unwrap();
    let momentum = |simulation: &Simulation| -> Vec3 {
        let solid = &simulation.scene().solid;
        solid.velocity.iter().zip(&solid.mass).map(|(v, m)| v * *m).sum()
    };
    let mut half_step = 0.0;
    while simulation.time() < 5e-3 {
        half_step = simulation.time() + 0.5 * simulation.scene().clock.dt_after;
        simulation.step().unwrap();
        simulation.record().unwrap();
    }
    let impulse = force * half_step;
    assert!((momentum(&simulation) - impulse).norm() < 1e-9 * impulse.norm(), "{} {impulse}", momentum(&simulation));
    // Without forces the momentum stays.
    simulation.clear_forces();
    while !simulation.is_over() {
        simulation.step().unwrap();
        simulation.record().unwrap();
    }
    assert!((momentum(&simulation) - impulse).norm() < 1e-9 * impulse.norm(), "{} {impulse}", momentum(&simulation));
    let outcome = simulation.finish().unwrap();
    let energy = &outcome.summary.energy;
    assert_eq!(outcome.summary.status, Status::Completed);
    assert!(energy.entries[EnergyKind::External as usize] > 0.0 && energy.residual_max_relative < 1e-9, "{energy:?}");
}

#[test]
fn forces_that_cannot_be_are_refused() {
    let place = Workplace::new(FREE_BAR);
    let mut simulation = open(&place);
    let count = simulation.scene().solid.reference.len() as u32;
    let mut said = |population, node: u32, x: f64| {
        let forces = [(0, Vec3::x()), (node, Vec3::x() * x)];
        simulation.add_forces(population, forces).unwrap_err().to_string()
    };
    assert!(said(Population::Nodes, count, 1.0).contains("expected less than"));
    assert!(said(Population::Particles, 0, 1.0).contains("particle 0"));
    assert!(said(Population::Nodes, 1, f64::NAN).contains("finite"));
    // Nor does what was right of them act.
    simulation.step().unwrap();
    assert!(simulation.scene().solid.velocity.iter().all(|v| *v == Vec3::zeros()));
    drop(simulation);
    let held = "supports = [{ group = \"x-\", fix = \"xyz\" }]\nsolver = { kind = \"static\", end";
    let place = Workplace::new(&FREE_BAR.replace("solver = { kind = \"explicit\", end", held));
    let refused = open(&place).add_forces(Population::Nodes, [(0, Vec3::zeros())]).unwrap_err().to_string();
    assert!(refused.contains("solver.kind = \"explicit\""), "{refused}");
}

#[test]
fn a_run_that_its_driver_ends_is_complete() {
    let place = Workplace::new(FREE_BAR);
    let mut simulation = open(&place);
    for _ in 0..10 {
        simulation.step().unwrap();
        simulation.record().unwrap();
    }
    assert_eq!(simulation.status(), None);
    simulation.stop().unwrap();
    assert!(simulation.is_over() && simulation.status() == Some(Status::Completed));
    simulation.step().unwrap();
    assert_eq!(simulation.steps(), 10);
    let hash = fractum_output::summary::hash_text(simulation.state_hash());
    let outcome = simulation.finish().unwrap();
    assert_eq!((outcome.summary.status, outcome.summary.hashes.state_hash), (Status::Completed, hash));
    assert_eq!(outcome.summary.time.reason, "ended by the program that drives it");
}

#[test]
fn a_probe_with_an_interval_measures_once_in_each_and_at_the_end() {
    let probes = "output = { history = { every = \"0.1 ms\" } }
probes = [
    { name = \"fast\", momentum = { along = \"-y\" } },
    { name = \"slow\", momentum = { along = \"-y\" }, every = \"3.5 ms\" },
]";
    let case =
        FREE_BAR.replace("output = { history = { every = \"0.1 ms\" } }", probes).replace("0 m/s^2", "-10 m/s^2");
    let place = Workplace::new(&case);
    let mut simulation = open(&place);
    while !simulation.is_over() {
        simulation.step().unwrap();
        simulation.record().unwrap();
    }
    let folder = simulation.folder().to_owned();
    simulation.finish().unwrap();
    let history = fractum_output::history::read(&folder.join("history.csv")).unwrap();
    let column = |name: &str| history.column(name).unwrap().0.to_vec();
    let (times, fast, slow) = (column("time"), column("fast"), column("slow"));
    let interval = |time: f64| (time / 3.5e-3 * (1.0 + 1e-12)).floor();
    let mut held = slow[0];
    for row in 0..times.len() {
        let is_due = row == 0 || row + 1 == times.len() || interval(times[row]) > interval(times[row - 1]);
        held = if is_due { fast[row] } else { held };
        assert_eq!(slow[row], held, "row {row}");
    }
    let measured = 1 + (1..slow.len()).filter(|&row| slow[row] != slow[row - 1]).count();
    assert!((6..=8).contains(&measured) && times.len() > 28, "{measured} of {}", times.len());
}
