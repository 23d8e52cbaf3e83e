//! Bonded bodies, loose particles and solids that meet facets leave the domain of a run.

use std::sync::Arc;

use fractum_dem::criterion::{BeamRankine, FractureCriterion};
use fractum_dem::{BeamSection, CrackFaces, LocalBond, Particles};
use fractum_fem::{Body, Elastic, ElementKind, Kinematics, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::structured_box;
use fractum_mesh::topology::boundary_of_tetrahedra;
use fractum_scene::coupling::Debris;
use fractum_scene::{
    BondFracture, Bonded, BondedPart, ContactMaterial, ContactParameters, Contacts, Domain, ElasticMaterial,
    EnergyKind, Heat, HeatSettings, Loads, PackingConduction, Scene, SolidSurface, Supports, ThermalMaterial,
};
use fractum_tests::{noise, settings};

const SURFACE: ContactParameters = ContactParameters { friction: 0.3, damping_ratio: 0.0, rolling_friction: 0.0 };
const ELASTIC: ElasticMaterial = ElasticMaterial { young_modulus: 1e9, poisson_ratio: 0.2 };
const RADIUS: f64 = 0.01;

fn section() -> BeamSection {
    BeamSection { radius: 0.6 * RADIUS, young_modulus: 1e9, poisson_ratio: 0.2 }
}

/// A row of particles along x from a place, touching, with a bit of disorder in their motion.
fn row(from: Vec3, count: usize, velocity: Vec3, disorder: f64) -> Particles {
    let position: Vec<Vec3> = (0..count).map(|i| from + Vec3::x() * (2.0 * RADIUS * i as f64)).collect();
    let mut row = Particles::at_rest(position, vec![RADIUS; count], 0.01 * count as f64).unwrap();
    for i in 0..count {
        row.velocity[i] = velocity + Vec3::from_fn(|a, _| disorder * noise(3 * i + a));
        row.spin[i] = Vec3::from_fn(|a, _| 50.0 * disorder * noise(3 * i + a + 1000));
    }
    row
}

fn part(name: &str, particles: Particles, bonded: bool, strength: Option<f64>) -> BondedPart {
    let count = if bonded { particles.len() as u32 } else { 1 };
    let breaking = |strength| BondFracture {
        criterion: Some(FractureCriterion::BeamRankine(BeamRankine { strength, moments: Default::default() })),
        faces: CrackFaces { friction: 0.3, damping_ratio: 0.0 },
        volume: 1e-4,
        strength_factors: Vec::new(),
        to_wall: Vec::new(),
    };
    BondedPart {
        name: name.into(),
        pairs: (1..count).map(|i| [i - 1, i]).collect(),
        particles,
        law: section().into(),
        shares: Vec::new(),
        density: 2400.0,
        fraction: 0.6,
        fracture: strength.map(breaking),
        clumps: fractum_dem::Clumps::default(),
    }
}

/// Particles of these bodies alone.
fn of_particles(parts: Vec<BondedPart>, end: f64) -> Scene {
    let solid = Solid::new(Vec::new(), Vec::new()).unwrap();
    let debris = Debris::new(&solid, Vec::new());
    let material = ContactMaterial { elastic: ELASTIC, density: 2400.0, surface: SURFACE, work_of_adhesion: 0.0 };
    let materials = vec![material; parts.len()];
    let bonded = Bonded::new(parts).unwrap();
    let contacts = Contacts::new(&bonded, materials, Vec::new(), Vec::new(), Vec::new());
    let (loads, supports) = (Loads::new(Vec::new(), 0), Supports::new(Vec::new(), &[]).unwrap());
    Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings(end, 1e-2))
        .with_bonded(bonded)
        .with_contacts(contacts, &[])
        .with_domain(Domain { min: Vec3::repeat(-0.3), max: Vec3::repeat(0.3) })
}

fn run(scene: &mut Scene) {
    while !scene.is_finished() {
        scene.step(scene.clock.step.is_multiple_of(10)).unwrap();
    }
    scene.step(true).unwrap();
}

