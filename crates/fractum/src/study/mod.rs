//! Many runs: a list, done here or one by one on a cluster, and one comparison of what they came to.
//!
//! Every run has a folder of its own; one that has finished there is not run again, and one that was interrupted goes on.
//! Tables and pages are made from what has finished.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use fractum_case::study::plan::Study;
use fractum_case::study::quantity::{Quantity, of_probes};
use fractum_output::atomic;
use fractum_output::expectation::Expectation;
use fractum_output::number::{percent, significant};
use fractum_output::study::compare::{Family, families};
use fractum_output::study::run::{End, Measured, Planned, Run};
use fractum_output::study::{list, table};
use fractum_output::summary::{Status, Summary};

use crate::error::Failure;
use crate::kept::{self, program};
use crate::process::interrupt::{UnderWay, is_interrupted};
use crate::run::run_measured;
use crate::simulation::Options;
use crate::{report, tell};

/// Where the results of a study are.
#[derive(Clone, Debug)]
pub struct Folders {
    /// Tables and page.
    pub tables: PathBuf,
    /// The folders of the runs, from that of the tables.
    pub runs: PathBuf,
}

impl Folders {
    /// Those of a study: tables in a folder, runs below `runs`.
    pub fn of_study(folder: &Path) -> Self {
        Self { tables: folder.to_owned(), runs: PathBuf::from("runs") }
    }

    /// Those of a list: `runs/` beside `runs.csv`, where nothing else is said.
    pub fn of_list(list: &Path, results: Option<PathBuf>) -> Self {
        Self { tables: results.unwrap_or_else(|| list.with_extension("")), runs: PathBuf::new() }
    }

    fn results(&self) -> PathBuf {
        self.tables.join(&self.runs)
    }
}

/// How runs are done.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Runs at the same time.
    pub jobs: usize,
    /// Run anew what has finished before.
    pub anew: bool,
    /// Threads of a run, and the cache of packings and beams.
    pub options: Options,
}

/// Writes the list of the runs of a study; `case` in it counts from its folder.
///
/// # Errors
/// [`Failure::Write`].
pub fn write_list(runs: &[Planned], path: &Path) -> Result<(), Failure> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    let mut runs = runs.to_vec();
    if let Some(folder) = folder {
        atomic::create_folder(folder)?;
        runs.iter_mut().for_each(|run| run.case = std::path::absolute(&run.case).unwrap_or_else(|_| run.case.clone()));
    }
    Ok(atomic::write(path, list::to_csv(&runs.iter().collect::<Vec<_>>()).as_bytes())?)
}

/// Finds a run by its name, else by its number in the list, from 1.
///
/// # Errors
/// A run that the list does not have.
pub fn find<'a>(runs: &'a [Planned], wanted: &str) -> Result<&'a Planned, Failure> {
    let number = wanted.parse().ok().and_then(|number: usize| runs.get(number.checked_sub(1)?));
    runs.iter().find(|run| run.name == wanted).or(number).ok_or_else(|| {
        Failure::input(format!("no run \"{wanted}\"; the list has {} runs, by name or from 1", runs.len()))
    })
}

/// Does one run, unless it has finished before; goes on from its last state. The status that it ends with.
///
/// # Errors
/// As [`crate::run`].
pub fn run_one(planned: &Planned, folders: &Folders, settings: &Settings) -> Result<Status, Failure> {
    let results = folders.results();
    let (status, kept) =
        kept::run_one(planned, &results, &settings.options, settings.anew, (program()?, run_measured))?;
    if kept {
        tell!("run {} has finished before: {}", planned.name, results.join(&planned.name).display());
    }
    Ok(status)
}

/// Does all runs, some at the same time. A run that is refused or stops itself is left as such, and the others go on.
///
/// # Errors
/// What the machine refuses; [`Failure::Interrupted`] after Ctrl-C.
pub fn run_all(runs: &[Planned], folders: &Folders, settings: &Settings) -> Result<(), Failure> {
    let results = folders.results();
    atomic::create_folder(&results)?;
    let (under_way, program) = (UnderWay::new(), program()?);
    // Two runs alike are one.
    let mut names = BTreeSet::new();
    let unlike: Vec<&Planned> = runs.iter().filter(|run| names.insert(run.name.as_str())).collect();
    let (next, wrong) = (AtomicUsize::new(0), Mutex::new(None));
    let work = || {
        while !is_interrupted() {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(planned) = unlike.get(index) else { return };
            match kept::run_one(planned, &results, &settings.options, settings.anew, (program, run_measured)) {
                Err(failure) if !kept::is_of_case(&failure) => {
                    // A worker that panicked has left its lock poisoned, and the value as it was.
                    *wrong.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(failure);
                    return;
                }
                _ => show(&kept::found(planned, &results, &folders.runs), index, unlike.len()),
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..settings.jobs.clamp(1, unlike.len().max(1)) {
            scope.spawn(work);
        }
    });
    drop(under_way);
    match wrong.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner) {
        Some(failure) => Err(failure),
        None if is_interrupted() => Err(Failure::Interrupted),
        None => Ok(()),
    }
}

