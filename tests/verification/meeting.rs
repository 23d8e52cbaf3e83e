//! Solids that break on other solids, on rigid facets and among loose particles: momentum, energy, sameness.

use std::collections::HashMap;

use fractum_dem::Particles;
use fractum_fem::{Body, Elastic, ElementKind, Kinematics, LocalDamping, Solid};
use fractum_math::{Rotation, Vec3};
use fractum_mesh::generate::{Jitter, structured_box};
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_scene::coupling::Debris;
use fractum_scene::{
    Along, Bonded, BondedPart, ContactBody, ContactMaterial, ContactPairs, ContactParameters, ContactProbe, Contacts,
    Drive, ElasticMaterial, EnergyKind, FacetMesh, FlatFaces, Form, Frame, Inertia, Loads, PairContact, RigidBody,
    Scene, SceneSettings, Shape, SolidSurface, Supports, TimeStepSettings,
};
use fractum_tests::{settings, softening};

use crate::ranks::{advance, bits, on_two_threads, same_on_ranks};

const SURFACE: ContactParameters = ContactParameters { friction: 0.4, damping_ratio: 0.05, rolling_friction: 0.0 };

fn elastic() -> Elastic {
    Elastic { young_modulus: 10e9, poisson_ratio: 0.2, density: 2400.0 }
}

/// A box of tetrahedra from the origin, and its outward facets with nodes counted from `first`.
fn block(cells: [u32; 3], size: Vec3, first: u32) -> (Vec<Vec3>, Vec<[u32; 4]>, Vec<[u32; 3]>) {
    let mesh = structured_box(cells, size, Some(Jitter { fraction: 0.1, seed: 5 }));
    let elements: Vec<[u32; 4]> = mesh.tetrahedra.iter().map(|e| e.map(|n| n + first)).collect();
    let facets = boundary_of_tetrahedra(&elements).iter().map(|f| f.nodes).collect();
    (mesh.nodes, elements, facets)
}

/// Nodes of the block that flies.
fn block_nodes() -> usize {
    block([4, 4, 4], Vec3::repeat(0.1), 0).0.len()
}

/// What stands in the way of the block.
pub(crate) enum Target {
    /// Another block of tetrahedra.
    Solid,
    /// A free rigid block of facets.
    Facets,
}

