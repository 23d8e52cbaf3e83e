//! Cells with steps of two sizes: energy, momentum, long runs, and the same answers as with one step.

use std::sync::Arc;

use fractum_fem::{Body, Formulation, LocalDamping, Solid, SolidError, motion};
use fractum_math::Vec3;
use fractum_scene::coupling::Debris;
use fractum_scene::{
    ContactParameters, EnergyKind, Gravity, Load, Loads, Motion, Scene, SceneSettings, Support, Supports,
};
use fractum_tests::{jittered_box, settings, softening};

const CELLS: [u32; 3] = [44, 3, 3];
const SIZE: Vec3 = Vec3::new(4.4, 0.3, 0.3);

/// The bar with a zone in the middle whose cells are an eighth as long.
fn graded(formulation: Formulation) -> (Vec<Vec3>, Body) {
    let (mut nodes, body) = jittered_box(CELLS, SIZE);
    let (from, to) = (2.0, 2.4);
    for node in &mut nodes {
        node.x -= 0.875 * (node.x - from).clamp(0.0, to - from);
    }
    (nodes, Body { formulation, ..body })
}

fn scene(solid: Solid, supports: Vec<Support>, loads: Vec<Load>, settings: SceneSettings) -> Scene {
    let places: Vec<Vec3> = (0..solid.mass.len()).map(|node| solid.reference[solid.original(node)]).collect();
    let loads = Loads::new(loads, places.len());
    let supports = Supports::new(supports, &places).unwrap();
    let debris = Debris::new(&solid, vec![ContactParameters::default()]);
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings)
}

fn ends_at(solid: &Solid, x: f64) -> Vec<u32> {
    (0..solid.reference.len() as u32).filter(|&n| (solid.reference[n as usize].x - x).abs() < 1e-9).collect()
}

/// A smooth push of the left end, 2 ms long, which is 80 long cells.
fn pushed(solid: Solid, end: f64, safety: f64) -> Scene {
    let push = |t: f64, _: &Vec3| if t < 2e-3 { (std::f64::consts::PI * t / 2e-3).sin().powi(2) } else { 0.0 };
    let left = ends_at(&solid, 0.0);
    let mut settings = settings(end, 1e-6);
    settings.time_step.safety = safety;
    scene(solid, vec![Support::new("left", left, 0, Motion::Velocity(Arc::new(push)))], Vec::new(), settings)
}

fn momentum(scene: &Scene) -> Vec3 {
    scene.solid.velocity.iter().zip(&scene.solid.mass).map(|(v, m)| v * *m).sum()
}

#[test]
fn a_bar_with_a_fine_zone_takes_eight_short_steps_in_a_long_one() {
    for formulation in [Formulation::Standard, Formulation::Smoothed] {
        let (nodes, body) = graded(formulation);
        let mass = body.elastic.density * 0.09 * 4.05;
        let solid = Solid::subcycled(nodes, vec![body]).unwrap();
        assert!((solid.mass.iter().sum::<f64>() / mass - 1.0).abs() < 1e-12);
        let (parts, share, linked) = pushed(solid, 1e-3, 0.8).subcycling().unwrap();
        assert!((5..=9).contains(&parts) && share < 0.2 && linked > 0, "{parts} {share} {linked}");
    }
    // All cells alike: nothing is gained.
    let (nodes, body) = jittered_box(CELLS, SIZE);
    assert!(!Solid::subcycled(nodes, vec![body]).unwrap().is_subcycled());
}

type NewSolid = fn(Vec<Vec3>, Vec<Body>) -> Result<Solid, SolidError>;

/// Largest mean velocity of the free end under the pulse [m/s], and what the steps took of the work done.
fn passed(new: NewSolid, formulation: Formulation, safety: f64) -> (f64, f64) {
    let (nodes, body) = graded(formulation);
    let mut scene = pushed(new(nodes, vec![body]).unwrap(), 4e-3, safety);
    let right = ends_at(&scene.solid, 4.05);
    let mut peak = 0.0_f64;
    while !scene.is_finished() {
        scene.step(true).unwrap();
        assert!(scene.ledger().relative_residual() < 1e-11, "{}", scene.ledger().relative_residual());
        let mean = right.iter().map(|&n| scene.solid.velocity[n as usize].x).sum::<f64>() / right.len() as f64;
        peak = peak.max(mean);
    }
    (peak, scene.ledger()[EnergyKind::TimeStep] / scene.ledger()[EnergyKind::External])
}

#[test]
fn a_pulse_passes_a_fine_zone_as_with_one_step() {
    for formulation in [Formulation::Standard, Formulation::Smoothed] {
        let (peak, taken) = passed(Solid::new, formulation, 0.8);
        assert_eq!(taken, 0.0);
        let (in_parts, taken) = passed(Solid::subcycled, formulation, 0.8);
        assert!((in_parts / peak - 1.0).abs() < 5e-3, "{peak} {in_parts}");
        // The link takes energy, the less the shorter the steps are.
        let (_, with_half) = passed(Solid::subcycled, formulation, 0.4);
        assert!(taken > 0.0 && taken < 3e-3 && with_half < 0.6 * taken, "{taken} {with_half}");
    }
}

