//! Strength and fracture energy of a material by the rate of strain.

use fractum_kernels::damage::{RateLaw, rate_factor};

/// How a material grows stronger with the rate of strain: rates [1/s], ascending, and the factors there.
#[derive(Clone, Debug, PartialEq)]
pub struct RateCurves {
    /// Factor on the tensile strength.
    pub strength: Vec<[f64; 2]>,
    /// Factor on the compressive strength, and this strength over the tensile one, where the criterion has it.
    pub compression: Option<(Vec<[f64; 2]>, f64)>,
    /// Factor on the fracture energy; 1 without points.
    pub energy: Vec<[f64; 2]>,
}

impl RateCurves {
    /// The law of an edge.
    ///
    /// - `watched`: as [`RateCurves::watched`] finds it
    pub(crate) fn law(&self, watched: f64) -> RateLaw<'_> {
        RateLaw {
            strength: &self.strength,
            compression: self.compression.as_ref().map(|(curve, ratio)| (&curve[..], *ratio)),
            energy: &self.energy,
            watched,
        }
    }

    /// Factor on the tensile strength at a rate of strain [1/s].
    pub fn strength_at(&self, rate: f64) -> f64 {
        rate_factor(&self.strength, rate)
    }

    /// Part of the strength at rest from which on the rate is measured.
    pub(crate) fn watched(&self) -> f64 {
        let compression = self.compression.iter().flat_map(|(curve, _)| curve);
        0.5 * self.strength.iter().chain(compression).map(|point| point[1]).fold(1.0, f64::min)
    }
}
