//! Quasi-static equilibrium: patch test, both linear solvers, snap-back of a bar, free bodies.

use std::sync::Arc;

use fractum_fem::{
    Body, DamageLaw, DamageZone, Elastic, ElementKind, Formulation, Kinematics, LocalDamping, Plane, Region, Solid,
    fields,
};
use fractum_math::{Mat3, Sym3, Vec3};
use fractum_mesh::generate::{Jitter, structured_rectangle};
use fractum_scene::coupling::Debris;
use fractum_scene::statics::{Control, LinearSolver, Opening, StaticSettings, StaticSolver, Stiffness, check_supports};
use fractum_scene::{
    ContactParameters, EnergyKind, Load, Loads, Motion, NodalForce, Scene, SceneError, SceneSettings, Support,
    Supports, TimeFunction, TimeStepSettings,
};
use fractum_tests::{CONCRETE, jittered_box, softening, statics};

const FORMULATIONS: [Formulation; 2] = [Formulation::Standard, Formulation::Smoothed];

fn settings(control: Control, linear: LinearSolver) -> StaticSettings {
    StaticSettings { control, tolerance: 1e-6, linear, ..statics(0.1, 1.0) }
}

fn scene(solid: Solid, supports: Vec<Support>, loads: Vec<Load>) -> Scene {
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let loads = Loads::new(loads, solid.reference.len());
    let debris = Debris::new(&solid, vec![ContactParameters::default(); solid.body_count()]);
    let settings = SceneSettings {
        time_step: TimeStepSettings { safety: 0.8, element_bound: true, fixed: None, begin: 0.0, end: 1.0 },
        damping: LocalDamping::default(),
        stiffness_time: 0.0,
        balance_stop: 1e-2,
        joined_below: 0.95,
    };
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings)
}

fn nodes_where(solid: &Solid, keep: impl Fn(&Vec3) -> bool) -> Vec<u32> {
    (0..solid.reference.len() as u32).filter(|&n| keep(&solid.reference[n as usize])).collect()
}

#[test]
fn affine_motion_of_the_surface_moves_the_inside_affinely() {
    let slope = Mat3::new(1.0, 0.3, -0.2, 0.5, -0.7, 0.4, 0.1, 0.6, 0.9) * 1e-4;
    for formulation in FORMULATIONS {
        for linear in [LinearSolver::Direct, LinearSolver::Iterative] {
            let (nodes, body) = jittered_box([4, 3, 5], Vec3::new(1.0, 0.8, 1.2));
            let solid = Solid::new(nodes, vec![Body { formulation, ..body }]).unwrap();
            let outside = |p: &Vec3| (0..3).any(|a| p[a] < 1e-9 || p[a] > [1.0, 0.8, 1.2][a] - 1e-9);
            let surface = nodes_where(&solid, outside);
            let support = |axis: usize| {
                let motion: TimeFunction = Arc::new(move |t, x: &Vec3| t * (slope * x)[axis]);
                Support::new(&format!("surface {axis}"), surface.clone(), axis, Motion::Displacement(motion))
            };
            let mut scene = scene(solid, (0..3).map(support).collect(), Vec::new());
            let mut solver = StaticSolver::new(&scene, settings(Control::Time, linear)).unwrap();
            while !solver.is_finished(&scene) {
                solver.step(&mut scene).unwrap();
            }
            for i in 0..scene.solid.reference.len() {
                let error = (scene.solid.displacement[i] - slope * scene.solid.reference[i]).norm();
                assert!(error < 1e-12 * slope.norm(), "{formulation:?} {linear:?}: {error:e}");
            }
            assert!(scene.ledger().relative_residual() < 1e-12);
        }
    }
}

fn soft() -> DamageLaw {
    softening(60.0)
}