/// A tilted brittle block of 0.1 m flies at 8 m/s onto a free block, and loose particles fly at both from all around.
///
/// - `beads`: their number, and their speed over their distance [1/s]
pub(crate) fn crash(target: Target, (beads, rate): (usize, f64)) -> Scene {
    let turn = Rotation::from_scaled_axis(Vec3::new(0.4, 0.3, 0.1));
    let (points, elements, facets) = block([4, 4, 4], Vec3::repeat(0.1), 0);
    let mut nodes: Vec<Vec3> = points.iter().map(|x| turn * (x - Vec3::repeat(0.05))).collect();
    let lowest = nodes.iter().map(|x| x.z).fold(f64::INFINITY, f64::min);
    nodes.iter_mut().for_each(|x| x.z -= lowest - 1e-4);
    let law = softening(60.0);
    let mut brittle = Body::new("block", ElementKind::T4, elements, elastic()).smoothed().with_damage(law);
    brittle.kinematics = Kinematics::Corotational;
    brittle.damage.as_mut().unwrap().reduce_strength_to_fit = true;
    let (mut bodies, mut all_facets, mut rigid_bodies) = (vec![brittle], vec![facets], Vec::new());
    let count = nodes.len();
    let size = Vec3::new(0.3, 0.3, 0.08);
    let shift = Vec3::new(0.15, 0.15, 0.08);
    match target {
        Target::Solid => {
            let (points, elements, facets) = block([6, 6, 2], size, count as u32);
            nodes.extend(points.iter().map(|x| x - shift));
            let mut anvil = Body::new("anvil", ElementKind::T4, elements, elastic());
            anvil.kinematics = Kinematics::Corotational;
            bodies.push(anvil);
            all_facets.push(facets);
        }
        Target::Facets => {
            let (points, _, facets) = block([3, 3, 1], size, 0);
            let points: Vec<Vec3> = points.iter().map(|x| x - shift).collect();
            let mesh = FacetMesh::new(&points, &facets).unwrap();
            let form = Form::Mesh { mesh, points };
            let mut rigid_body = RigidBody::new("anvil", form, Frame::at_rest(), ElasticMaterial::RIGID, SURFACE);
            rigid_body.along = [Drive::Free, Drive::Free, Drive::Free];
            rigid_body.inertia = Some(Inertia { mass: 17.0, tensor: fractum_math::Mat3::identity() });
            rigid_bodies.push(rigid_body);
        }
    }
    let mut solid = Solid::new(nodes, bodies).unwrap();
    solid.velocity[..count].fill(Vec3::new(1.0, 0.0, -8.0));
    let mut surface: Vec<u32> = all_facets.iter().flatten().flatten().copied().collect();
    surface.sort_unstable();
    surface.dedup();
    let mut bonded = Bonded::default();
    let mut materials = Vec::new();
    if beads > 0 {
        let layers = beads.div_ceil(24);
        let place = |k: usize| {
            let (layer, spoke) = (k % layers, k / layers);
            let (angle, radius) = (std::f64::consts::TAU * spoke as f64 / 24.0, 0.13 + 0.018 * layer as f64);
            Vec3::new(radius * angle.cos(), radius * angle.sin(), 0.02 + 0.025 * (spoke % 3) as f64)
        };
        let position: Vec<Vec3> = (0..beads).map(place).collect();
        let mut own = Particles::at_rest(position.clone(), vec![8e-3; beads], beads as f64 * 5e-3).unwrap();
        for (velocity, x) in own.velocity.iter_mut().zip(&position) {
            *velocity = -x * (rate * 0.13 / x.xy().norm());
        }
        let part = BondedPart {
            name: "beads".into(),
            particles: own,
            pairs: Vec::new(),
            law: fractum_dem::BeamSection { radius: 1.0, young_modulus: 1.0, poisson_ratio: 0.3 }.into(),
            shares: Vec::new(),
            density: 2400.0,
            fraction: 1.0,
            fracture: None,
            clumps: fractum_dem::Clumps::default(),
        };
        bonded = Bonded::new(vec![part]).unwrap();
        let elastic = ElasticMaterial { young_modulus: 10e9, poisson_ratio: 0.2 };
        materials.push(ContactMaterial { elastic, density: 2400.0, surface: SURFACE, work_of_adhesion: 0.0 });
    }
    let ground = |(body, facets): (usize, &Vec<[u32; 3]>)| SolidSurface::new(&solid, body, SURFACE, facets).unwrap();
    let solids = all_facets.iter().enumerate().map(ground).collect();
    let contacts = Contacts::new(&bonded, materials, rigid_bodies, solids, Vec::new());
    let debris = Debris::new(&solid, vec![SURFACE; all_facets.len()]);
    let settings = SceneSettings {
        time_step: TimeStepSettings { safety: 0.2, element_bound: false, fixed: None, begin: 0.0, end: 4e-3 },
        damping: LocalDamping::default(),
        stiffness_time: 0.0,
        balance_stop: 1e-2,
        joined_below: 0.95,
    };
    let (loads, supports) = (Loads::new(Vec::new(), solid.mass.len()), Supports::new(Vec::new(), &solid.reference));
    Scene::new(solid, supports.unwrap(), loads, debris, Vec::new(), &surface, settings)
        .with_bonded(bonded)
        .with_contacts(contacts, &surface)
}

/// Linear and angular momentum.
pub(crate) fn momenta(scene: &Scene) -> (Vec3, Vec3) {
    let along = |of: fn(&Scene, &Vec3) -> f64| Vec3::from_fn(|k, _| of(scene, &Vec3::ith(k, 1.0)));
    (along(Scene::momentum_along), along(Scene::angular_momentum_along))
}

/// Runs to the end; momenta at the start and the largest changes of both since.
fn run(scene: &mut Scene, mut seen: impl FnMut(&Scene)) -> ((Vec3, Vec3), (f64, f64)) {
    let start = momenta(scene);
    let mut change: (f64, f64) = (0.0, 0.0);
    while !scene.is_finished() {
        scene.step(scene.clock.step.is_multiple_of(10)).unwrap();
        let now = momenta(scene);
        change = (change.0.max((now.0 - start.0).norm()), change.1.max((now.1 - start.1).norm()));
        seen(scene);
    }
    (start, change)
}

