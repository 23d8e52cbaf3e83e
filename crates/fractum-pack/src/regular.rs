//! Spheres of one size in a regular arrangement, as the counterpart of random packings.

use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::domain::Domain;
use crate::error::PackError;
use crate::packing::{Compaction, Packing};

/// How the particles of a packing lie.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Arrangement {
    /// At random, close-packed.
    #[default]
    Random,
    /// On a cubic grid: six neighbours each.
    Cartesian,
    /// In hexagonal close packing, layers normal to z and rows along x: twelve neighbours each.
    Staggered,
}

impl Arrangement {
    /// Neighbours of an interior particle; none of random packings.
    pub fn neighbours(self) -> Option<f64> {
        match self {
            Arrangement::Random => None,
            Arrangement::Cartesian => Some(6.0),
            Arrangement::Staggered => Some(12.0),
        }
    }

    /// Volume of the particles over that of their cells; none of random packings.
    pub fn fraction(self) -> Option<f64> {
        use std::f64::consts::{PI, SQRT_2};
        match self {
            Arrangement::Random => None,
            Arrangement::Cartesian => Some(PI / 6.0),
            Arrangement::Staggered => Some(PI / (3.0 * SQRT_2)),
        }
    }
}

/// Fills a box with touching spheres of one radius from its lower corner, as many as there is room for.
///
/// - `arrangement`: random ones are made by [`crate::pack`], and come out as Cartesian here
/// - the domain of the result is the box that the cells of the particles fill
///
/// # Errors
/// [`PackError::TooSmall`] and [`PackError::Count`] for a box that holds fewer than two particles along an axis, fewer than 20, or
/// more than 20 million.
pub fn regular(lower: Vec3, upper: Vec3, radius: f64, arrangement: Arrangement) -> Result<Packing, PackError> {
    let staggered = arrangement == Arrangement::Staggered;
    // Height of an equilateral triangle and of a regular tetrahedron of unit edge.
    let steps = if staggered { [1.0, 0.75f64.sqrt(), (2.0f64 / 3.0).sqrt()] } else { [1.0; 3] };
    let step = Vec3::from(steps) * (2.0 * radius);
    let size = upper - lower;
    let counts = [0, 1, 2].map(|a| (size[a] / step[a] * (1.0 + 1e-9)).floor());
    let total = counts.iter().product::<f64>();
    if counts.iter().any(|n| *n < 2.0) {
        let (extent, across) = (size.min(), size.min() / (2.0 * radius));
        return Err(PackError::TooSmall { count: total as usize, extent, across, needed: 2.0 });
    }
    if !(20.0..=2e7).contains(&total) {
        return Err(PackError::Count(total as usize));
    }
    let counts = counts.map(|n| n as usize);
    let mut walls: Vec<(String, Vec<u32>)> =
        Domain::BOX_WALLS.iter().map(|name| ((*name).to_owned(), Vec::new())).collect();
    let mut position = Vec::with_capacity(total as usize);
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let index = position.len() as u32;
                for (axis, at) in [i, j, k].into_iter().enumerate() {
                    if at == 0 {
                        walls[2 * axis].1.push(index);
                    }
                    if at + 1 == counts[axis] {
                        walls[2 * axis + 1].1.push(index);
                    }
                }
                // Rows and layers lie in the gaps of those before, to both sides of the middle of their cells.
                let row = if (j + k) % 2 == 0 { -0.25 } else { 0.25 };
                let layer = if k % 2 == 0 { -1.0 / 6.0 } else { 1.0 / 6.0 };
                let shift = if staggered { Vec3::new(row, layer, 0.0) } else { Vec3::zeros() };
                let cell = Vec3::new(i as f64 + 0.5, j as f64 + 0.5, k as f64 + 0.5) + shift;
                position.push(lower + cell.component_mul(&step));
            }
        }
    }
    let upper = lower + step.component_mul(&Vec3::from(counts.map(|n| n as f64)));
    let (count, domain) = (position.len(), Domain::Box { lower, upper });
    let coordination = arrangement.neighbours().unwrap_or_default();
    let contacts = (coordination * count as f64 / 2.0) as usize;
    let compaction = Compaction { coordination, overlap: 0.0, contacts, rattlers: 0, iterations: 0 };
    Ok(Packing { domain, seed: 0, dispersion: 0.0, position, radius: vec![radius; count], walls, compaction })
}

