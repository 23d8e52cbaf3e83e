//! Regularised damage in motion: energy balance, bits, and that nothing happens where nothing is damaged.

use std::sync::Arc;

use fractum_fem::{Body, ElementKind, Formulation, Kinematics, Plane, Regularisation, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::{Jitter, structured_rectangle};
use fractum_scene::coupling::Debris;
use fractum_scene::{
    ContactParameters, EnergyKind, Loads, Motion, NodesOnShape, Scene, SceneSettings, Support, Supports,
};
use fractum_tests::{CONCRETE, jittered_box, settings, softening};

/// Elements, smoothed and plain.
const KINDS: [(ElementKind, Formulation); 4] = [
    (ElementKind::T3, Formulation::Smoothed),
    (ElementKind::T4, Formulation::Smoothed),
    (ElementKind::T3, Formulation::Standard),
    (ElementKind::T4, Formulation::Standard),
];

/// A jittered block of elements of 15 mm whose damage is a phase field.
fn block((kind, formulation): (ElementKind, Formulation), fracture_energy: f64, change: impl Fn(&mut Body)) -> Solid {
    let (nodes, body) = match kind {
        ElementKind::T4 => jittered_box([12, 4, 3], Vec3::new(0.18, 0.06, 0.045)),
        ElementKind::T3 => {
            let jitter = Some(Jitter { fraction: 0.15, seed: 7 });
            let mesh = structured_rectangle([16, 6], [0.24, 0.09], jitter);
            let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
            let body = Body::new("plate", ElementKind::T3, elements, CONCRETE);
            (mesh.nodes, Body { plane: Plane::Strain, thickness: 0.045, ..body })
        }
    };
    let mut body = body.smoothed().with_damage(softening(fracture_energy));
    body.damage.as_mut().unwrap().regularisation = Some(Regularisation { length: None });
    body.formulation = formulation;
    change(&mut body);
    Solid::new(nodes, vec![body]).unwrap()
}

fn scene(solid: Solid, supports: Vec<Support>, grounds: Vec<NodesOnShape>, settings: SceneSettings) -> Scene {
    let surface: Vec<u32> = (0..solid.reference.len() as u32).collect();
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let loads = Loads::new(Vec::new(), solid.reference.len());
    let debris = Debris::new(&solid, vec![ContactParameters { friction: 0.5, ..ContactParameters::default() }]);
    Scene::new(solid, supports, loads, debris, grounds, &surface, settings)
}

/// One end held, the other pulled away at a speed [m/s].
fn pulled(solid: Solid, speed: f64, end: f64) -> Scene {
    pulled_at(solid, speed, settings(end, f64::INFINITY))
}

fn pulled_at(solid: Solid, speed: f64, settings: SceneSettings) -> Scene {
    let length = solid.reference.iter().map(|p| p.x).fold(0.0, f64::max);
    let at = |x: f64| -> Vec<u32> {
        (0..solid.reference.len() as u32).filter(|&n| (solid.reference[n as usize].x - x).abs() < 1e-9).collect()
    };
    let supports = vec![
        Support::new("left", at(0.0), 0, Motion::Fixed),
        Support::new("right", at(length), 0, Motion::Velocity(Arc::new(move |_, _| speed))),
    ];
    scene(solid, supports, Vec::new(), settings)
}

fn finish(scene: &mut Scene) {
    while !scene.is_finished() {
        scene.step(true).unwrap();
    }
}

/// Blocks that are torn and thrown until elements are gone: nothing is lost from the books.
#[test]
fn violent_fracture_closes_its_balance() {
    for kind in KINDS {
        for kinematics in [Kinematics::Small, Kinematics::Corotational] {
            // Plain elements cannot close cracks.
            let closing: &[bool] = if kind.1 == Formulation::Smoothed { &[false, true] } else { &[false] };
            for &unilateral in closing {
                let change = |body: &mut Body| {
                    body.kinematics = kinematics;
                    body.damage.as_mut().unwrap().law.unilateral = unilateral;
                };
                let torn = pulled(block(kind, 100.0, change), 1.0, 4e-4);
                let mut solid = block(kind, 100.0, change);
                solid.reference.iter_mut().for_each(|p| p.x += 1e-4);
                solid.velocity.fill(Vec3::x() * -100.0);
                let wall = NodesOnShape::plane(Vec3::zeros(), Vec3::x(), ContactParameters::default());
                let thrown = scene(solid, Vec::new(), vec![wall], settings(1.5e-4, f64::INFINITY));
                for (name, mut scene) in [("torn", torn), ("thrown", thrown)] {
                    finish(&mut scene);
                    let (ledger, removed) = (scene.ledger(), scene.counts().removed_elements);
                    let residual = ledger.residual_max_relative;
                    println!("{name} {kind:?} {kinematics:?} {unilateral}: {residual:.1e}, {removed} removed");
                    assert!(removed > 0 && residual < 1e-3, "{name} {kind:?} {kinematics:?} {unilateral}: {ledger:?}");
                }
            }
        }
    }
}

/// Damage takes what opening and closing edges lose while they soften, whatever the time step.
#[test]
fn edges_that_close_keep_their_balance_at_any_step() {
    let error = |safety: f64| {
        let solid = block((ElementKind::T4, Formulation::Smoothed), 100.0, |body| {
            body.damage.as_mut().unwrap().law.unilateral = true;
        });
        let mut settings = settings(3e-4, f64::INFINITY);
        settings.time_step.safety = safety;
        let mut scene = pulled_at(solid, 1.0, settings);
        finish(&mut scene);
        scene.ledger().residual_max_relative
    };
    let [whole, half] = [0.8, 0.4].map(error);
    println!("{whole:.1e} {half:.1e}");
    assert!(whole < 2e-4 && half < 2e-4, "{whole:e} {half:e}");
}

#[test]
fn the_same_bits_for_any_number_of_threads_and_after_a_restart() {
    for kind in KINDS {
        let start = || pulled(block(kind, 100.0, |_| {}), 1.0, 3e-4);
        let state = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut scene = start();
                finish(&mut scene);
                assert!(scene.counts().removed_elements > 0);
                scene.state()
            })
        };
        let whole = state(1);
        assert!(whole == state(2) && whole == state(7), "{kind:?}: threads");
        // Saved before the first damage, in the middle of it, and after the first removal.
        for steps in [20, 60, 150] {
            let mut first = start();
            for _ in 0..steps {
                first.step(true).unwrap();
            }
            let saved = first.state();
            let mut second = start();
            second.restore(saved);
            finish(&mut second);
            assert!(whole == second.state(), "{kind:?}: restart after {steps} steps");
        }
    }
}

/// Far below the strength a regularised body is an elastic one, bit by bit.
#[test]
fn a_body_that_stays_intact_is_elastic() {
    for kind in KINDS {
        let displacement = |elastic: bool| {
            let solid = block(kind, 100.0, |body| {
                if elastic {
                    body.damage = None;
                }
            });
            let mut scene = pulled(solid, 0.01, 1e-4);
            finish(&mut scene);
            assert_eq!(scene.ledger()[EnergyKind::Damage], 0.0);
            scene.solid.displacement.clone()
        };
        assert!(displacement(true) == displacement(false), "{kind:?}");
    }
}
