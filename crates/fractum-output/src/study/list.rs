//! The list of runs as a CSV file, and the same lines with what came of them.
//!
//! ```csv
//! run,case,solver.safety,velocity
//! 1,case.toml,0.5,2 mm/s
//! 2,case.toml,0.9,2 mm/s
//! ```
//!
//! `run` names the results folder, `case` is taken from the folder of the list, and every further column is a parameter or
//! dotted key. An empty cell leaves the key as the case has it. Any program may write such a list.

use std::collections::BTreeSet;

use serde_json::Value;

use super::run::{End, Planned, Run};
use crate::history::quoted;

/// `summary.csv`: a line per run, the columns of the list, how the run ended, and every number of its summary under its dotted path.
pub fn results(runs: &[Run]) -> String {
    let planned: Vec<&Planned> = runs.iter().map(|run| &run.planned).collect();
    let rows: Vec<Vec<(String, String)>> = runs.iter().map(numbers).collect();
    let mut columns: Vec<&str> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !columns.contains(&name.as_str()) {
            columns.push(name);
        }
    }
    let keys = keys(&planned);
    let header = ["run", "case"].into_iter().chain(keys.iter().copied()).chain(columns.iter().copied());
    let mut text = line(header);
    for (run, row) in planned.iter().zip(&rows) {
        let case = run.case.to_string_lossy();
        let of_row = |name: &&str| row.iter().find(|(key, _)| key == name).map_or("", |(_, value)| value);
        let cells = [run.name.as_str(), &case].into_iter().chain(keys.iter().map(|key| set(run, key)));
        text += &line(cells.chain(columns.iter().map(of_row)));
    }
    text
}

/// The file that lists runs: a line for each, with what it sets. Labels of families and settings have columns in brackets.
pub fn to_csv(runs: &[&Planned]) -> String {
    let keys = keys(runs);
    let labels: Vec<Label> =
        LABELS.into_iter().filter(|(_, label)| runs.iter().any(|run| label(run) != label(runs[0]))).collect();
    let header = FIRST.into_iter().chain(labels.iter().map(|(name, _)| *name)).chain(keys.iter().copied());
    let mut text = line(header);
    for run in runs {
        let case = run.case.to_string_lossy();
        let labels = labels.iter().map(|(_, label)| label(run));
        text += &line([run.name.as_str(), &case].into_iter().chain(labels).chain(keys.iter().map(|key| set(run, key))));
    }
    text
}

/// The first columns of a list.
pub const FIRST: [&str; 2] = ["run", "case"];

/// A column of a list that is a label: its title and its cells.
pub type Label = (&'static str, fn(&Planned) -> &str);

/// The columns of a list that are labels, where these differ.
pub const LABELS: [Label; 2] = [("[family]", |run: &Planned| &run.family), ("[setting]", |run: &Planned| &run.setting)];

/// The keys that some run sets, in the order in which they come first.
fn keys<'a>(runs: &[&'a Planned]) -> Vec<&'a str> {
    let mut seen = BTreeSet::new();
    let all = runs.iter().flat_map(|run| &run.overrides).map(|(name, _)| name.as_str());
    all.filter(|name| seen.insert(*name)).collect()
}

/// The value that a run sets, as it was given.
fn set<'a>(run: &'a Planned, key: &str) -> &'a str {
    run.overrides.iter().rev().find(|(name, _)| name == key).map_or("", |(_, value)| value)
}

fn line<'a>(cells: impl Iterator<Item = &'a str>) -> String {
    cells.map(quoted).collect::<Vec<_>>().join(",") + "\n"
}

/// How a run ended, and what its summary tells: names and values.
fn numbers(run: &Run) -> Vec<(String, String)> {
    let mut row = vec![("status".to_owned(), run.status().to_owned())];
    if let End::Failed(why) = &run.end {
        row.push(("error".to_owned(), why.clone()));
    }
    if let Some(summary) = &run.summary {
        flatten("", &serde_json::to_value(summary).unwrap_or_default(), &mut row);
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
