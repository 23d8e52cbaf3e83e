//! One case, from its file to its results folder.

use std::path::Path;

use crate::error::Failure;
use crate::simulation::{Options, Outcome, Simulation};

/// Runs the case at `path` on threads of its own.
///
/// # Errors
/// [`Failure`]: mistakes in the input, a run that stopped itself, a machine that failed.
pub fn run(path: &Path, options: &Options) -> Result<Outcome, Failure> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = options.threads {
        pool = pool.num_threads(threads);
    }
    // Inside the pool, parallel loops start without a hand-over between threads.
    pool.build()?.install(|| {
        let mut simulation = Simulation::open(path, options)?;
        while !simulation.is_over() {
            simulation.step()?;
            simulation.record()?;
        }
        simulation.finish()
    })
}
