//! Solids turned about an axis: patch tests on the axis and off it, mass, stiffness and stable step, bars that are torn.

use std::f64::consts::PI;
use std::sync::Arc;

use fractum_fem::{
    Body, DamageLaw, DamageZone, Depth, Elastic, ElementKind, Formulation, Kinematics, Plane, Region, Regularisation,
    Solid, fields, motion,
};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_rectangle};
use fractum_scene::coupling::Debris;
use fractum_scene::statics::{Control, StaticSettings, StaticSolver};
use fractum_scene::{ContactParameters, EnergyKind, Load, Loads, Motion, Pressure, Scene, Support, Supports};
use fractum_tests::{CONCRETE, settings, statics, surface};

/// A section of radii from `inner` to `inner` + width, and its height [m], in jittered triangles.
fn section(cells: [u32; 2], inner: f64, [width, height]: [f64; 2], seed: u64) -> (Vec<Vec3>, Body) {
    let mesh = structured_rectangle(cells, [width, height], Some(Jitter { fraction: 0.15, seed }));
    let nodes = mesh.nodes.into_iter().map(|p| p + Vec3::x() * inner).collect();
    let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
    let body = Body::new("tube", ElementKind::T3, elements, CONCRETE);
    (nodes, Body { plane: Plane::Axisymmetric, ..body })
}

/// Both formulations and measures of strain, with a hole and without.
fn each(mut see: impl FnMut(f64, Formulation, Kinematics)) {
    for inner in [0.0, 0.7] {
        for formulation in [Formulation::Standard, Formulation::Smoothed] {
            for kinematics in [Kinematics::Small, Kinematics::Corotational] {
                see(inner, formulation, kinematics);
            }
        }
    }
}

/// What stretches evenly along the radius and along the axis has one stress, no force within it, and the tractions of that stress on its surface.
#[test]
fn even_stretches_give_one_stress_and_no_inner_force() {
    let ([width, height], [radial, axial]) = ([1.0, 0.8], [3e-4, -1e-4]);
    each(|inner, formulation, kinematics| {
        let (nodes, body) = section([5, 4], inner, [width, height], 5);
        let mut solid = Solid::new(nodes, vec![Body { formulation, kinematics, ..body }]).unwrap();
        for i in 0..solid.reference.len() {
            let p = solid.reference[i];
            solid.displacement[i] = Vec3::new(radial * p.x, axial * p.y, 0.0);
        }
        solid.update_internal_forces(0.0, true);
        let (lambda, mu) = (CONCRETE.lame_lambda(), CONCRETE.shear_modulus());
        let stress = |strain: f64| lambda * (2.0 * radial + axial) + 2.0 * mu * strain;
        let expected = [stress(radial), stress(axial), stress(radial), 0.0, 0.0, 0.0];
        let name = format!("{inner} {formulation:?} {kinematics:?}");
        for (found, _) in fields::element_fields(&solid, 0, None) {
            for (found, wanted) in found.0.iter().zip(expected) {
                assert!((found - wanted).abs() < 1e-11 * stress(radial), "{name}: {found} for {wanted}");
            }
        }
        let outer = inner + width;
        let volume = PI * (outer * outer - inner * inner) * height;
        let density = 0.5 * (2.0 * expected[0] * radial + expected[1] * axial);
        assert!((solid.elastic_energy() / (density * volume) - 1.0).abs() < 1e-12, "{name}");
        let mass: f64 = solid.mass.iter().sum();
        assert!((mass / (CONCRETE.density * volume) - 1.0).abs() < 1e-14, "{name}: {mass}");
        // What holds it are its tractions, spread over the area of the turn.
        let mut rest: Vec<Vec3> = solid.force.clone();
        for [a, b, _] in surface(&solid) {
            let ends = [a, b].map(|n| solid.reference[n as usize]);
            let area = fractum_fem::facet_area([ends[0], ends[1], ends[1]], Some(Depth::Turn));
            for (node, share) in [a, b].into_iter().zip(Depth::Turn.shares([&ends[0], &ends[1]])) {
                rest[node as usize] += Vec3::new(area.x * expected[0], area.y * expected[1], 0.0) * share;
            }
        }
        let size = expected[0] * outer * height;
        for (node, force) in rest.iter().enumerate() {
            assert!(force.norm() < 1e-11 * size, "{name}: {force:?} at {:?}", solid.reference[node]);
        }
    });
}

