//! Two-column text files: time and value.

use super::{read_file, table_path};
use crate::case::reader::Reader;
use crate::case::{Diagnostic, Place, Spanned};

/// Reads the file a case names; notes everything wrong, each with its line in that file.
pub(super) fn read(reader: &Reader, name: &Spanned<String>) -> Option<Vec<(f64, f64)>> {
    let (file, text) = text(reader, name)?;
    parse(&text, |line, message| {
        let place = Place { file: file.clone(), line, column: 1, key: String::new() };
        let by = format!("read for {} at {}", name.place.key, name.place);
        reader.note(Diagnostic::error(&place, message).remedy(by));
    })
}

/// Path and text of a file that a case names, which then belongs to the case; notes why it cannot be read.
pub(super) fn text(reader: &Reader, name: &Spanned<String>) -> Option<(String, String)> {
    let path = table_path(reader, &name.value);
    match read_file(&path) {
        Ok(bytes) => {
            let text = String::from_utf8_lossy(&bytes).into_owned();
            reader.tables.borrow_mut().push((name.value.clone(), bytes));
            Some((path.display().to_string(), text))
        }
        Err(error) => {
            reader.note(Diagnostic::error(&name.place, format!("= \"{}\" {error}", name.value)));
            None
        }
    }
}

/// Parses rows of two numbers separated by comma, semicolon or blanks. Blank lines and comments (`#`) are skipped, and
/// so is a first row of words.
fn parse(text: &str, mut report: impl FnMut(u32, String)) -> Option<Vec<(f64, f64)>> {
    let mut points: Vec<(f64, f64)> = Vec::new();
    let mut first = true;
    let mut wrong = 0;
    for (line, row) in (1..).zip(text.lines()) {
        let row = row.split('#').next().unwrap_or_default().trim();
        if row.is_empty() {
            continue;
        }
        let columns: Vec<&str> = if row.contains([',', ';']) {
            row.split([',', ';']).map(str::trim).collect()
        } else {
            row.split_whitespace().collect()
        };
        let numbers: Vec<Option<f64>> = columns.iter().map(|cell| cell.parse().ok()).collect();
        let header = std::mem::take(&mut first) && numbers.iter().all(Option::is_none);
        let problem = match numbers[..] {
            _ if header => None,
            [Some(time), Some(value)] if time.is_finite() && value.is_finite() => match points.last() {
                Some(last) if time <= last.0 => Some(format!("time {time} does not follow {}", last.0)),
                _ => {
                    points.push((time, value));
                    None
                }
            },
            [_, _] => Some(format!("\"{row}\" is not two numbers")),
            _ => Some(format!("{} columns instead of two", numbers.len())),
        };
        if let Some(problem) = problem {
            wrong += 1;
            if wrong <= 5 {
                report(line, problem); // a file of the wrong kind would fill the screen
            }
        }
    }
    if points.is_empty() && wrong == 0 {
        report(1, "has no row of time and value".to_string());
    }
    (wrong == 0 && !points.is_empty()).then_some(points)
}

#[cfg(test)]
mod tests {
    use super::parse;

    fn good(text: &str) -> Vec<(f64, f64)> {
        parse(text, |line, message| panic!("line {line}: {message}")).unwrap()
    }

    #[test]
    fn rows_may_be_separated_in_several_ways() {
        for text in ["0,1\n2,3", "0;1\r\n2 ; 3\r\n", "# c\nt p\n0 1 # x\n\n2\t3", "\"t [s]\",p\n0, 1\n2, 3e0\n"] {
            assert_eq!(good(text), [(0.0, 1.0), (2.0, 3.0)], "{text}");
        }
    }

    #[test]
    fn wrong_rows_are_named_by_line() {
        for (text, line) in [("0 1\n0 2", 2), ("0 1\n1 2 3", 2), ("a b\nc d", 2), ("0 nan", 1), ("", 1), ("1", 1)] {
            let mut lines = Vec::new();
            assert_eq!(parse(text, |line, _| lines.push(line)), None, "{text}");
            assert_eq!(lines, [line], "{text}");
        }
        let mut count = 0;
        parse(&"x 1\n".repeat(1000), |_, _| count += 1);
        assert_eq!(count, 5);
    }
}