/// The same on several threads and from a state saved once something has left.
fn is_the_same_on_threads_and_after_resume(build: impl Fn() -> Scene + Sync) {
    let state = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut scene = build();
            run(&mut scene);
            (scene.state(), scene.heat_state())
        })
    };
    let whole = state(1);
    let mut first = build();
    while first.left().pieces == 0 {
        first.step(first.clock.step.is_multiple_of(10)).unwrap();
    }
    let mut second = build();
    second.restore(first.state());
    second.restore_heat(first.heat_state());
    run(&mut second);
    assert!(whole == (second.state(), second.heat_state()), "resumed");
    assert!(whole == state(2) && whole == state(7), "threads");
}

#[test]
fn an_elastic_bonded_flyer_leaves_with_its_mass_momentum_and_energy() {
    let build = || {
        let flyer = row(Vec3::zeros(), 8, Vec3::new(0.0, 30.0, 5.0), 0.05);
        let rest = row(Vec3::new(-0.1, 0.0, -0.2), 6, Vec3::zeros(), 0.01);
        of_particles(vec![part("flyer", flyer, true, None), part("rest", rest, true, None)], 0.02)
    };
    let mut scene = build();
    let momentum = |s: &Scene| -> Vec3 {
        s.bonded.particles.velocity.iter().zip(&s.bonded.particles.mass).map(|(v, m)| v * *m).sum()
    };
    let start = momentum(&scene);
    run(&mut scene);
    let (left, ledger) = (scene.left(), scene.ledger());
    assert_eq!(
        (left.pieces, left.mass, scene.counts().particles),
        (1, scene.bonded.particles.mass[..8].iter().sum(), 6)
    );
    assert!((momentum(&scene) + left.momentum - start).norm() < 1e-12 * start.norm(), "{left:?}");
    assert!(ledger.residual_max_relative < 1e-10, "{ledger:?}");
    assert!(ledger[EnergyKind::Left] > 0.9 * 0.5 * 0.08 * 925.0, "{ledger:?}");
    assert_eq!(scene.fragments().len(), 1);
    is_the_same_on_threads_and_after_resume(build);
}

#[test]
fn a_body_of_local_bonds_that_is_torn_is_two_fragments_and_leaves_as_a_whole() {
    let build = || {
        let mut bar = row(Vec3::new(-0.1, 0.0, 0.0), 10, Vec3::y() * 20.0, 0.0);
        (0..10).for_each(|i| bar.velocity[i].x = if i < 4 { -3.0 } else { 3.0 });
        let law = LocalBond { tensile_strength: 2e6, shear_strength: 2e6, ..LocalBond::elastic(1e9, 0.2) };
        let faces = CrackFaces { friction: 0.3, damping_ratio: 0.0 };
        let fracture = Some(BondFracture {
            criterion: None,
            faces,
            volume: 1e-4,
            strength_factors: Vec::new(),
            to_wall: Vec::new(),
        });
        of_particles(vec![BondedPart { law: law.into(), fracture, ..part("bar", bar, true, None) }], 0.02)
    };
    let mut scene = build();
    while scene.clock.time < 5e-3 {
        scene.step(false).unwrap();
    }
    let fragments = scene.fragments();
    let sizes: Vec<(usize, usize)> = fragments.iter().map(|piece| (piece.nodes.len(), piece.bonds)).collect();
    assert_eq!((sizes, scene.counts().broken_bonds), (vec![(6, 5), (4, 3)], 1));
    assert!(fragments[0].velocity.x > 0.0 && fragments[1].velocity.x < 0.0, "{fragments:?}");
    run(&mut scene);
    assert_eq!((scene.left().pieces, scene.fragments().len()), (1, 0));
    is_the_same_on_threads_and_after_resume(build);
}

#[test]
fn pieces_of_a_broken_body_and_loose_particles_leave_one_by_one_and_meet_nothing_afterwards() {
    let build = || {
        // Its ends fly apart; loose ones are shot through the place where the first piece comes to rest.
        let mut bar = row(Vec3::new(-0.1, 0.0, 0.0), 10, Vec3::zeros(), 0.01);
        for i in 0..10 {
            bar.velocity[i].x += 300.0 * (bar.position[i].x + 0.01);
        }
        let shot = row(Vec3::new(-0.2, 0.05, 0.0), 3, Vec3::new(-15.0, -1.0, 0.0), 0.0);
        let target = row(Vec3::new(-0.25, 0.05, 0.0), 1, Vec3::zeros(), 0.0);
        let parts = [("bar", bar, true, Some(2e6)), ("shot", shot, false, None), ("target", target, false, None)];
        of_particles(parts.map(|(name, all, bonded, strength)| part(name, all, bonded, strength)).into(), 0.05)
    };
    let mut scene = build();
    run(&mut scene);
    let (left, ledger) = (scene.left(), scene.ledger());
    assert!(scene.counts().broken_bonds > 0 && left.pieces > 4, "{left:?} {:?}", scene.counts());
    assert!(ledger.residual_max_relative < 1e-3, "{ledger:?}");
    assert!(ledger[EnergyKind::Kinetic] < 0.1 * ledger.initial, "{ledger:?}");
    is_the_same_on_threads_and_after_resume(build);
}

