//! Materials: elasticity, damage, contact.

use fractum_fem::{BedStrength, Bedding, CriterionKind, DamageLaw, RateCurves, Regularisation};
use fractum_scene::ContactParameters;

use super::{BondFailure, Bonds, Interfaces, Scatter, Thermal};
use crate::Spanned;
use crate::choice::choice;

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
    /// Beds, where the material has a `bedding` table.
    pub bedding: Option<Spanned<Beds>>,
    /// Damage, where the material has a `damage` table.
    pub damage: Option<Spanned<Damage>>,
    /// Beams of bonded bodies, where the material has a `bonds` table; found by calibration otherwise.
    pub bonds: Option<Spanned<Bonds>>,
    /// Interfaces of bonded bodies, where the material has an `interface` table.
    pub interfaces: Option<Spanned<Interfaces>>,
    /// When bonds break, where the material has a `fracture` table; they hold otherwise.
    pub fracture: Option<Spanned<BondFailure>>,
    /// What it is to heat.
    pub thermal: Option<Spanned<Thermal>>,
    /// Contact of the discrete elements that this material leaves behind.
    pub contact: ContactParameters,
    /// Young's modulus that contacts of its particles take [Pa], > 0; `None` = that of the material.
    pub contact_modulus: Option<f64>,
    /// Work of adhesion between two of its loose particles [J/m²].
    pub work_of_adhesion: f64,
}

impl Material {
    /// Length of its process zone, of its beds where theirs is shorter [m]; none where it does not crack.
    pub fn process_zone(&self) -> Option<f64> {
        let of_rock = self.damage.as_ref()?.value.law.process_zone(self.young_modulus);
        let beds = self.bedding.as_ref().map(|beds| &beds.value);
        let of_beds = beds.and_then(|beds| Some(beds.strength?.process_zone(beds.law.young_modulus)));
        Some(of_beds.map_or(of_rock, |of_beds| of_beds.min(of_rock)))
    }
}

/// Bedding of a material.
#[derive(Debug, Clone, PartialEq)]
pub struct Beds {
    /// Normal of the beds, and elasticity along it.
    pub law: Bedding,
    /// Strength of their planes, where rock is weaker along them.
    pub strength: Option<BedStrength>,
    /// Whether the normal comes from dip and dip direction.
    pub by_dip: bool,
    /// Whether the shear modulus is Saint-Venant's estimate.
    pub is_estimated: bool,
}

/// Softening damage.
#[derive(Debug, Clone, PartialEq)]
pub struct Damage {
    /// When damage begins, and how stress falls with crack opening; the scene settles whether it is unilateral.
    pub law: DamageLaw,
    /// Whether stiffness recovers where cracks close; by the scene if absent.
    pub unilateral: Option<bool>,
    /// Random scatter of the strength.
    pub scatter: Option<Scatter>,
    /// Lower the strength where an element is too large for its fracture energy, instead of refusing it.
    pub reduce_strength_to_fit: bool,
    /// Damage as a phase field.
    pub regularisation: Option<Regularisation>,
    /// Strength and fracture energy by the rate of strain.
    pub rate: Option<Spanned<RateCurves>>,
}

choice!(CriterionKind {
    "rankine" => Rankine, "mohr-coulomb" => MohrCoulomb, "drucker-prager" => DruckerPrager, "mazars" => Mazars,
    "modified-mohr-coulomb" => ModifiedMohrCoulomb,
});