/// Axis and lower corner of a body as they are held: nothing else needs a support.
fn held(solid: &Solid) -> Supports {
    let at = |keep: &dyn Fn(&Vec3) -> bool| -> Vec<u32> {
        (0..solid.reference.len() as u32).filter(|&n| keep(&solid.reference[n as usize])).collect()
    };
    let inner = solid.reference.iter().map(|p| p.x).fold(f64::INFINITY, f64::min);
    let supports = vec![
        Support::new("axis", at(&|p| p.x == 0.0), 0, Motion::Fixed),
        Support::new("corner", at(&|p| p.x == inner && p.y == 0.0), 1, Motion::Fixed),
    ];
    Supports::new(supports, &solid.reference).unwrap()
}

fn scene(solid: Solid, supports: Supports, loads: Vec<Load>, end: f64) -> Scene {
    let loads = Loads::new(loads, solid.reference.len());
    let debris = Debris::new(&solid, vec![ContactParameters::default()]);
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings(end, f64::INFINITY))
}

/// A pressure all around leaves a body under that pressure: loads, stiffness and stress fit each other node by node, on the axis too.
#[test]
fn a_pressure_all_around_gives_that_pressure_everywhere() {
    // It follows the moved surface: as little of it as leaves no more than rounding.
    const PRESSURE: f64 = 0.3;
    each(|inner, formulation, kinematics| {
        if kinematics == Kinematics::Corotational {
            return;
        }
        let (nodes, body) = section([4, 6], inner, [1.0, 1.5], 8);
        let solid = Solid::new(nodes, vec![Body { formulation, ..body }]).unwrap();
        let value = Arc::new(|_: f64, _: &Vec3| PRESSURE);
        let load = Load::Pressure(Pressure { facets: surface(&solid), value });
        let supports = held(&solid);
        let mut scene = scene(solid, supports, vec![load], 1.0);
        let mut solver = StaticSolver::new(&scene, statics(1.0, 1.0)).unwrap();
        while !solver.is_finished(&scene) {
            solver.step(&mut scene).unwrap();
        }
        for (stress, _) in fields::element_fields(&scene.solid, 0, None) {
            for (found, wanted) in stress.0.into_iter().zip([-PRESSURE, -PRESSURE, -PRESSURE, 0.0, 0.0, 0.0]) {
                assert!((found - wanted).abs() < 1e-8 * PRESSURE, "{inner} {formulation:?}: {stress:?}");
            }
        }
    });
}

/// The stiffness of static runs gives the forces of those in motion, and the bound of the stable step holds.
#[test]
fn both_solvers_know_one_stiffness_and_its_highest_frequency() {
    each(|inner, formulation, kinematics| {
        if kinematics == Kinematics::Corotational {
            return;
        }
        let (nodes, body) = section([6, 5], inner, [1.0, 0.8], 2);
        let mut solid = Solid::new(nodes, vec![Body { formulation, ..body }]).unwrap();
        for i in 0..solid.reference.len() {
            let shake = |k: f64| 1e-5 * (k * (i + 1) as f64).sin();
            solid.displacement[i] = Vec3::new(shake(1.3), shake(0.7), 0.0);
        }
        solid.update_internal_forces(0.0, false);
        let mut force = vec![Vec3::zeros(); solid.reference.len()];
        solid.secant_force(&solid.cell_damage(), &solid.displacement, &mut force);
        let largest = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
        for (by_secant, inside) in force.iter().zip(&solid.force) {
            assert!((by_secant + inside).norm() < 1e-12 * largest, "{inner} {formulation:?}");
        }
        let [bound, found] = [motion::stable_step_bound(&solid).frequency, solid.stable_step().frequency / 1.02];
        assert!(found <= bound * (1.0 + 1e-9) && bound < 2.0 * found, "{inner} {formulation:?}: {found} {bound}");
    });
}

/// Size of the cells of a rod [m], its height in cells, and half of the part that is weaker [m].
const SIZE: f64 = 0.004;
const HIGH: u32 = 20;
const HALF: f64 = 4.0 * SIZE;
const WEAKER: f64 = 0.9;
const FRACTURE_ENERGY: f64 = 100.0;

