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

use fractum::study::{Folders, Settings, collect, run_all};
use fractum::{Failure, Options, cache_of_user};
use fractum_case::study::plan::{Variation, is_list, plan};
use fractum_case::study::quantity::Quantity;
use fractum_output::expectation::Comparison;
use fractum_output::study::run::End;
use fractum_output::summary::Status;
use pyo3::prelude::*;

use crate::core::{Core, parts};
use crate::errors::{raise, wrong};
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
    let options = Options {
        output,
        threads,
        overrides: set,
        resume,
        overwrite,
        quiet,
        strict,
        cache: cache_of_user(),
        ..Options::default()
    };
    // A thread that waits for those of the run.
    let host = pool(py, Some(1))?;
    let outcome = watch(py, &host, || fractum::run(&case, &options))?.map_err(|failure| raise(py, &failure))?;
    Ok((outcome.folder, outcome.summary.status == Status::Interrupted))
}

/// The plan of a case and what is doubtful, as `fractum check` says them: code, text, place and remedy of each warning.
#[pyfunction]
fn check(py: Python<'_>, case: PathBuf, set: Vec<(String, String)>) -> PyResult<(String, Vec<[String; 4]>)> {
    let host = pool(py, Some(1))?;
    let (plan, doubts) = watch(py, &host, || fractum::plan::checked(&case, &set, &cache_of_user()))?
        .map_err(|failure| raise(py, &failure))?;
    let warnings = doubts.iter().filter_map(fractum_case::Diagnostic::to_warning);
    Ok((plan.to_string(), warnings.map(|warning| parts(&warning)).collect()))
}

/// Writes a template, as `fractum new` does; the path of its case.
#[pyfunction]
fn new(py: Python<'_>, name: &str, folder: Option<PathBuf>, overwrite: bool) -> PyResult<PathBuf> {
    fractum::template::write(name, folder, overwrite).map(|written| written.case).map_err(|failure| raise(py, &failure))
}

/// Names of the templates, each with what it is.
#[pyfunction]
fn templates() -> Vec<(&'static str, &'static str)> {
    fractum::template::all().collect()
}

/// Path, meaning, type and default of a key of the case file.
type Key = (&'static str, &'static str, String, &'static str);

/// The keys of the case file: one with those right below it, or all of them without a name.
#[pyfunction]
#[pyo3(signature = (key=None))]
fn explain(py: Python<'_>, key: Option<&str>) -> PyResult<Vec<Key>> {
    let told = |doc: &fractum_case::KeyDoc| (doc.path, doc.doc, doc.kind.label(), doc.default);
    let Some(key) = key else { return Ok(fractum_case::keys().iter().map(told).collect()) };
    let found = fractum_case::explain(key).map_err(|near| match near {
        Some(near) => wrong(py, format!("no key \"{key}\"; did you mean \"{near}\"?")),
        None => wrong(py, format!("no key \"{key}\"; fractum.explain() lists all of them")),
    })?;
    let below = format!("{}.", found.path);
    let is_below = |doc: &&fractum_case::KeyDoc| doc.path.strip_prefix(&below).is_some_and(|name| !name.contains('.'));
    Ok(std::iter::once(found).chain(fractum_case::keys().iter().filter(is_below)).map(told).collect())
}

/// Keys with their values: what all runs set, and what is varied.
type Given = (Vec<(String, String)>, Vec<(String, Vec<String>)>);

/// A run of a study: its folder, how it ended, why it failed, and what it varies and came to, each with its name.
type Ran = (PathBuf, &'static str, String, Vec<(String, String)>, Vec<(String, f64)>);

/// Does the runs of a study and writes its tables, as `fractum study` does.
///
/// - `begin`: runs at the same time, threads of each, whether what has finished is run anew
#[pyfunction]
fn study(
    py: Python<'_>,
    case: PathBuf,
    given: Given,
    compare: Vec<String>,
    output: PathBuf,
    begin: (usize, Option<usize>, bool),
) -> PyResult<Vec<Ran>> {
    let ((set, vary), (jobs, threads, anew)) = (given, begin);
    let host = pool(py, Some(1))?;
    let work = || -> Result<Vec<Ran>, Failure> {
        let vary: Vec<Variation> = vary.into_iter().map(|(key, values)| Variation { key, values }).collect();
        let mut study = plan(&case, &set, &vary)?;
        for text in &compare {
            study.compare.push(Quantity::parse(text).map_err(Failure::input)?);
        }
        let folders = if is_list(&case) { Folders::of_list(&case, Some(output)) } else { Folders::of_study(&output) };
        let options = Options { threads, quiet: true, cache: cache_of_user(), ..Options::default() };
        let ended = run_all(&study.runs, &folders, &Settings { jobs, anew, options });
        let (runs, _) = collect(&study, &folders, None)?;
        ended?;
        let ran = runs.iter().map(|run| {
            let error = if let End::Failed(why) = &run.end { why.clone() } else { String::new() };
            let named = |(axis, value): (&str, &str)| (axis.to_owned(), value.to_owned());
            let lines = run.measured().map_or(&[][..], |measured| &measured.expect);
            let asked = lines.iter().filter(|line| line.comparison == Comparison::Nothing && !compare.is_empty());
            let values = asked.map(|line| (line.quantity.clone(), line.value)).collect();
            let folder = folders.tables.join(&run.folder);
            (folder, run.status(), error, run.planned.coordinates().map(named).collect(), values)
        });
        Ok(ran.collect())
    };
    watch(py, &host, work)?.map_err(|failure| raise(py, &failure))
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
    module.add_function(wrap_pyfunction!(study, module)?)?;
    module.add_function(wrap_pyfunction!(check, module)?)?;
    module.add_function(wrap_pyfunction!(explain, module)?)?;
    module.add_function(wrap_pyfunction!(new, module)?)?;
    module.add_function(wrap_pyfunction!(templates, module)?)?;
    module.add_function(wrap_pyfunction!(interrupt, module)?)?;
    module.add_function(wrap_pyfunction!(clear_interrupt, module)?)
}
