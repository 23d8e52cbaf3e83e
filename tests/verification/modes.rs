//! Natural vibrations against a dense solver; pieces, rigid motions and mechanisms; the linear solvers.

use fractum_dem::{BeamSection, Particles};
use fractum_fem::{Body, Elastic, ElementKind, Formulation, LocalDamping, Plane, Solid};
use fractum_math::Vec3;
use fractum_mesh::generate::structured_rectangle;
use fractum_scene::coupling::Debris;
use fractum_scene::statics::{LinearSolver, ModesSettings, find_modes};
use fractum_scene::{
    Bonded, BondedPart, ContactParameters, Loads, Modes, Motion, Scene, SceneSettings, Support, Supports,
    TimeStepSettings,
};
use fractum_tests::{CONCRETE, jittered_box};
use nalgebra::DMatrix;

pub(super) const SOLVERS: [LinearSolver; 3] = [LinearSolver::Direct, LinearSolver::Faer, LinearSolver::Iterative];

pub(super) fn scene(solid: Solid, supports: Vec<Support>) -> Scene {
    let supports = Supports::new(supports, &solid.reference).unwrap();
    let loads = Loads::new(Vec::new(), solid.reference.len());
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

pub(super) fn modes(scene: &Scene, count: usize, linear: LinearSolver) -> Modes {
    let found = find_modes(scene, ModesSettings { count, linear }, || false).unwrap();
    assert!(found.converged, "{linear:?}");
    found
}

/// All frequencies of a small scene, from its stiffness column by column and its masses, by a dense solver.
fn dense(scene: &Scene) -> Vec<f64> {
    let (solid, held) = (&scene.solid, scene.supports().held());
    let axes = if solid.is_plane() { 2 } else { 3 };
    let is_free = |node: usize, axis: usize| held.get(node).is_none_or(|bits| bits >> axis & 1 == 0);
    let free: Vec<(usize, usize)> = (0..solid.reference.len())
        .flat_map(|node| (0..axes).map(move |axis| (node, axis)))
        .filter(|&(node, axis)| is_free(node, axis))
        .collect();
    let mut matrix = DMatrix::zeros(free.len(), free.len());
    let (mut field, mut force) = (vec![Vec3::zeros(); solid.mass.len()], vec![Vec3::zeros(); solid.mass.len()]);
    for (column, &(node, axis)) in free.iter().enumerate() {
        field[node][axis] = 1.0;
        solid.secant_force(&solid.cell_damage(), &field, &mut force);
        field[node][axis] = 0.0;
        for (row, &(other, along)) in free.iter().enumerate() {
            matrix[(row, column)] = force[other][along] / (solid.mass[node] * solid.mass[other]).sqrt();
        }
    }
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values.iter().map(|value| value.max(0.0).sqrt() / (2.0 * std::f64::consts::PI)).collect()
}

fn near(found: &Modes, exact: &[f64], what: &str) {
    assert!(!found.modes.is_empty());
    for (mode, exact) in found.modes.iter().zip(exact) {
        assert!((mode.frequency / exact - 1.0).abs() < 1e-8, "{what}: {} against {exact}", mode.frequency);
    }
}

/// Boxes whose size differs by a million, with these Poisson's ratios and both elements.
fn boxes() -> impl Iterator<Item = (String, Solid)> {
    let of = |size: f64, formulation: Formulation, poisson_ratio: f64| {
        let (nodes, body) = jittered_box([4, 3, 2], Vec3::new(1.0, 0.7, 0.4) * size);
        let elastic = Elastic { poisson_ratio, ..CONCRETE };
        let solid = Solid::new(nodes, vec![Body { formulation, elastic, ..body }]).unwrap();
        (format!("{size} m, {formulation:?}, {poisson_ratio}"), solid)
    };
    let sizes = [1e-3, 1e3].into_iter();
    sizes.flat_map(move |size| {
        let both = [Formulation::Standard, Formulation::Smoothed].into_iter();
        both.flat_map(move |formulation| [0.0, 0.2, 0.45].into_iter().map(move |ratio| of(size, formulation, ratio)))
    })
}

#[test]
fn free_and_held_boxes_vibrate_as_a_dense_solver_says() {
    for (what, solid) in boxes() {
        let free = scene(solid.clone(), Vec::new());
        let exact = dense(&free);
        for linear in SOLVERS {
            let found = modes(&free, 9, linear);
            assert_eq!((found.pieces, found.rigid_motions, found.mechanisms), (1, 6, 0), "{what}");
            assert_eq!(found.modes.len(), 9);
            near(&found, &exact[6..], &what);
        }
        let end: Vec<u32> = (0..).zip(&solid.reference).filter(|(_, p)| p.x < 1e-9).map(|(node, _)| node).collect();
        let all = (0..3).map(|axis| Support::new("end", end.clone(), axis, Motion::Fixed)).collect();
        let held = scene(solid, all);
        let exact = dense(&held);
        for linear in SOLVERS {
            let found = modes(&held, 9, linear);
            assert_eq!((found.rigid_motions, found.mechanisms), (0, 0), "{what}");
            near(&found, &exact, &what);
        }
        // All of them together set all of the mass in motion.
        let found = modes(&held, exact.len(), LinearSolver::Direct);
        near(&found, &exact, &what);
        let moved: Vec3 = found.modes.iter().map(|mode| mode.effective_mass()).sum();
        assert!((moved - found.free_mass).norm() < 1e-9 * found.free_mass.norm(), "{moved:?} {:?}", found.free_mass);
    }
}

#[test]
fn plane_bodies_have_three_rigid_motions_and_a_square_its_double_frequencies() {
    let mesh = structured_rectangle([6, 6], [1.0, 1.0], None);
    let elements: Vec<[u32; 4]> = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
    for plane in [Plane::Stress, Plane::Strain] {
        let body = Body { plane, ..Body::new("square", ElementKind::T3, elements.clone(), CONCRETE) };
        let scene = scene(Solid::new(mesh.nodes.clone(), vec![body]).unwrap(), Vec::new());
        let exact = dense(&scene);
        for linear in SOLVERS {
            let found = modes(&scene, 12, linear);
            assert_eq!(found.rigid_motions, 3);
            near(&found, &exact[3..], "square");
        }
    }
}

/// Cubes of some tetrahedra, cornered as these nodes say.
fn of_tetrahedra(nodes: Vec<Vec3>, elements: Vec<[u32; 4]>) -> Scene {
    scene(Solid::new(nodes, vec![Body::new("parts", ElementKind::T4, elements, CONCRETE)]).unwrap(), Vec::new())
}

#[test]
fn pieces_and_mechanisms_are_counted() {
    let one = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
    let far = one.map(|p| p * 0.7 + Vec3::new(3.0, 0.0, 0.0));
    let apart = of_tetrahedra([one, far].concat(), vec![[0, 1, 2, 3], [4, 5, 6, 7]]);
    // Two that share the edge from 0 to 1, and two that share the node 0.
    let back = [-Vec3::y(), -Vec3::z()];
    let hinged = of_tetrahedra([&one[..], &back].concat(), vec![[0, 1, 2, 3], [0, 1, 4, 5]]);
    let ball = [-Vec3::x(), -Vec3::y(), -Vec3::z()];
    let jointed = of_tetrahedra([&one[..], &ball].concat(), vec![[0, 1, 2, 3], [0, 5, 4, 6]]);
    for (scene, counts, what) in
        [(apart, (2, 12, 0), "apart"), (hinged, (1, 6, 1), "an edge"), (jointed, (1, 6, 3), "a node")]
    {
        let exact = dense(&scene);
        let left = counts.1 + counts.2;
        assert!(exact[left - 1] < 1e-5 * exact[left], "{what}: {exact:?}");
        for linear in [LinearSolver::Direct, LinearSolver::Faer] {
            let found = modes(&scene, 4, linear);
            assert_eq!((found.pieces, found.rigid_motions, found.mechanisms), counts, "{what}");
            near(&found, &exact[left..], what);
        }
    }
}

/// A rod of particles of this radius in a row along x, `spacing` apart, the first of them clamped or not.
fn rod(count: usize, spacing: f64, clamped: bool) -> Scene {
    let radius = 0.5 * spacing;
    let position: Vec<Vec3> = (0..=count).map(|i| Vec3::x() * (spacing * i as f64)).collect();
    let mut particles = Particles::at_rest(position, vec![radius; count + 1], RHO * (count + 1) as f64).unwrap();
    if clamped {
        particles.held[0] = 0b11_1111;
    }
    let solid = Solid::new(Vec::new(), Vec::new()).unwrap();
    scene(solid, Vec::new()).with_bonded(Bonded::new(vec![part(particles, count)]).unwrap())
}

/// A rod of particles, the first of which are bonded one to the next by so many beams.
fn part(particles: Particles, bonds: usize) -> BondedPart {
    BondedPart {
        name: "rod".into(),
        particles,
        pairs: (0..bonds as u32).map(|i| [i, i + 1]).collect(),
        law: SECTION.into(),
        shares: Vec::new(),
        density: 1000.0,
        fraction: 0.64,
        fracture: None,
        clumps: fractum_dem::Clumps::default(),
    }
}

/// Mass of a particle of rods [kg], and the section of their beams.
const RHO: f64 = 0.02;
const SECTION: BeamSection = BeamSection { young_modulus: 1e9, poisson_ratio: 0.3, radius: 0.02 };

#[test]
fn a_clamped_rod_of_particles_stretches_twists_and_bends_as_chains_and_beams_do() {
    let (count, spacing) = (40, 0.05);
    let held = rod(count, spacing, true);
    let inertia = held.bonded.particles.inertia[1];
    // A chain of equal springs and masses, one end held and the last mass whole.
    let chain = |stiffness: f64, mass: f64| {
        let phase = std::f64::consts::PI / (2 * (2 * count + 1)) as f64;
        2.0 * (stiffness / mass).sqrt() * phase.sin() / (2.0 * std::f64::consts::PI)
    };
    let length = count as f64 * spacing;
    // Euler's beam; the last particle is half a mass more than the beam has.
    let beam = 1.875_104_068_7f64.powi(2) * (SECTION.bending() * spacing / RHO).sqrt()
        / (length * length)
        / (2.0 * std::f64::consts::PI);
    for linear in SOLVERS {
        let found = modes(&held, 16, linear);
        assert_eq!((found.pieces, found.rigid_motions, found.mechanisms), (1, 0, 0));
        let nearest = |wanted: f64| {
            let off = |frequency: f64| (frequency / wanted - 1.0).abs();
            found.modes.iter().map(|mode| off(mode.frequency)).fold(f64::INFINITY, f64::min)
        };
        assert!(nearest(chain(SECTION.axial() / spacing, RHO)) < 1e-8, "{linear:?}: tension");
        assert!(nearest(chain(SECTION.torsion() / spacing, inertia)) < 1e-8, "{linear:?}: torsion");
        let bending = [found.modes[0].frequency, found.modes[1].frequency];
        assert!((bending[1] / bending[0] - 1.0).abs() < 1e-8, "{bending:?}");
        // Of the mass of the tip 2 % of the fundamental at 40 particles, and less with more.
        assert!((bending[0] / beam - 1.0).abs() < 0.03, "{} against {beam}", bending[0]);
    }
    let found = modes(&rod(count, spacing, false), 3, LinearSolver::Auto);
    assert_eq!((found.pieces, found.rigid_motions, found.mechanisms), (1, 6, 0));
    // A free beam: (4.730/L)², in two planes.
    let free = 4.730_040_744_9f64.powi(2) * (SECTION.bending() * spacing / RHO).sqrt()
        / (length * length)
        / (2.0 * std::f64::consts::PI);
    assert!((found.modes[0].frequency / free - 1.0).abs() < 0.06, "{} against {free}", found.modes[0].frequency);
}

#[test]
fn a_particle_without_bonds_does_not_vibrate() {
    for clamped in [true, false] {
        let alone = modes(&rod(20, 0.05, clamped), 8, LinearSolver::Direct);
        for linear in SOLVERS {
            let mut scene = rod(20, 0.05, clamped);
            let place = Vec3::new(0.0, 1.0, 0.0);
            let particles = &scene.bonded.particles;
            let position = [&particles.position[..], &[place]].concat();
            let mass = particles.mass[0] * position.len() as f64;
            let mut all = Particles::at_rest(position, vec![0.025; 22], mass).unwrap();
            all.held[..21].copy_from_slice(&particles.held);
            scene = scene.with_bonded(Bonded::new(vec![part(all, 20)]).unwrap());
            let found = modes(&scene, 8, linear);
            assert!(found.converged, "{linear:?}");
            assert_eq!((found.loose, found.pieces, found.rigid_motions), (1, 1, alone.rigid_motions), "{linear:?}");
            for (mode, exact) in found.modes.iter().zip(&alone.modes) {
                assert!((mode.frequency / exact.frequency - 1.0).abs() < 1e-8, "{linear:?}: {mode:?}");
            }
        }
    }
}
