//! The gallery against its references.

pub(crate) mod needs;
pub mod neighbours;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use fractum_case::model::Case;
use fractum_case::read_case;
use fractum_output::expectation::Expectation;
use fractum_output::number::quantity;
use fractum_output::summary::{Status, Summary, Wall};
use fractum_output::verified::{self, Verified};
use fractum_prepare::Cache;

use crate::error::Failure;
use crate::input::load;
use crate::phases::Part;
use crate::plan::{Estimate, estimate};
use crate::process::pool;
use crate::run::run;
use crate::simulation::{Options, Outcome};
use crate::verify::needs::needs;
use crate::{say, tell};

/// What is verified, and where results go.
#[derive(Clone, Debug)]
pub struct Selection {
    /// Folder with the cases.
    pub cases: PathBuf,
    /// Only cases whose path contains one of these; all if empty.
    pub names: Vec<String>,
    /// Only cases marked `[verify] quick = true`.
    pub quick: bool,
    /// Folder for results, `verify.json` and `verify.md`.
    pub output: PathBuf,
    /// Cases that run at the same time.
    pub jobs: usize,
    /// Threads per case; all cores if none is given.
    pub threads: Option<usize>,
    /// Where packings and beams of bonded bodies are kept.
    pub cache: Cache,
}

/// What has come out so far.
struct Done {
    /// Lines of each case, in the order of the cases.
    lines: Vec<Vec<Verified>>,
    /// What ended the verification before its end.
    wrong: Option<Failure>,
}

/// The cases that have not run, in their order, and those that run.
struct Queue {
    waiting: Vec<usize>,
    running: Vec<usize>,
}

impl Queue {
    /// The next case: one of a folder of which none runs, where there is one. Cases of one folder have bonded bodies in common, which
    /// the second finds ready once the first has made them.
    fn next<F: PartialEq>(&mut self, folder: impl Fn(usize) -> F) -> Option<usize> {
        let is_free = |&index: &usize| self.running.iter().all(|&other| folder(other) != folder(index));
        let place = self.waiting.iter().position(is_free).unwrap_or(0);
        let index = (!self.waiting.is_empty()).then(|| self.waiting.remove(place))?;
        self.running.push(index);
        Some(index)
    }
}

