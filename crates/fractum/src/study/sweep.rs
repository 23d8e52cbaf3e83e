//! Runs of a list, each started by itself: on the nodes of a cluster, or by a workflow program; and their results in one
//! table.

use std::path::{Path, PathBuf};

use fractum_case::read_case;
use fractum_case::study::list::{Listed, keys, read};
use fractum_output::history::quoted;
use fractum_output::summary::{Status, Summary, hash_text};
use fractum_output::{atomic, checkpoint};
use serde_json::Value;

use crate::error::{ExitCode, Failure};
use crate::run::run;
use crate::simulation::{Options, kept_hash};
use crate::tell;

/// Where a list keeps the results of its runs: `runs/` beside `runs.csv`.
pub fn results_folder(list: &Path) -> PathBuf {
    list.with_extension("")
}

/// Finds a run by its name, else by its number in the list, from 1.
///
/// # Errors
/// Mistakes of the list; a run that it does not have.
pub fn find(list: &Path, wanted: &str) -> Result<Listed, Failure> {
    let runs = read(list)?;
    let number = wanted.parse().ok().and_then(|number: usize| number.checked_sub(1));
    let at = runs.iter().position(|run| run.name == wanted).or(number.filter(|&at| at < runs.len()));
    at.map(|at| runs[at].clone()).ok_or_else(|| {
        let text = format!("{}: no run \"{wanted}\"; it has {} runs, by name or from 1", list.display(), runs.len());
        Failure::input(text)
    })
}

/// Does a run of a list, unless it has finished before; goes on from its last state, if there is one of this case. The
/// status that it ends with.
///
/// - `options`: their `output` is the folder of all results; overrides and `resume` are those of the run
/// - `anew`: from the start in any case
///
/// # Errors
/// As [`run`].
pub fn run_one(listed: &Listed, folder: &Path, options: &Options, anew: bool) -> Result<Status, Failure> {
    let place = folder.join(&listed.name);
    let case = read_case(&listed.case, &listed.overrides)?;
    let hash = hash_text(case.hash());
    let summary = Summary::read(&place.join("summary.json")).ok();
    let own = summary.filter(|summary| summary.hashes.case_hash == hash && !anew);
    if own.as_ref().is_some_and(|summary| summary.status == Status::Completed) {
        tell!("run {} has finished before: {}", listed.name, place.display());
        return Ok(Status::Completed);
    }
    // A state by itself does not tell whether it was reached with the end of this case.
    let has_state = checkpoint::is_there(&place.join("checkpoint"));
    let resume = !anew && has_state && kept_hash(&place) == Some(hash);
    if !resume && !anew && has_state {
        tell!("{}: a state of another case; run {} starts anew", place.display(), listed.name);
    }
    let overrides = listed.overrides.clone();
    let options = Options { output: Some(place), overrides, resume, overwrite: !resume, ..options.clone() };
    match run(&listed.case, &options) {
        // The state is that of another mesh or program.
        Err(failure @ Failure::Checkpoint(_)) if resume && failure.exit_code() == ExitCode::Input => {
            tell!("{failure}; run {} starts anew", listed.name);
            run(&listed.case, &Options { resume: false, overwrite: true, ..options })
        }
        ended => ended,
    }
    .map(|outcome| outcome.summary.status)
}

/// Writes what all runs of a list came to as one table: the columns of the list, then every number of the summaries under
/// its dotted path. How many runs have finished, of all.
///
/// # Errors
/// Mistakes of the list; a table that cannot be written.
pub fn collect(list: &Path, folder: &Path, table: &Path) -> Result<(usize, usize), Failure> {
    let runs = read(list)?;
    let rows: Vec<Vec<(String, String)>> = runs.iter().map(|run| row(&folder.join(&run.name))).collect();
    let mut columns: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !columns.contains(&name.as_str()) {
            columns.push(name);
        }
    }
    let keys = keys(&runs);
    let header: Vec<&str> =
        ["run", "case"].into_iter().chain(keys.iter().copied()).chain(columns.iter().copied()).collect();
    let mut lines = vec![header.into_iter().map(quoted).collect::<Vec<_>>().join(",")];
    let find = |pairs: &[(String, String)], name: &str| {
        quoted(pairs.iter().rev().find(|(key, _)| key == name).map_or("", |(_, value)| value))
    };
    for (run, row) in runs.iter().zip(&rows) {
        let mut cells = vec![quoted(&run.name), quoted(&run.case.to_string_lossy())];
        cells.extend(keys.iter().map(|key| find(&run.overrides, key)));
        cells.extend(columns.iter().map(|name| find(row, name)));
        lines.push(cells.join(","));
    }
    atomic::write(table, (lines.join("\n") + "\n").as_bytes())?;
    let finished = rows.iter().filter(|row| row.iter().any(|(name, value)| name == "status" && value == "completed"));
    Ok((finished.count(), runs.len()))
}

/// What a results folder tells: names and values.
fn row(folder: &Path) -> Vec<(String, String)> {
    let mut row = Vec::new();
    match Summary::read(&folder.join("summary.json")) {
        Ok(summary) => flatten("", &serde_json::to_value(summary).unwrap_or_default(), &mut row),
        Err(_) => row.push(("status".to_owned(), "missing".to_owned())),
    }
    row
}

/// Numbers and texts under their dotted paths; lists are left out.
fn flatten(path: &str, value: &Value, row: &mut Vec<(String, String)>) {
    match value {
        Value::Object(entries) => {
            for (name, value) in entries {
                let path = if path.is_empty() { name.clone() } else { format!("{path}.{name}") };
                flatten(&path, value, row);
            }
        }
        Value::Array(_) => {}
        Value::Null => row.push((path.to_owned(), String::new())),
        Value::String(text) => row.push((path.to_owned(), text.clone())),
        other => row.push((path.to_owned(), other.to_string())),
    }
}
