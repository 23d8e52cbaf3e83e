//! What leads a step of a path: the edges of bodies that may be damaged, or one point of an interface.
//!
//! Where nothing but its own growth keeps a crack from running on, tangents that soften leave no definite matrix. So the softening of one point is
//! taken as given: it comes to the end of its growth, and its traction there is known. What is left is definite as long as a machine could control
//! the test by the opening of that point. The load parameter follows from the condition that the point comes to where it is led.

use super::path::{Farthest, Way};
use crate::interfaces::joints::PointPlace;

/// Changes of what leads before a step is cut.
const MOST_CHANGES: usize = 8;
/// Growth of other points over that of the one that leads, beyond which they take its place.
const BESIDE: f64 = 1.5;

/// What leads the steps of a path.
#[derive(Clone, Debug, Default)]
pub(super) struct Lead {
    /// The point of an interface that does; none where edges do, or the load alone.
    pub(super) at: Option<PointPlace>,
    /// How far it goes down its softening curve in this step.
    pub(super) growth: f64,
    /// How often another one has taken its place in this step.
    changes: usize,
}

impl Lead {
    /// Begins an iteration.
    ///
    /// - `along`: whether it goes along a path
    pub(super) fn begin(&mut self, growth: f64, along: bool) {
        (self.growth, self.changes) = (growth, 0);
        if !along || growth < 0.0 {
            self.at = None;
        }
    }

    /// The step of the load parameter, and what leads from then on; none where there is no such step.
    ///
    /// - `lowest`: below it the load parameter does not go
    pub(super) fn step(&mut self, way: &Way<'_>, [lowest, longest]: [f64; 2]) -> Option<f64> {
        let (tau, next) = match self.at {
            None => {
                let (tau, stops) = way.largest_step(longest)?;
                match stops {
                    Some(Farthest::Interface(at)) if way.growth > 0.0 => (tau, Some(at)),
                    _ => (tau, None),
                }
            }
            Some(at) => {
                // A point that has still the mode of the last iterate may go too far at any load, until it has its own.
                let tau = way.step_of(at, longest).or_else(|| way.step_in_mode(at))?;
                let tau = if tau < lowest { longest } else { tau.min(longest) };
                match way.most_grown(tau) {
                    Some((other, growth)) if other != at && growth > BESIDE * way.growth => (tau, Some(other)),
                    _ if tau == longest => (tau, None),
                    _ => (tau, Some(at)),
                }
            }
        };
        if next != self.at {
            self.changes += 1;
            self.at = next;
        }
        (self.changes <= MOST_CHANGES).then_some(tau)
    }
}
