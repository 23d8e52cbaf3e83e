//! Natural vibrations of bonded bodies on solids: they swing as motion lets them, and what is tied is one piece.

use fractum_dem::{BeamSection, Particles};
use fractum_fem::{Body, Elastic, Formulation, Solid};
use fractum_math::Vec3;
use fractum_mesh::topology;
use fractum_scene::coupling::Layer;
use fractum_scene::statics::LinearSolver;
use fractum_scene::{Bonded, BondedPart, Mode, Motion, Scene, Support};
use fractum_tests::{CONCRETE, jittered_box, noise};

use super::modes::{SOLVERS, modes, scene};

/// A box of tetrahedra of this size with a lattice of particles of half its height on top of it, whose places are moved at
/// random by a part of the spacing but for the lowest layer.
fn half_bonded(size: f64, poisson_ratio: f64, seed: usize, ties: bool, clamped: bool) -> Scene {
    let (nodes, body) = jittered_box([3, 3, 3], Vec3::new(1.0, 0.8, 0.6) * size);
    let elastic = Elastic { poisson_ratio, ..CONCRETE };
    let solid = Solid::new(nodes, vec![Body { formulation: Formulation::Smoothed, elastic, ..body }]).unwrap();
    let spacing = 0.2 * size;
    let radius = 0.5 * spacing;
    let mut position = Vec::new();
    for k in 0..60 {
        let layer = k / 20;
        let place = Vec3::new((k % 5) as f64, (k / 5 % 4) as f64, layer as f64) + Vec3::repeat(0.5);
        let off = if layer == 0 { 0.0 } else { 0.2 };
        let moved = Vec3::from_fn(|a, _| off * noise(seed + 3 * k + a));
        position.push((place + moved) * spacing + Vec3::z() * (0.6 * size));
    }
    let near = |i: usize, j: usize| (position[j] - position[i]).norm() < 1.55 * spacing;
    let all: Vec<[usize; 2]> = (0..60).flat_map(|i| (i + 1..60).map(move |j| [i, j])).collect();
    let pairs = all.into_iter().filter(|&[i, j]| near(i, j)).map(|pair| pair.map(|i| i as u32)).collect();
    let particles = Particles::at_rest(position, vec![radius; 60], 2400.0 * 0.48 * size.powi(3)).unwrap();
    let section = BeamSection { radius: 0.4 * radius, young_modulus: 3.0 * CONCRETE.young_modulus, poisson_ratio: 0.3 };
    let part = BondedPart {
        name: "lattice".into(),
        particles,
        pairs,
        law: section.into(),
        shares: Vec::new(),
        density: 2400.0,
        fraction: 1.0,
        fracture: None,
        clumps: fractum_dem::Clumps::default(),
    };
    let facets: Vec<[u32; 3]> =
        topology::boundary_of_tetrahedra(&solid.body(0).elements).iter().map(|facet| facet.nodes).collect();
    let bonded = Bonded::new(vec![part]).unwrap();
    let among: Vec<u32> = (0..20).collect();
    let layer = Layer::find(&solid, &facets, &bonded.particles, &among, 0.1 * radius).unwrap();
    assert_eq!(layer.attachments.len(), 20);
    let low = |node: &u32| solid.reference[*node as usize].z < 1e-9 * size;
    let end: Vec<u32> = (0..solid.reference.len() as u32).filter(low).collect();
    let axes = if clamped { 0..3 } else { 0..0 };
    let supports = axes.map(|axis| Support::new("end", end.clone(), axis, Motion::Fixed)).collect();
    let scene = scene(solid, supports).with_bonded(bonded);
    if ties { scene.with_ties(&layer.attachments) } else { scene }
}

/// Starts with a vibration as velocities, and looks whether the displacements stay in its shape and grow and fall as they should.
fn swings(mut scene: Scene, mode: &Mode, size: f64, what: &str) {
    let largest = mode.shape.iter().chain(mode.particles.iter().map(|[shift, _]| shift)).map(|u| u.norm());
    let omega = 2.0 * std::f64::consts::PI * mode.frequency;
    let scale = 1e-6 * size * omega / largest.fold(0.0, f64::max);
    scene.solid.velocity.iter_mut().zip(&mode.shape).for_each(|(v, shape)| *v = shape * scale);
    let start = scene.bonded.particles.position.clone();
    for (i, [shift, turn]) in mode.particles.iter().enumerate() {
        scene.bonded.particles.velocity[i] = shift * scale;
        scene.bonded.particles.spin[i] = turn * scale;
    }
    let steps = (2.2 / (omega * scene.clock.dt_after)) as usize;
    assert!(steps > 10, "{what}: {steps}");
    let dt = scene.clock.dt_after;
    for _ in 0..steps {
        scene.step(false).unwrap();
        assert!((scene.clock.dt_before / dt - 1.0).abs() < 1e-9);
    }
    // Central differences turn a little faster: sin(θ/2) = ω Δt/2.
    let theta = 2.0 * (0.5 * omega * dt).asin();
    let expected = scale * dt * (theta * steps as f64).sin() / theta.sin();
    let moved: Vec<Vec3> = scene.bonded.particles.position.iter().zip(&start).map(|(p, start)| p - start).collect();
    let pairs = scene.solid.displacement.iter().zip(&mode.shape);
    let of_particles = moved.iter().zip(mode.particles.iter().map(|[shift, _]| shift));
    let most = 1e-6 * size;
    for (k, (u, shape)) in pairs.chain(of_particles).enumerate() {
        let off = (u - shape * expected).norm();
        assert!(off < 2e-4 * most, "{what}, point {k}: {} of the largest", off / most);
    }
}

