use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use super::criterion::BreakMode;

/// A bond that broke.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Crack {
    /// The bond.
    pub bond: u32,
    /// Its particles.
    pub pair: [u32; 2],
    /// Number of the equilibrium after which it broke.
    pub event: usize,
    /// Time [s] in dynamics, load factor at rest.
    pub time: f64,
    /// Load then.
    pub load: f64,
    /// Middle of the bond in the undeformed body [m].
    pub position: Vec3,
    /// Direction of the bond.
    pub normal: Vec3,
    /// Facet that the bond stands for: the facets of all bonds and their particles' centres fill the body [m²].
    pub area: f64,
    /// How it broke.
    pub mode: BreakMode,
    /// Its elastic energy when it broke [J].
    pub energy: f64,
}

/// Facet area of every bond: bonds and facets fill the body, V = Σ A l/3.
pub(crate) fn facet_area(volume: f64, position: &[Vec3], pairs: &[[u32; 2]]) -> f64 {
    let length: f64 = pairs.iter().map(|p| (position[p[1] as usize] - position[p[0] as usize]).norm()).sum();
    3.0 * volume / length
}
