//! Places at which the largest velocity of a run is kept.

use fractum_fem::Solid;
use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

use crate::clock::Clock;

/// Places of solids near each other, of which the one that moves fastest counts.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityStation {
    /// Its places, at least one, nearest to the hole first.
    pub places: Vec<StationPlace>,
}

/// A node at a distance from a hole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StationPlace {
    /// The node.
    pub node: u32,
    /// Its place without load [m].
    pub place: Vec3,
    /// Distance from the hole [m].
    pub distance: f64,
}

/// Largest velocity so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PeakVelocity {
    /// Magnitude of the velocity [m/s].
    pub velocity: f64,
    /// When it was that large first [s].
    pub time: f64,
    /// Which of the places of the station has it.
    pub place: u32,
}

impl VelocityStation {
    /// Takes over the velocity of the last step, which belongs to its middle, where it is larger at one of the nodes.
    pub fn watch(&self, solid: &Solid, clock: &Clock, peak: &mut PeakVelocity) {
        for (place, own) in (0..).zip(&self.places) {
            let velocity = solid.velocity[own.node as usize].norm();
            if velocity > peak.velocity {
                *peak = PeakVelocity { velocity, time: clock.time - 0.5 * clock.dt_before, place };
            }
        }
    }
}
