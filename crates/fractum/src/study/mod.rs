//! `fractum study`: runs the cases of a study and writes run time beside error.
//!
//! Every run has a folder of its own below `runs`, named by the hash of its case, mesh and program; a run that has finished
//! there is not run again. Tables and pages are made from what has finished, so that a study that was interrupted goes on.

mod single;
pub mod sweep;

use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use fractum_case::study::plan::Study;
use fractum_output::atomic;
use fractum_output::number::significant;
use fractum_output::study::compare::{Family, families};
use fractum_output::study::run::{End, Run};
use fractum_output::study::table;
use fractum_prepare::Cache;

use crate::error::Failure;
use crate::process::interrupt::{UnderWay, is_interrupted};
use crate::report;
use crate::{say, tell};
use single::Single;

/// How a study is run.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Folder for runs, tables and page.
    pub output: PathBuf,
    /// Runs at the same time.
    pub jobs: usize,
    /// Threads per run.
    pub threads: usize,
    /// Run anew what has finished before.
    pub anew: bool,
    /// Only the tables of what has finished.
    pub only_tables: bool,
    /// Where packings and beams of bonded bodies are kept.
    pub cache: Cache,
}

/// Runs what has not finished yet, and writes `study.csv`, `study.json`, `study.svg`, `study.html` and the tables.
///
/// # Errors
/// [`Failure::Write`] where something cannot be written, [`Failure::Interrupted`] after Ctrl-C, with the tables of what has
/// finished. A run that is refused or stops itself is a line of the tables.
pub fn study(study: &Study, settings: &Settings) -> Result<Vec<Run>, Failure> {
    let (runs, ended) = runs(study, settings)?;
    write(study, &runs, settings)?;
    ended.map(|()| runs)
}

/// Runs what has not finished yet: all runs, and what kept those that are open from their end.
///
/// # Errors
/// [`Failure::Write`] where the folder of the study cannot be made.
pub(crate) fn runs(study: &Study, settings: &Settings) -> Result<(Vec<Run>, Result<(), Failure>), Failure> {
    atomic::create_folder(&settings.output)?;
    let under_way = UnderWay::new();
    let slots: Vec<Mutex<Option<Run>>> = study.runs.iter().map(|_| Mutex::new(None)).collect();
    let next = AtomicUsize::new(0);
    let wrong: Mutex<Option<Failure>> = Mutex::new(None);
    let program = program()?;
    // Two runs alike share a folder; the second one waits until the first has finished.
    let busy = Mutex::new(BTreeSet::new());
    let work = || {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(planned) = study.runs.get(index) else { return };
            let single = Single { planned, settings, program, busy: &busy };
            match single.run() {
                Ok(run) => {
                    show(&run, index, study.runs.len());
                    put(&slots[index], Some(run));
                }
                Err(failure) => {
                    put(&wrong, Some(failure));
                    return;
                }
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..settings.jobs.clamp(1, study.runs.len().max(1)) {
            scope.spawn(work);
        }
    });
    let open = |planned: &fractum_output::study::run::Planned| Run { planned: planned.clone(), ..Run::default() };
    let runs: Vec<Run> =
        slots.into_iter().zip(&study.runs).map(|(slot, planned)| take(slot).unwrap_or_else(|| open(planned))).collect();
    let ended = match take(wrong) {
        Some(failure) => Err(failure),
        None if is_interrupted() => Err(Failure::Interrupted),
        None => Ok(()),
    };
    drop(under_way);
    Ok((runs, ended))
}

/// Hash of this program, by which what another build has found is told from its own results.
fn program() -> Result<u128, Failure> {
    let read = std::env::current_exe().and_then(std::fs::read);
    let bytes =
        read.map_err(|error| Failure::input(format!("this program cannot be read, to tell its results: {error}")))?;
    Ok(xxhash_rust::xxh3::xxh3_128(&bytes))
}

/// A worker that panicked has left its lock poisoned, and its value as it was.
fn put<T>(slot: &Mutex<T>, value: T) {
    *slot.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = value;
}

fn take<T>(slot: Mutex<T>) -> T {
    slot.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// A line of progress.
fn show(run: &Run, index: usize, of: usize) {
    let words: Vec<&str> = run.planned.coordinates.iter().map(|(_, value)| value.as_str()).collect();
    let name = format!("{}/{of} {}: {}", index + 1, run.planned.family, words.join(", "));
    match &run.end {
        End::Finished(measured) => {
            let worst = measured.worst().map_or(String::new(), |worst| {
                format!(", largest relative error {}", fractum_output::number::percent(worst))
            });
            tell!("{name}: {} s{worst}", significant(measured.seconds(), 3));
        }
        End::Failed(why) => tell!("{name}: {why}"),
        End::Open => {}
    }
}

fn write(study: &Study, runs: &[Run], settings: &Settings) -> Result<(), Failure> {
    let families: Vec<Family<'_>> = families(runs);
    let within = study.within;
    let file = |name: &str| settings.output.join(name);
    let mut text: Vec<String> = families.iter().map(|family| table::runs(family).to_markdown()).collect();
    text.extend(table::settings(&families).iter().map(|settings| settings.to_markdown()));
    text.push(lines(&table::findings(&families, within)));
    text.push(lines(&table::failures(&families)));
    text.retain(|part| !part.is_empty());
    let text = text.join("\n");
    atomic::write(&file("study.md"), text.as_bytes())?;
    atomic::write(&file("study.csv"), table::to_csv(runs).as_bytes())?;
    atomic::write(&file("study.json"), table::to_json(&study.title, &families, within).as_bytes())?;
    report::write_study(&study.title, &families, within, &settings.output)?;
    say!("{text}");
    say!("! means that a reference is missed; {} in {}", report::STUDY_FILES, settings.output.display());
    Ok(())
}

fn lines(lines: &[String]) -> String {
    lines.iter().map(|line| format!("- {line}\n")).collect()
}
