//! Reads a list of runs: the CSV file that `fractum study list` or any other program writes.

use std::fs;
use std::path::Path;

use fractum_output::study::list::{FIRST, LABELS};
use fractum_output::study::run::Planned;

use crate::{Diagnostic, Diagnostics, Place, refuse_endless};

/// Reads a list of runs.
///
/// # Errors
/// The first mistake with its line.
pub fn read(path: &Path) -> Result<Vec<Planned>, Diagnostics> {
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
        let remedy = "fractum study list CASE --vary KEY=a,b,c writes a list";
        return Err(wrong(1, ": the first columns are not run,case".into(), remedy));
    };
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut runs: Vec<Planned> = Vec::new();
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
        let mut run = Planned { name: name.clone(), case: folder.join(&cells[1]), ..Planned::default() };
        for (key, value) in header.iter().zip(cells).skip(FIRST.len()).filter(|(_, value)| !value.is_empty()) {
            match LABELS.iter().position(|(label, _)| label == key) {
                Some(0) => run.family = value,
                Some(_) => run.setting = value,
                None => run.overrides.push((key.clone(), value)),
            }
        }
        // Runs that are the same in two families are done once.
        let other = |own: &Planned| own.name == run.name && (&own.case, &own.overrides) != (&run.case, &run.overrides);
        if runs.iter().any(other) {
            let found = format!(": run \"{}\" stands there twice, with other values", run.name);
            return Err(wrong(line, found, "give each run a name of its own"));
        }
        runs.push(run);
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
    use fractum_output::study::list::to_csv;

    use super::*;

    fn listed(name: &str, overrides: &[(&str, &str)]) -> Planned {
        let overrides = overrides.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect();
        Planned { name: name.into(), case: "case.toml".into(), overrides, ..Planned::default() }
    }

    #[test]
    fn a_list_reads_back_as_it_was_written() {
        let mut runs = vec![
            listed("1", &[("point", "[1, 2]"), ("text", "a \"quoted\" word\nand a line")]),
            listed("2", &[("speed", "2 mm/s"), ("text", " ")]),
        ];
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("runs.csv");
        let text = |runs: &[Planned]| to_csv(&runs.iter().collect::<Vec<_>>());
        for first in ["run,case,point,text,speed", "run,case,[setting],point,text,speed"] {
            assert_eq!(text(&runs).lines().next(), Some(first));
            fs::write(&path, text(&runs)).unwrap();
            let mut read_back = read(&path).unwrap();
            assert!(read_back.iter().all(|run| run.case == folder.path().join("case.toml")));
            read_back.iter_mut().for_each(|run| run.case = "case.toml".into());
            let mut sorted = runs.clone();
            sorted[1].overrides.swap(0, 1); // in the order of the columns
            assert_eq!(read_back, sorted);
            runs[0].setting = "local".into();
        }
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
        assert!(said("run,case\n1,c.toml\n1,d.toml\n").contains("stands there twice"));
        assert!(said("run,case,k\n1,c.toml,\"1\n2,c.toml,3\n").contains("runs.csv:2"));
    }
}