/// What came of all runs, from their folders.
pub fn found(runs: &[Planned], folders: &Folders) -> Vec<Run> {
    let results = folders.results();
    runs.iter().map(|planned| kept::found(planned, &results, &folders.runs)).collect()
}

/// Compares what came of all runs: writes the tables and the page, and tells them. The runs.
///
/// - `table`: where the line of each run with every number of its summary goes
///
/// # Errors
/// [`Failure::Write`]; [`Failure::Input`] for a quantity that no run knows.
pub fn collect(study: &Study, folders: &Folders, table: Option<&Path>) -> Result<(Vec<Run>, String), Failure> {
    let mut runs = found(&study.runs, folders);
    compare(&mut runs, &study.compare)?;
    let families: Vec<Family<'_>> = families(&runs);
    let within = study.within;
    let file = |name: &str| folders.tables.join(name);
    let mut text: Vec<String> = families.iter().map(|family| table::runs(family).to_markdown()).collect();
    text.extend(table::settings(&families).iter().map(|settings| settings.to_markdown()));
    text.push(lines(&table::findings(&families, within)));
    text.push(lines(&table::failures(&families)));
    text.retain(|part| !part.is_empty());
    let mut text = text.join("\n");
    atomic::create_folder(&folders.tables)?;
    atomic::write(table.unwrap_or(&file("summary.csv")), list::results(&runs).as_bytes())?;
    atomic::write(&file("study.md"), text.as_bytes())?;
    atomic::write(&file("study.csv"), table::to_csv(&runs).as_bytes())?;
    atomic::write(&file("study.json"), table::to_json(&study.title, &families, within).as_bytes())?;
    report::write_study(&study.title, &families, within, &folders.tables)?;
    let missed = "! means that a reference is missed; ";
    let missed = if text.contains(" !") { missed } else { "" };
    text += &format!("{missed}{} in {}", report::STUDY_FILES, folders.tables.display());
    Ok((runs, text))
}

/// A line of progress.
fn show(run: &Run, index: usize, of: usize) {
    let words: Vec<&str> = run.planned.coordinates().map(|(_, value)| value).collect();
    let name = format!("{}/{of} {}: {}", index + 1, run.planned.family, words.join(", "));
    match &run.end {
        End::Finished(measured) => {
            let error = measured.worst().map(|worst| format!(", largest relative error {}", percent(worst)));
            tell!("{name}: {} s{}", significant(measured.seconds(), 3), error.unwrap_or_default());
        }
        End::Failed(why) => tell!("{name}: {why}"),
        End::Open => {}
    }
}

fn lines(lines: &[String]) -> String {
    lines.iter().map(|line| format!("- {line}\n")).collect()
}

/// Adds what finished runs are compared by: the wishes, or for runs without references their probes.
///
/// # Errors
/// A wish that no run can meet.
fn compare(runs: &mut [Run], wishes: &[Quantity]) -> Result<(), Failure> {
    let mut finished: Vec<(&mut Measured, &Summary)> = Vec::new();
    for run in runs {
        if let (End::Finished(measured), Some(summary)) = (&mut run.end, &run.summary) {
            finished.push((&mut **measured, summary));
        }
    }
    for wish in wishes {
        let found: Vec<Result<Expectation, String>> = finished.iter().map(|(_, summary)| wish.of(summary)).collect();
        if let Some(Err(why)) = found.first().filter(|_| found.iter().all(Result::is_err)) {
            return Err(Failure::input(why.clone()));
        }
        for ((measured, _), line) in finished.iter_mut().zip(found) {
            measured.expect.extend(line);
        }
    }
    for (measured, summary) in finished.into_iter().filter(|(measured, _)| measured.expect.is_empty()) {
        measured.expect = of_probes(summary);
    }
    Ok(())
}
