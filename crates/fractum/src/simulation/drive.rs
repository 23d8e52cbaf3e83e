//! What a program may do that drives a simulation, beside its steps.

use fractum_math::Vec3;
use fractum_output::summary::Status;
use fractum_scene::Population;

use super::{End, Simulation};
use crate::error::Failure;
use crate::output::summary::state_hash;

impl Simulation {
    /// Adds forces that the case does not know of: nodes of solids or particles, in the numbering of the scene, and the force
    /// on each [N]. They act from the next step on until [`Simulation::clear_forces`].
    ///
    /// Forces of a point that is named twice are added. Their work is booked as that of loads; the stable step knows
    /// nothing of them, so that stiff forces need a smaller `solver.safety`. A checkpoint does not hold them.
    ///
    /// # Errors
    /// [`Failure::Input`] in a run that does not move, for a point that is none and for a force that is not finite; no force
    /// is added then.
    pub fn add_forces(
        &mut self,
        population: Population,
        forces: impl IntoIterator<Item = (u32, Vec3)>,
    ) -> Result<(), Failure> {
        if !self.solver.is_explicit() {
            let text = "forces from outside the case need a run in motion; expected solver.kind = \"explicit\"";
            return Err(Failure::input(text));
        }
        let (what, count) = match population {
            Population::Nodes => ("node", self.scene.solid.reference.len()),
            Population::Particles => ("particle", self.scene.bonded.particles.len()),
        };
        let given = self.scene.given_forces(population);
        let before = given.len();
        given.extend(forces);
        let added = check(&given[before..], what, count);
        if added.is_err() {
            given.truncate(before);
        }
        added
    }

    /// Takes away all forces of [`Simulation::add_forces`].
    pub fn clear_forces(&mut self) {
        self.scene.given_forces(Population::Nodes).clear();
        self.scene.given_forces(Population::Particles).clear();
    }

    /// Ends the run as if its end were reached; of no effect once it is over.
    ///
    /// # Errors
    /// [`Failure::Write`] where the log cannot be written.
    pub fn stop(&mut self) -> Result<(), Failure> {
        if !self.is_over() {
            let why = "ended by the program that drives it".to_owned();
            self.messages.log.line(&why)?;
            self.end = Some(End::Finished(why));
        }
        Ok(())
    }

    /// How the run ended; none before it is over.
    pub fn status(&self) -> Option<Status> {
        self.end.as_ref().map(End::status)
    }

    /// Hash of everything that changes in the scene, as `summary.json` has it for the end.
    pub fn state_hash(&self) -> u128 {
        state_hash(&self.scene)
    }
}

/// Refuses forces on points that are none, and such that are not finite.
fn check(forces: &[(u32, Vec3)], what: &str, count: usize) -> Result<(), Failure> {
    let wrong = forces.iter().find(|(point, force)| *point as usize >= count || !force.iter().all(|f| f.is_finite()));
    match wrong {
        None => Ok(()),
        Some((point, _)) if *point as usize >= count => {
            Err(Failure::input(format!("a force on {what} {point}; expected less than {count}")))
        }
        Some((point, force)) => {
            let [x, y, z] = [force.x, force.y, force.z];
            Err(Failure::input(format!("a force of ({x}, {y}, {z}) N on {what} {point}; expected finite numbers")))
        }
    }
}