/// A plane bar that can be damaged in its middle only, long enough to snap back.
fn bar(formulation: Formulation) -> Solid {
    let mesh = structured_rectangle([40, 4], [1.0, 0.1], Some(Jitter { fraction: 0.1, seed: 2 }));
    let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
    let elastic = Elastic { poisson_ratio: 0.0, ..CONCRETE };
    let body = Body::new("bar", ElementKind::T3, elements, elastic);
    let body = Body { formulation, plane: Plane::Stress, thickness: 0.1, ..body };
    let near = |p: &Vec3| (p.x - 0.5).abs() < 0.03;
    let region = Region::Edges(body.edge_midpoints(&mesh.nodes).iter().map(near).collect());
    let zone = DamageZone {
        law: soft(),
        region,
        strength_factor: Vec::new(),
        strength_by_chance: Vec::new(),
        reduce_strength_to_fit: false,
        regularisation: None,
        rate: None,
    };
    Solid::new(mesh.nodes, vec![Body { damage: Some(zone), ..body }]).unwrap()
}

#[test]
fn path_follows_the_snap_back_of_a_bar_and_closes_its_balance() {
    for formulation in FORMULATIONS {
        let solid = bar(formulation);
        let (left, right) = (nodes_where(&solid, |p| p.x < 1e-9), nodes_where(&solid, |p| p.x > 1.0 - 1e-9));
        let corner = nodes_where(&solid, |p| p.x < 1e-9 && p.y < 1e-9);
        let supports = vec![
            Support::new("left", left, 0, Motion::Fixed),
            Support::new("corner", corner, 1, Motion::Fixed),
            Support::new("right", right.clone(), 0, Motion::Displacement(Arc::new(|t, _| 4e-4 * t))),
        ];
        let mut scene = scene(solid, supports, Vec::new());
        let mut solver = StaticSolver::new(&scene, settings(Control::Path, LinearSolver::Direct)).unwrap();
        let places = scene.supports().places(&right);
        let (mut peak, mut back, mut last, mut now) = (0.0f64, false, 0.0, 0.0);
        while !solver.is_finished(&scene) && now >= 0.1 * peak {
            solver.step(&mut scene).unwrap();
            now = scene.supports().reaction(&places, &Vec3::x());
            peak = peak.max(now);
            back |= scene.clock.time < last;
            last = scene.clock.time;
        }
        assert!(back, "{formulation:?}: the end of the bar goes back");
        assert!(now < 0.1 * peak, "{formulation:?}: {now} of {peak} left");
        let strength = soft().tensile_strength * 0.01;
        assert!((peak / strength - 1.0).abs() < 0.03, "{formulation:?}: {peak} of {strength} N");
        let residual = scene.ledger().residual_max_relative;
        assert!(residual < 1e-4, "{formulation:?}: {residual:e}");
    }
}

#[test]
fn a_body_that_nothing_holds_is_named_with_its_motion() {
    let (nodes, body) = jittered_box([2, 2, 2], Vec3::new(1.0, 1.0, 1.0));
    let solid = Solid::new(nodes, vec![Body { name: "brick".into(), ..body }]).unwrap();
    let bottom = nodes_where(&solid, |p| p.z < 1e-9);
    let held = |axes: &[usize]| {
        let sets = axes.iter().map(|&a| Support::new(&format!("{a}"), bottom.clone(), a, Motion::Fixed)).collect();
        Supports::new(sets, &solid.reference).unwrap()
    };
    let motion = |axes: &[usize]| match check_supports(&solid, held(axes).held(), &[], &[]) {
        Err(SceneError::FreeBody { body, motion, .. }) => format!("{body}: {motion}"),
        other => format!("{other:?}"),
    };
    assert_eq!(motion(&[0, 1, 2]), "Ok(())");
    assert_eq!(motion(&[0, 2]), "brick: move along y");
    assert_eq!(motion(&[2]).split(':').next(), Some("brick"));
    assert!(motion(&[]).starts_with("brick: "));
}

