//! Natural vibrations under a stress of the start: struts, ties, buckling, free bodies; springs that hold.

use std::f64::consts::PI;

use fractum_fem::{Body, Elastic, ElementKind, Formulation, Plane, Solid};
use fractum_math::{Mat3, Vec3};
use fractum_mesh::generate::structured_rectangle;
use fractum_mesh::topology;
use fractum_scene::statics::{LinearSolver, ModesError, ModesSettings, find_modes};
use fractum_scene::{Motion, Scene, Support, SupportedFacet, SurfaceSupports};
use fractum_tests::{CONCRETE, jittered_box};

use super::modes::{SOLVERS, modes, scene};

/// Length over depth of struts.
const SLENDER: f64 = 20.0;

/// A plane strut hinged at both ends under a strain along it, and its length.
fn strut(size: f64, poisson_ratio: f64, plane: Plane, formulation: Formulation, strain: f64) -> Scene {
    let depth = size / SLENDER;
    let mesh = structured_rectangle([80, 4], [size, depth], None);
    let elements: Vec<[u32; 4]> = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
    let elastic = Elastic { poisson_ratio, ..CONCRETE };
    let body = Body { plane, formulation, ..Body::new("strut", ElementKind::T3, elements, elastic) };
    let across = if plane == Plane::Stress { poisson_ratio } else { poisson_ratio / (1.0 - poisson_ratio) };
    let mut solid = Solid::new(mesh.nodes, vec![body]).unwrap();
    let moved = |p: &Vec3| Vec3::new(p.x, -across * (p.y - 0.5 * depth), 0.0) * strain;
    solid.displacement = solid.reference.iter().map(moved).collect();
    solid.initial_displacement = solid.displacement.clone();
    let middle = |x: f64| {
        let near = |p: &Vec3| (p - Vec3::new(x, 0.5 * depth, 0.0)).norm() < 1e-6 * size;
        (0..).zip(&solid.reference).filter(|(_, p)| near(p)).map(|(node, _)| node).collect::<Vec<u32>>()
    };
    let [left, right] = [middle(0.0), middle(size)];
    assert_eq!((left.len(), right.len()), (1, 1));
    let held = [("left", &left, 0), ("left", &left, 1), ("right", &right, 1)];
    let supports = held.map(|(name, nodes, axis)| Support::new(name, nodes.clone(), axis, Motion::Fixed));
    scene(solid, supports.to_vec())
}

/// Stress along a strut over its strain [Pa].
fn modulus(poisson_ratio: f64, plane: Plane) -> f64 {
    let lateral = if plane == Plane::Stress { 0.0 } else { poisson_ratio * poisson_ratio };
    CONCRETE.young_modulus / (1.0 - lateral)
}

#[test]
fn a_strut_vibrates_more_slowly_until_it_buckles_and_faster_as_it_is_stretched() {
    let (standard, smoothed) = (Formulation::Standard, Formulation::Smoothed);
    let each = [
        (1.0, 0.2, Plane::Stress, smoothed),
        (1e-3, 0.0, Plane::Stress, standard),
        (1e3, 0.45, Plane::Stress, smoothed),
        (1.0, 0.3, Plane::Strain, smoothed),
        (1.0, 0.45, Plane::Strain, standard),
    ];
    for (size, poisson_ratio, plane, formulation) in each {
        let what = format!("{size} m, ratio {poisson_ratio}, {plane:?}, {formulation:?}");
        let under = |strain: f64| strut(size, poisson_ratio, plane, formulation, strain);
        let square = |mode: &fractum_scene::Mode| mode.frequency * mode.frequency;
        // Two vibrations: the third one of a strut that locks is that along it.
        let free = modes(&under(0.0), 2, LinearSolver::Direct);
        // f_n² = f_n0² + n² σ/(4 L² ρ): Euler's stress is that of n = 1 with f = 0.
        let stress_per_square = |n: f64| 4.0 * size * size * CONCRETE.density / (n * n);
        let euler = -square(&free.modes[0]) * stress_per_square(1.0) / modulus(poisson_ratio, plane);
        // Of Euler's beam without shear; triangles are stiffer, most where they lock.
        let theory = -PI * PI / (12.0 * SLENDER * SLENDER);
        let locks = poisson_ratio > 0.4 && plane == Plane::Strain && formulation == standard;
        assert!(
            (euler / theory - 1.0).abs() < if locks || formulation == standard { 0.6 } else { 0.05 },
            "{what}: {}",
            euler / theory
        );
        for part in [-4.0, -1.0, 0.5, 0.9, 0.99] {
            for linear in SOLVERS {
                let found = modes(&under(part * euler), 2, linear);
                assert_eq!((found.rigid_motions, found.mechanisms), (0, 0), "{what}");
                for (n, (mode, free)) in found.modes.iter().zip(&free.modes).enumerate() {
                    let n = n as f64 + 1.0;
                    let stress = part * euler * modulus(poisson_ratio, plane);
                    let expected = square(free) + stress / stress_per_square(n);
                    let off = (square(mode) - expected).abs() / square(free);
                    assert!(off < 0.01 * part.abs().max(1.0), "{what}, {part} of Euler, mode {n}, {linear:?}: {off}");
                }
            }
        }
        for (beyond, linear) in [(1.05, 0), (1.05, 1), (1.05, 2), (3.0, 0), (30.0, 1), (30.0, 2)] {
            let settings = ModesSettings { count: 3, linear: SOLVERS[linear] };
            let told = find_modes(&under(beyond * euler), settings, || false);
            let Err(ModesError::Unstable { time }) = told else { panic!("{what}, {beyond}, {linear}: {told:?}") };
            if beyond < 4.0 {
                let grows = 1.0 / (2.0 * PI * (square(&free.modes[0]) * (beyond - 1.0)).sqrt());
                assert!((time / grows - 1.0).abs() < 0.15, "{what}, {beyond}: {time} for {grows}");
            }
        }
    }
}