#[test]
fn a_block_that_breaks_on_another_among_loose_particles_keeps_momentum_and_energy() {
    let mut scene = crash(Target::Solid, (24, 200.0));
    // Pairs of a discrete element that nothing holds and a particle that met from apart: how deep they came.
    let mut depth: HashMap<(u32, usize), Option<f64>> = HashMap::new();
    let (start, change) = run(&mut scene, |scene| {
        let debris = scene.debris.state();
        for &node in &debris.nodes {
            for (bead, x) in scene.bonded.particles.position.iter().enumerate() {
                let apart = (scene.solid.position(node as usize) - x).norm();
                let overlap = scene.debris.radius(node) + scene.bonded.particles.radius[bead] - apart;
                // One that overlapped when it was born does not count.
                let entry = depth.entry((node, bead)).or_insert((overlap <= 0.0).then_some(0.0));
                *entry = entry.map(|deepest| deepest.max(overlap));
            }
        }
    });
    let counts = scene.counts();
    assert!(counts.removed_elements > 20, "{counts:?}");
    assert!(change.0 < 1e-12 * start.0.norm(), "{change:?} {start:?}");
    assert!(change.1 < 1e-12 * start.0.norm() * 0.1, "{change:?} {start:?}");
    let met: Vec<f64> = depth.values().flatten().copied().filter(|d| *d > 0.0).collect();
    let deepest = met.iter().copied().fold(0.0, f64::max);
    assert!(met.len() > 10 && deepest < 2e-3, "{} pairs met, {deepest} m deep", met.len());
    let ledger = scene.ledger();
    assert!(ledger[EnergyKind::Friction] > 0.0 && ledger.residual_max_relative < 1e-3, "{ledger:?}");
    // The anvil has taken up the blow.
    let anvil: f64 = (125..scene.solid.mass.len()).map(|i| scene.solid.mass[i] * scene.solid.velocity[i].z).sum();
    assert!(anvil < 0.2 * start.0.z, "{anvil} {}", start.0.z);
}

#[test]
fn a_block_that_breaks_on_free_rigid_facets_keeps_momentum_and_energy() {
    let mut scene = crash(Target::Facets, (0, 200.0));
    let (start, change) = run(&mut scene, |_| {});
    assert!(scene.counts().removed_elements > 20, "{:?}", scene.counts());
    assert!(change.0 < 1e-12 * start.0.norm(), "{change:?} {start:?}");
    let below = (0..125).map(|i| scene.solid.position(i).z - scene.contacts.rigid_bodies()[0].displacement().z);
    assert!(below.clone().fold(0.0, f64::min) > -5e-3, "{}", below.fold(0.0, f64::min));
    assert!(scene.ledger().residual_max_relative < 1e-3, "{:?}", scene.ledger());
}

/// The same where every two bodies, and each with itself, have a coefficient of friction of their own.
fn with_friction_of_pairs(mut scene: Scene, friction: f64) -> Scene {
    let solids = (0..scene.solid.body_count()).map(ContactBody::Solid);
    let rigid_bodies = (0..scene.contacts.rigid_bodies().len()).map(ContactBody::Rigid);
    let particles = (0..scene.bonded.bodies().len()).map(ContactBody::Particles);
    let bodies: Vec<ContactBody> = solids.chain(rigid_bodies).chain(particles).collect();
    let mut pairs = ContactPairs::default();
    for first in &bodies {
        for second in &bodies {
            let surface = ContactParameters { friction, ..SURFACE };
            pairs.set([*second, *first], PairContact { surface, work_of_adhesion: None });
        }
    }
    scene.contacts = std::mem::take(&mut scene.contacts).with_pairs(&pairs);
    scene.debris = scene.debris.clone().with_pairs(pairs);
    scene
}

