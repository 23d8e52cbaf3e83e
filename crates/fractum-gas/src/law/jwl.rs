use fractum_math::elementary::exp;
use serde::{Deserialize, Serialize};

use super::{Law, PressureLine};

/// Products of detonation after Jones, Wilkins and Lee:
/// p = A (1 − ω/(R₁ v)) e^(−R₁ v) + B (1 − ω/(R₂ v)) e^(−R₂ v) + ω e/v, with the volume v and the internal energy e per
/// volume of the explosive before it reacts.
///
/// Lee, Hornig and Kury, *Adiabatic expansion of high explosive detonation products*, UCRL-50422 (1968).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Jwl {
    /// A [Pa].
    pub a: f64,
    /// B [Pa].
    pub b: f64,
    /// R₁.
    pub r1: f64,
    /// R₂.
    pub r2: f64,
    /// ω.
    pub omega: f64,
    /// Density of the explosive before it reacts ρ₀ [kg/m³].
    pub density: f64,
    /// Heat capacity c_v [J/(kg K)], for the temperature only.
    pub heat_capacity: f64,
}

impl Jwl {
    /// TNT, with e = 7.0 GJ/m³ at v = 1. Dobratz and Crawford, *LLNL Explosives Handbook*, UCRL-52997 (1985).
    pub const TNT: Jwl =
        Jwl { a: 371.2e9, b: 3.231e9, r1: 4.15, r2: 0.95, omega: 0.30, density: 1630.0, heat_capacity: 1500.0 };

    /// A e^(−R₁ v), B e^(−R₂ v) [Pa].
    fn cold(&self, v: f64) -> [f64; 2] {
        [self.a * exp(-self.r1 * v), self.b * exp(-self.r2 * v)]
    }
}

impl Law for Jwl {
    fn pressure_line(&self, mass: f64, volume: f64) -> PressureLine {
        // Without mass the volume v is infinite: what is left is ω U/V.
        let at_zero = if mass > 0.0 {
            let v = self.density * volume / mass;
            let [a, b] = self.cold(v);
            a * (1.0 - self.omega / (self.r1 * v)) + b * (1.0 - self.omega / (self.r2 * v))
        } else {
            0.0
        };
        PressureLine { at_zero, slope: self.omega / volume }
    }

    fn sound_speed_squared(&self, density: f64, specific_energy: f64) -> f64 {
        // c² = (v²/ρ₀) (p ∂p/∂e − ∂p/∂v), with all powers of v that cancel left out; far out the exponentials are zero.
        let v = (self.density / density).min(1e3);
        let [a, b] = self.cold(v);
        let w = self.omega * (1.0 + self.omega);
        let of = |cold: f64, r: f64| cold * (r * v * v - w / r) / self.density;
        (w * specific_energy + of(a, self.r1) + of(b, self.r2)).max(0.0)
    }

    fn temperature(&self, density: f64, specific_energy: f64) -> f64 {
        let [a, b] = self.cold(self.density / density);
        ((specific_energy - (a / self.r1 + b / self.r2) / self.density) / self.heat_capacity).max(0.0)
    }

    fn contents(&self, _: f64, _: f64, _: f64) -> Option<(f64, f64)> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tnt_at_the_volume_and_energy_of_the_charge_has_its_pressure_of_explosion_at_constant_volume() {
        // A (1 − ω/R₁) e^(−R₁) + B (1 − ω/R₂) e^(−R₂) + ω e by hand: 5.4287 + 0.8550 + 2.1 GPa.
        let p = Jwl::TNT.pressure_line(1630.0, 1.0).at(7e9);
        assert!((p - 8.3837e9).abs() < 0.0002e9, "{p}");
    }
}
