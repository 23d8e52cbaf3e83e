//! What brings a scene from one instant to the next: motion, or equilibrium of solids or of a bonded body.

mod breaking;
pub(crate) mod choice;
mod equilibrium;
mod heat;
mod modes;
mod motion;

use fractum_case::build::BuiltScene;
use fractum_scene::{BondedStaticState, Scene, StepError};
use serde::{Deserialize, Serialize};

use crate::error::Failure;
use crate::phases::Phases;
use breaking::BreakingRun;
use equilibrium::{EquilibriumRun, EquilibriumState};
use modes::ModesRun;

/// The solver of a run.
pub(crate) enum Solver {
    /// Explicit motion.
    Explicit,
    /// Solids from equilibrium to equilibrium, or in motion between two of them.
    Static(Box<EquilibriumRun>),
    /// A bonded body from break to break.
    BondedStatic(Box<BreakingRun>),
    /// Heat, while nothing moves.
    Heat,
    /// Natural vibrations.
    Modes(ModesRun),
}

/// What a solver remembers beside the scene, for a checkpoint.
#[derive(Serialize, Deserialize)]
pub(crate) enum SolverState {
    Explicit,
    Static(EquilibriumState),
    BondedStatic(BondedStaticState),
    Heat,
    Modes,
}

impl SolverState {
    /// As [`Solver::rests`].
    pub(crate) fn rests(&self) -> bool {
        match self {
            SolverState::Explicit | SolverState::Heat | SolverState::Modes => false,
            SolverState::Static(state) => !state.moves(),
            SolverState::BondedStatic(_) => true,
        }
    }
}

/// An instant at which the ledger was measured: a row of the history.
pub(crate) struct Measured {
    /// Time [s].
    pub(crate) time: f64,
    /// The step that belongs to it [s].
    pub(crate) dt: f64,
    /// Whether the scene moved then.
    pub(crate) in_motion: bool,
}

/// What a step brought, beside the new state of the scene.
#[derive(Default)]
pub(crate) struct Advance {
    pub(crate) measured: Option<Measured>,
    /// What the user should hear of it.
    pub(crate) event: Option<String>,
}

impl Advance {
    fn measured(time: f64, dt: f64, in_motion: bool) -> Self {
        Advance { measured: Some(Measured { time, dt, in_motion }), event: None }
    }
}

impl Solver {
    /// The solver that a case asks for, before the first step of its scene.
    ///
    /// # Errors
    /// A linear system that is too large; a bonded body without a first equilibrium.
    pub(crate) fn new(scene: &Scene, built: &BuiltScene, phases: &mut Phases) -> Result<Self, Failure> {
        if let Some(settings) = built.modes {
            return Ok(Solver::Modes(ModesRun::new(settings)));
        }
        Ok(match (&built.statics, built.bonded_statics) {
            (Some(settings), _) => Solver::Static(Box::new(EquilibriumRun::new(scene, settings.clone())?)),
            (None, Some(settings)) => Solver::BondedStatic(Box::new(BreakingRun::new(scene, settings, phases)?)),
            (None, None) if built.conducts_alone => Solver::Heat,
            (None, None) => Solver::Explicit,
        })
    }

    /// Goes on from the present state of the scene, in which another solver has left it.
    ///
    /// - `moving`: whether the scene moved then
    pub(crate) fn take_over(&mut self, scene: &mut Scene, moving: bool) {
        match self {
            Solver::Explicit if moving => scene.renew_step(),
            Solver::Explicit => scene.start_from_rest(),
            Solver::Static(run) => run.take_over(),
            Solver::BondedStatic(_) | Solver::Heat | Solver::Modes(_) => {}
        }
    }

    /// Whether a run with another end can go on from this state.
    pub(crate) fn may_go_on(&self, state: &SolverState) -> bool {
        matches!(
            (self, state),
            (Solver::Explicit, SolverState::Explicit)
                | (Solver::Static(_), SolverState::Static(_))
                | (Solver::Heat, SolverState::Heat)
        )
    }

