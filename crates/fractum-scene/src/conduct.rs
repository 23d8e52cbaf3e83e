//! Heat in the step of a scene, and alone.

use crate::clock::{Clock, Phase};
use crate::error::StepError;
use crate::heat::{Heat, HeatState};
use crate::scene::Scene;
use crate::stable_step::equal_steps;

impl Scene {
    /// The same scene with heat, before its first step.
    ///
    /// - `alone`: nothing moves, the clock is that of the heat
    pub fn with_heat(mut self, heat: Heat, alone: bool) -> Self {
        if alone {
            self.clock = Clock::new(equal_steps(heat.step_size(), self.settings.time_step.end));
        }
        self.optional.heat = Some(Box::new(heat));
        self
    }

    /// Heat in the bodies.
    pub fn heat(&self) -> Option<&Heat> {
        self.optional.heat.as_deref()
    }

    /// What changes in heat, for a checkpoint.
    pub fn heat_state(&self) -> Option<HeatState> {
        self.heat().map(Heat::state)
    }

    /// Puts a saved state of heat back, after that of the scene.
    pub fn restore_heat(&mut self, state: Option<HeatState>) {
        let Scene { optional, solid, bonded, .. } = self;
        if let (Some(heat), Some(state)) = (&mut optional.heat, state) {
            heat.restore(solid, bonded, &optional.interfaces, state);
        }
    }

    /// Advances temperatures by a step of their own; nothing moves.
    ///
    /// # Errors
    /// [`StepError::Heat`].
    pub fn conduct_alone(&mut self) -> Result<(), StepError> {
        let (step, time) = (self.clock.step, self.clock.time);
        let target = time + self.clock.dt_after;
        let Scene { optional, solid, bonded, .. } = self;
        let Some(heat) = &mut optional.heat else { return Ok(()) };
        heat.conduct_to(target, solid, bonded, &optional.interfaces).map_err(|reason| StepError::Heat {
            step,
            time,
            reason,
        })?;
        let dt = equal_steps(heat.step_size(), self.settings.time_step.end - target);
        self.clock.advance(dt);
        Ok(())
    }
}

/// Books the work of the last expansion at the present stresses.
pub(crate) fn finish_expansion(scene: &mut Scene, passed: &mut impl FnMut(Phase)) {
    let Scene { optional, solid, bonded, books, .. } = scene;
    if let Some(heat) = &mut optional.heat {
        books.external += heat.finish_expansion(solid, bonded);
        passed(Phase::Heat);
    }
}

/// Conducts heat for the step that follows, where its own step is due, and expands bodies by it; returns half of the work of
/// the expansion, at the present stresses [J].
///
/// - `passed`: is told what was done before, and the conduction
pub(crate) fn conduct(scene: &mut Scene, dt: f64, passed: &mut impl FnMut(Phase)) -> Result<f64, StepError> {
    let (step, time) = (scene.clock.step, scene.clock.time);
    let (target, end) = (time + dt, scene.settings.time_step.end);
    let Scene { optional, solid, bonded, .. } = scene;
    let Some(heat) = &mut optional.heat else { return Ok(0.0) };
    passed(Phase::Motion);
    let conducted = heat.conduct_for([time, target, end], solid, bonded, &optional.interfaces);
    let conducted = conducted.map_err(|reason| StepError::Heat { step, time, reason })?;
    let work = heat.expand(target, solid, bonded);
    if conducted || heat.expands() {
        passed(Phase::Heat);
    }
    Ok(work)
}

/// Conducts heat to a time that an equilibrium is tried at, and expands bodies by the temperatures there. The time may come back, as long as
/// no equilibrium was found.
pub(crate) fn warm_to(scene: &mut Scene, target: f64) -> Result<(), StepError> {
    let (step, time) = (scene.clock.step, scene.clock.time);
    let Scene { optional, solid, bonded, .. } = scene;
    let Some(heat) = &mut optional.heat else { return Ok(()) };
    heat.warm_to([time, target], solid, bonded, &optional.interfaces).map_err(|reason| StepError::Heat {
        step,
        time,
        reason,
    })
}

/// Takes the temperatures of an equilibrium at a time; returns half of the work of its expansion, at the stresses of the one before [J].
pub(crate) fn settle_heat(scene: &mut Scene, target: f64) -> Result<f64, StepError> {
    let (step, time, first) = (scene.clock.step, scene.clock.time, is_first(scene));
    let Scene { optional, solid, bonded, .. } = scene;
    let Some(heat) = &mut optional.heat else { return Ok(0.0) };
    heat.settle(target, solid, bonded, &optional.interfaces, first).map_err(|reason| StepError::Heat {
        step,
        time,
        reason,
    })
}

/// The other half, at the stresses of the equilibrium [J].
pub(crate) fn finish_settled_expansion(scene: &mut Scene) -> f64 {
    let first = is_first(scene);
    let Scene { optional, solid, bonded, .. } = scene;
    optional.heat.as_mut().map_or(0.0, |heat| heat.finish_settled_expansion(solid, bonded, first))
}

/// Whether an equilibrium is the first one of a run that did not start with energy: what was stress-free at another temperature than that of
/// the start is brought from there.
fn is_first(scene: &Scene) -> bool {
    scene.clock.step == 0 && scene.ledger.initial == 0.0
}

/// Nothing conducts through elements that have left.
pub(crate) fn heat_loses_elements(scene: &mut Scene) {
    if let Some(heat) = &mut scene.optional.heat {
        heat.lose_elements();
    }
}
