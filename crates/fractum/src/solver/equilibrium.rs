//! Solids from equilibrium to equilibrium, in motion where there is none.

use fractum_output::number::quantity;
use fractum_scene::statics::{DynamicPhase, NoEquilibrium, StaticSettings, StaticSolver, StaticState};
use fractum_scene::{Scene, StepError};
use serde::{Deserialize, Serialize};

use super::{Advance, motion};
use crate::error::Failure;
use crate::phases::{Part, Phases};
use crate::process::interrupt::is_interrupted;

/// Where such a run stands, for its checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct EquilibriumState {
    solver: StaticState,
    phase: Phase,
    rested_at: f64,
    periods: f64,
}

impl EquilibriumState {
    /// Whether the next step is one of motion.
    pub(super) fn moves(&self) -> bool {
        matches!(self.phase, Phase::Moving(_))
    }
}

/// What the next step is.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
enum Phase {
    /// To the next equilibrium.
    AtRest,
    /// To the next equilibrium, from a state in which motion has died.
    Rested,
    /// A step of motion.
    Moving(DynamicPhase),
}

/// A run at equilibrium, or in motion between two states of it.
pub(crate) struct EquilibriumRun {
    solver: StaticSolver,
    phase: Phase,
    /// Time at which motion ended last [s].
    rested_at: f64,
    /// First periods that the next motion lasts at least: more where the last one has not reached an equilibrium.
    periods: f64,
}

impl EquilibriumRun {
    pub(super) fn new(scene: &Scene, settings: StaticSettings) -> Result<Self, Failure> {
        let solver = StaticSolver::new(scene, settings)
            .map_err(|error| Failure::input(format!("{error}; choose solver.linear_solver = \"iterative\"")))?;
        let solver = solver.with_stop(is_interrupted);
        // Loads and supports act from the start where in-situ stress is in balance with them.
        let phase = if scene.solid.initial_displacement.is_empty() { Phase::AtRest } else { Phase::Rested };
        Ok(EquilibriumRun { solver, phase, rested_at: f64::NEG_INFINITY, periods: 1.0 })
    }

    pub(super) fn restore(&mut self, scene: &mut Scene, state: EquilibriumState) {
        let EquilibriumState { solver, phase, rested_at, periods } = state;
        self.solver.restore(solver);
        if let Phase::Moving(interlude) = &phase {
            scene.resume_motion(interlude);
        }
        (self.phase, self.rested_at, self.periods) = (phase, rested_at, periods);
    }

    pub(super) fn state(&self) -> EquilibriumState {
        let EquilibriumRun { solver, phase, rested_at, periods } = self;
        EquilibriumState { solver: solver.state(), phase: *phase, rested_at: *rested_at, periods: *periods }
    }

    /// The next step begins at a state that another solver has found.
    pub(super) fn take_over(&mut self) {
        self.phase = Phase::Rested;
    }

    pub(super) fn moves(&self) -> bool {
        matches!(self.phase, Phase::Moving(_))
    }

    pub(super) fn has_used_up_its_steps(&self) -> bool {
        self.solver.has_used_up_its_steps()
    }

    pub(super) fn is_finished(&self, scene: &Scene) -> bool {
        if self.moves() { scene.is_finished() } else { self.solver.is_finished(scene) }
    }

    pub(super) fn has_given_way(&self, scene: &Scene) -> bool {
        !self.moves() && self.solver.has_given_way(scene)
    }

    pub(super) fn step(&mut self, scene: &mut Scene, phases: &mut Phases) -> Result<Advance, StepError> {
        match self.phase {
            Phase::Moving(interlude) => return self.move_on(scene, interlude, phases),
            Phase::Rested => phases.timed(Part::Solid, || self.solver.resume_from_motion(scene)),
            Phase::AtRest => {}
        }
        self.phase = Phase::AtRest;
        let (before, followed) = (scene.clock.time, self.solver.has_turned_to_path());
        match phases.timed(Part::Solid, || self.solver.step(scene)) {
            Ok(_) => {
                let advance = Advance::measured(scene.clock.time, scene.clock.dt_before, false);
                let turned = !followed && self.solver.has_turned_to_path();
                Ok(Advance { event: turned.then(|| turned_to_path(before)), ..advance })
            }
            Err(StepError::NoEquilibrium { .. }) if self.solver.settings().no_equilibrium == NoEquilibrium::Motion => {
                Ok(phases.timed(Part::Solid, || self.begin_motion(scene)))
            }
            Err(error) => Err(error),
        }
    }

    fn begin_motion(&mut self, scene: &mut Scene) -> Advance {
        let time = scene.clock.time;
        self.periods = if time == self.rested_at { 2.0 * self.periods } else { 1.0 };
        let interlude = scene.begin_motion(self.solver.settings().damping, self.periods);
        self.phase = Phase::Moving(interlude);
        let event = format!(
            "t = {}: no equilibrium ahead; the scene moves, first period {}, time step {}",
            quantity(time, "s"),
            quantity(interlude.period, "s"),
            quantity(scene.clock.dt_after, "s")
        );
        Advance { event: Some(event), measured: None }
    }

    /// A step of motion, which may end it.
    fn move_on(
        &mut self,
        scene: &mut Scene,
        mut interlude: DynamicPhase,
        phases: &mut Phases,
    ) -> Result<Advance, StepError> {
        let (time, dt) = (scene.clock.time, scene.clock.dt_after);
        if !interlude.look_is_due(time) {
            return motion::step(scene, false, phases);
        }
        let rested = phases.timed(Part::Solid, || scene.look(&mut interlude))?;
        let mut advance = Advance::measured(time, dt, true);
        self.phase = Phase::Moving(interlude);
        if rested {
            advance.event = Some(format!(
                "t = {}: at rest again after {}; largest kinetic energy {}",
                quantity(time, "s"),
                quantity(time - interlude.begin, "s"),
                quantity(interlude.most_kinetic, "J")
            ));
            (self.phase, self.rested_at) = (Phase::Rested, time);
        }
        Ok(advance)
    }

    pub(super) fn iterations(&self) -> usize {
        self.solver.work().1
    }

    pub(super) fn effort(&self) -> String {
        let (linear, iterations) = self.solver.work();
        format!(
            "{iterations} equilibrium iterations, {} factorisations, {} linear solutions, {} iterations of conjugate gradients",
            linear.factorisations, linear.solutions, linear.iterations
        )
    }
}

/// What the user hears where a path begins.
fn turned_to_path(time: f64) -> String {
    format!(
        "t = {}: no equilibrium at a larger load; from here on the run follows the path of equilibrium, by steps of interfaces that soften",
        quantity(time, "s")
    )
}
