//! The gallery against its references: `verify.json` for scripts, `verify.md` for people, `phases.md` with what took the time,
//! `estimates.md` with what `fractum check` says of it.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::atomic;
use crate::error::WriteError;
use crate::expectation::Expectation;
use crate::number::{or_null, quantity};
use crate::summary::json;

/// One line of `verify.json`: an expectation with the case it belongs to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verified {
    /// Name of the case.
    pub case: String,
    /// What was expected, and what came out.
    #[serde(flatten)]
    pub expectation: Expectation,
    /// Time on the clock [s].
    #[serde(with = "or_null")]
    pub seconds: f64,
    /// Time on the clock by part of the run [s], as in `summary.json`.
    #[serde(default)]
    pub phases: BTreeMap<String, f64>,
    /// Parts that the physics of the case needs, for `phases.md`.
    #[serde(skip)]
    pub needs: BTreeSet<String>,
    /// Time that `fractum check` says of the steps, and of output [s], for `estimates.md`; none where it says nothing.
    #[serde(skip)]
    pub estimate: Option<[f64; 2]>,
}

impl Verified {
    /// Folder of its case.
    fn folder(&self) -> &str {
        self.case.split_once('/').map_or(self.case.as_str(), |(folder, _)| folder)
    }
}

/// Writes `verify.json`, `verify.md`, `phases.md` and `estimates.md` into a folder.
///
/// # Errors
/// [`WriteError`].
pub fn write(folder: &Path, lines: &[Verified]) -> Result<(), WriteError> {
    atomic::write(&folder.join("verify.json"), json(lines).as_bytes())?;
    atomic::write(&folder.join("phases.md"), phases(lines).as_bytes())?;
    atomic::write(&folder.join("estimates.md"), estimates(lines).as_bytes())?;
    atomic::write(&folder.join("verify.md"), table(lines).as_bytes())
}

/// Case by case the share of every part of the run in per cent; a dash where a part has not run at all, and a star at one that has run
/// though the physics of the case does not need it. Setting up is what no part has.
fn phases(lines: &[Verified]) -> String {
    let names: BTreeSet<&str> = lines.iter().flat_map(|line| line.phases.keys().map(String::as_str)).collect();
    let head: String = names.iter().map(|name| format!(" {name} |")).collect();
    let rule = "---|".repeat(names.len());
    let mut text = format!("| case | needs | seconds |{head} set up |\n|---|---|---|{rule}---|\n");
    for case in lines.chunk_by(|a, b| a.case == b.case) {
        let Verified { case, seconds, phases, needs, .. } = &case[0];
        let needed: Vec<&str> = needs.iter().map(String::as_str).collect();
        // Writing into a string has no way to fail.
        let _ = write!(text, "| {case} | {} | {seconds:.2} |", needed.join(", "));
        for name in &names {
            let _ = match phases.get(*name) {
                Some(time) => {
                    let mark = if needs.contains(*name) { "" } else { " *" };
                    write!(text, " {:.1}{mark} |", 100.0 * time / seconds)
                }
                None => write!(text, " - |"),
            };
        }
        let rest = seconds - phases.values().sum::<f64>();
        let _ = writeln!(text, " {:.1} |", 100.0 * rest / seconds);
    }
    text
}

/// Ratio of estimate and run, or of run and estimate, up to which an estimate is good.
const GOOD: f64 = 2.0;

/// Time of the steps of a run from which on its estimate counts among the longer ones [s].
const LONG: f64 = 0.1;

/// How many estimates are good, of the steps and with output, then case by case estimate and time of the run. Setting up is measured by
/// `fractum check` rather than estimated, and counts in neither.
fn estimates(lines: &[Verified]) -> String {
    let pairs = |case: &Verified| {
        let [steps, output] = case.estimate?;
        let all: f64 = case.phases.values().sum();
        let of_steps = all - case.phases.get("output").copied().unwrap_or(0.0);
        Some([[steps, of_steps], [steps + output, all]])
    };
    let cases = || lines.chunk_by(|a, b| a.case == b.case).filter_map(|case| Some((&case[0].case, pairs(&case[0])?)));
    let is_good = |[estimate, run]: [f64; 2]| (estimate / GOOD..=estimate * GOOD).contains(&run);
    let counted = |which: usize, least: f64| {
        let long = cases().filter(|(_, [[_, run], _])| *run >= least);
        let (good, all) =
            long.fold((0, 0), |(good, all), (_, pairs)| (good + usize::from(is_good(pairs[which])), all + 1));
        format!("{good} of {all}")
    };
    let [[steps, output], [long, long_output]] = [0.0, LONG].map(|least| [0, 1].map(|which| counted(which, least)));
    let mut text = format!(
        "Within a factor of {GOOD} of the run: {steps} estimates of the steps, {output} with output; where the steps take {LONG} s or more, \
         {long} and {long_output}.\n\n\
         | case | estimate of the steps [s] | run [s] | ratio | estimate with output [s] | run [s] | ratio |\n\
         |---|---|---|---|---|---|---|\n"
    );
    for (case, [[a, b], [c, d]]) in cases() {
        // Writing into a string has no way to fail.
        let _ = writeln!(text, "| {case} | {a:.3} | {b:.3} | {:.2} | {c:.3} | {d:.3} | {:.2} |", a / b, c / d);
    }
    text
}

