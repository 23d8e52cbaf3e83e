//! Strain of a set of particles from their displacements.

use fractum_math::{Mat3, Sym3, Vec3};

/// Mean displacement gradient of a set of particles: the affine field that fits their displacements best in the sense
/// of least squares (Cundall; Jebahi et al. 2015, eqs. 1.19–1.29). None when the particles do not span a volume.
pub fn best_fit_gradient(points: impl Iterator<Item = (Vec3, Vec3)> + Clone) -> Option<Mat3> {
    let moments = fit_moments(points.clone().map(|(x, _)| x));
    let mixed = points.fold(Mat3::zeros(), |sum, (x, u)| sum + u * (x - moments.centre).transpose());
    moments.inverse().map(|inverse| mixed * inverse)
}

/// Mean small strain of a set of particles; see [`best_fit_gradient`].
pub fn best_fit(points: impl Iterator<Item = (Vec3, Vec3)> + Clone) -> Option<Sym3> {
    best_fit_gradient(points).map(|gradient| Sym3::symmetric_part(&gradient))
}

/// Stretch less the identity, U − I with F = I + H = R U, for a displacement gradient H: the small strain where that is small, and
/// nothing for a rotation.
pub fn small_part_of_stretch(gradient: &Mat3) -> Sym3 {
    let green = (gradient + gradient.transpose() + gradient.transpose() * gradient) * 0.5;
    let eigen = green.symmetric_eigen();
    // √(1 + 2λ) − 1 without the loss of digits.
    let stretch = eigen.eigenvalues.map(|value| 2.0 * value / ((1.0 + 2.0 * value).max(0.0).sqrt() + 1.0));
    let axes = eigen.eigenvectors;
    Sym3::symmetric_part(&(axes * Mat3::from_diagonal(&stretch) * axes.transpose()))
}

/// Second moments of points about their centre.
pub(super) struct Moments {
    pub(super) centre: Vec3,
    sum: Mat3,
}

/// Share of the largest moment below which points lie in a plane.
const FLAT: f64 = 1e-12;

pub(super) fn fit_moments(points: impl Iterator<Item = Vec3> + Clone) -> Moments {
    let (count, sum) = points.clone().fold((0.0, Vec3::zeros()), |(count, sum), x| (count + 1.0, sum + x));
    let centre = sum / count;
    let outer = |sum: Mat3, x: Vec3| sum + (x - centre) * (x - centre).transpose();
    Moments { centre, sum: points.fold(Mat3::zeros(), outer) }
}

impl Moments {
    /// None where points do not span a volume.
    fn inverse(&self) -> Option<Mat3> {
        let size = self.sum.trace();
        (self.sum / size).try_inverse().map(|inverse| inverse / size)
    }

    /// The inverse, in the plane of points that do not leave one, with the direction across that; none for points on a line.
    pub(super) fn inverse_in_plane(&self) -> Option<(Mat3, Option<Vec3>)> {
        let eigen = self.sum.symmetric_eigen();
        let largest = eigen.eigenvalues.max();
        let flat: Vec<usize> =
            (0..3).filter(|&k| eigen.eigenvalues[k].is_nan() || eigen.eigenvalues[k] <= FLAT * largest).collect();
        match flat[..] {
            [] => self.inverse().map(|inverse| (inverse, None)),
            [across] => {
                let column = |k: usize| eigen.eigenvectors.column(k).into_owned();
                let share = |k: usize| column(k) * column(k).transpose() / eigen.eigenvalues[k];
                Some(((0..3).filter(|&k| k != across).map(share).sum(), Some(column(across))))
            }
            _ => None,
        }
    }
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
