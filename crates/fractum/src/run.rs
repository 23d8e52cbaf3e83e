//! One case, from its file to its results folder: by one run, or by several where it asks for an accuracy.

use std::path::Path;

use fractum_case::read_case;

use crate::accuracy;
use crate::error::Failure;
use crate::process::ranks::Ranks;
use crate::simulation::{Measure, Options, Outcome, run_whole};

/// Runs the case at `path` on threads of its own.
///
/// # Errors
/// [`Failure`]: mistakes in the input, a run that stopped itself, a machine that failed.
pub fn run(path: &Path, options: &Options) -> Result<Outcome, Failure> {
    run_measured(path, options).map(|(outcome, _)| outcome)
}

/// As [`run`], as one of several ranks: the first of them has the outcome of one process by itself.
///
/// # Errors
/// As [`run`]; [`Failure::Elsewhere`] where another rank tells what went wrong.
pub fn run_shared(path: &Path, options: &Options, ranks: Ranks) -> Result<Outcome, Failure> {
    measure(path, options, ranks).map(|(outcome, _)| outcome)
}

/// As [`run`], and what it took.
///
/// # Errors
/// As [`run`].
pub(crate) fn run_measured(path: &Path, options: &Options) -> Result<(Outcome, Measure), Failure> {
    measure(path, options, Ranks::alone())
}

fn measure(path: &Path, options: &Options, ranks: Ranks) -> Result<(Outcome, Measure), Failure> {
    if ranks.processes().all == 1 {
        let case = read_case(path, &options.overrides)?;
        if let Some(asked) = case.asked_accuracy() {
            return accuracy::run(path, &case, asked, options);
        }
    }
    run_whole(path, options, ranks)
}