/// Cubes of 0.1 m with their places [m] and velocities [m/s] along z, and their facets.
fn cubes(each: &[(&str, f64, f64)]) -> (Solid, Vec<Vec<[u32; 3]>>) {
    let (mut nodes, mut bodies, mut facets) = (Vec::<Vec3>::new(), Vec::new(), Vec::new());
    let mut speeds: Vec<f64> = Vec::new();
    for &(name, at, velocity) in each {
        let mesh = structured_box([3, 3, 2], Vec3::repeat(0.1), None);
        let first = nodes.len() as u32;
        let elements: Vec<[u32; 4]> = mesh.tetrahedra.iter().map(|e| e.map(|n| n + first)).collect();
        facets.push(boundary_of_tetrahedra(&elements).iter().map(|f| f.nodes).collect::<Vec<_>>());
        let elastic = Elastic { young_modulus: 1e9, poisson_ratio: 0.2, density: 2400.0 };
        let body = Body::new(name, ElementKind::T4, elements, elastic);
        bodies.push(Body { kinematics: Kinematics::Corotational, ..body });
        nodes.extend(mesh.nodes.iter().map(|x| x + Vec3::z() * at));
        speeds.resize(nodes.len(), velocity);
    }
    let mut solid = Solid::new(nodes, bodies).unwrap();
    solid.velocity.iter_mut().zip(&speeds).for_each(|(v, speed)| v.z = *speed);
    (solid, facets)
}

#[test]
fn nothing_conducts_through_a_solid_that_has_left() {
    let build = || {
        let (mut solid, _) = cubes(&[("rest", -0.1, 0.0), ("flyer", 0.2, 60.0)]);
        let debris = Debris::new(&solid, vec![SURFACE; 2]);
        let thermal = ThermalMaterial { conductivity: 1e6, capacity: 1e3, expansion: 0.0 };
        let heat = HeatSettings {
            solids: vec![thermal; 2],
            bonded: Vec::new(),
            interfaces: Vec::new(),
            packing: PackingConduction::Table,
            initial: Arc::new(|_, x| 300.0 + 1e3 * x.z),
            stress_free: 300.0,
            conditions: Vec::new(),
            implicit: false,
            step: None,
            safety: 0.5,
            longest: 1e-4,
            alone: false,
            at_rest: false,
            unstressed: false,
        };
        let heat = Heat::new(&mut solid, &mut Bonded::default(), &fractum_scene::Interfaces::default(), heat).unwrap();
        let (loads, supports) = (Loads::new(Vec::new(), 0), Supports::new(Vec::new(), &solid.reference).unwrap());
        Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings(0.02, 1e-2))
            .with_heat(heat, false)
            .with_domain(Domain { min: Vec3::repeat(-0.3), max: Vec3::new(0.3, 0.3, 0.8) })
    };
    let mut scene = build();
    while scene.left().pieces == 0 {
        scene.step(false).unwrap();
    }
    let flyer = scene.solid.reference.len() / 2..scene.solid.reference.len();
    let before = scene.heat().unwrap().of_nodes().to_vec();
    run(&mut scene);
    let after = scene.heat().unwrap().of_nodes();
    assert!(scene.left().pieces == 1 && after[flyer.clone()] == before[flyer.clone()], "{:?}", scene.left());
    assert!(after[..flyer.start] != before[..flyer.start]);
    is_the_same_on_threads_and_after_resume(build);
}

