//! What a study runs: from `--vary KEY=a,b,c`, or from a study file.
//!
//! ```toml
//! study = 1
//! title = "Damage, regularised and not"
//! within = "2 %"
//!
//! [[settings]]
//! label = "local"
//! [[settings]]
//! label = "phase field"
//! set = { "materials.*.damage.regularisation" = "phase-field" }
//!
//! [[families]]
//! label = "notched beam"
//! cases = ["../notched-beam/tilt-10.toml", "../notched-beam/delaunay-5.toml"]
//! vary = { "solver.safety" = [0.5, 0.9] }
//! ```

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use fractum_output::number::percent;
use fractum_output::study::run::Planned;
use serde::Deserialize;
use toml::{Spanned, Table, Value};
use xxhash_rust::xxh3::xxh3_64;

use super::list;
use super::quantity::Quantity;
use crate::{Diagnostic, Diagnostics, Dimension, Place, nearest, parse_quantity, place_of, refuse_endless};

/// The version of the study format this reads.
const VERSION: u64 = 1;

/// More runs than this are most likely a mistake in what is varied.
const MOST_RUNS: usize = 10_000;

/// What is to be run, and within which error a setting is sought.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Study {
    /// Title; empty where none was given.
    pub title: String,
    /// Error within which the cheapest setting is sought [-].
    pub within: Option<f64>,
    /// What is compared beside the references.
    pub compare: Vec<Quantity>,
    /// The runs, in the order in which they stand in tables.
    pub runs: Vec<Planned>,
}

/// A key with the values that it takes in turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Variation {
    /// Parameter or dotted key.
    pub key: String,
    /// Its values, as `--set` takes them.
    pub values: Vec<String>,
}

impl Variation {
    /// Reads `KEY=a,b,c`; commas within brackets or quotes belong to a value.
    ///
    /// # Errors
    /// What is wrong, in one line.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (key, values) = text.split_once('=').ok_or("expected KEY=a,b,c, such as --vary solver.safety=0.5,0.9")?;
        let (mut depth, mut quote) = (0i32, None);
        let values = values.split(|letter: char| {
            match (quote, letter) {
                (Some(open), _) if open == letter => quote = None,
                (Some(_), _) => {}
                (None, '"' | '\'') => quote = Some(letter),
                (None, '[' | '{' | '(') => depth += 1,
                (None, ']' | '}' | ')') => depth -= 1,
                _ => {}
            }
            letter == ',' && depth == 0 && quote.is_none()
        });
        let values = values.map(|value| value.trim().to_owned()).collect();
        Self { key: key.trim().to_owned(), values }.checked()
    }

    /// Refuses what could not be told apart in a table.
    fn checked(self) -> Result<Self, String> {
        let different: BTreeSet<&String> = self.values.iter().collect();
        if self.key.is_empty() || self.values.is_empty() || self.values.iter().any(String::is_empty) {
            return Err(format!("{}: a value is missing; expected KEY=a,b,c", self.key));
        }
        if different.len() < self.values.len() {
            return Err(format!("{}: a value stands there twice; name each once", self.key));
        }
        Ok(self)
    }
}

/// The study of a case file, of a list of runs, or the one that a study file describes.
///
/// - `set`: what all runs have, as `--set` takes it
/// - `vary`: what is varied in all of them
///
/// # Errors
/// Every mistake of a study file with its place; too many runs. Case files are not read here.
pub fn plan(path: &Path, set: &[(String, String)], vary: &[Variation]) -> Result<Study, Diagnostics> {
    let file = path.display().to_string();
    let whole = Place { file: file.clone(), line: 0, column: 0, key: String::new() };
    let fail = |found: String| Diagnostics(vec![Diagnostic::error(&whole, found)]);
    if is_list(path) {
        if !set.is_empty() || !vary.is_empty() {
            return Err(fail("is a list, which says itself what each run sets; leave out --set and --vary".into()));
        }
        return of_list(path);
    }
    refuse_endless(path).map_err(&fail)?;
    let text = fs::read_to_string(path).map_err(|error| fail(format!("cannot be read: {error}")))?;
    let mut study = if is_study(path, &text) {
        read(&text, path)?
    } else {
        let case = Planned { family: label(path), case: path.to_owned(), ..Planned::default() };
        Study { runs: vec![case], ..Study::default() }
    };
    for run in &mut study.runs {
        run.overrides.splice(0..0, set.iter().cloned());
    }
    study.runs = named(product(study.runs, vary).map_err(fail)?);
    Ok(study)
}

/// Gives runs their names and labels.
pub fn named(mut runs: Vec<Planned>) -> Vec<Planned> {
    label_cases(&mut runs);
    runs.iter_mut().for_each(|run| run.name = name_of(run));
    runs
}

/// The study of a list of runs.
///
/// # Errors
/// As [`list::read`].
pub fn of_list(path: &Path) -> Result<Study, Diagnostics> {
    let mut runs = list::read(path)?;
    runs.iter_mut().filter(|run| run.family.is_empty()).for_each(|run| run.family = label(path));
    label_cases(&mut runs);
    Ok(Study { runs, ..Study::default() })
}

