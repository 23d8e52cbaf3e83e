//! What a run tells its user, on the terminal and in its log.

use std::io::Stderr;

use fractum_io::log::{Progress, RunLog};
use fractum_io::number::at_instant;
use fractum_scene::Scene;

use crate::error::Failure;

/// Terminal, log, and the warnings for the report.
pub(super) struct Messages {
    pub(super) progress: Progress<Stderr>,
    pub(super) log: RunLog,
    pub(super) warnings: Vec<String>,
    /// What the last step brought, until it is told.
    pub(super) event: Option<String>,
    warned_of_balance: bool,
    /// Another rank speaks.
    silent: bool,
}

impl Messages {
    /// - `quiet`: no progress; `silent`: nothing at all, since another rank speaks
    pub(super) fn new(log: RunLog, quiet: bool, silent: bool) -> Self {
        let progress = Progress::on_stderr(quiet || silent);
        Messages { progress, log, warnings: Vec::new(), event: None, warned_of_balance: false, silent }
    }

    pub(super) fn tell(&mut self, text: &str) -> Result<(), Failure> {
        if !self.silent {
            self.progress.message(text);
        }
        Ok(self.log.line(text)?)
    }

    pub(super) fn warn(&mut self, text: String) -> Result<(), Failure> {
        self.tell(&text)?;
        self.warnings.push(text);
        Ok(())
    }

    pub(super) fn tell_event(&mut self) -> Result<(), Failure> {
        self.event.take().map_or(Ok(()), |event| self.tell(&event))
    }

    /// - `allowed`: relative residual of the energy balance above which to warn, once in a run
    /// - `at_rest`: whether the time is a load factor
    pub(super) fn warn_of_balance(&mut self, scene: &Scene, allowed: f64, at_rest: bool) -> Result<(), Failure> {
        let relative = scene.ledger().relative_residual();
        if self.warned_of_balance || relative <= allowed {
            return Ok(());
        }
        self.warned_of_balance = true;
        let instant = at_instant(scene.clock.time, at_rest);
        self.warn(format!("warning: {instant}: the energy balance is off by {relative:.1e} of the energy put in"))
    }
}
