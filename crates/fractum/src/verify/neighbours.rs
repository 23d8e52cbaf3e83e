//! `fractum verify --neighbours`: every case with references is run beside itself, and each reference is looked at there.
//!
//! The runs are those of a study: each has a folder of its own and is kept.

use std::path::Path;

use fractum_case::model::{Case, Expect, Neighbour, Saying};
use fractum_case::study::plan::named;
use fractum_output::atomic;
use fractum_output::beside::{End, Row, page};
use fractum_output::number::quantity;
use fractum_output::study::run::{self, Planned, Run};

use crate::error::Failure;
use crate::say;
use crate::simulation::Options;
use crate::study::{Folders, Settings, found, run_all};
use crate::verify::{Selection, selected};

/// Name of the run of the case as it is, among its neighbours.
const ITSELF: &str = "itself";

/// Runs the neighbours of the selected cases, prints the table and writes it into `neighbours.json` and `neighbours.md`; its rows.
///
/// - `only_promised`: leave out neighbours of which no reference says anything; those with exceptions alone are never run
///
/// # Errors
/// [`Failure::Input`] if nothing is selected; [`Failure::Write`]; [`Failure::Interrupted`] after Ctrl-C, with the table of what has
/// finished.
pub fn neighbours(selection: &Selection, only_promised: bool) -> Result<Vec<Row>, Failure> {
    let cases = selected(selection)?;
    if cases.is_empty() {
        return Err(Failure::input(format!("{}: no case with [[expect]] matches", selection.cases.display())));
    }
    let mut planned = Vec::new();
    for (path, case) in &cases {
        let plan = |neighbour: String, overrides: &[(String, String)]| Planned {
            family: selection.name_of(path),
            setting: neighbour,
            case: path.clone(),
            overrides: overrides.to_vec(),
            ..Planned::default()
        };
        let wanted = wanted(case, only_promised);
        if !wanted.is_empty() {
            planned.push(plan(ITSELF.to_owned(), &[]));
            planned.extend(wanted.iter().map(|neighbour| plan(neighbour.name(), &neighbour.set)));
        }
    }
    let (planned, folders) = (named(planned), Folders::of_study(&selection.output));
    let options = Options {
        threads: selection.threads.or(Some(1)),
        quiet: true,
        cache: selection.cache.clone(),
        ..Options::default()
    };
    let ended = run_all(&planned, &folders, &Settings { jobs: selection.jobs, anew: false, options });
    let done = found(&planned, &folders);
    let rows: Vec<Row> = cases.iter().flat_map(|(path, case)| rows(&selection.name_of(path), case, &done)).collect();
    write(&selection.output, &rows)?;
    ended.map(|()| rows)
}

/// Neighbours that are to be run.
fn wanted(case: &Case, only_promised: bool) -> Vec<&Neighbour> {
    let verify = &case.source.verify;
    let is_wanted = |said: Saying<'_>| match said {
        Saying::Holds => true,
        Saying::Nothing => !only_promised,
        Saying::Excepted(_) => false,
    };
    let some = |neighbour: &&Neighbour| case.expect.iter().any(|expect| is_wanted(verify.says(expect, neighbour)));
    verify.neighbours.iter().filter(some).collect()
}

/// A row for every reference and neighbour of a case.
fn rows(name: &str, case: &Case, runs: &[Run]) -> Vec<Row> {
    let of = |neighbour: &str| {
        runs.iter().find(|run| run.planned.family == name && run.planned.setting == neighbour).map(|run| &run.end)
    };
    let mut rows = Vec::new();
    for neighbour in &case.source.verify.neighbours {
        for (index, expect) in case.expect.iter().enumerate() {
            let row = Row {
                case: name.to_owned(),
                neighbour: neighbour.name(),
                kind: neighbour.kind.clone(),
                quantity: expect.quantity.value.clone(),
                ..Row::default()
            };
            rows.push(judged(
                row,
                case.source.verify.says(expect, neighbour),
                index,
                of(ITSELF),
                of(&neighbour.name()),
            ));
        }
    }
    rows
}

