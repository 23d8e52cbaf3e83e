//! Text files of columns of numbers, such as time and value.

use super::{read_file, table_path};
use crate::reader::Reader;
use crate::{Diagnostic, Place, Spanned};

/// Reads the file a case names; notes everything wrong, each with its line in that file.
pub(super) fn read(reader: &Reader, name: &Spanned<String>) -> Option<Vec<(f64, f64)>> {
    let (file, text) = text(reader, name)?;
    parse(&text, |line, message| report(reader, name, &file, (line, message)))
}

/// Two columns, counted from 0, of a file that plays no part in the run; notes everything wrong, each with its line in that
/// file.
pub(super) fn pairs(reader: &Reader, name: &Spanned<String>, columns: [usize; 2]) -> Option<Vec<[f64; 2]>> {
    let (file, bytes) = bytes(reader, name)?;
    let text = String::from_utf8_lossy(&bytes);
    parse_pairs(&text, columns, |line, message| report(reader, name, &file, (line, message)))
}

/// Path and text of a file that a case names, which then belongs to the case; notes why it cannot be read.
pub(super) fn text(reader: &Reader, name: &Spanned<String>) -> Option<(String, String)> {
    let (file, bytes) = bytes(reader, name)?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    reader.tables.borrow_mut().push((name.value.clone(), bytes));
    Some((file, text))
}

/// Joints of a file.
pub(super) struct JointRows {
    /// The file.
    pub(super) place: Place,
    /// Lines with their numbers.
    pub(super) rows: Vec<(u32, Vec<f64>)>,
}

/// Rows of four or of six numbers, all alike.
pub(super) fn joints(reader: &Reader, name: &Spanned<String>) -> Option<JointRows> {
    let (file, text) = text(reader, name)?;
    let place = Place { file: file.clone(), line: 1, column: 1, key: name.place.key.clone() };
    let mut line_of = rows(&text).map(|(line, ..)| line);
    let take = |taken: &[Vec<f64>], row: &str, numbers: &[Option<f64>]| {
        let count = taken.first().map_or(numbers.len(), Vec::len);
        let known = numbers.iter().copied().collect::<Option<Vec<f64>>>();
        match known.filter(|numbers| numbers.iter().all(|number| number.is_finite())) {
            Some(numbers) if numbers.len() == count && (count == 4 || count == 6) => Ok(numbers),
            Some(numbers) => Err(format!("{} numbers; expected 4 of a trace, or 6 of a disc", numbers.len())),
            None => Err(format!("\"{row}\" is not a row of numbers")),
        }
    };
    let taken = collect(&text, "joints", take, |line, message| report(reader, name, &file, (line, message)))?;
    let rows = taken.into_iter().filter_map(|row| Some((line_of.next()?, row))).collect();
    Some(JointRows { place, rows })
}

fn bytes(reader: &Reader, name: &Spanned<String>) -> Option<(String, Vec<u8>)> {
    let path = table_path(reader, &name.value);
    let bytes = read_file(&path).map_err(|error| {
        reader.note(Diagnostic::error(&name.place, format!("= \"{}\" {error}", name.value)));
    });
    Some((path.display().to_string(), bytes.ok()?))
}

fn report(reader: &Reader, name: &Spanned<String>, file: &str, (line, message): (u32, String)) {
    let place = Place { file: file.to_owned(), line, column: 1, key: String::new() };
    let by = format!("read for {} at {}", name.place.key, name.place);
    reader.note(Diagnostic::error(&place, message).remedy(by));
}

