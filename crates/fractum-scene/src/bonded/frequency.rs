//! What bonded bodies ask of the step.

use fractum_dem::highest_frequency;

use super::{Bonded, BondedBody};
use crate::error::SceneError;

impl Bonded {
    /// Finds the highest frequency of beams as they are by the Lanczos process, in the place of its bound. Other bonds keep theirs, and so do bodies
    /// that can break: where crack faces meet within a step, the balance pays for every step's length.
    ///
    /// # Errors
    /// Beams that are none, which [`Bonded::new`] refuses.
    pub fn find_frequency(&mut self) -> Result<(), SceneError> {
        let mut highest: f64 = 0.0;
        for body in self.bodies.iter().filter(|body| !body.bonds.is_empty()) {
            highest = highest.max(if body.can_break() || body.bonds.beam().is_none() {
                body.bound
            } else {
                highest_frequency(&body.bonds, &self.particles, body.range.clone())?
            });
        }
        self.frequency = self.frequency.min(highest);
        Ok(())
    }

    /// Highest natural frequency, or a bound on it [rad/s]; breaking only lowers it.
    pub(crate) fn frequency(&self) -> f64 {
        self.frequency
    }

    /// Largest damping ratio of bonds and crack faces.
    pub(crate) fn damping_ratio(&self) -> f64 {
        let ratio = |body: &BondedBody| {
            let bonds = 0.5 * self.frequency * body.viscous_time;
            bonds.max(body.fracture.as_ref().map_or(0.0, |f| f.faces().damping_ratio))
        };
        self.bodies.iter().map(ratio).fold(0.0, f64::max)
    }

    /// By how much the dissipation shortens the stable step: √(2φ − 1).
    pub(crate) fn step_divisor(&self) -> f64 {
        (1.0 + 2.0 * self.dissipation).sqrt()
    }
}
