//! Equations of state, a file per law. A new law is its file, a variant of [`EquationOfState`] and an arm of `law`.

mod jwl;
mod noble_abel;
mod perfect_gas;

use serde::{Deserialize, Serialize};

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

#[cfg(test)]
mod tests {
    use super::*;

    /// Densities [kg/m³] and internal energies per mass [J/kg] that suit each law.
    fn table() -> Vec<(EquationOfState, Vec<(f64, f64)>)> {
        let perfect = PerfectGas { heat_ratio: 1.3, gas_constant: 300.0 };
        let dense = NobleAbel { heat_ratio: 1.25, gas_constant: 320.0, covolume: 8e-4 };
        let gas = vec![(1.2, 2e5), (30.0, 1e6), (300.0, 3e6)];
        let products = vec![(1630.0, 4.3e6), (800.0, 3e6), (50.0, 1.5e6), (1.0, 1e6)];
        vec![
            (EquationOfState::PerfectGas(perfect), gas.clone()),
            (EquationOfState::NobleAbel(dense), gas),
            (EquationOfState::Jwl(Jwl::TNT), products),
        ]
    }

    fn pressure(law: &dyn Law, density: f64, energy: f64) -> f64 {
        law.pressure_line(density, 1.0).at(energy * density)
    }

    #[test]
    fn pressure_is_extensive_and_positive() {
        for (state, points) in table() {
            let law = state.law();
            for (density, energy) in points {
                let p = pressure(law, density, energy);
                let other = law.pressure_line(density * 3e-6, 3e-6).at(energy * density * 3e-6);
                assert!(p > 0.0 && (other / p - 1.0).abs() < 1e-12, "{state:?} {density}");
                assert!(law.temperature(density, energy) > 0.0);
            }
        }
    }

    #[test]
    fn sound_speed_is_the_slope_of_pressure_over_density_without_exchange_of_heat() {
        for (state, points) in table() {
            let law = state.law();
            for (density, energy) in points {
                // Along an isentrope du = p dρ/ρ².
                let d = 1e-5 * density;
                let p = pressure(law, density, energy);
                let at = |d: f64| pressure(law, density + d, energy + p * d / (density * density));
                // The second derivative of the path drops out of the central difference.
                let slope = (at(d) - at(-d)) / (2.0 * d);
                let square = law.sound_speed_squared(density, energy);
                assert!((slope / square - 1.0).abs() < 1e-6, "{state:?} {density}: {slope} {square}");
            }
        }
    }

    #[test]
    fn contents_give_back_pressure_and_temperature() {
        for (state, _) in table() {
            let law = state.law();
            let Some((mass, energy)) = law.contents(2e-3, 4e7, 2500.0) else { continue };
            assert!((law.pressure_line(mass, 2e-3).at(energy) / 4e7 - 1.0).abs() < 1e-12);
            assert!((law.temperature(mass / 2e-3, energy / mass) / 2500.0 - 1.0).abs() < 1e-12);
        }
    }
}
