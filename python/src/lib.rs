//! The module `fractum._core` behind the Python package `fractum`: whole runs, simulations that are driven step by step,
//! and their state as bytes of arrays.
//!
//! Python's lock is free while anything is computed, and Ctrl-C ends what runs as it ends the program: with its state
//! saved. Arrays come in the order of the mesh file, as in the results. The package in `python/fractum` makes numpy arrays
//! and exceptions of what this module gives.

mod arrays;
mod core;
mod errors;
mod given_load;
mod watch;

use std::path::PathBuf;

use fractum::{Options, cache_of_user};
use fractum_output::summary::Status;
use pyo3::prelude::*;

use crate::core::Core;
use crate::errors::raise;
use crate::watch::{pool, watch};

/// Runs a case to its end; its results folder, and whether it was interrupted.
///
/// - `set`: parameters or dotted keys and their values, as `fractum run --set` takes them
#[pyfunction]
fn run(
    py: Python<'_>,
    case: PathBuf,
    set: Vec<(String, String)>,
    output: Option<PathBuf>,
    threads: Option<usize>,
    begin: (bool, bool),
    told: (bool, bool),
) -> PyResult<(PathBuf, bool)> {
    let ((resume, overwrite), (quiet, strict)) = (begin, told);
    let options = Options { output, threads, overrides: set, resume, overwrite, quiet, strict, cache: cache_of_user() };
    // A thread that waits for those of the run.
    let host = pool(py, Some(1))?;
    let outcome = watch(py, &host, || fractum::run(&case, &options))?.map_err(|failure| raise(py, &failure))?;
    Ok((outcome.folder, outcome.summary.status == Status::Interrupted))
}

/// Asks all runs of this process to save their state and end.
#[pyfunction]
fn interrupt() {
    fractum::interrupt();
}

/// Lets runs start again after [`interrupt`].
#[pyfunction]
fn clear_interrupt() {
    fractum::clear_interrupt();
}

#[pymodule]
fn _core(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<Core>()?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(interrupt, module)?)?;
    module.add_function(wrap_pyfunction!(clear_interrupt, module)?)
}
