//! Spheres that come one after another: their sizes, and places for them in a region.

use fractum_math::{Vec3, sphere_volume};

use crate::grading::Grading;
use crate::insertion::room_for;
use crate::random::Random;

/// Points that are drawn for a place before a region has no room for a sphere.
const DRAWS: usize = 1000;

/// Sizes of spheres, by their number.
#[derive(Clone, Debug, PartialEq)]
pub enum Sizes {
    /// Radii scattered uniformly.
    Uniform {
        /// Mean radius [m], > 0.
        radius: f64,
        /// (largest - smallest)/mean, 0 to 1.
        dispersion: f64,
    },
    /// A sieve curve or a law.
    Graded(Grading),
}

impl Sizes {
    /// Largest radius [m].
    pub fn largest(&self) -> f64 {
        match self {
            Sizes::Uniform { radius, dispersion } => radius * (1.0 + 0.5 * dispersion),
            Sizes::Graded(grading) => 0.5 * grading.limits()[1],
        }
    }

    /// Mean volume of a sphere [m³].
    pub fn mean_volume(&self) -> f64 {
        match self {
            // The mean of r³ over radii r (1 - κ/2) to r (1 + κ/2).
            Sizes::Uniform { radius, dispersion } => sphere_volume(*radius) * (1.0 + 0.25 * dispersion * dispersion),
            Sizes::Graded(grading) => grading.mean_volume(),
        }
    }

    /// Radii without end, each by chance [m].
    pub fn radii(&self, seed: u64) -> impl Iterator<Item = f64> + '_ {
        let mut random = Random::new(seed);
        std::iter::repeat_with(move || match self {
            Sizes::Uniform { radius, dispersion } => {
                random.between(radius * (1.0 - 0.5 * dispersion), radius * (1.0 + 0.5 * dispersion))
            }
            Sizes::Graded(grading) => 0.5 * grading.at_number(random.uniform()),
        })
    }
}

/// A random place for a sphere within a region, every point alike; none where a thousand points are outside.
///
/// - `lower`, `upper` [m]: box around the region; `depth`: distance of a point from its wall [m], positive inside
/// - `number`: of the place in the series of the seed
pub fn place_in(
    lower: &Vec3,
    upper: &Vec3,
    depth: impl Fn(&Vec3) -> f64,
    radius: f64,
    (seed, number): (u64, u64),
) -> Option<Vec3> {
    let (inset, room) = room_for(lower, upper, radius)?;
    // Odd, so that no two numbers of a seed have the same stream.
    let mut random = Random::new(seed ^ number.wrapping_mul(0xD134_2543_DE82_EF95));
    let mut place = || lower + Vec3::from_fn(|axis, _| inset[axis] + room[axis] * random.uniform());
    (0..DRAWS).map(|_| place()).find(|x| depth(x) >= radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radii_that_come_have_the_mean_volume_that_is_told() {
        let sieves = Grading::sieves(vec![[0.5e-3, 0.0], [1e-3, 0.3], [2e-3, 1.0]]);
        for sizes in [Sizes::Uniform { radius: 1e-3, dispersion: 0.8 }, Sizes::Graded(sieves)] {
            let mean = sizes.radii(1).take(40_000).map(sphere_volume).sum::<f64>() / 40_000.0;
            assert!((mean / sizes.mean_volume() - 1.0).abs() < 0.02, "{}", mean / sizes.mean_volume());
            assert!(sizes.radii(2).take(1000).all(|radius| radius <= sizes.largest() * (1.0 + 1e-12)));
        }
    }

    #[test]
    fn places_fill_the_region_evenly_and_are_the_same_again() {
        let (lower, upper) = (Vec3::repeat(-1.0), Vec3::repeat(1.0));
        let ball = |x: &Vec3| 1.0 - x.norm();
        let at = |number| place_in(&lower, &upper, ball, 0.1, (7, number)).unwrap();
        let inner = (0..20_000).filter(|&number| at(number).norm() < 0.45).count() as f64 / 20_000.0;
        assert!((inner - 0.125).abs() < 0.01, "{inner}");
        assert_eq!(at(5), at(5));
        assert!(place_in(&lower, &upper, ball, 1.1, (1, 0)).is_none());
        assert!(place_in(&lower, &upper, |_| -1.0, 0.1, (1, 0)).is_none());
    }
}
