//! The results of a case that asked for an accuracy: those of its finest pass, with estimates and error bars.

use std::fs;
use std::path::Path;

use fractum_case::model::AskedAccuracy;
use fractum_output::WriteError;
use fractum_output::accuracy::{Accuracy, CONFIDENCE};
use fractum_output::atomic::{self, Group};
use fractum_output::number::percent;
use fractum_output::study::table;
use fractum_output::summary::{Hashes, Status, Summary, hash_text};
use fractum_output::warning::{Code, Warning};

use super::{MESH, Passes};
use crate::error::Failure;
use crate::output::summary;
use crate::report;
use crate::simulation::{Outcome, begin_results, keep_case};
use crate::tell;

/// What stays with a pass: its states, its mesh, and what tells that it was done.
const OF_PASS: [&str; 7] = ["checkpoint", "input", MESH, "study-run.json", "damaged.json", "run.log", "summary.json"];

/// Writes the results of a case from those of its passes.
///
/// - `finest`: the pass whose fields and curves are shown
///
/// # Errors
/// [`Failure`] for what cannot be written.
pub(super) fn publish(
    passes: &Passes<'_>,
    finest: usize,
    asked: &AskedAccuracy,
    results: &Path,
) -> Result<Outcome, Failure> {
    let (case, load) = (passes.case, &passes.load.0);
    let outcome = |summary| Outcome { summary, folder: results.to_owned(), load: Some(load.clone()) };
    let (pass, shown, _) = &passes.done[finest];
    if passes.is_interrupted() {
        return Ok(outcome(Summary { status: Status::Interrupted, ..shown.clone() }));
    }
    let mut log = begin_results(results)?;
    keep_case(case, results, true)?;
    copy(&passes.folder.join(&pass.name), results, &OF_PASS)?;
    let probes =
        shown.probes.iter().filter_map(|(name, probe)| Some((name.clone(), passes.estimate(name, &probe.unit)?)));
    let accuracy = Accuracy {
        load: load.clone(),
        asked: asked.share.value,
        reached: passes.reached().unwrap_or(f64::NAN),
        confidence: CONFIDENCE,
        length: passes.length(),
        passes: passes.done.iter().map(|(pass, ..)| pass.clone()).collect(),
        probes: probes.collect(),
    };
    let own: Vec<Warning> = doubt(passes).into_iter().chain(missed(&accuracy, passes)).collect();
    own.iter().for_each(|warning| tell!("{warning}"));
    let warnings = [passes.warnings_of(finest), own].concat();
    let mut summary = Summary {
        hashes: Hashes { case_hash: hash_text(case.hash()), ..shown.hashes.clone() },
        warnings,
        ..shown.clone()
    };
    summary.origin.overrides = passes.options.overrides.iter().map(|(name, value)| format!("{name}={value}")).collect();
    summary.origin.command = passes.options.command("fractum", passes.path, results);
    summary.wall.total = passes.done.iter().map(|(pass, ..)| pass.wall).sum();
    let text = table::accuracy(&accuracy);
    summary.accuracy = Some(accuracy);
    summary.expect = case.expect.iter().map(|expect| summary::expectation(expect, &summary)).collect();
    text.lines().try_for_each(|line| log.line(line))?;
    summary.warnings.iter().try_for_each(|warning| log.line(warning))?;
    let mut files = Group::default();
    files.add(&results.join("summary.json"), summary.to_json().as_bytes());
    files.add(&results.join("accuracy.md"), text.as_bytes());
    let page = report::add(results, &mut files);
    files.finish()?;
    page?;
    passes.refuse_warnings(&summary.warnings, results)?;
    Ok(outcome(summary))
}

/// Bars that nobody has held against exact loads.
fn doubt(passes: &Passes<'_>) -> Option<Warning> {
    let found = format!(
        ": bars were held against exact loads of plane bodies at rest that crack by Rankine's criterion, and this is {}",
        passes.untried.join(" and ")
    );
    let warning = Warning::new(Code::Accuracy, "solver.accuracy", found);
    (!passes.untried.is_empty()).then(|| warning.remedy("take the bar for a hint, and compare with a finer mesh"))
}

/// What the passes did not reach.
fn missed(accuracy: &Accuracy, passes: &Passes<'_>) -> Option<Warning> {
    let (load, asked, count) = (&passes.load.0, percent(accuracy.asked), accuracy.passes.len());
    let warn = |found: String| Warning::new(Code::Accuracy, "solver.accuracy", found);
    if passes.done[0].2.is_empty() {
        return Some(
            warn(": no damage came, and the mesh was left as it is".to_owned())
                .remedy("look at loads and strengths, or leave it out"),
        );
    }
    match accuracy.probes.get(load) {
        None => Some(
            warn(format!(": fewer than two of {count} passes have seen the load fall behind its peak"))
                .remedy("let the run go on until the load falls, and look at the logs of the passes"),
        ),
        Some(_) if accuracy.reached > accuracy.asked => Some(
            warn(format!(" = {asked}: {} was reached after {count} passes", percent(accuracy.reached)))
                .remedy("raise solver.accuracy_runs, which begins anew, or be content with the bar"),
        ),
        Some(_) => None,
    }
}

/// Copies what a folder holds, but for some of its own files and folders.
fn copy(from: &Path, to: &Path, leave: &[&str]) -> Result<(), Failure> {
    atomic::create_folder(to)?;
    let wrong = |error| WriteError::new(from, error);
    for entry in fs::read_dir(from).map_err(wrong)? {
        let entry = entry.map_err(wrong)?;
        let (name, path) = (entry.file_name(), entry.path());
        if leave.iter().any(|own| name == *own) {
            continue;
        }
        if path.is_dir() {
            copy(&path, &to.join(&name), &[])?;
        } else {
            let bytes = fs::read(&path).map_err(|error| WriteError::new(&path, error))?;
            atomic::write(&to.join(&name), &bytes)?;
        }
    }
    Ok(())
}
