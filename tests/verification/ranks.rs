//! Several ranks advance one scene: the state has the bits of a single process, whatever their number.

use std::sync::Arc;

use fractum_fem::{
    Body, Criterion, CriterionKind, DamageLaw, ElementKind, Formulation, Kinematics, LocalDamping, Regularisation,
    Solid, Viscosity, facet_area, motion, neighbours, rubbed_energy,
};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_rectangle};
use fractum_parallel::{Exchange, threads};
use fractum_scene::coupling::Debris;
use fractum_scene::{
    ContactParameters, Gravity, Load, Loads, Motion, NodalForce, Pressure, Scene, SceneState, Support, SupportedFacet,
    Supports, SurfaceSupports, Watched, ranks,
};
use fractum_tests::{CONCRETE, jittered_box, noise, settings, surface};

const SIZE: Vec3 = Vec3::new(0.4, 0.2, 0.2);
pub(crate) const RANKS: [usize; 3] = [2, 3, 7];

/// A box of several blocks.
fn block() -> (Vec<Vec3>, Body) {
    jittered_box([20, 10, 10], SIZE)
}

pub(crate) fn scene(solid: Solid, supports: Vec<Support>, loads: Vec<Load>, damping: LocalDamping) -> Scene {
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let loads = Loads::new(loads, solid.reference.len());
    let debris = Debris::new(&solid, vec![ContactParameters::default(); solid.body_count()]);
    let mut settings = settings(1.0, 1e9);
    settings.damping = damping;
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings)
}

/// Supports on both ends: one fixed, one that moves along x.
pub(crate) fn ends(solid: &Solid, speed: f64) -> Vec<Support> {
    let at = |x: f64| (0..).zip(&solid.reference).filter(|(_, p)| (p.x - x).abs() < 1e-9).map(|(n, _)| n).collect();
    let right: Vec<u32> = at(SIZE.x);
    let moves = Motion::Velocity(Arc::new(move |t: f64, _: &Vec3| speed * (t / 2e-5).min(1.0)));
    vec![Support::new("left", at(0.0), 0, Motion::Fixed), Support::new("right", right, 0, moves)]
}

pub(crate) fn set_moving(solid: &mut Solid) {
    for i in 0..solid.velocity.len() {
        solid.velocity[i] = Vec3::from_fn(|axis, _| noise(3 * i + axis));
    }
}

pub(crate) fn advance(scene: &mut Scene, steps: u64) {
    for _ in 0..steps {
        scene.step(scene.clock.step.is_multiple_of(13)).unwrap();
    }
}

pub(crate) fn on_two_threads<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap().install(work)
}

/// The whole state, each bit of it: numbers are written so that they read back as they were.
pub(crate) fn bits(scene: &Scene) -> String {
    serde_json::to_string(&scene.state()).unwrap()
}

/// What each of several ranks has after `steps`, by what `made` gives it at the start.
pub(crate) fn shared(ranks: usize, steps: u64, made: impl Fn() -> Scene + Sync) -> Vec<Scene> {
    let run = |exchange: Arc<dyn Exchange>| {
        on_two_threads(|| {
            let mut scene = made();
            ranks::distribute(&mut scene, exchange, &Watched::default());
            advance(&mut scene, steps);
            ranks::gather_all(&mut scene);
            scene
        })
    };
    std::thread::scope(|scope| {
        let started: Vec<_> = threads(ranks).into_iter().map(|exchange| scope.spawn(|| run(exchange))).collect();
        started.into_iter().map(|thread| thread.join().unwrap()).collect()
    })
}

/// The scene of a single process after `steps`, once any number of ranks has come to the same.
pub(crate) fn same_on_ranks(steps: u64, made: impl Fn() -> Scene + Sync) -> Scene {
    let mut single = made();
    assert_eq!(ranks::cannot_be_distributed(&single), None);
    advance(&mut single, steps);
    let expected = bits(&single);
    for ranks in RANKS {
        for (rank, scene) in shared(ranks, steps, &made).iter().enumerate() {
            assert!(bits(scene) == expected, "rank {rank} of {ranks}");
        }
    }
    single
}

#[test]
fn an_elastic_body_has_the_same_bits_on_any_number_of_ranks() {
    let made = || {
        let (nodes, body) = block();
        let mut solid = Solid::new(nodes, vec![Body { kinematics: Kinematics::Corotational, ..body }]).unwrap();
        set_moving(&mut solid);
        let top = surface(&solid).into_iter().filter(|f| f.iter().all(|&n| solid.reference[n as usize].z > 0.199));
        let value = Arc::new(|t: f64, _: &Vec3| 1e6 * (t / 1e-5).min(1.0));
        let pressure = Pressure { facets: top.collect(), value };
        let force = NodalForce { points: vec![(40, 0.5), (7, 0.5)], axis: 1, value: Arc::new(|_, _| 1e3) };
        let supports = ends(&solid, 0.1);
        scene(solid, supports, vec![Load::Pressure(pressure), Load::Nodal(force)], LocalDamping::default())
    };
    let single = same_on_ranks(60, made);
    assert!(single.ledger().residual_max_relative < 1e-3);
}