#[test]
fn friction_of_pairs_acts_in_all_contacts_of_solids_rigid_facets_and_particles() {
    // Nothing rubs where all pairs are smooth, though their surfaces are not, and pairs with the coefficients of their surfaces change no bit.
    for (target, beads) in [(Target::Solid, (24, 200.0)), (Target::Facets, (0, 200.0))] {
        let made = crash(target, beads);
        let [mut smooth, mut rough, mut alone] =
            [with_friction_of_pairs(made.clone(), 0.0), with_friction_of_pairs(made.clone(), 0.4), made];
        for scene in [&mut smooth, &mut rough, &mut alone] {
            advance(scene, 2000);
            assert!(scene.debris.len() > 20 && scene.counts().contacts > 10, "{:?}", scene.counts());
        }
        let friction = [&smooth, &rough].map(|scene| scene.ledger()[EnergyKind::Friction]);
        assert!(friction[0].abs() < 1e-9 * friction[1], "{friction:?}");
        assert!(bits(&rough) == bits(&alone));
    }
}

#[test]
fn meetings_are_the_same_bits_for_any_number_of_threads_and_after_a_saved_state() {
    let state = |threads: usize, save: bool| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut scene = crash(Target::Solid, (24, 200.0));
            let mut fresh = scene.clone();
            for _ in 0..2000 {
                scene.step(false).unwrap();
            }
            if save {
                fresh.restore(scene.state());
                scene = fresh;
            }
            for _ in 0..300 {
                scene.step(false).unwrap();
            }
            assert!(scene.debris.len() > 20 && scene.counts().contacts > 10, "{:?}", scene.counts());
            scene.state()
        })
    };
    let first = state(1, false);
    assert!(first == state(3, true) && first == state(1, true));
}

/// Two bars of 10 mm with edges up and down; the upper one flies down at 2 m/s, `gap` above the lower one and turned by `angle` across it.
fn crossed_bars(cells: u32, (angle, shift): (f64, f64), nu: f64, gap: f64) -> Scene {
    let (side, length) = (0.01, 0.06);
    let bar = |first: u32, turn: Rotation, shift: Vec3| {
        let size = Vec3::new(length, side, side);
        let mesh = structured_box([3 * cells, cells, cells], size, None);
        let elements: Vec<[u32; 4]> = mesh.tetrahedra.iter().map(|e| e.map(|n| n + first)).collect();
        let facets: Vec<[u32; 3]> = boundary_of_tetrahedra(&elements).iter().map(|f| f.nodes).collect();
        let edge_up = Rotation::from_scaled_axis(Vec3::x() * std::f64::consts::FRAC_PI_4);
        let nodes: Vec<Vec3> = mesh.nodes.iter().map(|x| turn * (edge_up * (x - size * 0.5)) + shift).collect();
        (nodes, elements, facets)
    };
    let height = std::f64::consts::SQRT_2 * side + gap;
    let (mut nodes, lower, of_lower) = bar(0, Rotation::identity(), Vec3::zeros());
    let count = nodes.len();
    let turn = Rotation::from_scaled_axis(Vec3::z() * angle);
    let (upper_nodes, upper, of_upper) = bar(count as u32, turn, Vec3::new(shift, 0.3 * shift, height));
    nodes.extend(upper_nodes);
    let glass = Elastic { young_modulus: 70e9, poisson_ratio: nu, density: 2500.0 };
    let body = |name: &str, elements| {
        let body = Body::new(name, ElementKind::T4, elements, glass);
        Body { kinematics: Kinematics::Corotational, ..body }
    };
    let mut solid = Solid::new(nodes, vec![body("lower", lower), body("upper", upper)]).unwrap();
    solid.velocity[count..].fill(Vec3::z() * -2.0);
    let mut surface: Vec<u32> = of_lower.iter().chain(&of_upper).flatten().copied().collect();
    surface.sort_unstable();
    surface.dedup();
    let free = ContactParameters { friction: 0.3, damping_ratio: 0.0, rolling_friction: 0.0 };
    let facets = [of_lower, of_upper];
    let ground = |(body, facets): (usize, &Vec<[u32; 3]>)| SolidSurface::new(&solid, body, free, facets).unwrap();
    let solids = facets.iter().enumerate().map(ground).collect();
    let contacts = Contacts::new(&Bonded::default(), Vec::new(), Vec::new(), solids, Vec::new());
    let debris = Debris::new(&solid, vec![free; 2]);
    let settings = SceneSettings {
        time_step: TimeStepSettings { safety: 0.4, element_bound: false, fixed: None, begin: 0.0, end: 1.0 },
        damping: LocalDamping::default(),
        stiffness_time: 0.0,
        balance_stop: 1e-2,
        joined_below: 0.95,
    };
    let (loads, supports) = (Loads::new(Vec::new(), solid.mass.len()), Supports::new(Vec::new(), &solid.reference));
    Scene::new(solid, supports.unwrap(), loads, debris, Vec::new(), &surface, settings)
        .with_contacts(contacts, &surface)
}

