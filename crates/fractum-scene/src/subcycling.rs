//! Steps of two sizes: how many short ones lie in a long one.

use fractum_fem::{StableStep, motion};
use serde::{Deserialize, Serialize};

use crate::clock::{Frequencies, TimeStepSettings};
use crate::scene::Scene;
use crate::stable_step::stable_dt_at;

/// Relative excess of a step over a whole number of parts that is rounding.
const SAME_PART: f64 = 1e-9;

/// What changes where steps have two sizes, for checkpoints.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SubcyclingState {
    parts: u32,
    frequency: f64,
    governing: (usize, u32),
}

impl Scene {
    /// Most short steps in a long one, share of the cells that take them, and the number of nodes that stand twice; none where all
    /// cells take the same step.
    pub fn subcycling(&self) -> Option<(u32, f64, usize)> {
        let (share, linked) = motion::fine_shares(&self.solid)?;
        Some((short_steps_in(self, self.clock.dt_after), share, linked))
    }

    /// What changes where steps have two sizes, for a checkpoint.
    pub fn subcycling_state(&self) -> Option<SubcyclingState> {
        let (parts, fine) = motion::short_steps(&self.solid).zip(self.frequencies.fine)?;
        Some(SubcyclingState { parts, frequency: fine.frequency, governing: fine.governing })
    }

    /// Puts it back, after the state of the scene.
    pub fn restore_subcycling(&mut self, state: Option<SubcyclingState>) {
        let Some(SubcyclingState { parts, frequency, governing }) = state else { return };
        motion::restore_short_steps(&mut self.solid, parts);
        self.frequencies.fine = Some(StableStep { frequency, governing });
    }
}

/// How many short steps lie in one of `dt` [s].
pub(crate) fn short_steps_in(scene: &Scene, dt: f64) -> u32 {
    let Frequencies { stable, fine: Some(fine), .. } = scene.frequencies else { return 1 };
    let [long, short] = [stable, fine].map(|of| stable_dt_at(scene, of.frequency, 0.0));
    let TimeStepSettings { safety, fixed, .. } = scene.settings.time_step;
    let longest = fixed.unwrap_or(safety * long);
    (dt / (longest * short / long) * (1.0 - SAME_PART)).ceil().max(1.0) as u32
}