/// Whether a file is a list of runs.
pub fn is_list(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"))
}

/// A name by which a run is found again whatever stands beside it: `tilt-10-` and a hash of its case and what it sets.
fn name_of(run: &Planned) -> String {
    let mut text = run.case.to_string_lossy().into_owned();
    run.overrides.iter().for_each(|(key, value)| text += &format!("\0{key}\0{value}"));
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    format!("{}-{:016x}", label(&run.case).chars().map(plain).collect::<String>(), xxh3_64(text.as_bytes()))
}

/// Names the cases so that they are told apart: by their files where these differ, else with their folders too.
fn label_cases(runs: &mut [Planned]) {
    let whole = |case: &Path| case.with_extension("").to_string_lossy().into_owned();
    let short = |case: &Path| {
        let parts: Vec<_> = case.iter().rev().take(2).collect();
        Path::new(parts.last().copied().unwrap_or_default()).join(label(case)).to_string_lossy().into_owned()
    };
    let cases: BTreeSet<PathBuf> = runs.iter().map(|run| run.case.clone()).collect();
    let alone =
        |of: &dyn Fn(&Path) -> String, case: &Path| cases.iter().filter(|other| of(other) == of(case)).count() == 1;
    for run in runs {
        let case = &run.case;
        run.case_label = match () {
            () if alone(&label, case) => label(case),
            () if alone(&short, case) => short(case),
            () => whole(case),
        };
    }
}

/// Whether a file is a study rather than a case.
pub fn is_study(path: &Path, text: &str) -> bool {
    let named = path.file_name().is_some_and(|name| name == "study.toml");
    named || text.parse::<Table>().is_ok_and(|table| table.contains_key("study"))
}

