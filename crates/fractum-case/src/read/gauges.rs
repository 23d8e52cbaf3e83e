//! `[[output.gauges]]`.

use fractum_math::Vec3;

use crate::Diagnostic;
use crate::model::Gauges;
use crate::reader::Table;
use crate::reader::vectors::point;
use crate::selection::selection;

/// Most places of one grid.
const MOST: f64 = 10_000.0;

pub(super) fn read(output: &Table<'_>) -> Option<Vec<Gauges>> {
    let all: Vec<Option<Gauges>> = output.tables("gauges").into_iter().map(gauges).collect();
    let all: Vec<Gauges> = all.into_iter().collect::<Option<_>>()?;
    for (index, gauges) in all.iter().enumerate() {
        if all[..index].iter().any(|other| other.name.value == gauges.name.value) {
            let found = format!("= \"{}\" is the name of an earlier table", gauges.name.value);
            output.reader.note(Diagnostic::error(&gauges.name.place, found).remedy("rename it"));
        }
    }
    Some(all)
}

fn gauges(table: Table<'_>) -> Option<Gauges> {
    let fits =
        |name: &String| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    let name = table.text("name").check(fits, "a name of files: letters, digits, underscores and hyphens");
    let name = name.spanned().required();
    let (reader, on) = (table.reader, selection(&table));
    let [from, to] = ["from", "to"].map(|key| point(&table, key).required());
    let spacing = table.quantity("spacing").positive().spanned().required();
    let length = table.quantity("length").positive().spanned().required();
    table.finish("here");
    let (name, on, from, to, spacing, length) = (name?, on?, from?, to?, spacing?, length?);
    // A side that is a whole number of spacings up to rounding has no place more.
    let counts: Vec3 = (to - from).map(|side: f64| (side.abs() / spacing.value - 1e-9).ceil().max(0.0) + 1.0);
    let total: f64 = counts.product();
    if total.is_nan() || total > MOST {
        let note = Diagnostic::error(&spacing.place, format!("makes a grid of {total} places"));
        reader.note(note.expected(format!("at most {MOST}")).remedy("widen it, or move the corners together"));
        return None;
    }
    let count = [counts.x as usize, counts.y as usize, counts.z as usize];
    Some(Gauges { name, on, from, to, count, length })
}