/// Angles between crossed bars, with the way that the crossing is beside the middle of both.
const CROSSINGS: [(f64, f64); 6] =
    [(90.0, 1.3e-3), (90.0, 0.0), (45.0, 1.3e-3), (20.0, 1.3e-3), (20.0, 0.4e-3), (-120.0, 0.4e-3)];

#[test]
fn crossed_bars_meet_edge_on_edge_at_the_gap_between_them_and_part_again() {
    let gap = 0.2e-3;
    let mut wrong = Vec::new();
    for (cells, nu) in [(1, 0.22), (2, 0.0), (2, 0.3), (4, 0.3)] {
        for (angle, shift) in CROSSINGS {
            let mut scene = crossed_bars(cells, (f64::to_radians(angle), shift), nu, gap);
            let (start, mut met, mut deepest) = (momenta(&scene), None, 0.0f64);
            let half = scene.solid.mass.len() / 2;
            let mass: f64 = scene.solid.mass[half..].iter().sum();
            let of_upper = |scene: &Scene, of: &dyn Fn(usize) -> f64| -> f64 {
                (half..2 * half).map(|i| scene.solid.mass[i] * of(i)).sum::<f64>() / mass
            };
            while of_upper(&scene, &|i| scene.solid.velocity[i].z) < -0.9 && scene.clock.step < 20_000 {
                scene.step(true).unwrap();
                let down = -of_upper(&scene, &|i| scene.solid.displacement[i].z);
                deepest = deepest.max(down);
                if scene.counts().contacts > 0 && met.is_none() {
                    met = Some(down);
                }
            }
            let (met, now) = (met.unwrap_or(f64::INFINITY), momenta(&scene));
            let change = ((now.0 - start.0).norm() + (now.1 - start.1).norm() / 0.06) / start.0.norm();
            let ledger = scene.ledger();
            let residual = ledger.residual_max_relative;
            let told = format!(
                "{cells} {nu} {angle} {shift}: {met:e} {deepest:e} {change:e} {residual:e} {}",
                ledger[EnergyKind::Friction]
            );
            println!("{told}");
            let booked = ledger[EnergyKind::Friction] >= 0.0;
            if (met - gap).abs() > 0.01e-3 || deepest > gap + 0.15e-3 || change > 1e-11 || residual > 1e-4 || !booked {
                wrong.push(told);
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn crossed_bars_have_the_same_bits_on_any_number_of_ranks_and_threads_and_after_a_checkpoint() {
    let made = || crossed_bars(2, (1.2, 1.3e-3), 0.3, 0.02e-3);
    let single = same_on_ranks(120, made);
    assert!(single.counts().contacts > 0);
    let threaded = on_two_threads(|| {
        let mut scene = made();
        advance(&mut scene, 100);
        assert!(scene.counts().contacts > 0);
        let mut resumed = made();
        resumed.restore(scene.state());
        advance(&mut resumed, 20);
        bits(&resumed)
    });
    assert!(threaded == bits(&single));
}

/// Force of contact on a body from another [N].
pub(crate) fn between(scene: &Scene, on: ContactBody, from: ContactBody) -> Vec3 {
    let force = |axis| {
        let along = Along::Direction(Vec3::ith(axis, 1.0));
        scene.contacts.force_between(&ContactProbe { on, from, along }).unwrap()
    };
    Vec3::from_fn(|axis, _| force(axis))
}

#[test]
fn forces_between_bodies_are_what_changes_their_momentum() {
    for (target, anvil) in [(Target::Solid, ContactBody::Solid(1)), (Target::Facets, ContactBody::Rigid(0))] {
        let mut scene = crash(target, (24, 200.0));
        let (block, beads) = (ContactBody::Solid(0), ContactBody::Particles(0));
        for (on, from) in [(block, anvil), (anvil, block), (block, beads), (beads, anvil)] {
            for axis in 0..3 {
                scene.contacts.watch(ContactProbe { on, from, along: Along::Direction(Vec3::ith(axis, 1.0)) });
            }
        }
        let nodes = 0..block_nodes();
        let of_block =
            |scene: &Scene| nodes.clone().map(|i| scene.solid.velocity[i] * scene.solid.mass[i]).sum::<Vec3>();
        let of_beads = |scene: &Scene| {
            let Particles { velocity, mass, .. } = &scene.bonded.particles;
            velocity.iter().zip(mass).map(|(v, m)| v * *m).sum::<Vec3>()
        };
        let (mut before, scale) = ([of_block(&scene), of_beads(&scene)], of_block(&scene).norm());
        let mut largest = [0.0f64; 3];
        while !scene.is_finished() {
            let (first, dt) = (scene.clock.step == 0, 0.5 * (scene.clock.dt_before + scene.clock.dt_after));
            scene.step(true).unwrap();
            let forces = [between(&scene, block, anvil), between(&scene, block, beads), between(&scene, beads, anvil)];
            largest.iter_mut().zip(&forces).for_each(|(most, force)| *most = most.max(force.norm()));
            assert_eq!(between(&scene, anvil, block), -forces[0]);
            let now = [of_block(&scene), of_beads(&scene)];
            let expected = [forces[0] + forces[1], forces[2] - forces[1]].map(|force| force * dt);
            // The first kick begins half a step early.
            for k in (0..2).filter(|_| !first) {
                let missing = (now[k] - before[k] - expected[k]).norm();
                assert!(missing < 1e-11 * scale, "{anvil:?} step {}: {missing} of {scale}", scene.clock.step);
            }
            before = now;
        }
        assert!(!scene.debris.is_empty() && largest.iter().all(|force| *force > 0.0), "{largest:?}");
    }
}

#[test]
fn the_force_from_a_rigid_body_that_meets_one_body_is_its_reaction() {
    let mut scene = crash(Target::Facets, (0, 200.0));
    let along = Vec3::new(0.6, 0.0, 0.8);
    let (on, from) = (ContactBody::Solid(0), ContactBody::Rigid(0));
    let probe = ContactProbe { on, from, along: Along::Direction(along) };
    scene.contacts.watch(probe);
    let mut largest: f64 = 0.0;
    for _ in 0..400 {
        scene.step(true).unwrap();
        let reaction = -scene.contacts.rigid_bodies()[0].contact_force().dot(&along);
        let force = scene.contacts.force_between(&probe).unwrap();
        largest = largest.max(force.abs());
        assert!((force - reaction).abs() <= 1e-13 * largest, "{force} {reaction}");
    }
    assert!(largest > 0.0);
}

/// Radius of the particles of the cube with flat faces [m], and how far outside of them its faces are.
const GRAIN: f64 = 0.01;
const FACE: f64 = 0.08 * GRAIN;

/// A bonded cube of 27 particles with flat faces whose middle is high above a rigid plane.
fn flat_cube(velocity: Vec3, spin: Vec3) -> Scene {
    let cells = || (0..27).map(|i| Vec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64) - Vec3::repeat(1.0));
    let middle = Vec3::z() * 0.05;
    let position: Vec<Vec3> = cells().map(|cell| middle + cell * (2.0 * GRAIN)).collect();
    let mut particles = Particles::at_rest(position.clone(), vec![GRAIN; 27], 0.27).unwrap();
    for i in 0..27 {
        particles.velocity[i] = velocity + spin.cross(&(position[i] - middle));
        particles.spin[i] = spin;
    }
    let near = |&[i, j]: &[u32; 2]| (position[i as usize] - position[j as usize]).norm() < 2.1 * GRAIN;
    let part = BondedPart {
        name: "cube".into(),
        particles,
        pairs: (0..27).flat_map(|j| (0..j).map(move |i| [i, j])).filter(near).collect(),
        law: fractum_dem::BeamSection { radius: 0.6 * GRAIN, young_modulus: 1e9, poisson_ratio: 0.2 }.into(),
        shares: Vec::new(),
        density: 2400.0,
        fraction: 0.6,
        fracture: None,
        clumps: fractum_dem::Clumps::default(),
    };
    let bonded = Bonded::new(vec![part]).unwrap();
    let elastic = ElasticMaterial { young_modulus: 1e9, poisson_ratio: 0.2 };
    let form = Form::Shape { shape: Shape::HalfSpace, hollow: false };
    let plane = RigidBody::new("plane", form, Frame::at_rest(), ElasticMaterial::RIGID, SURFACE);
    let materials = vec![ContactMaterial { elastic, density: 2400.0, surface: SURFACE, work_of_adhesion: 0.0 }];
    let mut contacts = Contacts::new(&bonded, materials, vec![plane], Vec::new(), Vec::new());
    let shift = cells().map(|cell| cell * FACE).collect();
    let faces = FlatFaces { young_modulus: 1e9, poisson_ratio: 0.2, shift, out: Vec::new() };
    assert_eq!(contacts.flatten(vec![Some(faces)], &bonded.particles), Vec::new());
    let solid = Solid::new(Vec::new(), Vec::new()).unwrap();
    let debris = Debris::new(&solid, Vec::new());
    let (loads, supports) = (Loads::new(Vec::new(), 0), Supports::new(Vec::new(), &[]).unwrap());
    let mut settings = settings(0.01, 1e-2);
    // A particle hits a face for a few steps only.
    settings.time_step.safety = 0.05;
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings)
        .with_bonded(bonded)
        .with_contacts(contacts, &[])
}

#[test]
fn a_body_with_flat_faces_gets_the_angular_momentum_that_the_plane_loses() {
    let mut scene = flat_cube(Vec3::new(2.0, -1.0, -6.0), Vec3::new(30.0, -20.0, 10.0));
    scene.step(true).unwrap();
    let start = momenta(&scene);
    let (mut impulse, mut hardest) = ((Vec3::zeros(), Vec3::zeros()), 0.0f64);
    while !scene.is_finished() {
        let dt = 0.5 * (scene.clock.dt_before + scene.clock.dt_after);
        scene.step(scene.clock.step.is_multiple_of(10)).unwrap();
        // The reference point of the plane is the origin.
        let plane = &scene.contacts.rigid_bodies()[0];
        impulse = (impulse.0 + plane.contact_force() * dt, impulse.1 + plane.contact_moment() * dt);
        hardest = hardest.max(plane.contact_force().norm());
    }
    let end = momenta(&scene);
    assert!(hardest > 100.0 && impulse.1.norm() > 1e-3, "{hardest} {impulse:?}");
    assert!((end.0 - start.0 + impulse.0).norm() < 1e-11 * start.0.norm(), "{start:?} {end:?} {impulse:?}");
    assert!((end.1 - start.1 + impulse.1).norm() < 1e-11 * impulse.1.norm(), "{start:?} {end:?} {impulse:?}");
    assert!(scene.ledger().residual_max_relative < 1e-3, "{:?}", scene.ledger());
}

#[test]
fn a_body_that_has_turned_over_is_felt_at_its_face() {
    let mut scene = flat_cube(Vec3::zeros(), Vec3::zeros());
    let turn = Rotation::from_scaled_axis(Vec3::x() * std::f64::consts::PI);
    let particles = &mut scene.bonded.particles;
    let height = 2.0 * GRAIN + GRAIN + 0.5 * FACE;
    for i in 0..27 {
        particles.position[i] = Vec3::z() * height + turn * (particles.position[i] - Vec3::z() * 0.05);
        particles.orientation[i] = turn;
    }
    scene.step(false).unwrap();
    let force = scene.contacts.rigid_bodies()[0].contact_force();
    // Nine springs of 30 E R, half of the way to the face deep.
    let expected = 9.0 * 30.0 * 1e9 * GRAIN * 0.5 * FACE;
    assert!((force + Vec3::z() * expected).norm() < 1e-9 * expected, "{force:?} {expected}");
}
