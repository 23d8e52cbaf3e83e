//! Strain of a set of particles from their displacements.

use fractum_math::{Mat3, Sym3, Vec3};

/// Mean displacement gradient of a set of particles: the affine field that fits their displacements best in the sense
/// of least squares (Cundall; Jebahi et al. 2015, eqs. 1.19–1.29). None when the particles do not span a volume.
pub fn best_fit_gradient(points: impl Iterator<Item = (Vec3, Vec3)> + Clone) -> Option<Mat3> {
    let count = points.clone().count() as f64;
    let (x0, u0) = points.clone().fold((Vec3::zeros(), Vec3::zeros()), |(a, b), (x, u)| (a + x, b + u));
    let (x0, u0) = (x0 / count, u0 / count);
    let (mut moments, mut mixed) = (Mat3::zeros(), Mat3::zeros());
    for (x, u) in points {
        let d = x - x0;
        moments += d * d.transpose();
        mixed += (u - u0) * d.transpose();
    }
    let size = moments.trace();
    (moments / size).try_inverse().map(|inverse| mixed * inverse / size)
}

/// Mean small strain of a set of particles; see [`best_fit_gradient`].
pub fn best_fit(points: impl Iterator<Item = (Vec3, Vec3)> + Clone) -> Option<Sym3> {
    best_fit_gradient(points).map(|gradient| Sym3::symmetric_part(&gradient))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_affine_field_is_recovered_exactly() {
        let gradient = Mat3::new(1.0, 2.0, 3.0, -4.0, 5.0, 6.0, 7.0, 8.0, -9.0) * 1e-3;
        let point = |i: i32| Vec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i * i % 7) as f64);
        let points = (0..27).map(|i| (point(i), gradient * point(i) + Vec3::new(5.0, 6.0, 7.0)));
        assert!((best_fit_gradient(points).unwrap() - gradient).norm() < 1e-13);
    }

    #[test]
    fn flat_sets_have_no_strain() {
        let flat = (0..9).map(|i| (Vec3::new((i % 3) as f64, (i / 3) as f64, 0.0), Vec3::zeros()));
        assert!(best_fit(flat).is_none());
    }
}