/// [`regular`] in a box that repeats, which the arrangement must fill: without walls.
///
/// # Errors
/// Those of [`regular`]; [`PackError::Refused`] for a box of other edges than whole cells, of which rows and layers come in pairs.
pub fn regular_repeating(
    lower: Vec3,
    upper: Vec3,
    radius: f64,
    arrangement: Arrangement,
) -> Result<Packing, PackError> {
    let made = regular(lower, upper, radius, arrangement)?;
    let (_, filled) = made.domain.bounds();
    let step = (filled - lower).component_div(&Vec3::repeat(2.0 * radius));
    let even = |axis: usize, height: f64| ((step[axis] / height).round() as u64).is_multiple_of(2);
    let pairs = arrangement != Arrangement::Staggered || even(1, 0.75f64.sqrt()) && even(2, (2.0f64 / 3.0).sqrt());
    if (upper - filled).amax() > WHOLE * radius || !pairs {
        let size = (upper - lower) / (2.0 * radius);
        return Err(PackError::Refused {
            target: "a periodic box of whole cells of the arrangement".into(),
            reached: format!("edges of {:.6}, {:.6} and {:.6} diameters", size.x, size.y, size.z),
            remedy: "edges of 2 r times whole numbers; staggered: √3 r times an even number along y, √(8/3) r times one along z",
        });
    }
    let domain = Domain::Periodic { lower, upper };
    Ok(Packing { domain, walls: Vec::new(), ..made })
}

/// Part of a radius that is rounding of edges.
const WHOLE: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Convention, bond};

    #[test]
    fn interior_particles_touch_as_many_as_they_should_and_fill_what_they_should() {
        for arrangement in [Arrangement::Cartesian, Arrangement::Staggered] {
            let packing = regular(Vec3::zeros(), Vec3::repeat(1.0), 0.05, arrangement).unwrap();
            let network = bond(&packing, arrangement.neighbours().unwrap(), Convention::Interior).unwrap();
            assert_eq!(Some(network.coordination_interior), arrangement.neighbours());
            for pair in &network.pairs {
                let [a, b] = pair.map(|i| packing.position[i as usize]);
                assert!(((a - b).norm() / 0.1 - 1.0).abs() < 1e-12);
            }
            let filled = packing.sphere_volume() / packing.domain.volume();
            assert!((filled / arrangement.fraction().unwrap() - 1.0).abs() < 1e-12, "{arrangement:?}: {filled}");
        }
        let layers = Vec3::new(1.0, 0.6 * 3f64.sqrt(), 0.6 * (8.0f64 / 3.0).sqrt());
        let boxes = [(Arrangement::Cartesian, Vec3::repeat(1.0)), (Arrangement::Staggered, layers)];
        for (arrangement, size) in boxes {
            let packing = regular_repeating(Vec3::zeros(), size, 0.05, arrangement).unwrap();
            let network = bond(&packing, arrangement.neighbours().unwrap(), Convention::All).unwrap();
            assert_eq!(Some(network.coordination_all), arrangement.neighbours());
            for pair in &network.pairs {
                assert!((packing.apart(pair.map(|i| i as usize)).norm() / 0.1 - 1.0).abs() < 1e-9);
            }
            assert!(regular_repeating(Vec3::zeros(), size * 1.01, 0.05, arrangement).is_err());
        }
        assert!(regular(Vec3::zeros(), Vec3::new(1.0, 1.0, 0.15), 0.05, Arrangement::Cartesian).is_err());
    }
}
