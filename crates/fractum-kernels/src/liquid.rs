//! Liquid between two walls.

#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;
use serde::{Deserialize, Serialize};

/// Flow of a liquid between two walls: the cubic law, with the friction of rough walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CubicLaw {
    /// Dynamic viscosity μ [Pa s], > 0.
    pub viscosity: f64,
    /// Height ε of asperities [m], ≥ 0.
    pub roughness: f64,
}

/// Factor and exponent of the friction of rough walls are those of laminar flow in Louis, *A study of groundwater flow in jointed rock*, Imperial College
/// (1969).
const ROUGH: f64 = 8.8;

impl CubicLaw {
    /// Flow per width of the slit and gradient of pressure, T = w³/(12 μ (1 + 8.8 (ε/2w)^1.5)) [m³/(Pa s)], and dT/dw.
    ///
    /// - `aperture` w [m]; closed walls, w ≤ 0, let nothing through
    #[inline]
    pub fn transmissivity(&self, aperture: f64) -> [f64; 2] {
        if aperture <= 0.0 {
            return [0.0; 2];
        }
        let half = 0.5 * self.roughness;
        let (smooth, rough) = (aperture * aperture.sqrt(), ROUGH * half * half.sqrt());
        let flow = smooth * smooth * smooth / (12.0 * self.viscosity * (smooth + rough));
        [flow, 1.5 * flow / aperture * (3.0 - smooth / (smooth + rough))]
    }
}

/// Volume per area that both walls of a crack have taken from the liquid some time after it came: 4 C √t [m] (Carter 1957).
///
/// - `coefficient` C of one wall [m/√s]; `age` [s], ≥ 0
#[inline]
pub fn leaked(coefficient: f64, age: f64) -> f64 {
    4.0 * coefficient * age.sqrt()
}