/// - `index`: of the reference among those of the case
fn judged(row: Row, said: Saying<'_>, index: usize, itself: Option<&run::End>, there: Option<&run::End>) -> Row {
    let line = |end: Option<&run::End>| match end {
        Some(run::End::Finished(measured)) => measured.expect.get(index).cloned(),
        _ => None,
    };
    let (value, at_home) = (line(there), line(itself));
    let row = Row {
        value: value.as_ref().map_or(f64::NAN, |line| line.value),
        at_home: at_home.as_ref().map_or(f64::NAN, |line| line.value),
        unit: value.as_ref().or(at_home.as_ref()).map_or_else(String::new, |line| line.unit.clone()),
        expected: value.as_ref().map_or_else(String::new, |line| line.required()),
        off: value.as_ref().map_or_else(String::new, |line| line.off()),
        ..row
    };
    let (end, words) = match (said, there) {
        (Saying::Excepted(why), _) => (End::Excepted, why.to_owned()),
        (Saying::Nothing, _) => (
            End::Unsaid,
            match (there, &value) {
                (Some(run::End::Failed(why)), _) => first_line(why),
                (_, Some(value)) if value.pass => "met".to_owned(),
                (_, Some(_)) => "not met".to_owned(),
                _ => String::new(),
            },
        ),
        (Saying::Holds, Some(run::End::Failed(why))) => (End::Fails, first_line(why)),
        (Saying::Holds, Some(run::End::Finished(_))) => match (value, at_home) {
            (Some(value), _) if value.pass => (End::Holds, String::new()),
            (_, Some(at_home)) if !at_home.pass => (End::Missed, "missed by the case itself".to_owned()),
            _ => (End::Fails, String::new()),
        },
        (Saying::Holds, _) => (End::Open, String::new()),
    };
    Row { end, words, ..row }
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().to_owned()
}

fn write(folder: &Path, rows: &[Row]) -> Result<(), Failure> {
    let json = serde_json::to_string_pretty(rows).unwrap_or_default();
    atomic::write(&folder.join("neighbours.json"), json.as_bytes())?;
    atomic::write(&folder.join("neighbours.md"), page(rows).as_bytes())?;
    say!(
        "{:<36} {:<20} {:<30} {:>14} {:>14} {:>22} {:>10}  end",
        "case",
        "neighbour",
        "quantity",
        "value",
        "itself",
        "expected",
        "off by"
    );
    for row in rows.iter().filter(|row| !row.value.is_nan() || !row.words.is_empty() && row.end != End::Excepted) {
        let shown = |value| quantity(value, &row.unit);
        say!(
            "{:<36} {:<20} {:<30} {:>14} {:>14} {:>22} {:>10}  {} {}",
            row.case,
            row.neighbour,
            row.quantity,
            shown(row.value),
            shown(row.at_home),
            row.expected,
            row.off,
            row.end.word(),
            row.words
        );
    }
    let count = |end: End| rows.iter().filter(|row| row.end == end).count();
    let (holds, fails) = (count(End::Holds), count(End::Fails));
    say!(
        "{holds} of {} promised rows hold; {} excepted, {} missed by the case itself, {} of which nothing is said, {} open; {}",
        holds + fails,
        count(End::Excepted),
        count(End::Missed),
        count(End::Unsaid),
        count(End::Open),
        folder.join("neighbours.md").display()
    );
    Ok(())
}

/// References of a case that say nothing of one of its neighbours, as `neighbour: quantity`.
pub fn unsaid(case: &Case) -> Vec<String> {
    let verify = &case.source.verify;
    let pairs =
        verify.neighbours.iter().flat_map(|neighbour| case.expect.iter().map(move |expect| (neighbour, expect)));
    let silent = pairs.filter(|(neighbour, expect)| verify.says(expect, neighbour) == Saying::Nothing);
    silent.map(|(neighbour, Expect { quantity, .. })| format!("{}: {}", neighbour.name(), quantity.value)).collect()
}