/// A body that is turned inside out in the step in which it loses most of its stiffness: its elements leave one by one.
#[test]
fn crushed_elements_have_the_same_bits_on_any_number_of_ranks() {
    for smoothed in [false, true] {
        let made = || {
            let (nodes, body) = block();
            let body = body.with_damage(DamageLaw::rankine(5e9, 1e8));
            let body = Body { kinematics: Kinematics::Corotational, ..body };
            let mut solid = Solid::new(nodes, vec![if smoothed { body.smoothed() } else { body }]).unwrap();
            for node in 0..solid.reference.len() {
                let place = solid.reference[node];
                solid.displacement[node] = Vec3::new(-1.01 * place.x, 0.6 * place.y, 0.0);
            }
            scene(solid, Vec::new(), Vec::new(), LocalDamping::default())
        };
        let single = same_on_ranks(6, made);
        assert!(single.counts().crushed_elements > 3, "{:?}", single.counts());
    }
}

#[test]
fn a_viscous_body_with_absorbing_ends_has_the_same_bits_on_any_number_of_ranks() {
    let made = || {
        let (nodes, body) = block();
        let mut solid = Solid::new(nodes, vec![body.smoothed()]).unwrap();
        motion::set_viscosity(&mut solid, Viscosity { stiffness_time: 1e-8, bulk_linear: 0.06, bulk_quadratic: 1.2 });
        set_moving(&mut solid);
        for velocity in &mut solid.velocity {
            velocity.x *= 300.0; // strong enough for the step to follow the shock
        }
        let side = surface(&solid).into_iter().filter(|f| f.iter().all(|&n| solid.reference[n as usize].y < 1e-9));
        let facet = |nodes: [u32; 3]| {
            let area = facet_area(nodes.map(|n| solid.reference[n as usize]), None);
            let (normal, area) = (area.normalize(), area.norm());
            SupportedFacet { nodes, area, answer: SupportedFacet::along_and_across(normal, [9e6, 5e6]) }
        };
        let facets: Vec<SupportedFacet> = side.map(facet).collect();
        let supports = SurfaceSupports::new(&facets, &facets[..9], &solid.mass);
        scene(solid, Vec::new(), Vec::new(), LocalDamping::default()).with_surface_supports(supports)
    };
    let single = same_on_ranks(60, made);
    assert!(single.solid.viscous_dissipation() > 0.0);
}

/// The box, pulled until it breaks.
fn breaking() -> Scene {
    let (nodes, body) = block();
    let body = body.smoothed().with_damage(DamageLaw::rankine(3e6, 20.0));
    let solid = Solid::new(nodes, vec![Body { kinematics: Kinematics::Corotational, ..body }]).unwrap();
    let supports = ends(&solid, 10.0);
    scene(solid, supports, Vec::new(), LocalDamping::default())
}

/// The box, pressed until it fails and its cracks rub.
fn rubbing() -> Scene {
    let (nodes, body) = block();
    let criterion = Criterion::new(CriterionKind::MohrCoulomb, 0.6, 6.0, 0.2);
    let body =
        body.smoothed().with_damage(DamageLaw { criterion, friction: Some(0.5), ..DamageLaw::rankine(3e6, 20.0) });
    let solid = Solid::new(nodes, vec![Body { kinematics: Kinematics::Corotational, ..body }]).unwrap();
    let supports = ends(&solid, -10.0);
    scene(solid, supports, Vec::new(), LocalDamping::default())
}

#[test]
fn cracks_that_rub_have_the_same_bits_on_any_number_of_ranks() {
    let single = same_on_ranks(300, rubbing);
    let [damage, friction] = [single.solid.dissipated_energy(), rubbed_energy(&single.solid)];
    assert!(damage > 1.0 && friction > 1.0, "{damage} J, {friction} J");
    assert!(single.ledger().residual_max_relative < 1e-3, "{:?}", single.ledger());
}

#[test]
fn a_body_that_breaks_has_the_same_bits_on_any_number_of_ranks() {
    let single = same_on_ranks(400, breaking);
    let counts = single.counts();
    assert!(counts.removed_elements > 10 && counts.particles > 10, "{counts:?}");
}

#[test]
fn a_body_that_begins_to_turn_has_the_same_bits_on_any_number_of_ranks() {
    for breaks in [false, true] {
        let turning = || {
            let (nodes, mut body) = block();
            if breaks {
                body = body.smoothed().with_damage(DamageLaw::rankine(3e6, 20.0));
            }
            let mut solid = Solid::new(nodes, vec![Body { kinematics: Kinematics::Auto, ..body }]).unwrap();
            for i in 0..solid.velocity.len() {
                solid.velocity[i] = Vec3::new(0.0, 0.0, 500.0).cross(&solid.reference[i]);
            }
            scene(solid, Vec::new(), Vec::new(), LocalDamping::default())
        };
        let single = same_on_ranks(200, turning);
        assert_eq!(single.solid.body(0).kinematics, Kinematics::Corotational);
        assert_eq!(single.counts().removed_elements > 0, breaks, "{:?}", single.counts());
    }
}

