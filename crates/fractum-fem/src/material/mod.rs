//! Elasticity, the equivalent stress that drives damage, and softening.

mod criterion;
mod degradation;
mod softening;
mod wave;

#[cfg(test)]
pub(crate) use criterion::KINDS;
pub(crate) use criterion::equivalent_stresses;
pub use criterion::{Criterion, CriterionKind};
pub use degradation::Degradation;
pub use softening::Softening;
pub use wave::{Wave, rayleigh_wave_speed};

use serde::{Deserialize, Serialize};

/// Isotropic linear elasticity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Elastic {
    /// Mass density [kg/m³].
    pub density: f64,
    /// Young's modulus E [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio ν, between -1 and 0.5.
    pub poisson_ratio: f64,
}

impl Elastic {
    /// Lamé's first parameter λ = E ν / ((1 + ν)(1 - 2ν)) [Pa].
    pub fn lame_lambda(&self) -> f64 {
        let (e, nu) = (self.young_modulus, self.poisson_ratio);
        e * nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
    }

    /// Shear modulus μ = E / (2 (1 + ν)) [Pa].
    pub fn shear_modulus(&self) -> f64 {
        self.young_modulus / (2.0 * (1.0 + self.poisson_ratio))
    }

    /// Speed of a compression wave in the bulk, √((λ + 2μ)/ρ) [m/s].
    pub fn p_wave_speed(&self) -> f64 {
        ((self.lame_lambda() + 2.0 * self.shear_modulus()) / self.density).sqrt()
    }

    /// Speed of a shear wave, √(μ/ρ) [m/s].
    pub fn s_wave_speed(&self) -> f64 {
        (self.shear_modulus() / self.density).sqrt()
    }
}

/// How a material breaks: when damage starts, how stress falls with opening, when an edge counts as broken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DamageLaw {
    /// Equivalent stress that drives damage.
    pub criterion: Criterion,
    /// Uniaxial tensile strength f_t [Pa].
    pub tensile_strength: f64,
    /// Energy per crack area G_f [J/m²].
    pub fracture_energy: f64,
    /// Shape of the stress-opening curve.
    pub softening: Softening,
    /// An edge is broken once its residual stress ratio χ falls to this value (0.02).
    pub residual: f64,
    /// Damage acts on the tensile part of the strain only: closed cracks carry compression.
    pub unilateral: bool,
    /// Relaxation time of the damage driving force [s]; 0 is rate-independent.
    pub rate_time: f64,
}

impl DamageLaw {
    /// Rankine's criterion with exponential softening and the default residual.
    ///
    /// - `tensile_strength` [Pa], `fracture_energy` [J/m²]
    pub fn rankine(tensile_strength: f64, fracture_energy: f64) -> Self {
        DamageLaw {
            criterion: Criterion::rankine(),
            tensile_strength,
            fracture_energy,
            softening: Softening::Exponential,
            residual: 0.02,
            unilateral: false,
            rate_time: 0.0,
        }
    }

    /// Length of the process zone: E G_f/f_t² [m].
    ///
    /// - `young_modulus` E [Pa]
    ///
    /// Hillerborg, Modéer and Petersson (1976).
    pub fn process_zone(&self, young_modulus: f64) -> f64 {
        young_modulus * self.fracture_energy / self.tensile_strength.powi(2)
    }
}
