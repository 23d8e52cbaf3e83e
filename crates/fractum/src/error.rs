use fractum_case::{Diagnostic, Diagnostics};
use fractum_output::checkpoint::CheckpointError;
use fractum_output::memory::TooLarge;
use fractum_output::warning::Warning;
use fractum_output::{OutputError, WriteError};
use fractum_scene::StepError;

/// Exit codes of the program, for scripts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ExitCode {
    /// Done.
    Done = 0,
    /// The case or the mesh is wrong.
    Input = 1,
    /// The run stopped itself.
    Stopped = 2,
    /// The machine failed: disk, memory.
    Machine = 3,
    /// Interrupted by the user, state saved.
    Interrupted = 130,
}

/// Why a command did not do what it was asked to.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// Mistakes in the case or the mesh.
    #[error(transparent)]
    Input(#[from] Diagnostics),
    /// The run stopped itself; the state that it saved last is in the results folder.
    #[error("{error}; last good state saved in {saved}")]
    Stopped {
        /// Why.
        error: StepError,
        /// Results folder, and which state was saved last.
        saved: String,
    },
    /// The run has stopped itself before, with this case, mesh and program.
    #[error("{0}; --anew runs it again")]
    StoppedBefore(String),
    /// The run was asked to take warnings for errors, and met one.
    #[error("{warning}; last good state saved in {saved}")]
    Strict {
        /// The warning.
        warning: Warning,
        /// Results folder, and which state was saved last.
        saved: String,
    },
    /// A file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A result could not be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A checkpoint could not be saved or does not fit.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// There is less memory than the case or a state needs.
    #[error("{0}; choose a coarser mesh or fewer particles, or a machine with more memory")]
    Memory(#[from] TooLarge),
    /// Threads could not be started.
    #[error("the threads could not be started: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Another of the processes that run the case together could not go on, and says why.
    #[error("another process could not go on")]
    Elsewhere(ExitCode),
    /// The user ended it.
    #[error("interrupted")]
    Interrupted,
    /// A picture could not be drawn.
    #[cfg(feature = "report")]
    #[error(transparent)]
    Picture(#[from] fractum_report::picture::PictureError),
    /// A quantity of the case did not meet its reference.
    #[error("{0}")]
    Unmet(String),
}

impl ExitCode {
    /// The exit code of that number; a number of none is a failure of the machine.
    pub(crate) fn from_code(code: u64) -> Self {
        let all = [ExitCode::Done, ExitCode::Input, ExitCode::Stopped, ExitCode::Interrupted];
        all.into_iter().find(|own| *own as u64 == code).unwrap_or(ExitCode::Machine)
    }
}

#[cfg(feature = "report")]
impl From<fractum_report::ReportError> for Failure {
    fn from(error: fractum_report::ReportError) -> Self {
        use fractum_report::ReportError as Error;
        match error {
            Error::Input(message) => Failure::input(message),
            Error::Write(error) => Failure::Write(error),
            Error::Picture(error) => Failure::Picture(error),
        }
    }
}

impl Failure {
    /// A mistake in the input that has no place in a case file.
    pub fn input(message: impl Into<String>) -> Self {
        Failure::Input(Diagnostics(vec![Diagnostic::without_place(message)]))
    }

    /// The exit code that tells a script what kind of failure this is.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Failure::Input(_) | Failure::Unmet(_) => ExitCode::Input,
            #[cfg(feature = "report")]
            Failure::Picture(_) => ExitCode::Input,
            Failure::Stopped { .. } | Failure::StoppedBefore(_) | Failure::Strict { .. } => ExitCode::Stopped,
            Failure::Elsewhere(code) => *code,
            Failure::Interrupted => ExitCode::Interrupted,
            Failure::Write(WriteError::Busy { .. }) => ExitCode::Input,
            Failure::Checkpoint(CheckpointError::Write(_) | CheckpointError::TooLarge { .. }) => ExitCode::Machine,
            Failure::Checkpoint(_) => ExitCode::Input,
            Failure::Memory(_) | Failure::Write(_) | Failure::Output(_) | Failure::Threads(_) => ExitCode::Machine,
        }
    }
}