/// Pulls a rod or a tube along its axis until it has parted; peak over its strength, and energy over G_f times the area.
fn torn(inner: f64, across: u32, poisson_ratio: f64, is_spread: bool, seed: u64) -> [f64; 2] {
    let [width, height] = [across, HIGH].map(|cells| SIZE * f64::from(cells));
    let (nodes, body) = section([across, HIGH], inner, [width, height], seed);
    let elastic = Elastic { poisson_ratio, ..CONCRETE };
    let body = Body { elastic, ..body }.smoothed();
    let factor = |p: &Vec3| if (p.y - 0.5 * height).abs() < HALF { WEAKER } else { 1.0 };
    let law = DamageLaw::rankine(3e6, FRACTURE_ENERGY);
    let strength = WEAKER * law.tensile_strength;
    let zone = DamageZone {
        law,
        region: Region::Everywhere,
        strength_factor: body.edge_midpoints(&nodes).iter().map(factor).collect(),
        strength_by_chance: Vec::new(),
        reduce_strength_to_fit: false,
        regularisation: is_spread.then_some(Regularisation { length: None }),
        rate: None,
    };
    let solid = Solid::new(nodes, vec![Body { damage: Some(zone), ..body }]).unwrap();
    let at = |keep: &dyn Fn(&Vec3) -> bool| -> Vec<u32> {
        (0..solid.reference.len() as u32).filter(|&n| keep(&solid.reference[n as usize])).collect()
    };
    let pull = 20.0 * (3e6 / CONCRETE.young_modulus * height + FRACTURE_ENERGY / 3e6);
    let top = at(&|p| p.y > height - 1e-9);
    let supports = vec![
        Support::new("axis", at(&|p| p.x == 0.0), 0, Motion::Fixed),
        Support::new("bottom", at(&|p| p.y < 1e-9), 1, Motion::Fixed),
        Support::new("top", top.clone(), 1, Motion::Displacement(Arc::new(move |t, _| pull * t))),
    ];
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let mut scene = scene(solid, supports, Vec::new(), 1.0);
    let statics =
        StaticSettings { control: Control::Path, tolerance: 1e-5, linear_tolerance: 1e-12, ..statics(0.02, 1.0) };
    let mut solver = StaticSolver::new(&scene, statics).unwrap();
    let places = scene.supports().places(&top);
    let (mut peak, mut now) = (0.0f64, 0.0);
    while !solver.is_finished(&scene) && now >= 0.01 * peak {
        solver.step(&mut scene).unwrap();
        now = scene.supports().reaction(&places, &Vec3::y());
        peak = peak.max(now);
    }
    let ledger = scene.ledger();
    assert!(now < 0.01 * peak && ledger.residual_max_relative < 1e-3, "{inner} {poisson_ratio}: {ledger:?}");
    let area = PI * ((inner + width).powi(2) - inner * inner);
    let taken = ledger[EnergyKind::Damage] + ledger[EnergyKind::Removed];
    [peak / (area * strength), taken / (area * FRACTURE_ENERGY)]
}

/// A crack across a rod or a tube costs what it costs without lateral contraction, and both bear their strength, at any Poisson's ratio. On such
/// meshes local damage takes some tenth more than G_f times the area, as in plane bars (docs/limits.md).
#[test]
fn a_crack_across_the_axis_costs_the_same_at_any_poissons_ratio() {
    let mut missed = Vec::new();
    for (inner, across) in [(0.0, 6), (0.03, 5)] {
        let mut without = f64::NAN;
        for poisson_ratio in [0.0, 0.2, 0.4] {
            // Which elements a crack takes is chance where a rod softens: the mean of several meshes.
            let all = [3, 4, 5].map(|seed| torn(inner, across, poisson_ratio, false, seed));
            let energy = all.iter().map(|[_, energy]| energy / 3.0).sum::<f64>();
            if poisson_ratio == 0.0 {
                without = energy;
            }
            let off = all.iter().map(|[peak, _]| (peak - 1.0).abs()).fold(0.0, f64::max);
            let text = format!("{inner} {poisson_ratio}: strength {off:.3} off, energy {energy:.3} of {all:.3?}");
            println!("{text}");
            if off > 0.02 || (energy / without - 1.0).abs() > 0.05 {
                missed.push(text);
            }
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}

/// Under a phase field it costs G_f times the area.
#[test]
fn a_crack_across_the_axis_under_a_phase_field_costs_its_fracture_energy() {
    let mut missed = Vec::new();
    for poisson_ratio in [0.0, 0.2, 0.4] {
        let [peak, energy] = torn(0.0, 6, poisson_ratio, true, 3);
        let text = format!("{poisson_ratio}: strength {peak:.3}, energy {energy:.3}");
        println!("{text}");
        if (peak - 1.0).abs() > 0.02 || !(0.95..1.05).contains(&energy) {
            missed.push(text);
        }
    }
    assert!(missed.is_empty(), "{missed:#?}");
}
