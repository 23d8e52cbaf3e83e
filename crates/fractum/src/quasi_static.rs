//! The loops of quasi-static runs.

use fractum_scene::statics::{StaticSettings, StaticSolver};
use fractum_scene::{BondedStaticSettings, BondedStatics, Scene};

use crate::error::Failure;
use crate::run::{End, PHASES, Run, is_interrupted};

impl Run<'_> {
    /// Steps from equilibrium to equilibrium; each is a row of the history.
    pub(crate) fn equilibrate(&mut self, scene: &mut Scene, settings: StaticSettings) -> Result<End, Failure> {
        let output = PHASES.len() - 1;
        let mut solver = match StaticSolver::new(scene, settings) {
            Ok(solver) => solver,
            Err(error) => return Err(Failure::input(format!("{error}; choose solver.linear_solver = \"iterative\""))),
        };
        let mut end = End::Finished;
        while !solver.is_finished(scene) {
            if is_interrupted() {
                end = End::Interrupted;
                break;
            }
            if self.recorder.frame_is_due(scene.clock.time) {
                self.timed(output, |run| run.recorder.frame(scene))?;
            }
            if let Err(error) = self.timed(0, |_| solver.step(scene)) {
                end = End::Failed(error);
                break;
            }
            let (time, dt) = (scene.clock.time, scene.clock.dt_before);
            self.timed(output, |run| run.recorder.row(scene, time, dt))?;
            self.warn_of_balance(scene)?;
            if self.falls_below() {
                break;
            }
            if self.progress.due(self.started.elapsed()) {
                self.progress.show(&self.snapshot(scene), self.started.elapsed());
            }
        }
        let (linear, iterations) = solver.work();
        self.log.line(format!(
            "{iterations} equilibrium iterations, {} factorisations, {} linear solutions, {} iterations of conjugate gradients",
            linear.factorisations, linear.solutions, linear.iterations
        ))?;
        Ok(end)
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
