//! The standard and the smoothed element: patch test, zero modes, forces as derivatives of the energy, rotations.

use fractum_fem::{Body, ElementKind, Formulation, Kinematics, Plane, Solid, fields};
use fractum_math::{Mat3, Vec3};
use fractum_mesh::generate::{Jitter, structured_rectangle};
use fractum_tests::{CONCRETE, jittered_box, noise};
use nalgebra::DMatrix;

const FORMULATIONS: [Formulation; 2] = [Formulation::Standard, Formulation::Smoothed];

fn solid(cells: [u32; 3], size: Vec3, formulation: Formulation, kinematics: Kinematics) -> Solid {
    let (nodes, body) = jittered_box(cells, size);
    Solid::new(nodes, vec![Body { formulation, kinematics, ..body }]).unwrap()
}

fn energy(solid: &mut Solid, displacement: &[Vec3]) -> f64 {
    solid.displacement.copy_from_slice(displacement);
    solid.update_internal_forces(1.0, true);
    solid.elastic_energy()
}

#[test]
fn constant_strain_gives_constant_stress_and_no_inner_force() {
    for formulation in FORMULATIONS {
        let mut solid = solid([3, 2, 4], Vec3::new(1.0, 0.8, 1.2), formulation, Kinematics::Small);
        let slope = Mat3::new(1.0, 0.3, -0.2, 0.5, -0.7, 0.4, 0.1, 0.6, 0.9) * 1e-4;
        let expected = {
            let strain = (slope + slope.transpose()) * 0.5;
            strain * (2.0 * CONCRETE.shear_modulus()) + Mat3::identity() * (CONCRETE.lame_lambda() * strain.trace())
        };
        for i in 0..solid.reference.len() {
            solid.displacement[i] = slope * solid.reference[i];
        }
        solid.update_internal_forces(1.0, true);
        let scale = expected.norm();
        for (stress, _) in fields::element_fields(&solid, 0, None) {
            assert!((stress.to_matrix() - expected).norm() < 1e-12 * scale, "{formulation:?}");
        }
        let inside = |p: &Vec3| (0..3).all(|a| p[a] > 1e-9 && p[a] < [1.0, 0.8, 1.2][a] - 1e-9);
        for i in (0..solid.reference.len()).filter(|&i| inside(&solid.reference[i])) {
            assert!(solid.force[i].norm() < 1e-12 * scale, "{formulation:?}: {:e}", solid.force[i].norm() / scale);
        }
        let density = 0.5 * expected.component_mul(&((slope + slope.transpose()) * 0.5)).sum();
        assert!((solid.elastic_energy() / (density * 0.96) - 1.0).abs() < 1e-12);
    }
}

/// Eigenvalues of the stiffness, by unit displacements.
fn stiffness_eigenvalues(solid: &mut Solid, axes: usize) -> Vec<f64> {
    let n = axes * solid.reference.len();
    let mut k = DMatrix::zeros(n, n);
    for dof in 0..n {
        solid.displacement.fill(Vec3::zeros());
        solid.displacement[dof / axes][dof % axes] = 1.0;
        solid.update_internal_forces(1.0, false);
        for row in 0..n {
            k[(row, dof)] = -solid.force[row / axes][row % axes];
        }
    }
    let symmetry = (&k - k.transpose()).norm() / k.norm();
    assert!(symmetry < 1e-13, "stiffness is symmetric up to {symmetry:e}");
    let mut values: Vec<f64> = k.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    values
}

#[test]
fn rigid_motions_are_the_only_zero_modes() {
    for formulation in FORMULATIONS {
        let mut solid = solid([3, 2, 2], Vec3::new(1.0, 0.8, 1.2), formulation, Kinematics::Small);
        let values = stiffness_eigenvalues(&mut solid, 3);
        let top = values[values.len() - 1];
        assert!(values[5].abs() < 1e-12 * top && values[6] > 1e-4 * top, "{formulation:?}: {:?}", &values[..8]);
    }
}

