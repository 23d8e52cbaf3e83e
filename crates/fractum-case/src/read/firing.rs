//! `[pulses]` and firing sequences: which hole fires when, with which pressure.

use std::cell::Cell;

use fractum_output::warning::Code;

use super::detonation::{Acts, DelayScatter};
use super::table_file;
use super::time_functions::time_function_of;
use crate::model::{Load, LoadKind, Selection};
use crate::reader::{Reader, Table};
use crate::tree::{Entry, Node, Value};
use crate::unit::Dimension;
use crate::{Diagnostic, Place, Spanned, TimeFunction};

/// Rows of a sequence: a blast has hundreds of holes.
const MOST_ROWS: usize = 100_000;
/// Mistakes of a file that are shown: one of the wrong kind would fill the screen.
const MOST_SHOWN: usize = 5;

/// Pressures over time by their names.
pub(super) struct Pulses(Vec<Pulse>);

struct Pulse {
    name: String,
    place: Place,
    /// None with a mistake.
    pressure: Option<TimeFunction>,
    /// Whether a row of a sequence has it.
    is_used: Cell<bool>,
}

/// Reads `[pulses]`.
pub(super) fn pulses(root: &Table<'_>) -> Pulses {
    let Some(table) = root.table("pulses") else { return Pulses(Vec::new()) };
    let read = |node: &Node| time_function_of(root.reader, node, Dimension::PRESSURE);
    let pulse = |entry: &Entry| Pulse {
        name: entry.name.clone(),
        place: entry.key_place.clone(),
        pressure: read(&entry.node),
        is_used: Cell::new(false),
    };
    let pulses = table.entries().map(pulse).collect();
    table.finish("here");
    Pulses(pulses)
}

/// A row as it stands: group, delay and pulse.
type Row = [Node; 3];

/// Reads the firing sequence of a load: a pressure for every row.
///
/// - `acts`: how pressures act beside their facets; nothing where that is wrong
pub(super) fn sequence(
    table: &Table<'_>,
    pulses: &Pulses,
    name: Option<Spanned<String>>,
    acts: Option<Acts>,
) -> Option<Vec<Load>> {
    let reader = table.reader;
    let node = table.node("firing")?;
    let rows = match &node.value {
        Value::Text(file) => rows_of_file(reader, &Spanned::new(file.clone(), node.place.clone())),
        Value::Array(rows) if !rows.is_empty() => rows.iter().map(|row| row_of_list(reader, row)).collect(),
        _ => {
            let expected = "rows of group, delay and pulse, or the name of a CSV file of them";
            reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
            None
        }
    }?;
    let scatter = DelayScatter::read(table)?;
    let loads: Vec<Option<Load>> = rows
        .iter()
        .enumerate()
        .map(|(row, [group, delay, pulse])| {
            let delay = delay_of(reader, delay);
            let pulse = pulses.find(reader, pulse);
            let Value::Text(hole) = &group.value else { return None };
            let on = Selection::of_group(Spanned::new(hole.clone(), group.place.clone()));
            let delay = delay?;
            let delay = scatter.as_ref().map_or(delay, |scatter| scatter.of(row, delay));
            let pressure = TimeFunction::Delayed(delay, Box::new(pulse?));
            let pressure = Spanned::new(pressure, group.place.clone());
            let Acts { in_cracks, detonation } = acts?;
            Some(Load { name: name.clone(), kind: LoadKind::Pressure { on, pressure, in_cracks, detonation } })
        })
        .collect();
    loads.into_iter().collect()
}

fn delay_of(reader: &Reader, node: &Node) -> Option<f64> {
    let delay = reader.quantity(node, Dimension::TIME)?;
    if delay < 0.0 {
        reader.note(Diagnostic::error(&node.place, node.found()).expected("a delay of at least 0"));
        return None;
    }
    Some(delay)
}

impl Pulses {
    /// Notes those that no row has.
    pub(super) fn tell_unused(&self, reader: &Reader) {
        for pulse in self.0.iter().filter(|pulse| !pulse.is_used.get()) {
            let note = Diagnostic::warning(Code::Unused, &pulse.place, "is not used by any firing sequence");
            reader.note(note.remedy("name it in a row of loads[].firing, or leave it out"));
        }
    }

    fn find(&self, reader: &Reader, node: &Node) -> Option<TimeFunction> {
        let Value::Text(name) = &node.value else { return None };
        if let Some(pulse) = self.0.iter().find(|pulse| pulse.name == *name) {
            pulse.is_used.set(true);
            return pulse.pressure.clone();
        }
        let note = Diagnostic::error(&node.place, node.found()).expected("the name of a pulse of [pulses]");
        let names = self.0.iter().map(|pulse| pulse.name.as_str());
        reader.note(reader.suggest(note, name, names, "pulses here"));
        None
    }
}

fn row_of_list(reader: &Reader, row: &Node) -> Option<Row> {
    if let Value::Array(items) = &row.value
        && let [group, delay, pulse] = items.as_slice()
        && matches!((&group.value, &pulse.value), (Value::Text(_), Value::Text(_)))
    {
        return Some([group.clone(), delay.clone(), pulse.clone()]);
    }
    let expected = "a row such as [\"hole-1\", \"25 ms\", \"contour\"]: group, delay, pulse";
    reader.note(Diagnostic::error(&row.place, row.found()).expected(expected));
    None
}

/// Rows of three columns, separated by comma or semicolon. Blank lines and comments (`#`) are skipped, and so is a first
/// row whose second column is no quantity.
fn rows_of_file(reader: &Reader, name: &Spanned<String>) -> Option<Vec<Row>> {
    let (file, text) = table_file::text(reader, name)?;
    let place = |line: u32, key: &str| Place { file: file.clone(), line, column: 1, key: key.to_owned() };
    let (mut rows, mut wrong, mut first): (Vec<Row>, usize, bool) = (Vec::new(), 0, true);
    for (line, row) in (1u32..).zip(text.lines()) {
        let row = row.split('#').next().unwrap_or_default().trim();
        if row.is_empty() {
            continue;
        }
        let columns: Vec<&str> = row.split([',', ';']).map(|cell| cell.trim().trim_matches('"')).collect();
        let is_head =
            std::mem::take(&mut first) && columns.get(1).is_some_and(|c| !c.starts_with(|c: char| c.is_ascii_digit()));
        if is_head {
            continue;
        }
        let cell = |column: usize, key: &str| Node {
            value: match columns[column].parse() {
                Ok(number) if column == 1 => Value::Number(number),
                _ => Value::Text(columns[column].to_owned()),
            },
            place: place(line, key),
            raw: columns[column].to_owned(),
        };
        if columns.len() == 3 && columns.iter().all(|cell| !cell.is_empty()) {
            rows.push([cell(0, "group"), cell(1, "delay"), cell(2, "pulse")]);
            continue;
        }
        wrong += 1;
        if wrong <= MOST_SHOWN {
            let note = Diagnostic::error(&place(line, ""), format!("\"{row}\" has {} columns", columns.len()));
            reader.note(note.expected("three: group, delay, pulse"));
        }
    }
    if wrong == 0 && (rows.is_empty() || rows.len() > MOST_ROWS) {
        let found = format!("= \"{}\" has {} rows", name.value, rows.len());
        reader.note(
            Diagnostic::error(&name.place, found).expected(format!("1 to {MOST_ROWS} rows of group, delay, pulse")),
        );
        wrong += 1;
    }
    (wrong == 0).then_some(rows)
}
