//! Materials: elasticity, damage, contact.

use fractum_scene::Surface;

use super::{BondFailure, Bonds};
use crate::case::Spanned;
use crate::case::choice::choice;

/// A material of the case.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// Name in `[materials.NAME]`.
    pub name: Spanned<String>,
    /// Mass density [kg/m³], > 0.
    pub density: f64,
    /// Young's modulus [Pa], > 0.
    pub young_modulus: f64,
    /// Poisson's ratio [-], between -1 and 0.5, both excluded.
    pub poisson_ratio: f64,
    /// Damage, where the material has a `damage` table.
    pub damage: Option<Spanned<Damage>>,
    /// Beams of bonded bodies, where the material has a `bonds` table; found by calibration otherwise.
    pub bonds: Option<Spanned<Bonds>>,
    /// When bonds break, where the material has a `fracture` table; they hold otherwise.
    pub fracture: Option<Spanned<BondFailure>>,
    /// Contact of the discrete elements that this material leaves behind.
    pub contact: Surface,
    /// Young's modulus that contacts of its particles take [Pa], > 0; `None` = that of the material.
    pub contact_modulus: Option<f64>,
}

/// Softening damage.
#[derive(Debug, Clone, PartialEq)]
pub struct Damage {
    /// Equivalent stress that damage answers to.
    pub criterion: Criterion,
    /// Uniaxial tensile strength [Pa], > 0.
    pub tensile_strength: f64,
    /// Energy per area of a full crack [J/m²], > 0.
    pub fracture_energy: f64,
    /// Uniaxial compressive strength [Pa], above the tensile one, with Mohr-Coulomb by (1 + sin φ)/(1 - sin φ) or more;
    /// 10 times the tensile one where not given.
    pub compressive_strength: f64,
    /// Friction angle [rad], within 0..π/2; 35° where not given.
    pub friction_angle: f64,
    /// Stress against crack opening.
    pub softening: Softening,
    /// Ratio of residual stress to strength at which an edge counts as broken [-].
    pub residual: f64,
    /// Random scatter of the strength.
    pub scatter: Option<Scatter>,
    /// Lower the strength where an element is too large for its fracture energy, instead of refusing it.
    pub reduce_strength_to_fit: bool,
    /// Near a crack, damage begins only where the plane of the crack goes on.
    pub crack_plane_gate: bool,
    /// Stiffness recovers in compression.
    pub unilateral: bool,
    /// Time constant of the damage-rate limiter [s]; 0 = off.
    pub rate_time: f64,
}

/// Equivalent stress of the damage law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Largest principal stress.
    Rankine,
    /// Mohr-Coulomb with the largest principal stress as tension cut-off.
    MohrCoulomb,
    /// Mohr-Coulomb alone (`tension_cutoff = false`), scaled to the tensile strength.
    MohrCoulombPure,
    /// Drucker-Prager through both uniaxial strengths.
    DruckerPrager,
    /// Mazars' equivalent strain, times Young's modulus.
    Mazars,
    /// Modified Mohr-Coulomb (Oller).
    ModifiedMohrCoulomb,
}

impl Criterion {
    /// Whether the friction angle enters.
    pub fn uses_friction_angle(self) -> bool {
        matches!(self, Self::MohrCoulomb | Self::MohrCoulombPure | Self::ModifiedMohrCoulomb)
    }

    /// Whether the compressive strength enters.
    pub fn uses_compressive_strength(self) -> bool {
        matches!(self, Self::MohrCoulomb | Self::DruckerPrager | Self::ModifiedMohrCoulomb)
    }
}

choice!(Criterion {
    "rankine" => Rankine, "mohr-coulomb" => MohrCoulomb, "drucker-prager" => DruckerPrager, "mazars" => Mazars,
    "modified-mohr-coulomb" => ModifiedMohrCoulomb,
});

/// Decrease of stress with crack opening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Softening {
    /// Exponential.
    Exponential,
    /// Linear to zero at the opening 2 Gf/ft.
    Linear,
    /// Two straight lines; the last opening is 2 Gf / (ft (kink_stress + kink_opening)).
    Bilinear {
        /// Stress at the kink over tensile strength [-], within 0..1; 1/3 after Petersson (1981).
        kink_stress: f64,
        /// Opening at the kink over the last opening [-], within 0..1; 2/9 after Petersson (1981).
        kink_opening: f64,
    },
}

/// Random scatter of the tensile strength, drawn per edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scatter {
    /// Distribution of the factor on the strength.
    pub distribution: Distribution,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Distribution of a factor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// Weibull with this modulus m > 0; the strength given is its scale (63 % of edges are weaker).
    Weibull {
        /// Weibull modulus [-], > 0.
        modulus: f64,
    },
    /// Uniform between 1 - width and 1 + width.
    Uniform {
        /// Half width [-], within 0..1.
        width: f64,
    },
}
