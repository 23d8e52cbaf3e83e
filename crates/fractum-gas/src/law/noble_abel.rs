use serde::{Deserialize, Serialize};

use super::{Law, PressureLine};

/// Part of a volume that is free at least, however much mass is in it: the pressure stays finite while it drives the
/// mass out.
const LEAST_FREE: f64 = 1e-3;

/// Gas whose molecules take room, for dense powder gases: p (V − b m) = m R T, U = m R T/(γ − 1).
///
/// Corner, *Theory of the Interior Ballistics of Guns* (1950), chapter 2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct NobleAbel {
    /// Ratio of heat capacities γ, above 1.
    pub heat_ratio: f64,
    /// Gas constant per mass R [J/(kg K)].
    pub gas_constant: f64,
    /// Covolume b [m³/kg], about 1e-3 for powder gases.
    pub covolume: f64,
}

impl NobleAbel {
    fn free(&self, mass: f64, volume: f64) -> f64 {
        (volume - self.covolume * mass).max(LEAST_FREE * volume)
    }
}

impl Law for NobleAbel {
    fn pressure_line(&self, mass: f64, volume: f64) -> PressureLine {
        PressureLine { at_zero: 0.0, slope: (self.heat_ratio - 1.0) / self.free(mass, volume) }
    }

    fn sound_speed_squared(&self, density: f64, specific_energy: f64) -> f64 {
        let free = self.free(density, 1.0);
        self.heat_ratio * (self.heat_ratio - 1.0) * specific_energy / (free * free)
    }

    fn temperature(&self, _: f64, specific_energy: f64) -> f64 {
        specific_energy * (self.heat_ratio - 1.0) / self.gas_constant
    }

    fn contents(&self, volume: f64, pressure: f64, temperature: f64) -> Option<(f64, f64)> {
        let mass = pressure * volume / (self.gas_constant * temperature + pressure * self.covolume);
        Some((mass, mass * self.gas_constant * temperature / (self.heat_ratio - 1.0)))
    }
}
