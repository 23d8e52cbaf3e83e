//! The box of a run, and what has left it.

use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

/// A box with sides along the axes; free pieces outside it leave the run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    /// Lower corner [m]; its z is of no meaning where all bodies are plane.
    pub min: Vec3,
    /// Upper corner [m].
    pub max: Vec3,
}

/// What has left the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Left {
    /// Nodes, in the order in which they left.
    pub(crate) nodes: Vec<u32>,
    /// Elements.
    pub elements: usize,
    /// Pieces of solids and single discrete elements.
    pub pieces: usize,
    /// Mass [kg].
    pub mass: f64,
    /// Momentum [kg m/s].
    pub momentum: Vec3,
}

impl Domain {
    /// Whether a point is outside.
    ///
    /// - `planar`: whether z counts for nothing
    pub fn is_outside(&self, point: &Vec3, planar: bool) -> bool {
        (0..if planar { 2 } else { 3 }).any(|axis| point[axis] < self.min[axis] || point[axis] > self.max[axis])
    }
}