/// What happens far off does not have every rank move all nodes: removal, contact of discrete elements, rows.
#[test]
fn few_steps_of_a_body_that_breaks_need_all_nodes() {
    for scene in shared(3, 400, breaking) {
        let [whole, all] = neighbours::steps(&scene.solid).unwrap();
        assert!(all == 400 && 20 * whole <= all, "{whole} of {all} steps");
        assert!(!scene.debris.is_empty());
    }
}

#[test]
fn gravity_and_damping_have_the_same_bits_on_any_number_of_ranks() {
    let made = || {
        let mesh = structured_rectangle([80, 60], [0.4, 0.3], Some(Jitter { fraction: 0.15, seed: 3 }));
        let triangles = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let body = Body::new("plate", ElementKind::T3, triangles, CONCRETE).smoothed();
        let solid = Solid::new(mesh.nodes, vec![body]).unwrap();
        let supports = ends(&solid, 1e-3);
        let gravity = Load::Gravity(Gravity { axis: 1, value: Arc::new(|_, _| -9.81) });
        scene(solid, supports, vec![gravity], LocalDamping { local: 0.5, mass_rate: 10.0 })
    };
    same_on_ranks(60, made);
}

/// A plate and a box whose damage is a phase field, pulled until they break.
fn breaking_by_phase_field(kind: ElementKind, formulation: Formulation) -> Scene {
    let (nodes, body) = match kind {
        ElementKind::T4 => jittered_box([12, 6, 6], SIZE),
        ElementKind::T3 => {
            let mesh = structured_rectangle([60, 30], [SIZE.x, SIZE.y], Some(Jitter { fraction: 0.15, seed: 3 }));
            let triangles = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
            (mesh.nodes, Body::new("plate", ElementKind::T3, triangles, CONCRETE))
        }
    };
    let mut body = Body { formulation, ..body.smoothed().with_damage(DamageLaw::rankine(3e6, 60.0)) };
    let zone = body.damage.as_mut().unwrap();
    zone.regularisation = Some(Regularisation { length: None });
    zone.reduce_strength_to_fit = true; // these elements are too large for the strength
    let solid = Solid::new(nodes, vec![body]).unwrap();
    let supports = ends(&solid, 10.0);
    scene(solid, supports, Vec::new(), LocalDamping::default())
}

#[test]
fn a_phase_field_has_the_same_bits_on_any_number_of_ranks() {
    for kind in [ElementKind::T3, ElementKind::T4] {
        for formulation in [Formulation::Smoothed, Formulation::Standard] {
            let single = same_on_ranks(400, || breaking_by_phase_field(kind, formulation));
            let counts = single.counts();
            assert!(counts.removed_elements > 10, "{kind:?}, {formulation:?}: {counts:?}");
        }
    }
}

/// A state that three ranks have come to, and what other numbers of ranks make of it.
#[test]
fn a_state_goes_on_with_any_number_of_ranks() {
    let mut single = breaking();
    advance(&mut single, 330);
    let expected = bits(&single);
    for first in [60, 300] {
        let state: SceneState = shared(3, first, breaking).remove(1).state();
        let resumed = || {
            let mut scene = breaking();
            scene.restore(state.clone());
            scene
        };
        for ranks in [1, 2, 4] {
            assert!(bits(&shared(ranks, 330 - first, resumed)[0]) == expected, "{first} steps, then {ranks} ranks");
        }
    }
}

/// Every rank saves what it has; together that is the state, and parts of which one is missing are none.
#[test]
fn the_parts_of_all_ranks_are_the_state_of_a_single_process() {
    let viscous = || {
        let mut scene = breaking();
        motion::set_viscosity(&mut scene.solid, Viscosity { stiffness_time: 1e-8, ..Viscosity::default() });
        scene
    };
    let standard = || breaking_by_phase_field(ElementKind::T4, Formulation::Standard);
    let phase_field = || breaking_by_phase_field(ElementKind::T3, Formulation::Smoothed);
    for made in [&breaking as &(dyn Fn() -> Scene + Sync), &rubbing, &viscous, &standard, &phase_field] {
        let mut single = made();
        advance(&mut single, 331);
        for ranks in [2, 7] {
            let save = |exchange: Arc<dyn Exchange>| {
                on_two_threads(|| {
                    let mut scene = made();
                    ranks::distribute(&mut scene, exchange, &Watched::default());
                    advance(&mut scene, 331);
                    ranks::state_in_parts(&mut scene).unwrap()
                })
            };
            let (mut states, mut parts): (Vec<_>, Vec<_>) = std::thread::scope(|scope| {
                let started: Vec<_> =
                    threads(ranks).into_iter().map(|exchange| scope.spawn(|| save(exchange))).collect();
                started.into_iter().map(|thread| thread.join().unwrap()).unzip()
            });
            let beside = states.swap_remove(0);
            let whole = ranks::joined(&made(), beside.clone(), &parts).unwrap();
            assert!(whole == single.state(), "{ranks} ranks");
            parts.pop();
            assert!(ranks::joined(&made(), beside, &parts).is_none(), "{ranks} ranks");
        }
    }
}
