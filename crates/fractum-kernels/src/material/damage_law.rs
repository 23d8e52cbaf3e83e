use serde::{Deserialize, Serialize};

use super::{Criterion, Softening};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

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
    /// Coefficient of friction of closed cracks, 0 to below 1; none where damage acts on compression as on tension, or cracks close `unilateral`.
    pub friction: Option<f64>,
    /// Relaxation time of the damage driving force [s]; 0 is rate-independent.
    pub rate_time: f64,
    /// Strength of the planes of beds, where rock is weaker along them.
    pub beds: Option<BedStrength>,
}

/// Strength of the planes of beds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BedStrength {
    /// Tensile strength across them f_b, at most that of the rock [Pa].
    pub tensile_strength: f64,
    /// Cohesion along them c_b, at least f_b tan φ [Pa].
    pub cohesion: f64,
    /// Angle of friction φ [rad].
    pub friction_angle: f64,
    /// Energy per area of a crack that parts them [J/m²].
    pub fracture_energy: f64,
}

/// How much too high the load of a crack comes out under local damage, over the size of the elements at its tip in lengths of [`crack_scale`]: on average over
/// irregular meshes, and at most (`cases/crack-size`, against exact cohesive cracks). Standard elements are off by as much either way.
pub const EXCESS_OF_PEAK: [f64; 2] = [0.65, 1.9];

/// Length beside which elements at a crack are large or small: process zone and smallest extent of the body in series [m].
pub fn crack_scale(process_zone: f64, extent: f64) -> f64 {
    1.0 / (1.0 / process_zone + 1.0 / extent)
}

impl BedStrength {
    /// Length of the process zone of a crack that parts the beds [m].
    ///
    /// - `young_modulus`: of a pull along their normal [Pa]
    pub fn process_zone(&self, young_modulus: f64) -> f64 {
        young_modulus * self.fracture_energy / self.tensile_strength.powi(2)
    }
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
            friction: None,
            rate_time: 0.0,
            beds: None,
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
