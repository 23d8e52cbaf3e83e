//! A list of runs as a CSV file, which job schedulers and workflow programs work through run by run.
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
use std::fs;
use std::path::{Path, PathBuf};

use fractum_output::history::quoted;

use super::plan::Study;
use crate::{Diagnostic, Diagnostics, Place, refuse_endless};

/// A run of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Listed {
    /// Name, and that of its results folder.
    pub name: String,
    /// Case file.
    pub case: PathBuf,
    /// Keys and values, as `--set` takes them.
    pub overrides: Vec<(String, String)>,
}

/// The columns before the keys.
const FIRST: [&str; 2] = ["run", "case"];

/// The runs of a study under their numbers, which have the same number of digits.
pub fn of_study(study: &Study) -> Vec<Listed> {
    let digits = study.runs.len().to_string().len();
    let listed = study.runs.iter().zip(1..).map(|(run, number)| Listed {
        name: format!("{number:0digits$}"),
        case: run.case.clone(),
        overrides: run.overrides.clone(),
    });
    listed.collect()
}

/// The file that lists these runs.
pub fn to_csv(runs: &[Listed]) -> String {
    let keys = keys(runs);
    let mut lines = vec![FIRST.iter().copied().chain(keys.iter().copied()).map(quoted).collect::<Vec<_>>().join(",")];
    for run in runs {
        let case = run.case.to_string_lossy();
        let mut cells = vec![quoted(&run.name), quoted(&case)];
        // The last of several values counts, as it does on the command line.
        let value = |key: &str| run.overrides.iter().rev().find(|(name, _)| name == key).map_or("", |(_, value)| value);
        cells.extend(keys.iter().map(|key| quoted(value(key))));
        lines.push(cells.join(","));
    }
    lines.join("\n") + "\n"
}

/// The keys that some run sets, in the order in which they come first.
pub fn keys(runs: &[Listed]) -> Vec<&str> {
    let mut seen = BTreeSet::new();
    let all = runs.iter().flat_map(|run| &run.overrides).map(|(name, _)| name.as_str());
    all.filter(|name| seen.insert(*name)).collect()
}

/// Reads a list of runs.
///
/// # Errors
/// The first mistake with its line.
pub fn read(path: &Path) -> Result<Vec<Listed>, Diagnostics> {
    let place = |line: usize| Place {
        file: path.display().to_string(),
        line: line as u32,
        column: u32::from(line > 0),
        key: String::new(),
    };
    let wrong = |line: usize, found: String, remedy: &str| {
        Diagnostics(vec![Diagnostic::error(&place(line), found).remedy(remedy)])
    };
    refuse_endless(path).map_err(|error| wrong(0, error, ""))?;
    let text = fs::read_to_string(path).map_err(|error| wrong(0, format!("cannot be read: {error}"), ""))?;
    let mut rows = parse(&text).map_err(|line| wrong(line, ": a quote is not closed".into(), ""))?.into_iter();
    let Some((_, header)) = rows.next().filter(|(_, header)| header.starts_with(&FIRST.map(String::from))) else {
        let remedy = "fractum sweep list CASE --vary KEY=a,b,c writes a list";
        return Err(wrong(1, ": the first columns are not run,case".into(), remedy));
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut runs: Vec<Listed> = Vec::new();
    for (line, cells) in rows {
        if cells.len() != header.len() {
            let found = format!(": {} cells under {} columns", cells.len(), header.len());
            return Err(wrong(line, found, "put values with commas into double quotes"));
        }
        let name = &cells[0];
        if !is_name(name) {
            let remedy = "use letters, digits, dots, hyphens and underscores, at first a letter or digit";
            return Err(wrong(line, format!(": run \"{name}\" cannot be the name of a folder"), remedy));
        }
        if runs.iter().any(|run| run.name == *name) {
            return Err(wrong(line, format!(": run \"{name}\" stands there twice"), "give each run a name of its own"));
        }
        let set = header.iter().zip(&cells).skip(FIRST.len()).filter(|(_, value)| !value.is_empty());
        let overrides = set.map(|(key, value)| (key.clone(), value.clone())).collect();
        runs.push(Listed { name: name.clone(), case: folder.join(&cells[1]), overrides });
    }
    Ok(runs)
}

fn is_name(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || ['.', '-', '_'].contains(&c);
    name.starts_with(|c: char| c.is_ascii_alphanumeric()) && name.chars().all(plain)
}

/// The rows of a CSV file with the lines on which they begin, without empty ones; the line of a quote that is not closed.
fn parse(text: &str) -> Result<Vec<(usize, Vec<String>)>, usize> {
    let mut rows = Vec::new();
    let (mut row, mut cell, mut quoted) = (Vec::new(), String::new(), None);
    let (mut line, mut begin) = (1, 1);
    let mut letters = text.strip_prefix('\u{feff}').unwrap_or(text).chars().peekable();
    loop {
        let letter = letters.next();
        match (letter, quoted) {
            (None, Some(line)) => return Err(line),
            (Some('"'), Some(_)) if letters.next_if_eq(&'"').is_some() => cell.push('"'),
            (Some('"'), Some(_)) => quoted = None,
            (Some('"'), None) if cell.is_empty() => quoted = Some(line),
            (Some('\r'), None) if letters.peek() == Some(&'\n') => {}
            (Some(','), None) => row.push(std::mem::take(&mut cell)),
            (None | Some('\n'), None) => {
                row.push(std::mem::take(&mut cell));
                let row = std::mem::take(&mut row);
                if row.iter().any(|cell| !cell.is_empty()) {
                    rows.push((begin, row));
                }
                begin = line + 1;
            }
            (Some(letter), _) => cell.push(letter),
        }
        line += usize::from(letter == Some('\n'));
        if letter.is_none() {
            return Ok(rows);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listed(name: &str, overrides: &[(&str, &str)]) -> Listed {
        let overrides = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        Listed { name: name.into(), case: "case.toml".into(), overrides }
    }

    #[test]
    fn a_list_reads_back_as_it_was_written() {
        let runs = [
            listed("1", &[("point", "[1, 2]"), ("text", "a \"quoted\" word\nand a line")]),
            listed("2", &[("speed", "2 mm/s"), ("text", " ")]),
        ];
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.csv");
        fs::write(&path, to_csv(&runs)).unwrap();
        let mut read_back = read(&path).unwrap();
        assert!(read_back.iter().all(|run| run.case == folder.path().join("case.toml")));
        read_back.iter_mut().for_each(|run| run.case = "case.toml".into());
        let mut sorted = runs.to_vec();
        sorted[1].overrides.swap(0, 1); // in the order of the columns
        assert_eq!(read_back, sorted);
        assert_eq!(to_csv(&runs).lines().next(), Some("run,case,point,text,speed"));
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.csv");
        let said = |text: &str| {
            fs::write(&path, text).unwrap();
            read(&path).unwrap_err().to_string()
        };
        assert!(said("a,b\n1,2\n").contains("runs.csv:1") && said("").contains("not run,case"));
        assert!(said("run,case,k\r\n1,c.toml,1\r\n\r\n2,c.toml\r\n").contains("runs.csv:4"));
        assert!(said("run,case\n../1,c.toml\n").contains("cannot be the name of a folder"));
        assert!(said("run,case\n1,c.toml\n1,c.toml\n").contains("stands there twice"));
        assert!(said("run,case,k\n1,c.toml,\"1\n2,c.toml,3\n").contains("runs.csv:2"));
    }
}