#[test]
fn plane_rigid_motions_are_the_only_zero_modes() {
    for formulation in FORMULATIONS {
        let mesh = structured_rectangle([4, 3], [1.0, 0.8], Some(Jitter { fraction: 0.15, seed: 3 }));
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let body = Body::new("sheet", ElementKind::T3, elements, CONCRETE);
        let mut solid =
            Solid::new(mesh.nodes, vec![Body { formulation, plane: Plane::Stress, thickness: 0.1, ..body }]).unwrap();
        let values = stiffness_eigenvalues(&mut solid, 2);
        let top = values[values.len() - 1];
        assert!(values[2].abs() < 1e-12 * top && values[3] > 1e-4 * top, "{formulation:?}: {:?}", &values[..5]);
    }
}

#[test]
fn forces_are_the_derivative_of_the_energy() {
    for formulation in FORMULATIONS {
        for kinematics in [Kinematics::Small, Kinematics::Corotational] {
            let mut solid = solid([2, 2, 2], Vec3::new(1.0, 0.8, 1.2), formulation, kinematics);
            // Large enough to turn the corotational cells by some tenths of a radian.
            let base: Vec<Vec3> =
                (0..solid.reference.len()).map(|i| Vec3::from_fn(|a, _| 0.05 * noise(3 * i + a))).collect();
            energy(&mut solid, &base);
            let force = solid.force.clone();
            let scale = force.iter().map(|f| f.norm()).fold(0.0, f64::max);
            for dof in (0..3 * base.len()).step_by(7) {
                let at = |step: f64| {
                    let mut moved = base.clone();
                    moved[dof / 3][dof % 3] += step;
                    moved
                };
                let h = 1e-5;
                let slope = (energy(&mut solid, &at(h)) - energy(&mut solid, &at(-h))) / (2.0 * h);
                let f = force[dof / 3][dof % 3];
                assert!((slope + f).abs() < 2e-7 * scale, "{formulation:?} {kinematics:?}: {slope:e} against {:e}", -f);
            }
        }
    }
}

#[test]
fn rigid_rotation_gives_no_corotational_force() {
    for formulation in FORMULATIONS {
        let mut solid = solid([2, 3, 2], Vec3::new(1.0, 0.8, 1.2), formulation, Kinematics::Corotational);
        let rotation = nalgebra::Rotation3::from_euler_angles(0.9, -2.1, 1.3);
        for i in 0..solid.reference.len() {
            solid.displacement[i] = rotation * solid.reference[i] - solid.reference[i] + Vec3::new(1.0, 2.0, 3.0);
        }
        solid.update_internal_forces(1.0, true);
        let scale = CONCRETE.young_modulus;
        assert!(solid.force.iter().all(|f| f.norm() < 1e-13 * scale), "{formulation:?}");
        assert!(solid.elastic_energy() < 1e-20 * scale);
    }
}

#[test]
fn internal_forces_have_no_resultant() {
    for formulation in FORMULATIONS {
        for kinematics in [Kinematics::Small, Kinematics::Corotational] {
            let mut solid = solid([2, 2, 3], Vec3::new(1.0, 0.8, 1.2), formulation, kinematics);
            for i in 0..solid.reference.len() {
                solid.displacement[i] = Vec3::from_fn(|a, _| 0.02 * noise(3 * i + a));
            }
            solid.update_internal_forces(1.0, false);
            let scale: f64 = solid.force.iter().map(|f| f.norm()).sum();
            let sum: Vec3 = solid.force.iter().sum();
            // Small strains are invariant about the reference, corotational ones about the present configuration.
            let arm = |i: usize| if kinematics == Kinematics::Small { solid.reference[i] } else { solid.position(i) };
            let moment: Vec3 = (0..solid.force.len()).map(|i| arm(i).cross(&solid.force[i])).sum();
            assert!(
                sum.norm() < 1e-14 * scale && moment.norm() < 1e-13 * scale,
                "{formulation:?} {kinematics:?}: {:e} {:e}",
                sum.norm() / scale,
                moment.norm() / scale
            );
        }
    }
}