    /// Goes on where a checkpoint of the same case stood; the scene has been put back.
    pub(crate) fn restore(&mut self, scene: &mut Scene, state: SolverState) {
        match (self, state) {
            (Solver::Static(run), SolverState::Static(state)) => run.restore(scene, state),
            (Solver::BondedStatic(run), SolverState::BondedStatic(state)) => run.restore(state),
            _ => {}
        }
    }

    /// What it remembers, for a checkpoint.
    pub(crate) fn state(&self) -> SolverState {
        match self {
            Solver::Explicit => SolverState::Explicit,
            Solver::Static(run) => SolverState::Static(run.state()),
            Solver::BondedStatic(run) => SolverState::BondedStatic(run.state()),
            Solver::Heat => SolverState::Heat,
            Solver::Modes(_) => SolverState::Modes,
        }
    }

    /// Whether the run is over.
    pub(crate) fn is_finished(&self, scene: &Scene) -> bool {
        match self {
            Solver::Explicit | Solver::Heat => scene.is_finished(),
            Solver::Static(run) => run.is_finished(scene),
            Solver::BondedStatic(run) => run.is_finished(scene),
            Solver::Modes(run) => run.is_finished(scene),
        }
    }

    /// Whether `solver.max_steps` allows no further state of equilibrium.
    pub(crate) fn has_used_up_its_steps(&self) -> bool {
        matches!(self, Solver::Static(run) if run.has_used_up_its_steps())
    }

    /// Whether the scene moves all the time.
    pub(crate) fn is_explicit(&self) -> bool {
        matches!(self, Solver::Explicit)
    }

    /// Whether its instants are numbers of natural vibrations.
    pub(crate) fn shows_modes(&self) -> bool {
        matches!(self, Solver::Modes(_))
    }

    /// Whether its instants are load factors along a path of equilibria, unless it moves; else they are times.
    pub(crate) fn follows_path(&self) -> bool {
        matches!(self, Solver::Static(_) | Solver::BondedStatic(_))
    }

    /// Whether its time is a load factor, and its next step a search that may be interrupted.
    pub(crate) fn rests(&self) -> bool {
        self.follows_path() && !self.moves()
    }

    /// Whether the scene moves.
    pub(crate) fn moves(&self) -> bool {
        match self {
            Solver::Explicit => true,
            Solver::Static(run) => run.moves(),
            Solver::BondedStatic(_) | Solver::Heat | Solver::Modes(_) => false,
        }
    }

    /// Brings the scene to the next instant.
    ///
    /// - `measure`: whether motion should measure the ledger of the present instant; equilibria always have theirs
    ///
    /// # Errors
    /// As the step of the scene or the search for equilibrium says.
    pub(crate) fn step(&mut self, scene: &mut Scene, measure: bool, phases: &mut Phases) -> Result<Advance, StepError> {
        match self {
            Solver::Explicit => motion::step(scene, measure, phases),
            Solver::Static(run) => run.step(scene, phases),
            Solver::BondedStatic(run) => run.step(scene, phases),
            Solver::Heat => heat::step(scene, measure, phases),
            Solver::Modes(run) => run.step(scene, phases),
        }
    }

    /// Iterations to equilibrium so far; of other solvers none.
    pub(crate) fn iterations(&self) -> usize {
        if let Solver::Static(run) = self { run.iterations() } else { 0 }
    }

    /// Whether what is at rest has broken so far that it does not bear its loads.
    pub(crate) fn has_given_way(&self, scene: &Scene) -> bool {
        match self {
            Solver::BondedStatic(run) => run.has_given_way(),
            Solver::Static(run) => run.has_given_way(scene),
            Solver::Explicit | Solver::Heat | Solver::Modes(_) => false,
        }
    }

    /// How much work it was, in words.
    pub(crate) fn effort(&self) -> Option<String> {
        match self {
            Solver::Explicit | Solver::Heat | Solver::Modes(_) => None,
            Solver::Static(run) => Some(run.effort()),
            Solver::BondedStatic(run) => Some(run.effort()),
        }
    }
}