#[test]
fn tied_bodies_swing_as_motion_lets_them() {
    let each = [(1.0, 0.2, 0, true), (1.0, 0.0, 100, true), (1e-3, 0.45, 200, true), (1e3, 0.2, 300, false)];
    for (size, poisson_ratio, seed, clamped) in each {
        let what = format!("{size} m, ratio {poisson_ratio}, seed {seed}, clamped {clamped}");
        let tied = half_bonded(size, poisson_ratio, seed, true, clamped);
        let found = modes(&tied, 6, LinearSolver::Direct);
        let rigid = if clamped { 0 } else { 6 };
        assert_eq!((found.pieces, found.rigid_motions, found.mechanisms, found.loose), (1, rigid, 0, 0), "{what}");
        for linear in SOLVERS {
            let other = modes(&tied, 6, linear);
            for (mode, other) in found.modes.iter().zip(&other.modes) {
                assert!((other.frequency / mode.frequency - 1.0).abs() < 1e-8, "{what}, {linear:?}");
            }
        }
        for number in [0, 2, 5] {
            swings(tied.clone(), &found.modes[number], size, &format!("{what}, mode {number}"));
        }
        let weight = tied.solid.mass.iter().sum::<f64>() + 40.0 * tied.bonded.particles.mass[0];
        if !clamped {
            assert!((found.free_mass - Vec3::repeat(weight)).norm() < 1e-12 * weight, "{what}: {}", found.free_mass);
        }
    }
}

#[test]
fn without_ties_they_are_two_pieces_that_vibrate_each_by_itself() {
    for (clamped, rigid) in [(true, 6), (false, 12)] {
        let both = half_bonded(1.0, 0.2, 0, false, clamped);
        let found = modes(&both, 12, LinearSolver::Auto);
        assert_eq!((found.pieces, found.rigid_motions, found.mechanisms), (2, rigid, 0));
        let mut alone = scene(Solid::new(Vec::new(), Vec::new()).unwrap(), Vec::new());
        alone.bonded = both.bonded.clone();
        let mut solid = both.clone();
        solid.bonded = Bonded::new(Vec::new()).unwrap();
        let mut expected: Vec<f64> = Vec::new();
        for part in [&alone, &solid] {
            expected.extend(modes(part, 12, LinearSolver::Direct).modes.iter().map(|mode| mode.frequency));
        }
        expected.sort_by(f64::total_cmp);
        for (mode, expected) in found.modes.iter().zip(&expected) {
            assert!((mode.frequency / expected - 1.0).abs() < 1e-8, "{} {expected}", mode.frequency);
        }
    }
}

#[test]
fn two_bodies_that_share_their_nodes_vibrate_as_one() {
    for poisson_ratio in [0.0, 0.2, 0.45] {
        let (nodes, body) = jittered_box([6, 2, 2], Vec3::new(3.0, 1.0, 1.0));
        let elastic = Elastic { poisson_ratio, ..CONCRETE };
        let body = Body { elastic, ..body };
        let centre = |e: &[u32; 4]| e.iter().map(|n| nodes[*n as usize].x).sum::<f64>() / 4.0;
        let (left, right): (Vec<_>, Vec<_>) = body.elements.iter().copied().partition(|e| centre(e) < 1.5);
        let half = |name: &str, elements| Body { name: name.into(), elements, ..body.clone() };
        let halves = Solid::new(nodes.clone(), vec![half("left", left.into()), half("right", right.into())]).unwrap();
        let whole = scene(Solid::new(nodes.clone(), vec![body.clone()]).unwrap(), Vec::new());
        let halves = scene(halves, Vec::new());
        let (one, two) = (modes(&whole, 6, LinearSolver::Direct), modes(&halves, 6, LinearSolver::Direct));
        assert_eq!((two.pieces, two.rigid_motions, two.mechanisms), (1, 6, 0));
        for (one, two) in one.modes.iter().zip(&two.modes) {
            assert!((one.frequency / two.frequency - 1.0).abs() < 1e-9, "{} {}", one.frequency, two.frequency);
        }
    }
}