/// Every run with every combination of the varied values.
fn product(runs: Vec<Planned>, vary: &[Variation]) -> Result<Vec<Planned>, String> {
    let mut all = runs;
    for Variation { key, values } in vary {
        if all.len().saturating_mul(values.len()) > MOST_RUNS {
            return Err(format!("asks for more than {MOST_RUNS} runs; vary fewer keys at a time"));
        }
        let with = |run: &Planned, value: &String| {
            let mut run = run.clone();
            // What is varied replaces what was fixed.
            run.overrides.retain(|(name, _)| name != key);
            run.overrides.push((key.clone(), value.clone()));
            run
        };
        all = all.iter().flat_map(|run| values.iter().map(|value| with(run, value))).collect();
    }
    Ok(all)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyFile {
    study: Spanned<u64>,
    #[serde(default)]
    title: String,
    within: Option<Spanned<String>>,
    #[serde(default)]
    compare: Vec<Spanned<String>>,
    #[serde(default)]
    settings: Vec<Setting>,
    families: Vec<Family>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Setting {
    label: Spanned<String>,
    #[serde(default)]
    set: Table,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Family {
    label: Spanned<String>,
    cases: Vec<Spanned<String>>,
    /// Labels of the settings that it is run with; all if absent.
    settings: Option<Vec<Spanned<String>>>,
    #[serde(default)]
    set: Table,
    #[serde(default)]
    vary: BTreeMap<String, Spanned<Vec<Value>>>,
}

/// Reads a study file.
fn read(text: &str, path: &Path) -> Result<Study, Diagnostics> {
    let file = path.display().to_string();
    let place = |offset: usize| place_of(text, &file, offset);
    let parsed: StudyFile = toml::from_str(text).map_err(|error| {
        let found = format!(": {}", error.message().trim());
        Diagnostics(vec![Diagnostic::error(&place(error.span().map_or(0, |span| span.start)), found)])
    })?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut wrong = Vec::new();
    let mut note = |at: usize, found: String, remedy: &str| {
        wrong.push(Diagnostic::error(&place(at), found).remedy(remedy));
    };
    if *parsed.study.get_ref() != VERSION {
        note(parsed.study.span().start, "study is not 1, the version this program reads".into(), "");
    }
    let mut study = Study { title: parsed.title, ..Study::default() };
    if let Some(within) = parsed.within {
        let (at, text) = (within.span().start, within.into_inner());
        match parse_share(&text) {
            Ok(share) => study.within = Some(share),
            Err(found) => note(at, format!("within: {found}"), ""),
        }
    }
    for text in parsed.compare {
        match Quantity::parse(text.get_ref()) {
            Ok(quantity) => study.compare.push(quantity),
            Err(found) => note(text.span().start, format!("compare: {found}"), ""),
        }
    }
    let labels: Vec<&str> = parsed.settings.iter().map(|setting| setting.label.get_ref().as_str()).collect();
    for (index, setting) in parsed.settings.iter().enumerate() {
        if labels[..index].contains(&labels[index]) {
            let remedy = "give each setting a label of its own";
            note(setting.label.span().start, format!("label \"{}\" stands there twice", labels[index]), remedy);
        }
    }
    for family in &parsed.families {
        for name in family.settings.iter().flatten().filter(|name| !labels.contains(&name.get_ref().as_str())) {
            let near = nearest(name.get_ref(), labels.iter().copied());
            let remedy =
                near.map_or(format!("labels here: {}", labels.join(", ")), |near| format!("did you mean {near}?"));
            note(name.span().start, format!("no setting is called \"{}\"", name.get_ref()), &remedy);
        }
        for case in family.cases.iter().filter(|case| !folder.join(case.get_ref()).is_file()) {
            let found = format!("no case file \"{}\"", folder.join(case.get_ref()).display());
            note(case.span().start, found, "paths are taken from the folder of the study file");
        }
        match variations(&family.vary) {
            Ok(vary) => match product(runs(family, &parsed.settings, folder), &vary) {
                Ok(runs) => study.runs.extend(runs),
                Err(found) => note(family.label.span().start, found, ""),
            },
            Err((at, found)) => note(at, found, ""),
        }
    }
    if wrong.is_empty() { Ok(study) } else { Err(Diagnostics(wrong)) }
}

/// A share such as `2 %`.
///
/// # Errors
/// What is wrong, in one line.
pub fn parse_share(text: &str) -> Result<f64, String> {
    match parse_quantity(text, Dimension::NONE) {
        Ok(share) if share >= 1.0 => Err(format!("\"{text}\" is {}; expected a share such as \"2 %\"", percent(share))),
        Ok(share) if share > 0.0 => Ok(share),
        Ok(_) => Err(format!("\"{text}\" is not positive; expected a share such as \"2 %\"")),
        Err(error) => Err(format!("{error}; expected a share such as \"2 %\"")),
    }
}

fn variations(vary: &BTreeMap<String, Spanned<Vec<Value>>>) -> Result<Vec<Variation>, (usize, String)> {
    let one = |(key, values): (&String, &Spanned<Vec<Value>>)| {
        let variation = Variation { key: key.clone(), values: values.get_ref().iter().map(written).collect() };
        variation.checked().map_err(|found| (values.span().start, found))
    };
    vary.iter().map(one).collect()
}

/// The runs of a family without what it varies.
fn runs(family: &Family, settings: &[Setting], folder: &Path) -> Vec<Planned> {
    let wanted = |setting: &&Setting| {
        let label = setting.label.get_ref();
        family.settings.as_ref().is_none_or(|names| names.iter().any(|name| name.get_ref() == label))
    };
    let settings: Vec<Option<&Setting>> = match settings {
        [] => vec![None],
        some => some.iter().filter(wanted).map(Some).collect(),
    };
    let mut runs = Vec::new();
    for case in &family.cases {
        for setting in &settings {
            let mut run = Planned {
                family: family.label.get_ref().clone(),
                case: folder.join(case.get_ref()),
                overrides: pairs(&family.set),
                ..Planned::default()
            };
            if let Some(setting) = setting {
                run.setting.clone_from(setting.label.get_ref());
                run.overrides.extend(pairs(&setting.set));
            }
            runs.push(run);
        }
    }
    runs
}

fn label(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

fn pairs(set: &Table) -> Vec<(String, String)> {
    set.iter().map(|(key, value)| (key.clone(), written(value))).collect()
}

/// A value as `--set` takes it.
fn written(value: &Value) -> String {
    value.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_split_at_commas_outside_of_brackets_and_quotes() {
        let values = |text| Variation::parse(text).map(|variation| variation.values);
        assert_eq!(values("k=1, 2 ,3").unwrap(), ["1", "2", "3"]);
        assert_eq!(values("k=[1,2],{ a = 1, b = 2 }").unwrap(), ["[1,2]", "{ a = 1, b = 2 }"]);
        assert_eq!(values("k=\"a,b\",min(1,2)").unwrap(), ["\"a,b\"", "min(1,2)"]);
        for wrong in ["k", "=1", "k=", "k=1,,2", "k=1,1"] {
            assert!(values(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn everything_is_combined_and_what_varies_replaces_what_was_set() {
        let vary = ["a=1,2", "b=x,y,z"].map(|text| Variation::parse(text).unwrap());
        let fixed =
            Planned { overrides: vec![("a".into(), "9".into()), ("c".into(), "7".into())], ..Planned::default() };
        let runs = product(vec![fixed.clone()], &vary).unwrap();
        assert_eq!(runs.len(), 6);
        let pair = |key: &str, value: &str| (key.to_owned(), value.to_owned());
        assert_eq!(runs[5].overrides, [pair("c", "7"), pair("a", "2"), pair("b", "z")]);
        let values = (0..200).map(|value| value.to_string()).collect();
        let many = Variation { key: "k".into(), values };
        assert!(product(vec![fixed], &[many.clone(), Variation { key: "l".into(), ..many }]).is_err());
    }

    #[test]
    fn a_study_is_told_from_a_case() {
        assert!(is_study(Path::new("all.toml"), "study = 1\n[[families]]\n"));
        assert!(is_study(Path::new("cases/a/study.toml"), "not TOML at all ["));
        assert!(!is_study(Path::new("case.toml"), "fractum = 1\n"));
        assert!(!is_study(Path::new("case.toml"), "not TOML at all ["));
    }
}