/// Close to the limit of both sides, from noise: whatever the link does, it must not feed the waves.
#[test]
fn a_long_run_near_the_limit_gains_no_energy() {
    let (nodes, body) = graded(Formulation::Smoothed);
    let mut solid = Solid::subcycled(nodes, vec![body]).unwrap();
    for (node, velocity) in solid.velocity.iter_mut().enumerate() {
        *velocity = Vec3::from_fn(|axis, _| fractum_tests::noise(3 * node + axis));
    }
    motion::set_copies_off(&mut solid);
    let mut settings = settings(1.0, 1e-6);
    settings.time_step.safety = 0.95;
    let mut scene = scene(solid, Vec::new(), Vec::new(), settings);
    let start = momentum(&scene);
    let mut highest = 0.0_f64;
    for step in 0..20_000 {
        scene.step(step % 100 == 0).unwrap();
        let held = scene.ledger()[EnergyKind::Kinetic] + scene.ledger()[EnergyKind::Elastic];
        highest = highest.max(held / scene.ledger().initial);
    }
    assert!(highest < 1.0 + 1e-9, "{highest}");
    let scale: f64 = scene.solid.mass.iter().sum::<f64>() * 0.5;
    let lost = (momentum(&scene) - start).norm();
    assert!(lost < 1e-3 * scale, "{lost} of {scale}");
}

/// Weight, moving and fixed supports on either side of the link and on it: as with one step, and the books close.
#[test]
fn loads_and_supports_work_on_both_sides_of_the_link() {
    let run = |new: NewSolid, local: f64| {
        let (nodes, body) = graded(Formulation::Smoothed);
        let solid = new(nodes, vec![body]).unwrap();
        let bottom: Vec<u32> =
            (0..solid.reference.len() as u32).filter(|&n| solid.reference[n as usize].z < 1e-9).collect();
        let tops: Vec<u32> =
            (0..solid.reference.len() as u32).filter(|&n| solid.reference[n as usize].z > 0.3 - 1e-9).collect();
        let lift = Motion::Velocity(Arc::new(|t: f64, _: &Vec3| (t / 1e-3).min(1.0) * 1e-3));
        let sets = [("bottom", bottom, 2, Motion::Fixed), ("top", tops.clone(), 2, lift)];
        let mut supports = Vec::new();
        for (name, points, axis, motion) in sets {
            let all = motion::with_copies(&solid, points);
            for is_fine in [false, true] {
                let own = all.iter().copied().filter(|&n| solid.is_fine(n as usize) == is_fine).collect();
                let mut support = Support::new(name, own, axis, motion.clone());
                support.is_fine = is_fine;
                supports.push(support);
            }
        }
        let weight = Load::Gravity(Gravity { axis: 0, value: Arc::new(|t, _| 50.0 * (t / 1e-3).min(1.0)) });
        let mut settings = settings(4e-3, 1e-6);
        settings.damping = LocalDamping { local, mass_rate: 50.0 };
        let mut scene = scene(solid, supports, vec![weight], settings);
        let places = scene.supports().places(&motion::with_copies(&scene.solid, tops));
        let (mut sum, mut steps) = (0.0, 0.0);
        while !scene.is_finished() {
            scene.step(true).unwrap();
            assert!(scene.ledger().relative_residual() < 1e-9, "{}", scene.ledger().relative_residual());
            sum += scene.supports().reaction(&places, &Vec3::z());
            steps += 1.0;
        }
        scene.step(true).unwrap();
        (sum / steps, scene.ledger()[EnergyKind::External])
    };
    // Local damping depends on the steps.
    for (local, tolerance) in [(0.0, 5e-3), (0.3, 1e-2)] {
        let (force, work) = run(Solid::new, local);
        let (in_parts, work_in_parts) = run(Solid::subcycled, local);
        assert!((in_parts / force - 1.0).abs() < tolerance, "{local}: {force} N, {in_parts} N");
        assert!((work_in_parts / work - 1.0).abs() < tolerance, "{local}: {work} J, {work_in_parts} J");
    }
}

/// What is known in advance of the cells at the border is found again from a saved state.
#[test]
fn a_state_put_back_goes_on_with_the_same_bits_while_the_bar_breaks() {
    let (nodes, body) = graded(Formulation::Smoothed);
    let mut body = body.with_damage(softening(30.0));
    let weak = |p: &Vec3| if (p.x - 2.0).abs() < 0.25 { 0.7 } else { 1.0 };
    let factors = body.edge_midpoints(&nodes).iter().map(weak).collect();
    body.damage.as_mut().unwrap().strength_factor = factors;
    let solid = Solid::subcycled(nodes, vec![body]).unwrap();
    let pull = |sign: f64| Motion::Velocity(Arc::new(move |t: f64, _: &Vec3| sign * (t / 4e-4).min(1.0)));
    let supports = vec![
        Support::new("left", ends_at(&solid, 0.0), 0, pull(-0.5)),
        Support::new("right", ends_at(&solid, 4.05), 0, pull(0.5)),
    ];
    let mut scene = scene(solid, supports, Vec::new(), settings(2e-3, 1e-2));
    let mut removed = 0;
    while !scene.is_finished() {
        let mut other = scene.clone();
        other.restore(scene.state());
        other.restore_subcycling(scene.subcycling_state());
        removed += scene.step(true).unwrap().removed;
        other.step(true).unwrap();
        let step = scene.clock.step;
        assert!(scene.state() == other.state(), "after step {step}, {removed} elements have left");
    }
    assert!(removed > 0);
}
