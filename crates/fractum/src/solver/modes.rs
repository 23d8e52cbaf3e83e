//! Natural vibrations, shown one after the other.

use fractum_output::number::quantity;
use fractum_scene::statics::{ModesError, ModesSettings, find_modes, modes_of, set_modes, show_mode};
use fractum_scene::{Scene, StepError};

use super::Advance;
use crate::phases::{Part, Phases};
use crate::process::interrupt::is_interrupted;

/// The search for natural vibrations: its first step finds them, and every step shows one.
pub(crate) struct ModesRun {
    settings: ModesSettings,
}

impl ModesRun {
    pub(super) fn new(settings: ModesSettings) -> Self {
        ModesRun { settings }
    }

    pub(super) fn is_finished(&self, scene: &Scene) -> bool {
        modes_of(scene).is_some_and(|found| scene.clock.step >= found.modes.len() as u64)
    }

    pub(super) fn step(&mut self, scene: &mut Scene, phases: &mut Phases) -> Result<Advance, StepError> {
        let (step, time) = (scene.clock.step, scene.clock.time);
        let mut event = None;
        if modes_of(scene).is_none() {
            let found = phases.timed(Part::Solid, || find_modes(scene, self.settings, is_interrupted));
            let found = found.map_err(|error| match error {
                ModesError::Linear(error) => StepError::NoSolution { step, time, reason: error.to_string() },
                ModesError::Unstable { time: growth } => StepError::Buckles { growth },
                ModesError::Held => StepError::NothingFree,
            })?;
            if is_interrupted() {
                return Err(StepError::Interrupted { step, time });
            }
            let count = found.modes.len();
            event = found.modes.first().map(|mode| {
                format!("{count} natural vibrations, the slowest with {}", quantity(mode.frequency, "1/s"))
            });
            set_modes(scene, found);
        }
        show_mode(scene, step as usize + 1);
        Ok(Advance { event, ..Advance::measured(scene.clock.time, 0.0, false) })
    }
}
