//! `[[plots]]`.

use fractum_output::columns::HistoryColumns;

use super::probes::ReadProbes;
use super::{names, table_file, unit};
use crate::expression::parse_unit;
use crate::model::{Plot, PlotReference, PlotScale};
use crate::reader::Table;
use crate::unit::Dimension;
use crate::{Diagnostic, Spanned};

/// Reads all plots; nothing where one of them is wrong.
pub(super) fn read(root: &Table<'_>, probes: &ReadProbes) -> Option<Vec<Plot>> {
    let plots: Vec<Option<Plot>> = root.tables("plots").into_iter().map(|table| plot(table, probes)).collect();
    plots.into_iter().collect()
}

fn plot(table: Table<'_>, probes: &ReadProbes) -> Option<Plot> {
    let title = table.text("title").or(String::new());
    let x = table.text("x").spanned().required();
    let found = x.as_ref().map(|name| find(&table, name, probes));
    if let (Some(Found { has_history: false, .. }), Some(name)) = (&found, &x) {
        let note = Diagnostic::error(&name.place, format!("= \"{}\", which is one number at the end", name.value));
        table.reader.note(note.expected("a column of the history, such as \"time\""));
    }
    let (y, of_y) = ordinates(&table, probes).map_or((None, None), |(y, dimension)| (Some(y), dimension));
    let labels = ["x_label", "y_label"].map(|key| table.text(key).or(String::new()));
    let scale = table.choice("scale").or(PlotScale::Linear);
    let of_x = found.and_then(|found| found.dimension);
    let reference = table.has("reference").then(|| reference(&table, [of_x, of_y]));
    table.finish("here");
    if reference == Some(None) {
        return None;
    }
    Some(Plot { title, x: x?, y: y?, labels, scale, reference: reference.flatten() })
}

/// What a name stands for.
struct Found {
    /// Unknown where the probe is wrong itself, or there is none.
    dimension: Option<Dimension>,
    has_history: bool,
}

/// What a name of a plot stands for; notes a name that does not exist.
fn find(table: &Table<'_>, name: &Spanned<String>, probes: &ReadProbes) -> Found {
    if let Some(probe) = probes.find(&name.value) {
        return Found { dimension: probe.dimension, has_history: !probe.scalar };
    }
    let columns = HistoryColumns::ALL.list();
    if let Some((_, unit)) = columns.iter().find(|(column, _)| *column == name.value) {
        return Found { dimension: parse_unit(unit).ok().map(|unit| unit.dimension), has_history: true };
    }
    let of_probes = probes.list.iter().map(|probe| probe.name.as_str()).filter(|name| !name.is_empty());
    let known = of_probes.chain(columns.iter().map(|(column, _)| *column));
    let note =
        Diagnostic::error(&name.place, format!("= \"{}\" is neither a probe nor a column of history.csv", name.value));
    table.reader.note(table.reader.suggest(note, &name.value, known, "there are"));
    Found { dimension: None, has_history: true }
}

/// Names of the ordinates with their dimension, which is one.
fn ordinates(table: &Table<'_>, probes: &ReadProbes) -> Option<(Vec<Spanned<String>>, Option<Dimension>)> {
    if !table.has("y") {
        table.reader.note_missing(&table.place_of("y"), "a list of names such as [\"load\"]");
    }
    let y = names::read(table, "y", "probes or columns")?;
    let found: Vec<Found> = y.iter().map(|name| find(table, name, probes)).collect();
    if table.has("y") && !found.iter().any(|found| found.has_history) {
        let place = table.place_below("y");
        let note = Diagnostic::error(&place, "names no column of the history");
        table.reader.note(note.expected("at least one; probes that are one number are drawn beside it"));
    }
    let dimension = found.iter().find_map(|found| found.dimension);
    for (name, found) in y.iter().zip(&found) {
        if let (Some(own), Some(first)) = (found.dimension, dimension)
            && own != first
        {
            let found = format!("= \"{}\", {} beside {}", name.value, own.phrase(), first.phrase());
            table.reader.note(Diagnostic::error(&name.place, found).remedy("one plot shows columns of one dimension"));
        }
    }
    Some((y, dimension))
}

fn reference(table: &Table<'_>, dimensions: [Option<Dimension>; 2]) -> Option<PlotReference> {
    let inner = table.table("reference")?;
    let file = inner.text("file").spanned().required();
    let name = inner.text("name").or("reference".to_owned());
    let columns = [("x", 0), ("y", 1)].map(|(key, column)| inner.integer(key).or_if_absent(column));
    let sizes = [("x_unit", dimensions[0]), ("y_unit", dimensions[1])].map(|(key, dimension)| match dimension {
        Some(dimension) => {
            if inner.has(key) {
                unit(&inner, key, dimension)
            } else {
                Some(1.0)
            }
        }
        None => {
            inner.pass_over(&[key]);
            None
        }
    });
    inner.finish("here");
    let [x, y] = [columns[0]?, columns[1]?].map(|column| usize::try_from(column).unwrap_or(usize::MAX));
    let points = table_file::pairs(table.reader, &file?, [x, y])?;
    let sizes = [sizes[0]?, sizes[1]?];
    Some(PlotReference { name, points: points.into_iter().map(|[x, y]| [x * sizes[0], y * sizes[1]]).collect() })
}
