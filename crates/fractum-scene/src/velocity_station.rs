//! Places at which the largest velocity of a run is kept.

use fractum_fem::Solid;
use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::clock::Clock;

/// A place of solids at a distance from a hole.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityStation {
    /// Its nodes, at least one.
    pub nodes: Vec<u32>,
    /// Their mean place without load [m].
    pub place: Vec3,
    /// Distance from the hole [m].
    pub distance: f64,
}

/// Largest velocity so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PeakVelocity {
    /// Magnitude of the velocity, mean over the nodes [m/s].
    pub velocity: f64,
    /// When it was that large first [s].
    pub time: f64,
}

impl VelocityStation {
    /// Mean magnitude of the velocity of its nodes [m/s].
    pub fn speed(&self, solid: &Solid) -> f64 {
        self.nodes.iter().map(|&node| solid.velocity[node as usize].norm()).sum::<f64>() / self.nodes.len() as f64
    }

    /// Takes over the velocity of the last step, which belongs to its middle, where it is larger.
    pub fn watch(&self, solid: &Solid, clock: &Clock, peak: &mut PeakVelocity) {
        let velocity = self.speed(solid);
        if velocity > peak.velocity {
            *peak = PeakVelocity { velocity, time: clock.time - 0.5 * clock.dt_before };
        }
    }
}
