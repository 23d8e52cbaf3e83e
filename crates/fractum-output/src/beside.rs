//! What became of references beside the case that has them: rows of `neighbours.json`, and the page of them.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use crate::number::{or_null, quantity};

/// A reference at a neighbour of its case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Name of the case.
    pub case: String,
    /// Name of the neighbour.
    pub neighbour: String,
    /// Its kind.
    pub kind: String,
    /// Quantity of the reference.
    pub quantity: String,
    /// How it ended.
    pub end: End,
    /// What came out there, in SI; no number where it was not run.
    #[serde(with = "or_null")]
    pub value: f64,
    /// What the case itself gives.
    #[serde(with = "or_null")]
    pub at_home: f64,
    /// Unit of both.
    pub unit: String,
    /// What was expected there, in words.
    pub expected: String,
    /// How far it is off, in words.
    pub off: String,
    /// Reason of an exception, or why the run failed.
    pub words: String,
}

/// How a row ended.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// It was promised, and holds.
    Holds,
    /// It was promised, and does not hold.
    Fails,
    /// It was promised, but the case itself does not meet the reference.
    Missed,
    /// It is excepted, with the reason.
    Excepted,
    /// Nothing is said of it.
    Unsaid,
    /// It has not been run.
    #[default]
    Open,
}

impl End {
    /// Its name in tables.
    pub fn word(self) -> &'static str {
        match self {
            End::Holds => "holds",
            End::Fails => "FAILS",
            End::Missed => "missed",
            End::Excepted => "excepted",
            End::Unsaid => "nothing said",
            End::Open => "open",
        }
    }
}

/// Kinds in which rows are counted, with their heads.
const COUNTED: [End; 6] = [End::Holds, End::Fails, End::Missed, End::Excepted, End::Unsaid, End::Open];

/// Tables in Markdown: rows by kind of neighbour, rows by folder, what fails, and reasons of exceptions.
pub fn page(rows: &[Row]) -> String {
    let promised = |row: &&Row| matches!(row.end, End::Holds | End::Fails);
    let (all, good) = (rows.iter().filter(promised).count(), rows.iter().filter(|row| row.end == End::Holds).count());
    let mut text = format!("{good} of {all} promised rows hold ({:.1} %).\n", 100.0 * good as f64 / all as f64);
    counts(&mut text, "neighbour", rows, |row| row.kind.clone());
    counts(&mut text, "folder", rows, |row| row.case.split('/').next().unwrap_or_default().to_owned());
    let fails: Vec<&Row> = rows.iter().filter(|row| row.end == End::Fails).collect();
    if !fails.is_empty() {
        text.push_str("\n| fails | neighbour | quantity | value | case itself | expected | off by |\n|---|---|---|---|---|---|---|\n");
    }
    for row in fails {
        let Row { case, neighbour, quantity: name, expected, off, words, .. } = row;
        let shown = |value| if f64::is_nan(value) { String::new() } else { quantity(value, &row.unit) };
        let value = if words.is_empty() { shown(row.value) } else { words.replace('|', "/") };
        // Writing into a string has no way to fail.
        let _ =
            writeln!(text, "| {case} | {neighbour} | {name} | {value} | {} | {expected} | {off} |", shown(row.at_home));
    }
    let mut reasons: BTreeMap<(&str, &str), BTreeMap<&str, usize>> = BTreeMap::new();
    for row in rows.iter().filter(|row| row.end == End::Excepted) {
        let folder = row.case.split('/').next().unwrap_or_default();
        *reasons.entry((&row.kind, &row.words)).or_default().entry(folder).or_default() += 1;
    }
    if !reasons.is_empty() {
        text.push_str("\n| excepted | because | in (rows) |\n|---|---|---|\n");
    }
    for ((kind, why), folders) in reasons {
        let folders: Vec<String> = folders.into_iter().map(|(folder, count)| format!("{folder} ({count})")).collect();
        let _ = writeln!(text, "| {kind} | {} | {} |", why.replace('|', "/"), folders.join(", "));
    }
    text
}

/// Rows by what `key` says of them and by their end.
fn counts(text: &mut String, head: &str, rows: &[Row], key: impl Fn(&Row) -> String) {
    let mut found: BTreeMap<String, [usize; COUNTED.len()]> = BTreeMap::new();
    for row in rows {
        let counts = found.entry(key(row)).or_default();
        counts[COUNTED.iter().position(|end| *end == row.end).unwrap_or(0)] += 1;
    }
    let shown = COUNTED.map(|end| format!(" {} |", end.word().to_lowercase())).concat();
    // Writing into a string has no way to fail.
    let _ = writeln!(text, "\n| {head} |{shown}\n|---|{}", "---|".repeat(COUNTED.len()));
    for (name, counts) in found {
        let _ = writeln!(text, "| {name} |{}", counts.map(|count| format!(" {count} |")).concat());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_counts_by_kind_and_folder_and_gives_reasons() {
        let row = |case: &str, kind: &str, end, words: &str| Row {
            case: case.into(),
            neighbour: format!("{kind} 1"),
            kind: kind.into(),
            quantity: "peak".into(),
            unit: "N".into(),
            value: 2.0,
            at_home: 1.0,
            expected: "1 N ± 5 %".into(),
            off: "100 %".into(),
            end,
            words: words.into(),
        };
        let rows = [
            row("bar/a", "seed", End::Holds, ""),
            row("bar/a", "mesh", End::Fails, ""),
            row("beam/b", "mesh", End::Fails, "stopped: a | b"),
            row("beam/b", "half", End::Excepted, "costs an hour"),
        ];
        let text = page(&rows);
        assert!(text.starts_with("1 of 3 promised rows hold (33.3 %).\n"), "{text}");
        for line in [
            "| mesh | 0 | 2 | 0 | 0 | 0 | 0 |",
            "| bar | 1 | 1 | 0 | 0 | 0 | 0 |",
            "| bar/a | mesh 1 | peak | 2 N | 1 N | 1 N ± 5 % | 100 % |",
            "| beam/b | mesh 1 | peak | stopped: a / b | 1 N | 1 N ± 5 % | 100 % |",
            "| half | costs an hour | beam (1) |",
        ] {
            assert!(text.contains(line), "{line} in\n{text}");
        }
    }
}