/// Rows of a text with their lines: what its cells are and which numbers. Cells are separated by comma, semicolon or blanks.
/// Blank lines and comments (`#`) are skipped, and so is a first row of words.
fn rows(text: &str) -> impl Iterator<Item = (u32, &str, Vec<Option<f64>>)> {
    let mut first = true;
    (1..).zip(text.lines()).filter_map(move |(line, row)| {
        let row = row.split('#').next().unwrap_or_default().trim();
        if row.is_empty() {
            return None;
        }
        let number = |cell: &str| cell.trim().parse().ok();
        let numbers: Vec<Option<f64>> = if row.contains([',', ';']) {
            row.split([',', ';']).map(number).collect()
        } else {
            row.split_whitespace().map(number).collect()
        };
        let header = std::mem::take(&mut first) && numbers.iter().all(Option::is_none);
        (!header).then_some((line, row, numbers))
    })
}

/// Reports at most so many rows: a file of the wrong kind would fill the screen.
const MOST_WRONG: usize = 5;

/// Takes what each row gives, and reports what is wrong; nothing where anything is, or where there is no row.
///
/// - `of`: what a row should hold
fn collect<T>(
    text: &str,
    of: &str,
    mut take: impl FnMut(&[T], &str, &[Option<f64>]) -> Result<T, String>,
    mut report: impl FnMut(u32, String),
) -> Option<Vec<T>> {
    let (mut taken, mut wrong) = (Vec::new(), 0);
    for (line, row, numbers) in rows(text) {
        match take(&taken, row, &numbers) {
            Ok(value) => taken.push(value),
            Err(problem) => {
                wrong += 1;
                if wrong <= MOST_WRONG {
                    report(line, problem);
                }
            }
        }
    }
    if taken.is_empty() && wrong == 0 {
        report(1, format!("has no row of {of}"));
    }
    (wrong == 0 && !taken.is_empty()).then_some(taken)
}

/// Rows of two numbers, the first of which grows.
fn parse(text: &str, report: impl FnMut(u32, String)) -> Option<Vec<(f64, f64)>> {
    let take = |points: &[(f64, f64)], row: &str, numbers: &[Option<f64>]| match *numbers {
        [Some(time), Some(value)] if time.is_finite() && value.is_finite() => match points.last() {
            Some(last) if time <= last.0 => Err(format!("time {time} does not follow {}", last.0)),
            _ => Ok((time, value)),
        },
        [_, _] => Err(format!("\"{row}\" is not two numbers")),
        _ => Err(format!("{} columns instead of two", numbers.len())),
    };
    collect(text, "time and value", take, report)
}

/// Two columns of rows of any number of them.
fn parse_pairs(text: &str, columns: [usize; 2], report: impl FnMut(u32, String)) -> Option<Vec<[f64; 2]>> {
    let take = |_: &[[f64; 2]], row: &str, numbers: &[Option<f64>]| match columns.map(|column| numbers.get(column)) {
        [Some(Some(x)), Some(Some(y))] if x.is_finite() && y.is_finite() => Ok([*x, *y]),
        [Some(_), Some(_)] => Err(format!("\"{row}\" has no number in column {} or {}", columns[0], columns[1])),
        _ => Err(format!(
            "\"{row}\" has {} columns; columns {} and {} are read, counted from 0",
            numbers.len(),
            columns[0],
            columns[1]
        )),
    };
    collect(text, "numbers", take, report)
}

#[cfg(test)]
mod tests {
    use super::{parse, parse_pairs};

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

    #[test]
    fn two_columns_are_taken_of_several() {
        let text = "opening [mm],note,load [kN]\n0,a,0\n1,b,2.5\n0.5,c,1 # snap-back\n";
        let points = parse_pairs(text, [0, 2], |line, message| panic!("line {line}: {message}"));
        assert_eq!(points.unwrap(), [[0.0, 0.0], [1.0, 2.5], [0.5, 1.0]]);
        for (columns, lines) in [([0, 1], vec![2, 3, 4]), ([0, 3], vec![2, 3, 4])] {
            let mut wrong = Vec::new();
            assert_eq!(parse_pairs(text, columns, |line, _| wrong.push(line)), None);
            assert_eq!(wrong, lines, "{columns:?}");
        }
        assert_eq!(parse_pairs("x,y\n", [0, 1], |line, _| assert_eq!(line, 1)), None);
    }
}