/// Runs the selected cases that expect something, prints the table and writes it after every case into `verify.json` and
/// `verify.md`, with the shares of the parts of each run beside those that the case needs in `phases.md`, and the estimates of `fractum check` beside the times of the runs in
/// `estimates.md`; the lines of the table.
///
/// # Errors
/// [`Failure::Input`] if nothing is selected, [`Failure::Write`] if the table cannot be written. A case that fails to
/// run is a line that does not pass.
pub fn verify(selection: &Selection) -> Result<Vec<Verified>, Failure> {
    let cases = selected(selection)?;
    if cases.is_empty() {
        return Err(Failure::input(format!("{}: no case with [[expect]] matches", selection.cases.display())));
    }
    say!(
        "{:<36} {:<30} {:>14} {:>22} {:>10}  {:<5} {:>8}",
        "case",
        "quantity",
        "value",
        "expected",
        "off by",
        "pass",
        "seconds"
    );
    fractum_output::atomic::create_folder(&selection.output)?;
    let done = Mutex::new(Done { lines: vec![Vec::new(); cases.len()], wrong: None });
    // A worker that panicked has left the lines of whole cases.
    let lock = || done.lock().unwrap_or_else(PoisonError::into_inner);
    let queue = Mutex::new(Queue { waiting: (0..cases.len()).collect(), running: Vec::new() });
    let queued = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let folder = |index: usize| cases[index].0.parent();
    let work = || {
        loop {
            let Some(index) = queued().next(folder).filter(|_| lock().wrong.is_none()) else { return };
            let (path, case) = &cases[index];
            let lines = verified(selection, path, case);
            queued().running.retain(|&other| other != index);
            let mut done = lock();
            let written = lines.and_then(|lines| {
                lines.iter().for_each(print_line);
                done.lines[index] = lines;
                Ok(verified::write(&selection.output, &done.lines.concat())?)
            });
            if let Err(failure) = written {
                done.wrong.get_or_insert(failure);
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..selection.jobs.clamp(1, cases.len()) {
            scope.spawn(work);
        }
    });
    let Done { lines, wrong } = done.into_inner().unwrap_or_else(PoisonError::into_inner);
    if let Some(failure) = wrong {
        return Err(failure);
    }
    let lines = lines.concat();
    let passed = lines.iter().filter(|line| line.expectation.pass).count();
    say!("{passed} of {} passed; {}", lines.len(), selection.output.join("verify.md").display());
    Ok(lines)
}

/// The selected cases that expect something, in the order of their names.
pub(crate) fn selected(selection: &Selection) -> Result<Vec<(PathBuf, Case)>, Failure> {
    let mut paths = Vec::new();
    find_cases(&selection.cases, &mut paths).map_err(|error| {
        Failure::input(format!(
            "{}: cannot list the cases: {error}; name the folder with --cases",
            selection.cases.display()
        ))
    })?;
    paths.sort();
    paths.retain(|path| {
        let name = selection.name_of(path);
        selection.names.is_empty() || selection.names.iter().any(|n| name.contains(n.as_str()))
    });
    let mut cases = Vec::new();
    for path in paths {
        let case = read_case(&path, &[])?;
        if !case.expect.is_empty() && (case.source.verify.quick || !selection.quick) {
            cases.push((path, case));
        }
    }
    Ok(cases)
}

impl Selection {
    pub(crate) fn name_of(&self, path: &Path) -> String {
        path.strip_prefix(&self.cases).unwrap_or(path).with_extension("").display().to_string()
    }
}

/// Runs a case: a line for each of its expectations, or one that says why it did not run.
fn verified(selection: &Selection, path: &Path, case: &Case) -> Result<Vec<Verified>, Failure> {
    let name = selection.name_of(path);
    let options = Options {
        output: Some(selection.output.join(&name)),
        threads: selection.threads,
        quiet: true,
        strict: false,
        overwrite: true,
        cache: selection.cache.clone(),
        ..Options::default()
    };
    let started = Instant::now();
    let outcome = run(path, &options);
    let (seconds, needs) = (started.elapsed().as_secs_f64(), needs(case));
    let (expectations, phases) = match outcome {
        Ok(outcome) if outcome.summary.status == Status::Interrupted => return Err(Failure::Interrupted),
        Ok(Outcome { summary: Summary { expect, wall: Wall { total, mut phases }, .. }, .. }) => {
            // The files of the end are written when the summary has been made.
            *phases.entry(Part::Output.name().to_owned()).or_default() += seconds - total;
            (expect, phases)
        }
        Err(error) => {
            tell!("{name}: {error}");
            let failed = Expectation { quantity: "run".into(), source: error.to_string(), ..Expectation::default() };
            (vec![failed], BTreeMap::new())
        }
    };
    // After the run, which prepares what the estimate would have to make ready once more.
    let estimate = estimated(selection, path);
    let line = |expectation| Verified {
        case: name.clone(),
        expectation,
        seconds,
        phases: phases.clone(),
        needs: needs.clone(),
        estimate,
    };
    Ok(expectations.into_iter().map(line).collect())
}

/// How long `fractum check` says that the steps of a case take, and its output [s].
fn estimated(selection: &Selection, path: &Path) -> Option<[f64; 2]> {
    let estimated = || {
        let mut input = load(path, &[], &selection.cache).ok()?;
        let Estimate { steps, output, .. } = estimate(&mut input, 0.0)?;
        Some([steps, output])
    };
    pool(selection.threads).ok()?.install(estimated)
}

fn print_line(line: &Verified) {
    let expectation = &line.expectation;
    say!(
        "{:<36} {:<30} {:>14} {:>22} {:>10}  {:<5} {:>8.2}",
        line.case,
        expectation.quantity,
        quantity(expectation.value, &expectation.unit),
        expectation.required(),
        expectation.off(),
        if expectation.pass { "pass" } else { "FAIL" },
        line.seconds
    );
}

fn find_cases(folder: &Path, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            find_cases(&path, found)?;
        } else if path.extension().is_some_and(|e| e == "toml") && path.file_name().is_some_and(|n| n != "study.toml") {
            found.push(path);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cases_of_one_folder_run_one_after_the_other_where_others_wait() {
        let folders = ["a", "a", "b", "a", "c"];
        let mut queue = Queue { waiting: (0..folders.len()).collect(), running: Vec::new() };
        let mut next = |ended: Option<usize>| {
            queue.running.retain(|&index| Some(index) != ended);
            queue.next(|index| folders[index])
        };
        assert_eq!([next(None), next(None)], [Some(0), Some(2)]);
        assert_eq!([next(Some(2)), next(Some(0)), next(Some(4))], [Some(4), Some(1), Some(3)]);
        assert_eq!(next(None), None);
    }
}
