//! Work beside Python's lock that Ctrl-C reaches.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use fractum::Failure;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::errors::raise;

/// Between two looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);

/// Threads of a simulation; all cores if no number is given.
pub(crate) fn pool(py: Python<'_>, threads: Option<usize>) -> PyResult<ThreadPool> {
    let built = ThreadPoolBuilder::new().num_threads(threads.unwrap_or(0)).build();
    built.map_err(|error| raise(py, &Failure::from(error)))
}

/// Does `work` on the threads of a pool with Python's lock free.
///
/// # Errors
/// What a signal raised meanwhile, once the simulations that it interrupted have saved their state.
pub(crate) fn watch<R: Send>(py: Python<'_>, pool: &ThreadPool, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    let (done, mut finished) = channel();
    let (mut result, mut signal) = (None, None);
    pool.in_place_scope(|scope| {
        // Who waits hears of a panic by the end of the channel.
        scope.spawn(move |_| drop(done.send(work())));
        loop {
            let (waited, received) = py.detach(move || {
                let received = finished.recv_timeout(LOOK);
                (finished, received)
            });
            finished = waited;
            match received {
                Ok(value) => result = Some(value),
                Err(RecvTimeoutError::Disconnected) => {}
                Err(RecvTimeoutError::Timeout) => {
                    if let Err(error) = py.check_signals() {
                        fractum::interrupt();
                        signal.get_or_insert(error);
                    }
                    continue;
                }
            }
            break;
        }
    });
    if let Some(error) = signal {
        fractum::clear_interrupt();
        return Err(error);
    }
    result.ok_or_else(|| pyo3::exceptions::PyRuntimeError::new_err("the work ended without a result"))
}
