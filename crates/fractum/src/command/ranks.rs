//! `fractum run` as one of the processes that MPI has started together.

use fractum::{ExitCode, Failure, Ranks};

use super::RunArguments;

/// Runs a case, with the other processes where there are any.
#[cfg(not(feature = "mpi"))]
pub(super) fn run_case(run: RunArguments, _json: bool) -> Result<ExitCode, Failure> {
    // What Open MPI, and MPICH and its kin, tell the processes that they start.
    let started = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"].iter().filter_map(|name| std::env::var(name).ok());
    if started.into_iter().any(|size| size.trim() != "1") {
        return Err(Failure::input(
            "several processes were started, and this program was built without MPI; build it with --features mpi, or run it \
             without mpirun",
        ));
    }
    super::run_case(run, Ranks::alone())
}

/// Runs a case, with the other processes where there are any.
///
/// - `json`: as in [`super::report`]
#[cfg(feature = "mpi")]
pub(super) fn run_case(run: RunArguments, json: bool) -> Result<ExitCode, Failure> {
    use std::sync::Arc;

    use fractum_parallel::{Exchange, initialize};

    let Some((_universe, world)) = initialize() else {
        return Err(Failure::input("MPI cannot be used from threads here; its library needs MPI_THREAD_SERIALIZED"));
    };
    if world.size() == 1 {
        return super::run_case(run, Ranks::alone());
    }
    let _guard = EndAll(world);
    let failure = match super::run_case(run, Ranks::new(Arc::new(world))) {
        Err(failure) => failure,
        done => return done,
    };
    // What comes from input, memory and steps is known to all of them.
    if failure.exit_code() != ExitCode::Machine || matches!(failure, Failure::Elsewhere(_) | Failure::Memory(_)) {
        // Told before this process leaves MPI: once one has left with an error, the others are killed.
        super::report(&failure, json);
        return Err(Failure::Elsewhere(failure.exit_code()));
    }
    // Only this process knows of it: the others would wait for ever.
    fractum::tell!("process {}: {failure}", world.rank());
    world.abort(failure.exit_code() as i32);
}

/// Ends all processes where this one panics, since the others would wait for ever.
#[cfg(feature = "mpi")]
struct EndAll(fractum_parallel::World);

#[cfg(feature = "mpi")]
impl Drop for EndAll {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.abort(ExitCode::Machine as i32);
        }
    }
}
