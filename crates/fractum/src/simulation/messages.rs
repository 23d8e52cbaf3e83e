//! What a run tells its user, on the terminal and in its log.

use std::io::Stderr;

use fractum_math::Vec3;
use fractum_output::log::{Progress, RunLog};
use fractum_output::warning::Warning;

use super::Options;
use crate::error::Failure;

/// Terminal, log, and the one list of warnings.
pub(super) struct Messages {
    pub(super) progress: Progress<Stderr>,
    pub(super) log: RunLog,
    /// All warnings, in the order in which they came.
    warnings: Vec<Warning>,
    /// How many of them were found before the first step, and are found again by a resumed run.
    before: usize,
    /// What the last step brought, until it is told.
    pub(super) event: Option<String>,
    /// Whether a warning ends the run.
    pub(super) strict: bool,
    /// Another rank speaks, or all passes together.
    silent: bool,
}

impl Messages {
    /// - `silent`: nothing at all on the terminal, since another rank speaks
    pub(super) fn new(log: RunLog, options: &Options, silent: bool) -> Self {
        let progress = Progress::on_stderr(options.quiet || silent);
        let silent = silent || options.is_later_pass();
        Messages { progress, log, warnings: Vec::new(), before: 0, event: None, strict: options.strict, silent }
    }

    pub(super) fn tell(&mut self, text: &str) -> Result<(), Failure> {
        if !self.silent {
            self.progress.message(text);
        }
        Ok(self.log.line(text)?)
    }

    /// Warns, once of the same.
    pub(super) fn warn(&mut self, warning: Warning) -> Result<(), Failure> {
        if self.warnings.contains(&warning) {
            return Ok(());
        }
        self.tell(&warning.to_string())?;
        self.warnings.push(warning);
        Ok(())
    }

    /// Warns of what was found before the first step.
    ///
    /// - `earlier`: what the steps before a resumed one brought
    pub(super) fn begin(&mut self, found: Vec<Warning>, earlier: Vec<Warning>) -> Result<(), Failure> {
        found.into_iter().try_for_each(|warning| self.warn(warning))?;
        self.before = self.warnings.len();
        earlier.into_iter().try_for_each(|warning| self.warn(warning))
    }

    /// All warnings so far.
    pub(super) fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Those that the steps brought.
    pub(super) fn of_steps(&self) -> &[Warning] {
        &self.warnings[self.before..]
    }

    pub(super) fn tell_event(&mut self) -> Result<(), Failure> {
        self.event.take().map_or(Ok(()), |event| self.tell(&event))
    }
}

/// A place in words.
pub(super) fn at(x: Vec3) -> String {
    format!("({:.4e}, {:.4e}, {:.4e}) m", x.x, x.y, x.z)
}
