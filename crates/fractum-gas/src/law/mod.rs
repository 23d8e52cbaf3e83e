//! Equations of state, a file per law. A new law is its file, a variant of [`EquationOfState`] and an arm of `law`.

mod explosive;
mod jwl;
mod noble_abel;
mod perfect_gas;

use serde::{Deserialize, Serialize};

pub use explosive::Explosive;
pub use jwl::Jwl;
pub use noble_abel::NobleAbel;
pub use perfect_gas::PerfectGas;

/// Pressure at one mass and volume as a function of internal energy: p = p₀ + s U.
///
/// All laws here are of this form (Mie-Grüneisen), so that the pressure at the end of a step, which does work in that step,
/// has a closed form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressureLine {
    /// Pressure without internal energy p₀ [Pa].
    pub at_zero: f64,
    /// Slope s [Pa/J], ≥ 0.
    pub slope: f64,
}

impl PressureLine {
    /// Pressure at an internal energy [J].
    pub fn at(&self, energy: f64) -> f64 {
        (self.at_zero + self.slope * energy).max(0.0)
    }
}

/// What a law says about a gas.
pub trait Law {
    /// Pressure over internal energy in a volume [m³] that holds a mass [kg].
    fn pressure_line(&self, mass: f64, volume: f64) -> PressureLine;

    /// Square of the speed of sound [m²/s²] at a density [kg/m³] and internal energy per mass [J/kg].
    fn sound_speed_squared(&self, density: f64, specific_energy: f64) -> f64;

    /// Temperature [K].
    fn temperature(&self, density: f64, specific_energy: f64) -> f64;

    /// Mass [kg] and internal energy [J] of a volume [m³] at a pressure [Pa] and temperature [K]; none for a law that does
    /// not define its gas by these.
    fn contents(&self, volume: f64, pressure: f64, temperature: f64) -> Option<(f64, f64)>;
}

/// The law of a gas.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum EquationOfState {
    /// p = (γ − 1) U/V.
    PerfectGas(PerfectGas),
    /// p = (γ − 1) U/(V − b m).
    NobleAbel(NobleAbel),
    /// Jones-Wilkins-Lee, for products of detonation.
    Jwl(Jwl),
}

impl EquationOfState {
    /// The law itself.
    pub fn law(&self) -> &dyn Law {
        match self {
            EquationOfState::PerfectGas(law) => law,
            EquationOfState::NobleAbel(law) => law,
            EquationOfState::Jwl(law) => law,
        }
    }
}
