use std::f64::consts::TAU;

use fractum_math::elementary::sin_cos;
use fractum_math::{Rotation, Vec3, rotation_between, rotation_by};

use crate::random::Random;

/// Rotations by chance, all as likely: about z by any angle, and then z to any direction.
///
/// - `count`: how many; the first ones are the same for any
pub fn orientations(count: usize, seed: u64) -> Vec<Rotation> {
    let mut random = Random::new(seed);
    let mut draw = || {
        let [about, height, around] = [TAU * random.uniform(), random.between(-1.0, 1.0), TAU * random.uniform()];
        let ((s, c), out) = (sin_cos(around), (1.0 - height * height).sqrt());
        rotation_between(&Vec3::z(), &Vec3::new(out * c, out * s, height)) * rotation_by(Vec3::z() * about)
    };
    (0..count).map(|_| draw()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_math::Mat3;

    #[test]
    fn no_direction_is_preferred() {
        let all = orientations(20_000, 7);
        assert_eq!(all[..5], orientations(5, 7)[..]);
        for axis in [Vec3::x(), Vec3::z()] {
            let turned = || all.iter().map(|turn| turn.transform_vector(&axis));
            let mean = turned().sum::<Vec3>() / all.len() as f64;
            let second = turned().map(|x| x * x.transpose()).sum::<Mat3>() / all.len() as f64;
            assert!(mean.norm() < 0.02, "{mean}");
            assert!((second - Mat3::identity() / 3.0).norm() < 0.02, "{second}");
        }
    }
}
