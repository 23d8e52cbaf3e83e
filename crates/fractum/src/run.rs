//! One case, from its file to its results folder.

use std::path::Path;

use crate::error::Failure;
use crate::process::pool;
use crate::process::ranks::Ranks;
use crate::simulation::{Options, Outcome, Simulation};

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

/// As [`run`], with the processor time of all its threads [s] where the system tells it.
///
/// # Errors
/// As [`run`].
pub(crate) fn run_measured(path: &Path, options: &Options) -> Result<(Outcome, Option<f64>), Failure> {
    measure(path, options, Ranks::alone())
}

fn measure(path: &Path, options: &Options, ranks: Ranks) -> Result<(Outcome, Option<f64>), Failure> {
    let pool = pool(options.threads)?;
    // Inside the pool, parallel loops start without a hand-over between threads.
    let outcome = pool.install(|| {
        let mut simulation = Simulation::open_shared(path, options, ranks)?;
        while !simulation.is_over() {
            simulation.step()?;
            simulation.record()?;
        }
        simulation.finish()
    })?;
    let seconds = pool.broadcast(|_| processor_time()).into_iter().sum();
    Ok((outcome, seconds))
}

/// Processor time of this thread [s], as Linux tells it.
fn processor_time() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split_whitespace().next()?.parse().ok()?;
    Some(1e-9 * nanoseconds)
}
