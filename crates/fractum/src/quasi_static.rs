//! The loops of quasi-static runs.

use std::time::Duration;

use fractum_io::number::quantity;
use fractum_scene::statics::{DynamicPhase, NoEquilibrium, StaticSolver, StaticState};
use fractum_scene::{BondedStaticSettings, BondedStatics, Scene, StepError};
use serde::{Deserialize, Serialize};

use crate::error::Failure;
use crate::run::{End, PHASES, Run, is_interrupted};

/// Where a quasi-static run stands, for its checkpoint.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct StaticProgress {
    solver: StaticState,
    interlude: Option<DynamicPhase>,
    rested_at: f64,
    periods: f64,
}

/// A quasi-static run: at equilibrium, or in motion between two states of it.
pub(crate) struct Quiet {
    solver: StaticSolver,
    interlude: Option<DynamicPhase>,
    /// Time at which motion ended last [s].
    rested_at: f64,
    /// First periods that the next motion lasts at least: more where the last one has not reached an equilibrium.
    periods: f64,
}

impl Quiet {
    pub(crate) fn new(solver: StaticSolver) -> Self {
        Quiet { solver, interlude: None, rested_at: f64::NEG_INFINITY, periods: 1.0 }
    }

    /// Goes on where a checkpoint stood.
    pub(crate) fn restore(&mut self, scene: &mut Scene, progress: StaticProgress) {
        let StaticProgress { solver, interlude, rested_at, periods } = progress;
        self.solver.restore(solver);
        if let Some(interlude) = &interlude {
            scene.resume_motion(interlude);
        }
        (self.interlude, self.rested_at, self.periods) = (interlude, rested_at, periods);
    }

    pub(crate) fn progress(&self) -> StaticProgress {
        let Quiet { solver, interlude, rested_at, periods } = self;
        StaticProgress { solver: solver.state(), interlude: *interlude, rested_at: *rested_at, periods: *periods }
    }

    /// Whether the scene moves.
    pub(crate) fn moves(&self) -> bool {
        self.interlude.is_some()
    }
}