#[test]
fn a_solid_that_is_blind_to_tied_particles_does_not_meet_those_that_have_left() {
    let build = || {
        let (solid, facets) = cubes(&[("flyer", 0.2, 60.0)]);
        // The first bead is on the way of the flyer, outside of the box; the second counts as tied to it.
        let mut beads = row(Vec3::new(0.05, 0.05, 0.35), 2, Vec3::zeros(), 0.0);
        beads.position[1] = Vec3::new(-0.2, 0.05, 0.0);
        let surface = SolidSurface::new(&solid, 0, SURFACE, &facets[0]).unwrap();
        let solids = vec![surface.without([1].into_iter(), &beads.radius)];
        let bonded = Bonded::new(vec![part("beads", beads, false, None)]).unwrap();
        let materials =
            vec![ContactMaterial { elastic: ELASTIC, density: 2400.0, surface: SURFACE, work_of_adhesion: 0.0 }];
        let contacts = Contacts::new(&bonded, materials, Vec::new(), solids, Vec::new());
        let debris = Debris::new(&solid, vec![SURFACE]);
        let (loads, supports) = (Loads::new(Vec::new(), 0), Supports::new(Vec::new(), &solid.reference).unwrap());
        Scene::new(solid, supports, loads, debris, Vec::new(), &[], settings(4e-3, 1e-2))
            .with_bonded(bonded)
            .with_contacts(contacts, &[])
            .with_domain(Domain { min: Vec3::repeat(-0.3), max: Vec3::repeat(0.33) })
    };
    let mut scene = build();
    run(&mut scene);
    let left = scene.left();
    assert_eq!((left.pieces, left.elements), (2, scene.solid.body(0).elements.len()), "{left:?}");
    assert!((left.momentum - Vec3::z() * 2.4 * 60.0).norm() < 1e-9, "{left:?}");
    is_the_same_on_threads_and_after_resume(build);
}

#[test]
fn a_solid_leaves_beside_others_that_rest_on_facets_of_each_other() {
    let build = || {
        let (solid, facets) = cubes(&[("anvil", -0.1, 0.0), ("hammer", 1e-4, -1.0), ("flyer", 0.2, 60.0)]);
        let mut surface: Vec<u32> = facets.iter().flatten().flatten().copied().collect();
        surface.sort_unstable();
        surface.dedup();
        let ground =
            |(body, facets): (usize, &Vec<[u32; 3]>)| SolidSurface::new(&solid, body, SURFACE, facets).unwrap();
        let solids = facets.iter().enumerate().map(ground).collect();
        // Beads that the flyer leaves behind, and one that follows it out of the box.
        let mut beads = row(Vec3::new(0.2, 0.05, 0.0), 2, Vec3::zeros(), 0.0);
        beads.position[1] = Vec3::new(0.05, 0.05, 0.4);
        beads.velocity[1].z = 55.0;
        let bonded = Bonded::new(vec![part("beads", beads, false, None)]).unwrap();
        let materials =
            vec![ContactMaterial { elastic: ELASTIC, density: 2400.0, surface: SURFACE, work_of_adhesion: 0.0 }];
        let contacts = Contacts::new(&bonded, materials, Vec::new(), solids, Vec::new());
        let debris = Debris::new(&solid, vec![SURFACE; 3]);
        let (loads, supports) = (Loads::new(Vec::new(), surface.len()), Supports::new(Vec::new(), &solid.reference));
        Scene::new(solid, supports.unwrap(), loads, debris, Vec::new(), &surface, settings(0.02, 1e-2))
            .with_bonded(bonded)
            .with_contacts(contacts, &surface)
            .with_domain(Domain { min: Vec3::repeat(-0.3), max: Vec3::new(0.3, 0.3, 0.8) })
    };
    let mut scene = build();
    run(&mut scene);
    let (left, ledger) = (scene.left(), scene.ledger());
    assert_eq!((left.pieces, left.elements), (2, scene.solid.body(2).elements.len()), "{left:?}");
    assert!((left.momentum.z - 2.4 * 60.0 - 0.01 * 55.0).abs() < 0.01, "{left:?}");
    assert!(ledger.residual_max_relative < 1e-3, "{ledger:?}");
    // The hammer has bounced off the anvil meanwhile.
    let speed = |body: usize| scene.solid.velocity[scene.solid.body(body).elements[0][0] as usize].z;
    assert!(speed(0) < -0.1, "{} {}", speed(0), speed(1));
    is_the_same_on_threads_and_after_resume(build);
}
