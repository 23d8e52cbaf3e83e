//! `history.csv`: what the probes saw, one line per record, units in the header.
//!
//! The file grows as `history.csv.part` and gets its name when the run ends, normally or by an interrupt. A run that is
//! resumed from a checkpoint goes on after exactly the bytes that were there when the checkpoint was made, so that the
//! finished file is the same as without the interruption.

use std::fs;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::atomic::{Group, GrowingFile, Written};
use crate::error::{ReadError, WriteError};
use crate::number::push_shortest;

/// Name and unit of a column; the unit of a pure number is `-`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Column {
    /// Name, as a probe is called in the case.
    pub name: String,
    /// Unit, as `N` or `m/s`.
    pub unit: String,
}

impl Column {
    /// A column of that name and unit.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// The history while it is written.
#[derive(Debug)]
pub struct History {
    file: GrowingFile,
    columns: usize,
    line: String,
}

impl History {
    /// Starts the file with its header.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn create(path: &Path, columns: &[Column]) -> Result<Self, WriteError> {
        let mut file = GrowingFile::create(path)?;
        file.append(header(columns).as_bytes())?;
        Ok(Self { file, columns: columns.len(), line: String::new() })
    }

    /// Goes on after what [`sync`](Self::sync) told, with the same columns.
    ///
    /// # Errors
    /// [`WriteError::Shortened`] if the file holds less than that, [`WriteError::Damaged`] if it holds something else; else
    /// as the operating system says.
    pub fn resume(path: &Path, columns: &[Column], written: Written) -> Result<Self, WriteError> {
        let file = GrowingFile::resume(path, written)?;
        Ok(Self { file, columns: columns.len(), line: String::new() })
    }

    /// Adds a line. Numbers are written in the shortest form that reads back to the same bits. A value too few reads
    /// back as NaN, one too many is not written.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn record(&mut self, values: &[f64]) -> Result<(), WriteError> {
        debug_assert_eq!(values.len(), self.columns, "one value per column");
        self.line.clear();
        for column in 0..self.columns {
            if column > 0 {
                self.line.push(',');
            }
            push_shortest(&mut self.line, values.get(column).copied().unwrap_or(f64::NAN));
        }
        self.line.push('\n');
        self.file.append(self.line.as_bytes())
    }

    /// Brings all lines to the disk and returns what a checkpoint keeps for [`resume`](Self::resume).
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn sync(&mut self) -> Result<Written, WriteError> {
        self.file.sync()
    }

    /// Gives the file its name: at the end of the run, or when it is interrupted.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn finish(self) -> Result<(), WriteError> {
        self.file.finish()
    }

    /// As [`finish`](Self::finish), with the other files of a group.
    pub fn finish_in(self, group: &mut Group) {
        self.file.finish_in(group);
    }
}

/// A history as read back, column by column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Names and units.
    pub columns: Vec<Column>,
    /// Values of each column; all of the same length.
    pub values: Vec<Vec<f64>>,
}

impl Table {
    /// Values and unit of the column called `name`.
    pub fn column(&self, name: &str) -> Option<(&[f64], &str)> {
        let index = self.columns.iter().position(|column| column.name == name)?;
        Some((self.values.get(index)?, &self.columns[index].unit))
    }
}

/// Reads a history, finished or (`NAME.part`) not. A last line without its end, as a killed run may leave, is left out.
///
/// # Errors
/// [`ReadError`] with the line that is not as a history's should be.
pub fn read(path: &Path) -> Result<Table, ReadError> {
    let text = fs::read_to_string(path).map_err(|source| ReadError::Refused { path: path.to_path_buf(), source })?;
    parse(&text).map_err(|(line, found, expected)| ReadError::Malformed {
        path: path.to_path_buf(),
        line,
        found,
        expected,
    })
}

fn parse(text: &str) -> Result<Table, (usize, String, String)> {
    let complete = text.rfind('\n').map_or("", |end| &text[..end]);
    let mut lines = complete.lines();
    let Some(columns) = lines.next().and_then(parse_header) else {
        return Err((1, "no header".into(), "columns as `time [s],load [N]`".into()));
    };
    let mut values: Vec<Vec<f64>> = vec![Vec::new(); columns.len()];
    for (index, line) in lines.enumerate() {
        let mut count = 0;
        for (column, cell) in line.split(',').enumerate() {
            let value = cell.parse().map_err(|_| (index + 2, format!("`{cell}`"), "a number".into()))?;
            if let Some(values) = values.get_mut(column) {
                values.push(value);
            }
            count += 1;
        }
        if count != columns.len() {
            return Err((index + 2, format!("{count} values"), columns.len().to_string()));
        }
    }
    Ok(Table { columns, values })
}

