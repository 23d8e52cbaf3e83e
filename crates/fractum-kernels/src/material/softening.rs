use serde::{Deserialize, Serialize};

use crate::elementary::exp;

/// Shape of the stress-opening curve of a cohesive crack; all enclose the fracture energy.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Softening {
    /// χ = exp(A (1 - κ/f_t)), A = 1/(E G_f/(l f_t²) - ½).
    Exponential,
    /// Straight line to the opening 2 G_f/f_t.
    Linear,
    /// Two straight lines: to `stress` f_t at the opening `opening` G_f/f_t, then to zero.
    Bilinear {
        /// Stress at the kink as a fraction of f_t.
        stress: f64,
        /// Opening at the kink as a multiple of G_f/f_t.
        opening: f64,
    },
}

impl Softening {
    /// Petersson's bilinear curve for concrete: kink at f_t/3 and 0.8 G_f/f_t, end at 3.6 G_f/f_t.
    pub const PETERSSON: Softening = Softening::Bilinear { stress: 1.0 / 3.0, opening: 0.8 };

    /// Residual stress ratio χ = σ/f_t at the largest equivalent stress `kappa` ≥ f_t reached so far.
    ///
    /// - `kappa`, `strength` f_t [Pa]; `length` l [m]; `young_modulus` [Pa]; `fracture_energy` [J/m²]
    #[inline]
    pub fn residual_ratio(
        &self,
        kappa: f64,
        strength: f64,
        length: f64,
        young_modulus: f64,
        fracture_energy: f64,
    ) -> f64 {
        let ratio = kappa / strength;
        // Openings and strains in units of the elastic limit strain f_t/E: x = w E/(l f_t).
        let brittleness = young_modulus * fracture_energy / (length * strength * strength);
        let line = |x0: f64, y0: f64, x1: f64, y1: f64| y0 + (y1 - y0) * (ratio - x0) / (x1 - x0);
        match *self {
            Softening::Exponential => exp((1.0 - ratio) / (brittleness - 0.5)),
            Softening::Linear => line(1.0, 1.0, 2.0 * brittleness, 0.0).max(0.0),
            Softening::Bilinear { stress, opening } => {
                let kink = opening * brittleness + stress;
                let end = Self::bilinear_end(stress, opening) * brittleness;
                if ratio < kink { line(1.0, 1.0, kink, stress) } else { line(kink, stress, end, 0.0).max(0.0) }
            }
        }
    }

    /// Part of the fracture energy that is spent at the largest equivalent stress `kappa` ≥ f_t so far, 0 to 1; arguments as of [`Softening::residual_ratio`].
    ///
    /// Damage of a stress κ per volume takes ½ κ²/E dd with d = 1 − χ f_t/κ: over f_t²/E this is ∫ χ dx + ½ (1 − x χ) with x = κ/f_t from 1 on.
    pub fn spent_ratio(&self, kappa: f64, strength: f64, length: f64, young_modulus: f64, fracture_energy: f64) -> f64 {
        let ratio = kappa / strength;
        let brittleness = young_modulus * fracture_energy / (length * strength * strength);
        let left = self.residual_ratio(kappa, strength, length, young_modulus, fracture_energy);
        let below = match *self {
            Softening::Exponential => (brittleness - 0.5) * (1.0 - left),
            Softening::Linear => 0.5 * (1.0 + left) * (ratio.min(2.0 * brittleness) - 1.0),
            Softening::Bilinear { stress, opening } => {
                let kink = opening * brittleness + stress;
                let end = Self::bilinear_end(stress, opening) * brittleness;
                0.5 * (1.0 + left.max(stress)) * (ratio.min(kink) - 1.0)
                    + 0.5 * (stress + left.min(stress)) * (ratio.clamp(kink, end) - kink)
            }
        };
        (below + 0.5 * (1.0 - ratio * left)) / brittleness
    }

    /// Characteristic length above which the curve would snap back [m].
    #[inline]
    pub fn largest_length(&self, young_modulus: f64, strength: f64, fracture_energy: f64) -> f64 {
        let unit = young_modulus * fracture_energy / (strength * strength);
        match *self {
            Softening::Exponential | Softening::Linear => 2.0 * unit,
            Softening::Bilinear { stress, opening } => {
                let second = (Self::bilinear_end(stress, opening) - opening) / stress;
                unit * (opening / (1.0 - stress)).min(second)
            }
        }
    }

    /// Opening at zero stress, in multiples of G_f/f_t, such that the area is G_f.
    #[inline]
    fn bilinear_end(stress: f64, opening: f64) -> f64 {
        (2.0 - opening) / stress
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_spent_is_what_damage_takes() {
        const STEPS: u32 = 200_000;
        let (strength, length, modulus, energy) = (3e6, 0.01, 30e9, 100.0);
        for softening in [Softening::Exponential, Softening::Linear, Softening::PETERSSON] {
            let damage = |kappa: f64| {
                1.0 - softening.residual_ratio(kappa, strength, length, modulus, energy) * strength / kappa
            };
            let (mut taken, mut before) = (0.0, 0.0);
            for step in 1..=STEPS {
                let kappa = strength * (1.0 + 199.0 * f64::from(step) / f64::from(STEPS));
                let now = damage(kappa);
                taken += 0.5 * kappa * kappa / modulus * (now - before) * length / energy;
                before = now;
                if step % 20_000 == 0 {
                    let spent = softening.spent_ratio(kappa, strength, length, modulus, energy);
                    assert!((spent - taken).abs() < 2e-3, "{softening:?} {kappa}: {spent} for {taken}");
                }
            }
            assert!((taken - 1.0).abs() < 0.01, "{softening:?}: {taken}");
        }
    }
}
