//! A step of conduction while nothing moves.

use fractum_scene::{Scene, StepError};

use super::Advance;
use crate::phases::{Part, Phases};

/// Conducts heat over one step; where the present instant is to be measured, that alone.
pub(super) fn step(scene: &mut Scene, measure: bool, phases: &mut Phases) -> Result<Advance, StepError> {
    if !measure {
        phases.timed(Part::Heat, || scene.conduct_alone())?;
        if !scene.is_finished() {
            return Ok(Advance::default());
        }
    }
    Ok(Advance::measured(scene.clock.time, scene.clock.dt_before, false))
}