impl Run<'_> {
    /// Steps from equilibrium to equilibrium, each a row of the history; where there is none, moves to the next if asked to.
    pub(crate) fn equilibrate(&mut self, scene: &mut Scene, quiet: &mut Quiet) -> Result<End, Failure> {
        let every = Duration::try_from_secs_f64(self.case.output.checkpoint_every).unwrap_or(Duration::MAX);
        let end = loop {
            let over = if quiet.moves() { scene.is_finished() } else { quiet.solver.is_finished(scene) };
            if over {
                break End::Finished;
            }
            if is_interrupted() {
                self.save(scene, Some(quiet.progress()))?;
                break End::Interrupted;
            }
            if self.saved.elapsed() >= every {
                self.save(scene, Some(quiet.progress()))?;
            }
            if self.recorder.frame_is_due(scene.clock.time) {
                self.timed(PHASES.len() - 1, |run| run.recorder.frame(scene))?;
            }
            let rows = self.recorder.state().times.len();
            let stepped = match &mut quiet.interlude {
                None => self.find_equilibrium(scene, quiet)?,
                Some(interlude) => {
                    let mut now = *interlude;
                    let stepped = self.move_on(scene, quiet, &mut now)?;
                    quiet.interlude = quiet.interlude.and(Some(now));
                    stepped
                }
            };
            if let Err(error) = stepped {
                break End::Failed(error);
            }
            if self.recorder.state().times.len() > rows && self.falls_below() {
                break End::Finished;
            }
            if self.progress.due(self.started.elapsed()) {
                self.progress.show(&self.snapshot(scene), self.started.elapsed());
            }
        };
        let (linear, iterations) = quiet.solver.work();
        self.log.line(format!(
            "{iterations} equilibrium iterations, {} factorisations, {} linear solutions, {} iterations of conjugate gradients",
            linear.factorisations, linear.solutions, linear.iterations
        ))?;
        Ok(end)
    }

    /// A step from equilibrium to equilibrium, or into motion.
    fn find_equilibrium(&mut self, scene: &mut Scene, quiet: &mut Quiet) -> Result<Result<(), StepError>, Failure> {
        match self.timed(0, |_| quiet.solver.step(scene)) {
            Ok(_) => {
                let (time, dt) = (scene.clock.time, scene.clock.dt_before);
                self.record(scene, quiet, time, dt)?;
                Ok(Ok(()))
            }
            Err(StepError::NoEquilibrium { .. }) if quiet.solver.settings().no_equilibrium == NoEquilibrium::Motion => {
                let time = scene.clock.time;
                quiet.periods = if time == quiet.rested_at { 2.0 * quiet.periods } else { 1.0 };
                let (damping, periods) = (quiet.solver.settings().damping, quiet.periods);
                let interlude = self.timed(0, |_| scene.begin_motion(damping, periods));
                self.tell_event(format!(
                    "t = {}: no equilibrium ahead; the scene moves, first period {}, time step {}",
                    quantity(time, "s"),
                    quantity(interlude.period, "s"),
                    quantity(scene.clock.dt_after, "s")
                ))?;
                quiet.interlude = Some(interlude);
                Ok(Ok(()))
            }
            Err(error) => Ok(Err(error)),
        }
    }

    /// A step of motion, which may end it.
    fn move_on(
        &mut self,
        scene: &mut Scene,
        quiet: &mut Quiet,
        interlude: &mut DynamicPhase,
    ) -> Result<Result<(), StepError>, Failure> {
        let (time, dt) = (scene.clock.time, scene.clock.dt_after);
        if !interlude.look_is_due(time) {
            return Ok(self.step(scene, false));
        }
        let rested = match self.timed(0, |_| scene.look(interlude)) {
            Ok(rested) => rested,
            Err(error) => return Ok(Err(error)),
        };
        self.record(scene, quiet, time, dt)?;
        if rested {
            self.tell_event(format!(
                "t = {}: at rest again after {}; largest kinetic energy {}",
                quantity(time, "s"),
                quantity(time - interlude.begin, "s"),
                quantity(interlude.most_kinetic, "J")
            ))?;
            quiet.interlude = None;
            quiet.rested_at = time;
            self.timed(0, |_| quiet.solver.resume_from_motion(scene));
        }
        Ok(Ok(()))
    }

    fn record(&mut self, scene: &Scene, quiet: &Quiet, time: f64, dt: f64) -> Result<(), Failure> {
        self.timed(PHASES.len() - 1, |run| {
            run.recorder.set_in_motion(quiet.moves());
            run.recorder.row(scene, time, dt)
        })?;
        self.warn_of_balance(scene)
    }

    /// Says what became of the run, on the terminal and in the log.
    fn tell_event(&mut self, text: String) -> Result<(), Failure> {
        self.progress.message(&text);
        self.log.line(text)?;
        Ok(())
    }

    /// Brings a bonded body from break to break; each is a row of the history, with the load just before it.
    pub(crate) fn break_at_rest(&mut self, scene: &mut Scene, settings: BondedStaticSettings) -> Result<End, Failure> {
        let (bonds, output) = (1, PHASES.len() - 1);
        self.timed(output, |run| run.recorder.frame(scene))?;
        let solver = self.timed(bonds, |_| BondedStatics::new(scene, settings));
        let mut solver = solver.map_err(|error| Failure::input(format!("{error}; raise solver.tolerance")))?;
        let mut end = End::Finished;
        loop {
            self.timed(bonds, |_| solver.rise(scene));
            let (time, dt) = (scene.clock.time, scene.clock.dt_before);
            self.timed(output, |run| run.recorder.row(scene, time, dt))?;
            self.warn_of_balance(scene)?;
            if self.recorder.frame_is_due(time) {
                self.timed(output, |run| run.recorder.frame(scene))?;
            }
            if solver.is_finished(scene) || self.falls_below() {
                break;
            }
            if is_interrupted() {
                end = End::Interrupted;
                break;
            }
            if let Err(error) = self.timed(bonds, |_| solver.release(scene)) {
                end = End::Failed(error);
                break;
            }
            if self.progress.due(self.started.elapsed()) {
                self.progress.show(&self.snapshot(scene), self.started.elapsed());
            }
        }
        let (equilibria, iterations) = solver.effort();
        self.log
            .line(format!("{equilibria} equilibria of the bonds, {iterations} iterations of conjugate gradients"))?;
        Ok(end)
    }
}