/// A box that nothing holds, strained along x.
fn free_box(size: f64, poisson_ratio: f64, strain: f64) -> Scene {
    let (nodes, body) = jittered_box([6, 2, 2], Vec3::new(3.0, 1.0, 1.0) * size);
    let elastic = Elastic { poisson_ratio, ..CONCRETE };
    let mut solid = Solid::new(nodes, vec![Body { formulation: Formulation::Smoothed, elastic, ..body }]).unwrap();
    let ratios = Vec3::new(1.0, -poisson_ratio, -poisson_ratio) * strain;
    solid.displacement = solid.reference.iter().map(|p| p.component_mul(&ratios)).collect();
    solid.initial_displacement = solid.displacement.clone();
    scene(solid, Vec::new())
}

/// Squares of the two frequencies at which a rigid body turns back that is pulled along x, J w ω² = P (w − w_x e_x).
///
/// - `pull`: the stress times the volume [J]
fn turning(solid: &Solid, pull: f64) -> [f64; 2] {
    let total: f64 = solid.mass.iter().sum();
    let centre = solid.reference.iter().zip(&solid.mass).map(|(p, m)| p * *m).sum::<Vec3>() / total;
    let of = |(p, m): (&Vec3, &f64)| {
        let arm = p - centre;
        (Mat3::identity() * arm.norm_squared() - arm * arm.transpose()) * *m
    };
    let inertia: Mat3 = solid.reference.iter().zip(&solid.mass).map(of).sum();
    let flexibility = inertia.try_inverse().unwrap();
    let reduced = flexibility.fixed_view::<2, 2>(1, 1).into_owned();
    let squares = reduced.symmetric_eigenvalues() * pull;
    [squares.min(), squares.max()]
}

#[test]
fn a_free_body_turns_back_to_the_pull_and_away_from_the_push() {
    for (size, poisson_ratio) in [(1.0, 0.2), (1e-3, 0.0), (1e3, 0.45)] {
        let strain = 1e-5;
        for linear in SOLVERS {
            let scene = free_box(size, poisson_ratio, strain);
            let found = modes(&scene, 3, linear);
            // Translations, and the rotation about the axis of the pull.
            assert_eq!((found.pieces, found.rigid_motions, found.mechanisms), (1, 4, 0));
            let pull = CONCRETE.young_modulus * strain * 3.0 * size.powi(3);
            let squares = turning(&scene.solid, pull);
            for (mode, square) in found.modes[..2].iter().zip(squares) {
                let expected = square.sqrt() / (2.0 * PI);
                assert!((mode.frequency / expected - 1.0).abs() < 1e-3, "{} for {expected}", mode.frequency);
            }
            let pushed = free_box(size, poisson_ratio, -strain);
            let told = find_modes(&pushed, ModesSettings { count: 3, linear }, || false);
            let Err(ModesError::Unstable { time }) = told else { panic!("{linear:?}: {told:?}") };
            let expected = 1.0 / squares[1].sqrt();
            assert!((time / expected - 1.0).abs() < 1e-3, "{time} for {expected}");
        }
    }
}

#[test]
fn soft_springs_let_a_box_swing_as_a_whole() {
    for (size, poisson_ratio) in [(1.0, 0.2), (1e-3, 0.45)] {
        let scene = free_box(size, poisson_ratio, 0.0);
        let boundary = topology::boundary_of_tetrahedra(&scene.solid.body(0).elements);
        let stiffness = 1e-7 * CONCRETE.young_modulus / size;
        let springs: Vec<SupportedFacet> = boundary
            .iter()
            .map(|facet| {
                let [a, b, c] = facet.nodes.map(|n| scene.solid.reference[n as usize]);
                let across = (b - a).cross(&(c - a));
                let area = 0.5 * across.norm();
                SupportedFacet {
                    nodes: facet.nodes,
                    area,
                    answer: SupportedFacet::along_and_across(across / (2.0 * area), [stiffness; 2]),
                }
            })
            .collect();
        let area: f64 = springs.iter().map(|facet| facet.area).sum();
        let mass: f64 = scene.solid.mass.iter().sum();
        let held = SurfaceSupports::new(&[], &springs, &scene.solid.mass);
        let scene = scene.with_surface_supports(held);
        let expected = (stiffness * area / mass).sqrt() / (2.0 * PI);
        for linear in SOLVERS {
            let found = modes(&scene, 7, linear);
            assert_eq!((found.rigid_motions, found.mechanisms), (0, 0));
            let whole = found.modes[..6].iter().filter(|mode| (mode.frequency / expected - 1.0).abs() < 0.02).count();
            assert!(
                whole >= 3,
                "{linear:?}: {whole} of {:?}",
                found.modes.iter().map(|m| m.frequency).collect::<Vec<_>>()
            );
            assert!(found.modes[6].frequency > 100.0 * expected);
        }
    }
}
