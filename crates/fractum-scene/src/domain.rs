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
    /// Nodes, and particles of bonded bodies numbered after all nodes, in the order in which they left.
    points: Vec<u32>,
    /// Elements.
    pub elements: usize,
    /// Pieces of solids and of bonded bodies, and single discrete elements and particles.
    pub pieces: usize,
    /// Mass [kg].
    pub mass: f64,
    /// Momentum [kg m/s].
    pub momentum: Vec3,
}

impl Left {
    /// Adds a node, or a particle numbered after all nodes.
    pub(crate) fn push(&mut self, point: u32) {
        self.points.push(point);
    }

    /// Has nodes, which are ascending, back.
    pub(crate) fn bring_back(&mut self, nodes: &[u32]) {
        self.points.retain(|point| nodes.binary_search(point).is_err());
    }

    /// Nodes that have left a scene of so many nodes.
    pub(crate) fn nodes(&self, count: usize) -> impl Iterator<Item = u32> + '_ {
        self.points.iter().copied().filter(move |&point| (point as usize) < count)
    }

    /// Bonded and loose particles that have left a scene of so many nodes.
    pub(crate) fn particles(&self, nodes: usize) -> impl Iterator<Item = u32> + '_ {
        self.points.iter().filter_map(move |&point| point.checked_sub(nodes as u32))
    }
}

impl Domain {
    /// Whether a ball is wholly outside.
    pub(crate) fn is_ball_outside(&self, centre: &Vec3, radius: f64) -> bool {
        (0..3).any(|axis| centre[axis] + radius < self.min[axis] || centre[axis] - radius > self.max[axis])
    }

    /// Whether a point is outside.
    ///
    /// - `planar`: whether z counts for nothing
    pub fn is_outside(&self, point: &Vec3, planar: bool) -> bool {
        (0..if planar { 2 } else { 3 }).any(|axis| point[axis] < self.min[axis] || point[axis] > self.max[axis])
    }
}
