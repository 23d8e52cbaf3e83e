//! Displacement and strain on grids of places.

use fractum_math::Vec3;

use super::Selection;
use crate::Spanned;

/// A grid of places, with the points around each.
#[derive(Debug, Clone, PartialEq)]
pub struct Gauges {
    /// Name of its files.
    pub name: Spanned<String>,
    /// Nodes or particles that it follows.
    pub on: Selection,
    /// A corner [m].
    pub from: Vec3,
    /// The opposite corner [m].
    pub to: Vec3,
    /// Places along each axis, at least one.
    pub count: [usize; 3],
    /// Gauge length [m], > 0.
    pub length: Spanned<f64>,
}

impl Gauges {
    /// The places, x fastest [m].
    pub fn places(&self) -> Vec<Vec3> {
        let [nx, ny, nz] = self.count;
        let place = |site: [usize; 3]| {
            let share = |axis: usize| site[axis] as f64 / (self.count[axis].max(2) - 1) as f64;
            Vec3::from_fn(|axis, _| self.from[axis] + (self.to[axis] - self.from[axis]) * share(axis))
        };
        (0..nx * ny * nz).map(|i| place([i % nx, i / nx % ny, i / (nx * ny)])).collect()
    }
}