#[test]
fn a_pressed_block_has_the_stress_of_its_load() {
    let (nodes, body) = jittered_box([3, 3, 3], Vec3::new(1.0, 1.0, 1.0));
    let solid = Solid::new(nodes, vec![body]).unwrap();
    let at = |axis: usize| nodes_where(&solid, |p| p[axis] < 1e-9);
    let supports = (0..3).map(|a| Support::new(&format!("{a}"), at(a), a, Motion::Fixed)).collect();
    let top = nodes_where(&solid, |p| p.z > 1.0 - 1e-9);
    // Equal forces are no uniform traction on a jittered mesh, but their sum is.
    let share = 1.0 / top.len() as f64;
    let load = Load::Nodal(NodalForce {
        points: top.iter().map(|&n| (n, share)).collect(),
        axis: 2,
        value: Arc::new(|t, _| -1e6 * t),
    });
    let mut scene = scene(solid, supports, vec![load]);
    let mut solver = StaticSolver::new(&scene, settings(Control::Time, LinearSolver::Iterative)).unwrap();
    while !solver.is_finished(&scene) {
        solver.step(&mut scene).unwrap();
    }
    let fields = fields::element_fields(&scene.solid, 0, None);
    let mean = (0..fields.len() as u32).map(|e| fields[e as usize].0 * scene.solid.element_volume(0, e));
    let mean = mean.fold(Sym3::ZERO, |a, b| a + b);
    assert!((mean.0[2] + 1e6).abs() < 1.0, "{mean:?}");
}

#[test]
fn the_first_period_of_a_clamped_bar_is_four_transits() {
    let mesh = structured_rectangle([40, 2], [1.0, 0.05], None);
    let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
    let elastic = Elastic { poisson_ratio: 0.0, ..CONCRETE };
    let speed = (elastic.young_modulus / elastic.density).sqrt();
    let body = Body { plane: Plane::Stress, ..Body::new("bar", ElementKind::T3, elements, elastic) };
    let solid = Solid::new(mesh.nodes, vec![body]).unwrap();
    let supports = vec![
        Support::new("left", nodes_where(&solid, |p| p.x < 1e-9), 0, Motion::Fixed),
        Support::new("all", nodes_where(&solid, |_| true), 1, Motion::Fixed),
    ];
    let mut scene = scene(solid, supports, Vec::new());
    let mut stiffness = Stiffness::new(&scene).unwrap();
    stiffness.prepare(&scene).unwrap();
    let period = stiffness.first_period(&mut scene, 1.0).unwrap();
    assert!((period * speed / 4.0 - 1.0).abs() < 0.01, "{period}");
}

#[test]
fn opening_control_follows_the_snap_back_of_a_bar_as_well() {
    let solid = bar(Formulation::Smoothed);
    let (left, right) = (nodes_where(&solid, |p| p.x < 1e-9), nodes_where(&solid, |p| p.x > 1.0 - 1e-9));
    let corner = nodes_where(&solid, |p| p.x < 1e-9 && p.y < 1e-9);
    // Two rows of nodes on either side of the part that softens.
    let row = |x: f64| nodes_where(&solid, |p| (p.x - x).abs() < 0.01);
    let opening = Opening { nodes: row(0.575), against: row(0.425), direction: Vec3::x(), step: 2e-6, end: 6e-5 };
    let supports = vec![
        Support::new("left", left, 0, Motion::Fixed),
        Support::new("corner", corner, 1, Motion::Fixed),
        Support::new("right", right.clone(), 0, Motion::Displacement(Arc::new(|t, _| 4e-4 * t))),
    ];
    let mut scene = scene(solid, supports, Vec::new());
    let control = Control::Opening(opening.clone());
    let mut solver = StaticSolver::new(&scene, settings(control, LinearSolver::Direct)).unwrap();
    let places = scene.supports().places(&right);
    let (mut peak, mut back, mut last, mut open) = (0.0f64, false, 0.0, 0.0);
    while !solver.is_finished(&scene) {
        solver.step(&mut scene).unwrap();
        peak = peak.max(scene.supports().reaction(&places, &Vec3::x()));
        back |= scene.clock.time < last;
        last = scene.clock.time;
        let now = opening.of(&scene.solid.displacement);
        assert!(now > 0.99 * open && now < open + 1.01 * opening.step, "{now} after {open}");
        open = now;
    }
    assert!(back, "the end of the bar goes back");
    assert!((open - opening.end).abs() < 1e-9 * opening.end);
    let strength = soft().tensile_strength * 0.01;
    assert!((peak / strength - 1.0).abs() < 0.05, "{peak} of {strength} N");
    assert!(scene.supports().reaction(&places, &Vec3::x()) < 0.5 * peak);
    assert!(scene.ledger().residual_max_relative < 1e-3);
}

