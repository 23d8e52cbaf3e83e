//! A step of motion.

use std::time::Instant;

use fractum_output::number::at_instant;
use fractum_scene::{Scene, StepError};

use super::Advance;
use crate::phases::Phases;

/// Advances the scene by one time step; its row, if measured, is that of the instant before.
pub(super) fn step(scene: &mut Scene, measure: bool, phases: &mut Phases) -> Result<Advance, StepError> {
    let (time, dt) = (scene.clock.time, scene.clock.dt_after);
    let mut last = Instant::now();
    let report = scene.step_observed(measure, |phase| {
        let now = Instant::now();
        phases.add(phase.into(), now - last);
        last = now;
    })?;
    let advance = if measure { Advance::measured(time, dt, true) } else { Advance::default() };
    if report.turning.is_empty() {
        return Ok(advance);
    }
    let name = |&body: &u32| format!("\"{}\"", scene.solid.body(body as usize).name);
    let names: Vec<String> = report.turning.iter().map(name).collect();
    let event = format!(
        "{}: {} begins to turn, with corotational strains from now on",
        at_instant(time + dt, false),
        names.join(", ")
    );
    Ok(Advance { event: Some(event), ..advance })
}
