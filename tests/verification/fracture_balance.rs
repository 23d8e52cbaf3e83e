//! The energy balance of violent fracture at the default step: impact, a blast in a hole, a sudden pull; and what
//! guards it: the start out of balance, elements turned inside out, the stable step with damping.
//!
//! An edge goes from strong compression to broken within one step here, so that every term of the balance must take the
//! strain of the step before as it was.

use std::sync::Arc;

use fractum_fem::{Body, DamageLaw, ElementKind, Formulation, Kinematics, Plane, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
use fractum_scene::coupling::Debris;
use fractum_scene::{
    ContactParameters, EnergyKind, Ledger, Load, Loads, Motion, NodalForce, NodesOnShape, Pressure, Scene, StepError,
    Support, Supports,
};
use fractum_tests::{CONCRETE, settings, softening};

/// Part of the energy in play that may be missing from the balance.
const ALLOWED: f64 = 1e-3;

const KINDS: [(Formulation, Kinematics); 4] = [
    (Formulation::Smoothed, Kinematics::Small),
    (Formulation::Standard, Kinematics::Small),
    (Formulation::Smoothed, Kinematics::Corotational),
    (Formulation::Standard, Kinematics::Corotational),
];

fn concrete() -> DamageLaw {
    softening(100.0)
}

/// A jittered box of tetrahedra, or a rectangle of triangles where it has no cells in z.
fn block(cells: [u32; 3], size: Vec3) -> (Vec<Vec3>, Body) {
    let jitter = Some(Jitter { fraction: 0.15, seed: 7 });
    let body = |shape, elements| Body::new("block", shape, elements, CONCRETE).with_damage(concrete());
    if cells[2] == 0 {
        let mesh = structured_rectangle([cells[0], cells[1]], [size.x, size.y], jitter);
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        return (mesh.nodes, Body { plane: Plane::Strain, thickness: size.z, ..body(ElementKind::T3, elements) });
    }
    let mesh = structured_box(cells, size, jitter);
    (mesh.nodes, body(ElementKind::T4, mesh.tetrahedra))
}

fn nodes_where(solid: &Solid, keep: impl Fn(&Vec3) -> bool) -> Vec<u32> {
    (0..solid.reference.len() as u32).filter(|&n| keep(&solid.reference[n as usize])).collect()
}

fn scene(solid: Solid, supports: Vec<Support>, loads: Vec<Load>, grounds: Vec<NodesOnShape>, end: f64) -> Scene {
    let surface: Vec<u32> = (0..solid.reference.len() as u32).collect();
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let loads = Loads::new(loads, solid.reference.len());
    let debris = Debris::new(&solid, vec![ContactParameters { friction: 0.5, ..ContactParameters::default() }]);
    Scene::new(solid, supports, loads, debris, grounds, &surface, settings(end, f64::INFINITY))
}

/// Fails with all balances that do not close.
fn assert_closed(balances: &[(String, Ledger)], allowed: f64) {
    for (name, ledger) in balances {
        let (residual, removed) = (ledger.residual_max_relative, ledger[EnergyKind::Removed]);
        let step = ledger[EnergyKind::TimeStep];
        println!("{name}: residual {residual:.2e}, removed {removed:.3} J, step {step:.3} J of {:.3} J", ledger.scale);
        assert!(
            step.abs() < allowed * ledger.scale,
            "{name}: changes of the step cost {step:e} J of {:e} J",
            ledger.scale
        );
    }
    let open = balances
        .iter()
        .filter(|(_, ledger)| ledger.residual_max_relative.is_nan() || ledger.residual_max_relative >= allowed);
    let open: Vec<String> = open.map(|(name, l)| format!("{name}: {:.2e} {l:?}", l.residual_max_relative)).collect();
    assert!(open.is_empty(), "{open:#?}");
}

/// Runs to the end, and returns the last balance.
fn run(mut scene: Scene, name: &str) -> Ledger {
    while !scene.is_finished() {
        scene.step(true).unwrap();
    }
    assert!(scene.counts().removed_elements > 0, "{name}: something broke");
    *scene.ledger()
}

#[test]
fn a_block_thrown_at_a_plane_closes_its_balance() {
    let mut balances = Vec::new();
    for cells in [[6, 5, 5], [8, 6, 0]] {
        for (formulation, kinematics) in KINDS {
            let (nodes, body) = block(cells, Vec3::new(0.12, 0.1, 0.1));
            let nodes = nodes.into_iter().map(|p| p + Vec3::x() * 1e-4).collect();
            let mut solid = Solid::new(nodes, vec![Body { formulation, kinematics, ..body }]).unwrap();
            solid.velocity.fill(Vec3::x() * -100.0);
            let wall = NodesOnShape::plane(
                Vec3::zeros(),
                Vec3::x(),
                ContactParameters { friction: 0.3, ..ContactParameters::default() },
            );
            let name = format!("{cells:?} {formulation:?} {kinematics:?}");
            let ledger = run(scene(solid, Vec::new(), Vec::new(), vec![wall], 1.5e-4), &name);
            balances.push((name, ledger));
        }
    }
    assert_closed(&balances, ALLOWED);
}

#[test]
fn a_hole_under_a_pulse_closes_its_balance() {
    // A quarter of a ring of radii 20 and 100 mm; 1 GPa within 4 µs, gone after 20 µs.
    let mut balances = Vec::new();
    for cells in [[12, 12, 0], [8, 7, 2]] {
        for (formulation, kinematics) in KINDS {
            let thickness = 0.02;
            let (nodes, body) = block(cells, Vec3::new(1.0, 1.0, thickness));
            let bend = |p: Vec3| {
                let (angle, radius) = (std::f64::consts::FRAC_PI_2 * (1.0 - p.x), 0.02 + 0.08 * p.y);
                let flat = |c: f64| if c.abs() < 1e-12 { 0.0 } else { c };
                Vec3::new(flat(radius * angle.cos()), flat(radius * angle.sin()), p.z)
            };
            let body = Body { formulation, kinematics, ..body };
            let mut solid = Solid::new(nodes.into_iter().map(bend).collect(), vec![body]).unwrap();
            solid.velocity.fill(Vec3::zeros());
            let inside = |n: u32| solid.reference[n as usize].xy().norm() < 0.0201;
            let elements = &solid.body(0).elements;
            let facets: Vec<[u32; 3]> = if cells[2] == 0 {
                let triangles: Vec<[u32; 3]> = elements.iter().map(|e| [e[0], e[1], e[2]]).collect();
                let edges = fractum_mesh::topology::boundary_of_triangles(&triangles);
                edges
                    .iter()
                    .map(|e| [e.nodes[0], e.nodes[1], e.nodes[1]])
                    .filter(|f| f.iter().all(|&n| inside(n)))
                    .collect()
            } else {
                let facets = fractum_mesh::topology::boundary_of_tetrahedra(elements);
                facets.iter().map(|f| f.nodes).filter(|f| f.iter().all(|&n| inside(n))).collect()
            };
            assert!(!facets.is_empty());
            let fixed = |name: &str, axis: usize| {
                Support::new(name, nodes_where(&solid, |p| p[axis] == 0.0), axis, Motion::Fixed)
            };
            let supports = vec![fixed("x", 0), fixed("y", 1)];
            let pulse = |t: f64| if t < 4e-6 { t / 4e-6 } else { ((20e-6 - t) / 16e-6).max(0.0) };
            let pressure = Load::Pressure(Pressure { facets, value: Arc::new(move |t, _| 1e9 * pulse(t)) });
            let name = format!("{cells:?} {formulation:?} {kinematics:?}");
            let ledger = run(scene(solid, supports, vec![pressure], Vec::new(), 60e-6), &name);
            balances.push((name, ledger));
        }
    }
    assert_closed(&balances, ALLOWED);
}

#[test]
fn a_bar_pulled_at_once_closes_its_balance() {
    let mut balances = Vec::new();
    for cells in [[16, 4, 0], [12, 3, 3]] {
        for (formulation, kinematics) in KINDS {
            let (nodes, body) = block(cells, Vec3::new(0.4, 0.1, 0.1));
            let solid = Solid::new(nodes, vec![Body { formulation, kinematics, ..body }]).unwrap();
            let left = nodes_where(&solid, |p| p.x < 1e-9);
            let right = nodes_where(&solid, |p| p.x > 0.4 - 1e-9);
            let supports = vec![
                Support::new("left", left, 0, Motion::Fixed),
                Support::new("right", right, 0, Motion::Velocity(Arc::new(|_, _| 1.0))),
            ];
            let name = format!("{cells:?} {formulation:?} {kinematics:?}");
            let ledger = run(scene(solid, supports, Vec::new(), Vec::new(), 4e-4), &name);
            balances.push((name, ledger));
        }
    }
    assert_closed(&balances, ALLOWED);
}

#[test]
fn unilateral_damage_never_gives_energy_back() {
    let mut balances = Vec::new();
    for cells in [[16, 4, 0], [8, 3, 3]] {
        let (nodes, body) = block(cells, Vec3::new(0.4, 0.1, 0.1));
        let law = DamageLaw { unilateral: true, fracture_energy: 2000.0, ..concrete() };
        let mut solid = Solid::new(nodes, vec![body.smoothed().with_damage(law)]).unwrap();
        for i in 0..solid.velocity.len() {
            solid.velocity[i] = (solid.reference[i] - Vec3::new(0.2, 0.05, 0.05)) * 40.0;
        }
        let mut scene = scene(solid, Vec::new(), Vec::new(), Vec::new(), 2e-3);
        let mut taken = 0.0_f64;
        while !scene.is_finished() {
            scene.step(true).unwrap();
            let now = scene.ledger()[EnergyKind::Damage];
            assert!(now >= taken, "{cells:?}: damage gave back {:e} J", taken - now);
            taken = now;
        }
        assert!(taken > 0.1 * scene.ledger().scale, "{cells:?}: {:?}", scene.ledger());
        balances.push((format!("{cells:?}"), *scene.ledger()));
    }
    // Cracks that open or close within a step are an error of central differences.
    assert_closed(&balances, 5.0 * ALLOWED);
}

/// A block without damage, with the velocity of each node by its position.
fn elastic_block(kinematics: Kinematics, velocity: impl Fn(&Vec3) -> Vec3) -> Solid {
    let (nodes, body) = block([4, 3, 3], Vec3::new(0.12, 0.1, 0.1));
    let mut solid = Solid::new(nodes, vec![Body { kinematics, damage: None, ..body.smoothed() }]).unwrap();
    for i in 0..solid.velocity.len() {
        solid.velocity[i] = velocity(&solid.reference[i]);
    }
    solid
}

#[test]
fn a_start_out_of_balance_has_the_kinetic_energy_of_its_velocities() {
    for speed in [0.0, 0.3] {
        let solid = elastic_block(Kinematics::Small, |_| Vec3::y() * speed);
        let given: f64 = solid.mass.iter().map(|m| 0.5 * m * speed * speed).sum();
        let end = nodes_where(&solid, |p| p.x > 0.12 - 1e-9).into_iter().map(|n| (n, 1e-3)).collect();
        let load = Load::Nodal(NodalForce { points: end, axis: 0, value: Arc::new(|_, _| 1e6) });
        // The lower end is a little inside the wall.
        let wall = NodesOnShape::plane(Vec3::x() * 1e-6, Vec3::x(), ContactParameters::default());
        let mut scene = scene(solid, Vec::new(), vec![load], vec![wall], 1e-4);
        scene.step(true).unwrap();
        let kinetic = scene.ledger()[EnergyKind::Kinetic];
        assert!((kinetic - given).abs() <= 1e-12 * given, "{kinetic:e} J of {given:e} J");
        while !scene.is_finished() {
            scene.step(true).unwrap();
            assert!(scene.ledger()[EnergyKind::Kinetic] >= 0.0, "{:?}", scene.ledger());
        }
        assert!(scene.ledger().residual_max_relative < ALLOWED, "{:?}", scene.ledger());
    }
}

#[test]
fn an_element_turned_inside_out_is_named() {
    let run = |kinematics| {
        let solid = elastic_block(kinematics, |p| Vec3::x() * (-8e4 * p.x));
        let mut scene = scene(solid, Vec::new(), Vec::new(), Vec::new(), 1e-4);
        while !scene.is_finished() {
            scene.step(false)?;
        }
        Ok(())
    };
    let error: StepError = run(Kinematics::Corotational).unwrap_err();
    let text = error.to_string();
    assert!(matches!(error, StepError::Inverted { .. }), "{text}");
    assert!(text.contains("element") && text.contains("of body block") && text.contains("solver.safety"), "{text}");
    // Small strains are linear: nothing jumps.
    run(Kinematics::Small).unwrap();
}

#[test]
fn local_damping_stays_stable_at_the_default_step() {
    for local in [0.2, 0.9] {
        let solid = elastic_block(Kinematics::Small, |p| Vec3::x() * (10.0 * (p.x - 0.06)) + Vec3::y() * (p.z * 5.0));
        let mut scene = scene(solid, Vec::new(), Vec::new(), Vec::new(), 2e-3);
        let mut settings = settings(2e-3, f64::INFINITY);
        settings.damping.local = local;
        let loads = Loads::new(Vec::new(), scene.solid.reference.len());
        let debris = Debris::new(&scene.solid, vec![ContactParameters::default()]);
        scene = Scene::new(scene.solid, Supports::default(), loads, debris, Vec::new(), &[], settings);
        while !scene.is_finished() {
            scene.step(true).unwrap();
            let ledger = scene.ledger();
            assert!(
                ledger[EnergyKind::Kinetic] + ledger[EnergyKind::Elastic] <= 1.001 * ledger.initial,
                "{local}: {ledger:?}"
            );
        }
    }
}
