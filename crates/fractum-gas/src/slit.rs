use fractum_math::elementary::{log10, pow};
use serde::{Deserialize, Serialize};

/// Largest wall roughness over hydraulic diameter: asperities as high as half the opening on both walls.
const ROUGHEST: f64 = 0.5;

/// Walls of narrow slits, and the gas between them as a fluid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SlitFlow {
    /// Dynamic viscosity μ [Pa s], above 0.
    pub viscosity: f64,
    /// Height of the asperities of the walls ε [m]; 0 for smooth walls, which have laminar friction only.
    pub roughness: f64,
}

/// A slit between two cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Cells at its ends; [`Passage::OUTSIDE`] as the second one for a way to the outside.
    pub cells: [u32; 2],
    /// Length along the flow L [m].
    pub length: f64,
    /// Width across the flow, in the plane of the slit [m].
    pub width: f64,
    /// Distance between the walls w [m].
    pub opening: f64,
}

impl Passage {
    /// What is not a cell.
    pub const OUTSIDE: u32 = u32::MAX;
}

/// Gas at the end of a passage from which it flows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Upstream {
    /// Pressure [Pa].
    pub pressure: f64,
    /// Density ρ [kg/m³].
    pub density: f64,
    /// Speed of sound [m/s].
    pub sound_speed: f64,
}

impl SlitFlow {
    /// Mass flow over pressure difference [kg/(s Pa)], for a pressure `drop` ≥ 0 [Pa].
    ///
    /// Friction of Darcy and Weisbach, Δp = f L/D ρ v²/2, with the hydraulic diameter D = 2 w and f the larger one of the
    /// laminar 96/Re and of the rough f, so that v is the smaller one of w² Δp/(12 μ L) and √(2 D Δp/(f ρ L)).
    /// The flow is never above the choked one of an orifice of the same cross-section.
    pub fn conductance(&self, passage: &Passage, upstream: &Upstream, drop: f64) -> f64 {
        let Passage { length, width, opening, .. } = *passage;
        let Upstream { density, .. } = *upstream;
        let mut speed = opening * opening / (12.0 * self.viscosity * length); // v/Δp
        if drop > 0.0 {
            let friction = self.rough_friction(opening);
            if friction > 0.0 {
                speed = speed.min((4.0 * opening / (friction * density * length * drop)).sqrt());
            }
            speed = speed.min(choked_speed(upstream) / drop);
        }
        density * opening * width * speed
    }

    /// Largest mass flow [kg/s].
    pub fn choked(passage: &Passage, upstream: &Upstream) -> f64 {
        upstream.density * passage.opening * passage.width * choked_speed(upstream)
    }

    /// Darcy's friction factor of rough walls, 1/√f = −2 lg(ε/D/1.9), independent of the Reynolds number.
    ///
    /// Louis, *A study of groundwater flow in jointed rock and its influence on the stability of rock masses*, Imperial
    /// College (1969), for ε/D above 0.033; smoother walls get a little more friction than measured.
    fn rough_friction(&self, opening: f64) -> f64 {
        if self.roughness == 0.0 {
            return 0.0;
        }
        let relative = (self.roughness / (2.0 * opening)).min(ROUGHEST);
        let root = -2.0 * log10(relative / 1.9);
        1.0 / (root * root)
    }
}

/// Mass flow over cross-section and upstream density where the narrowest place reaches the speed of sound:
/// c (2/(Γ + 1))^((Γ + 1)/(2 (Γ − 1))), with Γ = ρ c²/p, which is γ in a perfect gas [m/s].
///
/// Shapiro, *The Dynamics and Thermodynamics of Compressible Fluid Flow* (1953), eq. (4.17).
fn choked_speed(upstream: &Upstream) -> f64 {
    let Upstream { pressure, density, sound_speed } = *upstream;
    // Cold products have no pressure any more, but a density.
    if pressure <= 0.0 {
        return 0.0;
    }
    let exponent = (density * sound_speed * sound_speed / pressure).max(1.0 + 1e-6);
    sound_speed * pow(2.0 / (exponent + 1.0), (exponent + 1.0) / (2.0 * (exponent - 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLIT: Passage = Passage { cells: [0, 1], length: 0.01, width: 0.1, opening: 2e-4 };

    #[test]
    fn slow_flow_is_laminar_and_fast_flow_chokes() {
        let flow = SlitFlow { viscosity: 2e-5, roughness: 0.0 };
        let air = Upstream { pressure: 1e5, density: 1.2, sound_speed: (1.4f64 * 1e5 / 1.2).sqrt() };
        let laminar = 1.2 * 8e-12 * 0.1 / (12.0 * 2e-5 * 0.01);
        assert!((flow.conductance(&SLIT, &air, 1.0) / laminar - 1.0).abs() < 1e-12);
        assert_eq!(flow.conductance(&SLIT, &air, 0.0), flow.conductance(&SLIT, &air, 1.0));
        // 0.6847 p/√(R T) for γ = 1.4.
        let choked = 0.1 * 2e-4 * 1e5 * 0.684_731 / (1e5f64 / 1.2).sqrt();
        assert!((flow.conductance(&SLIT, &air, 1e5) * 1e5 / choked - 1.0).abs() < 1e-5);
    }

    #[test]
    fn rough_walls_slow_the_flow_as_the_root_of_the_pressure_difference() {
        let flow = SlitFlow { viscosity: 1e-9, roughness: 2e-5 };
        let gas = Upstream { pressure: 1e8, density: 100.0, sound_speed: 1e3 };
        let [one, four] = [1e4, 4e4].map(|drop| flow.conductance(&SLIT, &gas, drop) * drop);
        assert!((four / one - 2.0).abs() < 1e-12);
        // ε/D = 0.05: f = 0.1001; v = √(2 D Δp/(f ρ L)).
        let speed = (4.0 * 2e-4 * 1e4 / (0.100_13 * 100.0 * 0.01f64)).sqrt();
        assert!((one / (100.0 * 2e-5 * speed) - 1.0).abs() < 1e-3);
    }
}
