use serde::{Deserialize, Serialize};

use super::{Law, PressureLine};

/// Perfect gas with constant heat capacity: p V = m R T, U = m R T/(γ − 1).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PerfectGas {
    /// Ratio of heat capacities γ, above 1.
    pub heat_ratio: f64,
    /// Gas constant per mass R [J/(kg K)]: 8.314 J/(mol K) over the molar mass.
    pub gas_constant: f64,
}

impl Law for PerfectGas {
    fn pressure_line(&self, _: f64, volume: f64) -> PressureLine {
        PressureLine { at_zero: 0.0, slope: (self.heat_ratio - 1.0) / volume }
    }

    fn sound_speed_squared(&self, _: f64, specific_energy: f64) -> f64 {
        self.heat_ratio * (self.heat_ratio - 1.0) * specific_energy
    }

    fn temperature(&self, _: f64, specific_energy: f64) -> f64 {
        specific_energy * (self.heat_ratio - 1.0) / self.gas_constant
    }

    fn contents(&self, volume: f64, pressure: f64, temperature: f64) -> Option<(f64, f64)> {
        let mass = pressure * volume / (self.gas_constant * temperature);
        Some((mass, pressure * volume / (self.heat_ratio - 1.0)))
    }
}
