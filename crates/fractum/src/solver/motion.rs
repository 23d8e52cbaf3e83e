//! A step of motion.

use std::time::Instant;

use fractum_scene::{Scene, StepError};

use super::Advance;
use crate::phases::Phases;

/// Advances the scene by one time step; its row, if measured, is that of the instant before.
pub(super) fn step(scene: &mut Scene, measure: bool, phases: &mut Phases) -> Result<Advance, StepError> {
    let (time, dt) = (scene.clock.time, scene.clock.dt_after);
    let mut last = Instant::now();
    scene.step_observed(measure, |phase| {
        let now = Instant::now();
        phases.add(phase.into(), now - last);
        last = now;
    })?;
    Ok(if measure { Advance::measured(time, dt, true) } else { Advance::default() })
}