/// Supports that move a whole body without strain find it at rest, at any size.
#[test]
fn a_body_that_is_moved_as_a_whole_is_at_rest() {
    for (formulation, scale) in
        [(Formulation::Smoothed, 1.0), (Formulation::Standard, 1e-3), (Formulation::Smoothed, 1e3)]
    {
        let (nodes, body) = jittered_box([4, 3, 3], Vec3::new(1.0, 0.6, 0.6) * scale);
        let solid = Solid::new(nodes, vec![Body { formulation, ..body }]).unwrap();
        let left = nodes_where(&solid, |p| p.x < 1e-9);
        let slope = Mat3::new(0.0, -0.02, 0.01, 0.02, 0.0, 0.03, -0.01, -0.03, 0.0);
        let support = |axis: usize| {
            let of = move |x: &Vec3| (slope * x + Vec3::new(0.1, 0.2, -0.3) * scale)[axis];
            let motion: TimeFunction = Arc::new(move |t, x: &Vec3| t * of(x));
            Support::new(&format!("left {axis}"), left.clone(), axis, Motion::Displacement(motion))
        };
        for linear in [LinearSolver::Direct, LinearSolver::Iterative, LinearSolver::Faer] {
            let mut scene = scene(solid.clone(), (0..3).map(support).collect(), Vec::new());
            let mut solver = StaticSolver::new(&scene, settings(Control::Time, linear)).unwrap();
            while !solver.is_finished(&scene) {
                solver.step(&mut scene).unwrap();
            }
            for (u, x) in scene.solid.displacement.iter().zip(&scene.solid.reference) {
                let expected = slope * x + Vec3::new(0.1, 0.2, -0.3) * scale;
                assert!((u - expected).norm() < 1e-8 * scale, "{linear:?}, {scale}: {u} {expected}");
            }
        }
    }
}

/// A bar that is stretched and turned has the strain of its stretch alone, at rest and on the way to the next equilibrium; in a later stage of motion it
/// turns.
#[test]
fn motion_between_equilibria_keeps_the_strains_of_equilibrium() {
    for formulation in FORMULATIONS {
        let (nodes, body) = jittered_box([4, 2, 2], Vec3::new(0.4, 0.1, 0.1));
        let body = Body { formulation, kinematics: Kinematics::Auto, ..body };
        let solid = Solid::new(nodes, vec![body]).unwrap();
        let ends = nodes_where(&solid, |p| p.x < 1e-9 || p.x > 0.4 - 1e-9);
        let turn = |axis: usize| {
            let of = |x: &Vec3| 0.02 * Vec3::z().cross(x) + Vec3::x() * (1e-5 * x.x);
            let motion: TimeFunction = Arc::new(move |t, x: &Vec3| t.min(1.0) * of(x)[axis]);
            Support::new(&format!("ends {axis}"), ends.clone(), axis, Motion::Displacement(motion))
        };
        let of = |solid: Solid| scene(solid, (0..3).map(turn).collect(), Vec::new());
        let mut moved = of(solid.clone());
        let mut solver = StaticSolver::new(&moved, settings(Control::Time, LinearSolver::Direct)).unwrap();
        while !solver.is_finished(&moved) {
            solver.step(&mut moved).unwrap();
        }
        let at_rest = moved.ledger()[EnergyKind::Elastic];
        moved.begin_motion(None, 1.0);
        for _ in 0..300 {
            moved.step(true).unwrap();
        }
        // Corotational cells would see a strain of theta^2/2, twenty times that of the stretch.
        assert_eq!(moved.solid.body(0).kinematics, Kinematics::Auto);
        let elastic = moved.ledger()[EnergyKind::Elastic];
        assert!(at_rest > 0.0 && (elastic / at_rest - 1.0).abs() < 1e-6, "{elastic} {at_rest}");
        moved.begin_stage(of(solid), true);
        let turns =
            (0..300).any(|_| moved.step(false).is_err() || moved.solid.body(0).kinematics == Kinematics::Corotational);
        assert!(turns && moved.solid.body(0).kinematics == Kinematics::Corotational);
    }
}