fn header(columns: &[Column]) -> String {
    let cell = |column: &Column| quoted(&format!("{} [{}]", column.name, column.unit));
    columns.iter().map(cell).collect::<Vec<_>>().join(",") + "\n"
}

/// A cell of a CSV file, in quotes where its text needs them.
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

fn parse_header(line: &str) -> Option<Vec<Column>> {
    let mut cells = vec![String::new()];
    let mut quoted = false;
    let mut characters = line.chars().peekable();
    while let Some(character) = characters.next() {
        let cell = cells.last_mut()?;
        match character {
            '"' if quoted && characters.peek() == Some(&'"') => {
                characters.next();
                cell.push('"');
            }
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            other => cell.push(other),
        }
    }
    let column = |cell: &String| {
        let (name, unit) = cell.strip_suffix(']')?.rsplit_once(" [")?;
        Some(Column::new(name, unit))
    };
    cells.iter().map(column).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn columns() -> Vec<Column> {
        vec![Column::new("time", "s"), Column::new("load", "N")]
    }

    #[test]
    fn header_bears_units_and_numbers_are_shortest() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut history = History::create(&path, &columns()).unwrap();
        history.record(&[0.0, 0.1]).unwrap();
        history.record(&[1e-7, -12_345.678]).unwrap();
        assert!(!path.exists());
        history.finish().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "time [s],load [N]\n0,0.1\n1e-7,-12345.678\n");
    }

    #[test]
    fn a_resumed_history_is_the_uninterrupted_one() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, killed: bool| {
            let path = folder.path().join(name);
            let mut history = History::create(&path, &columns()).unwrap();
            for step in 0..20 {
                history.record(&[step as f64 * 0.1, (step as f64).sqrt()]).unwrap();
            }
            if killed {
                let written = history.sync().unwrap();
                for step in 20..27 {
                    history.record(&[step as f64 * 0.1, (step as f64).sqrt()]).unwrap();
                }
                drop(history);
                history = History::resume(&path, &columns(), written).unwrap();
            }
            for step in 20..40 {
                history.record(&[step as f64 * 0.1, (step as f64).sqrt()]).unwrap();
            }
            history.finish().unwrap();
            fs::read(path).unwrap()
        };
        assert_eq!(write("whole.csv", false), write("killed.csv", true));
    }

    #[test]
    fn an_unfinished_last_line_is_left_out() {
        let table = parse("time [s],load [N]\n0,1\n1,2\n2,3.4").unwrap();
        assert_eq!(table.values, [vec![0.0, 1.0], vec![1.0, 2.0]]);
        assert_eq!(table.column("load"), Some((&[1.0, 2.0][..], "N")));
    }

    #[test]
    fn a_foreign_file_is_refused_with_its_line() {
        assert_eq!(parse("").unwrap_err().0, 1);
        assert_eq!(parse("hello\n").unwrap_err().0, 1);
        assert_eq!(parse("a [s],b [N]\n1,2\n3\n").unwrap_err().0, 3);
        assert_eq!(parse("a [s],b [N]\n1,2\n3,x\n").unwrap_err().0, 3);
    }

    proptest! {
        #[test]
        fn reading_gives_back_what_was_written(
            name in "[ -~]{1,12}",
            values in proptest::collection::vec(any::<f64>(), 1..20),
        ) {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("history.csv");
            let columns = [Column::new(name, "m/s"), Column::new("other", "-")];
            let mut history = History::create(&path, &columns).unwrap();
            for value in &values {
                history.record(&[*value, 1.0]).unwrap();
            }
            history.finish().unwrap();
            let table = read(&path).unwrap();
            prop_assert_eq!(&table.columns[..], &columns[..]);
            let bits = |values: &[f64]| values.iter().map(|v| if v.is_nan() { 0 } else { v.to_bits() }).collect::<Vec<_>>();
            prop_assert_eq!(bits(&table.values[0]), bits(&values));
        }

        #[test]
        fn any_text_is_read_or_refused(text in "\\PC{0,80}\n\\PC{0,20}\n") {
            let _ = parse(&text);
        }
    }
}
