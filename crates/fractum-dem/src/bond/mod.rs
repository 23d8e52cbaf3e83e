//! Laws of the bonds that join particles.

mod cohesive_beam;
mod lanes;
mod network;

pub use cohesive_beam::{BeamEnergy, BeamForces, BondedPair, cohesive_beam, cohesive_beam_energy};
pub use network::BeamNetwork;

use serde::{Deserialize, Serialize};

use crate::DemError;

/// The beam that makes a bond: one circular section for all bonds of a body.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeamSection {
    /// Young's modulus of the beam E_m [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio of the beam; it only sets the torsional stiffness and hardly matters (0.3 by convention).
    pub poisson_ratio: f64,
    /// Radius r = r_m R_mean [m].
    pub radius: f64,
}

impl BeamSection {
    /// A section with the conventional Poisson's ratio 0.3.
    ///
    /// # Errors
    /// [`DemError::BadSection`] unless both numbers are positive and finite.
    pub fn new(young_modulus: f64, radius: f64) -> Result<Self, DemError> {
        let section = BeamSection { young_modulus, poisson_ratio: 0.3, radius };
        section.check()?;
        Ok(section)
    }

    /// Refuses numbers that make no beam.
    ///
    /// # Errors
    /// [`DemError::BadSection`].
    pub fn check(&self) -> Result<(), DemError> {
        let positive = |v: f64| v.is_finite() && v > 0.0;
        if positive(self.young_modulus)
            && positive(self.radius)
            && self.poisson_ratio > -1.0
            && self.poisson_ratio <= 0.5
        {
            Ok(())
        } else {
            Err(DemError::BadSection(*self))
        }
    }

    /// E S [N], with S = π r².
    #[inline]
    pub fn axial(&self) -> f64 {
        self.young_modulus * std::f64::consts::PI * self.radius.powi(2)
    }

    /// E I [N m²], with I = π r⁴/4.
    #[inline]
    pub fn bending(&self) -> f64 {
        self.young_modulus * std::f64::consts::PI * self.radius.powi(4) / 4.0
    }

    /// G I₀ [N m²], with I₀ = 2 I and G = E/(2(1 + ν)).
    #[inline]
    pub fn torsion(&self) -> f64 {
        self.bending() / (1.0 + self.poisson_ratio)
    }
}
