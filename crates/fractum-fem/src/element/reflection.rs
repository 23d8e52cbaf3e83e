//! Rotations of cells turned inside out.

use fractum_math::{Mat3, Sym3, Vec3};

/// Rotation of F = Q H where Q is a reflection: the smallest stretch counts as negative, so that strain and energy go on without a
/// jump as a cell passes through the flat state (Irving, Teran and Fedkiw 2004, section 4).
///
/// A cell in the xy-plane, which keeps its thickness, is turned over within that plane.
pub(crate) fn without_reflection(q: &Mat3, f: &Mat3) -> Mat3 {
    let (stretches, directions) = Sym3::symmetric_part(&(q.transpose() * f)).eigen();
    let in_plane = f.row(2) == Mat3::identity().row(2) && f.column(2) == Mat3::identity().column(2);
    let may_turn = |&i: &usize| !in_plane || directions[(2, i)].abs() < 0.5;
    let smallest = (0..3).filter(may_turn).min_by(|&a, &b| stretches[a].total_cmp(&stretches[b]));
    let axis = smallest.map_or_else(Vec3::zeros, |i| directions.column(i).into_owned());
    q * (Mat3::identity() - axis * axis.transpose() * 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::polar::corotational_strain;

    /// Strain energy of a cell whose λ and μ are 1, and its derivative by F, R σ.
    fn energy(f: &Mat3) -> (f64, Mat3) {
        let (strain, rotation) = corotational_strain(&(f - Mat3::identity()));
        let stress = strain * 2.0 + Sym3::isotropic(strain.trace());
        (0.5 * stress.dot(strain), rotation * stress.to_matrix())
    }

    #[test]
    fn a_cell_goes_through_the_flat_state_without_a_jump() {
        let turned = Mat3::new(0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6);
        let shear = Mat3::new(0.0, 0.3, 0.1, 0.0, 0.1, 0.2, 0.0, 0.0, -0.2);
        let in_space = |d: f64| turned * (Mat3::from_diagonal(&Vec3::new(d, 1.0, 1.0)) + shear);
        let in_plane = |d: f64| Mat3::new(0.8 * d, -1.8, 0.0, 0.6 * d, 2.4, 0.0, 0.0, 0.0, 1.0);
        for path in [&in_space as &dyn Fn(f64) -> Mat3, &in_plane] {
            let (before, after) = (energy(&path(1e-7)), energy(&path(-1e-7)));
            assert!((before.0 - after.0).abs() < 1e-5 && (before.1 - after.1).norm() < 1e-5, "{before:?} {after:?}");
            for d in [0.3, -0.05, -0.3] {
                let (step, f) = (1e-6, path(d));
                let change = path(d + step) - path(d - step);
                let work = energy(&f).1.component_mul(&change).sum();
                let gained = energy(&(f + change * 0.5)).0 - energy(&(f - change * 0.5)).0;
                assert!((work - gained).abs() < 1e-9, "{d}: {work:e} {gained:e}");
            }
        }
        // Neither the thickness nor the plane of a plane cell changes.
        let (strain, rotation) = corotational_strain(&(in_plane(-0.3) - Mat3::identity()));
        assert_eq!((strain.0[2], rotation[(2, 2)]), (0.0, 1.0));
    }
}
