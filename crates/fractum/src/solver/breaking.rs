//! A bonded body at rest, from break to break.

use fractum_scene::{BondedStaticSettings, BondedStaticState, BondedStatics, Scene, StepError};

use super::Advance;
use crate::error::Failure;
use crate::phases::{Part, Phases};
use crate::process::interrupt::is_interrupted;

/// The breaking of a bonded body; every step is a row of the history, with the load just before bonds break.
pub(crate) struct BreakingRun(BondedStatics);

impl BreakingRun {
    pub(super) fn new(scene: &Scene, settings: BondedStaticSettings, phases: &mut Phases) -> Result<Self, Failure> {
        let solver = phases.timed(Part::Bonds, || BondedStatics::new(scene, settings, is_interrupted));
        solver.map(BreakingRun).map_err(|error| Failure::input(format!("{error}; raise solver.tolerance")))
    }

    pub(super) fn restore(&mut self, state: BondedStaticState) {
        self.0.restore(state);
    }

    pub(super) fn state(&self) -> BondedStaticState {
        self.0.state()
    }

    pub(super) fn is_finished(&self, scene: &Scene) -> bool {
        self.0.is_finished(scene)
    }

    pub(super) fn step(&mut self, scene: &mut Scene, phases: &mut Phases) -> Result<Advance, StepError> {
        phases.timed(Part::Bonds, || self.0.step(scene))?;
        Ok(Advance::measured(scene.clock.time, scene.clock.dt_before, false))
    }

    pub(super) fn has_given_way(&self) -> bool {
        self.0.has_given_way()
    }

    pub(super) fn effort(&self) -> String {
        let (equilibria, iterations) = self.0.effort();
        format!("{equilibria} equilibria of the bonds, {iterations} iterations of conjugate gradients")
    }
}