/// Folder by folder how many references are met, then those that are missed. Lines of a case and cases of a folder stand together.
fn table(lines: &[Verified]) -> String {
    let met = lines.iter().filter(|line| line.expectation.pass).count();
    let mut text = format!("{met} of {} references are met.\n\n", lines.len());
    // Writing into a string has no way to fail.
    let _ = writeln!(text, "| folder | cases | references | met | seconds |\n|---|---|---|---|---|");
    for folder in lines.chunk_by(|a, b| a.folder() == b.folder()) {
        let cases: Vec<&[Verified]> = folder.chunk_by(|a, b| a.case == b.case).collect();
        let seconds: f64 = cases.iter().map(|case| case[0].seconds).sum();
        let met = folder.iter().filter(|line| line.expectation.pass).count();
        let (name, count) = (folder[0].folder(), folder.len());
        let _ = writeln!(text, "| {name} | {} | {count} | {met} | {seconds:.1} |", cases.len());
    }
    if met < lines.len() {
        text.push_str("\n| missed | quantity | value | expected | off by |\n|---|---|---|---|---|\n");
    }
    for Verified { case, expectation: found, .. } in lines.iter().filter(|line| !line.expectation.pass) {
        let value = quantity(found.value, &found.unit);
        let _ = writeln!(text, "| {case} | {} | {value} | {} | {} |", found.quantity, found.required(), found.off());
    }
    text
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::expectation::Bound;

    fn line(case: &str, value: f64) -> Verified {
        let bound = Bound::Near { value: 1.0, tolerance: 0.1, relative: Some(0.1) };
        Verified {
            case: case.into(),
            expectation: Expectation::hold("peak", "Pa", value, bound, "exact"),
            seconds: 2.0,
            phases: [("motion".to_owned(), 0.1), ("solid".to_owned(), 1.5)].into(),
            needs: ["solid".to_owned()].into(),
            estimate: Some([1.0, 0.5]),
        }
    }

    #[test]
    fn shares_of_parts_are_told_case_by_case() {
        let other = Verified { phases: [("solid".to_owned(), 2.0)].into(), ..line("bar/b", 1.0) };
        let table = phases(&[line("bar/a", 1.0), line("bar/a", 1.2), other]);
        let head = "| case | needs | seconds | motion | solid | set up |\n|---|---|---|---|---|---|\n";
        let rows = "| bar/a | solid | 2.00 | 5.0 * | 75.0 | 20.0 |\n| bar/b | solid | 2.00 | - | 100.0 | 0.0 |\n";
        assert_eq!(table, format!("{head}{rows}"));
    }

    #[test]
    fn estimates_are_good_up_to_a_factor_of_two() {
        let far =
            Verified { estimate: Some([1.5, 2.6]), phases: [("output".to_owned(), 0.5)].into(), ..line("bar/b", 1.0) };
        let none = Verified { estimate: None, ..line("bar/c", 1.0) };
        let text = estimates(&[line("bar/a", 1.0), line("bar/a", 1.2), far, none]);
        let head = "Within a factor of 2 of the run: 1 of 2 estimates of the steps, 1 of 2 with output; where the steps take 0.1 s or more, \
                    1 of 1 and 1 of 1.\n";
        let rows = "| bar/a | 1.000 | 1.600 | 0.62 | 1.500 | 1.600 | 0.94 |\n\
                    | bar/b | 1.500 | 0.000 | inf | 4.100 | 0.500 | 8.20 |\n";
        assert!(text.starts_with(head) && text.ends_with(rows), "{text}");
    }

    #[test]
    fn the_table_counts_by_folder_and_lists_what_is_missed() {
        let lines = [line("bar/a", 1.0), line("bar/a", 1.2), line("bar/b", 1.0), line("hole/c", 1.0)];
        let table = table(&lines);
        assert!(table.starts_with("3 of 4 references are met.\n"), "{table}");
        assert!(table.contains("| bar | 2 | 3 | 2 | 4.0 |\n| hole | 1 | 1 | 1 | 2.0 |\n"), "{table}");
        assert!(table.ends_with("| bar/a | peak | 1.2 Pa | 1 Pa ± 10 % | 20 % |\n"), "{table}");
    }

    #[test]
    fn verify_lines_have_the_names_of_the_contract() {
        let folder = tempfile::tempdir().unwrap();
        let bound = Bound::Near { value: 1.0, tolerance: 0.1, relative: Some(0.1) };
        let expectation = Expectation::hold("stress", "Pa", 1.0, bound, "exact");
        let line = Verified { case: "patch".into(), expectation, seconds: 2.0, ..Verified::default() };
        write(folder.path(), &[line]).unwrap();
        let path = folder.path().join("verify.json");
        let lines: serde_json::Value = serde_json::from_str(&fs::read_to_string(&path).unwrap()).unwrap();
        let keys: Vec<&String> = lines[0].as_object().unwrap().keys().collect();
        let mut expected = [
            "case",
            "quantity",
            "unit",
            "value",
            "reference",
            "comparison",
            "error",
            "tolerance",
            "pass",
            "seconds",
            "phases",
            "source",
        ];
        expected.sort_unstable();
        assert_eq!(keys, expected);
    }
}
