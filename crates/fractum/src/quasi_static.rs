//! The loop of a quasi-static run.

use fractum_scene::Scene;
use fractum_scene::statics::{StaticSettings, StaticSolver};

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
}
