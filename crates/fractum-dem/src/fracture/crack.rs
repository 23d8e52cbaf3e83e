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

/// Where and when bonds break, for the list of cracks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Occasion {
    /// Time [s].
    pub time: f64,
    /// Number of the step or of the equilibrium.
    pub event: usize,
    /// Load, where there is one that matters.
    pub load: f64,
}

impl Crack {
    /// A bond between the particles of `pair`, which lie at `ends` in the undeformed body [m], breaks.
    pub(crate) fn new(
        bond: u32,
        pair: [u32; 2],
        [a, b]: [Vec3; 2],
        area: f64,
        mode: BreakMode,
        energy: f64,
        Occasion { time, event, load }: Occasion,
    ) -> Self {
        let (position, normal) = ((a + b) * 0.5, (b - a).normalize());
        Crack { bond, pair, event, time, load, position, normal, area, mode, energy }
    }
}

/// Facet area of every bond: bonds and facets fill the body, V = Σ A l/3.
pub(crate) fn facet_area(volume: f64, lengths: impl Iterator<Item = f64>) -> f64 {
    3.0 * volume / lengths.sum::<f64>()
}
