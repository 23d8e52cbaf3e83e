//! `[[mesh.joints]]` and `[mesh.grains]`: what is cut into the mesh.

use std::f64::consts::PI;

use fractum_mesh::{Disc, Grains, JointSet, Orientation, Vec3, normal_of};

use super::{names, table_file};
use crate::model::{GrainsWithin, JointSource, Joints, Network};
use crate::reader::presence::{exactly_one, optional};
use crate::reader::vectors::condition;
use crate::reader::{Reader, Table};
use crate::tree::{Node, Value};
use crate::unit::Dimension;
use crate::{Diagnostic, Place, Spanned};

/// Open share of a plane beyond which discs find no place beside each other.
const MOST_OF_PLANE: f64 = 0.4;
/// Keys of a set.
const OF_SETS: [&str; 8] =
    ["dip_direction", "scatter", "spacing", "spacing_scatter", "length", "length_scatter", "persistence", "seed"];

/// Reads what is cut into the mesh; nothing where that is wrong.
///
/// - `unit`: length of the unit of the mesh [m], in which tables are
pub(super) fn read(mesh: &Table<'_>, unit: f64) -> Option<Network> {
    let read: Vec<Option<Joints>> = mesh.tables("joints").into_iter().map(|table| joints(table, unit)).collect();
    let grains = match mesh.table("grains") {
        Some(table) => Some(grains(table)?),
        None => None,
    };
    Some(Network { joints: read.into_iter().collect::<Option<_>>()?, grains })
}

fn joints(table: Table<'_>, unit: f64) -> Option<Joints> {
    let name = table.text("name").or("joints".to_owned());
    let within = names::read(&table, "within", "mesh groups");
    let condition = optional(&table, "where", |name| condition(&table, name).spanned().given());
    let place = table.place.clone();
    let source = match exactly_one(&table, &["table", "angle", "dip"]) {
        Some("table") => {
            OF_SETS.iter().for_each(|key| table.refuse(key, "beside a table of joints"));
            of_table(&table, unit)
        }
        Some(given) => set(&table, given == "dip").map(JointSource::Set),
        None => {
            table.pass_over(&["table", "angle", "dip"]);
            table.pass_over(&OF_SETS);
            None
        }
    };
    table.finish("here");
    Some(Joints { name, place, within: within?, condition: condition?, source: source? })
}

fn set(table: &Table<'_>, is_spatial: bool) -> Option<JointSet> {
    let deviation = |name: &'static str| {
        table.quantity(name).check(|value| (0.0..=2.0).contains(value), "from 0 to 2").or_if_absent(0.0)
    };
    let orientation = if is_spatial {
        let dip = table.quantity("dip").check(|dip| (0.0..=0.5 * PI + 1e-12).contains(dip), "from 0 to 90 deg");
        let (dip, direction) = (dip.required(), table.quantity("dip_direction").required());
        dip.zip(direction).map(|(dip, direction)| Orientation::Dip([dip, direction]))
    } else {
        table.refuse("dip_direction", "beside angle: traces in a plane have an angle alone");
        table.quantity("angle").required().map(Orientation::Angle)
    };
    let scatter =
        table.quantity("scatter").check(|angle| (0.0..=0.25 * PI + 1e-12).contains(angle), "from 0 to 45 deg");
    let scatter = scatter.or_if_absent(0.0);
    let spacing = table.quantity("spacing").positive().required();
    let spacing_scatter = deviation("spacing_scatter");
    let most = if is_spatial { MOST_OF_PLANE } else { 1.0 };
    let (persistence, length, length_scatter) = if table.has("persistence") {
        let expected =
            if is_spatial { "above 0 and at most 0.4: discs on a plane lie apart" } else { "above 0 and below 1" };
        let fits = |share: &f64| *share > 0.0 && if is_spatial { *share <= most } else { *share < most };
        let persistence = table.quantity("persistence").check(fits, expected).required();
        let length = table.quantity("length").positive().required();
        (persistence, length.map(Some), deviation("length_scatter"))
    } else {
        table.refuse("length", "without persistence: the joints of the set go through the body");
        table.refuse("length_scatter", "without persistence");
        (Some(1.0), Some(None), Some(0.0))
    };
    let seed = table.integer("seed").or(1);
    Some(JointSet {
        group: 0,
        orientation: orientation?,
        scatter: scatter?,
        spacing: spacing?,
        spacing_scatter: spacing_scatter?,
        length: length?,
        length_scatter: length_scatter?,
        persistence: persistence?,
        seed,
    })
}

/// Joints of a table: rows in the case, or a file.
fn of_table(table: &Table<'_>, unit: f64) -> Option<JointSource> {
    let node = table.node("table")?;
    let reader = table.reader;
    let rows: Vec<(Vec<f64>, Place)> = match &node.value {
        Value::Text(file) => {
            let rows = table_file::joints(reader, &Spanned::new(file.clone(), node.place.clone()))?;
            let in_metres = |row: Vec<f64>| match row[..] {
                [x, y, z, dip, direction, diameter] => {
                    vec![x * unit, y * unit, z * unit, dip.to_radians(), direction.to_radians(), diameter * unit]
                }
                _ => row.iter().map(|x| x * unit).collect(),
            };
            let place = |line: u32| Place { line, column: 1, ..rows.place.clone() };
            rows.rows.into_iter().map(|(line, row)| (in_metres(row), place(line))).collect()
        }
        Value::Array(items) if !items.is_empty() => {
            let read: Vec<Option<_>> = items.iter().map(|item| row(reader, item)).collect();
            read.into_iter().collect::<Option<_>>()?
        }
        _ => {
            let expected = crate::KeyKind::JointRows.expected();
            reader.note(Diagnostic::error(&node.place, node.found()).expected(expected));
            return None;
        }
    };
    if rows.iter().any(|(row, _)| row.len() != rows[0].0.len()) {
        reader.note(Diagnostic::error(&node.place, "has rows of 4 and of 6").expected("traces, or discs"));
        return None;
    }
    if rows[0].0.len() == 4 {
        let trace = |(row, place): (Vec<f64>, Place)| ([[row[0], row[1]], [row[2], row[3]]], place);
        return Some(JointSource::Traces(rows.into_iter().map(trace).collect()));
    }
    let mut discs = Vec::new();
    for (row, place) in rows {
        let [dip, direction, diameter] = [3, 4, 5].map(|column| row[column]);
        if !(0.0..=0.5 * PI + 1e-12).contains(&dip) || diameter <= 0.0 {
            let found = format!("has the dip {} deg and the diameter {diameter} m", dip.to_degrees());
            reader.note(Diagnostic::error(&place, found).expected("a dip of 0 to 90 deg and a diameter above 0"));
            return None;
        }
        let centre = Vec3::new(row[0], row[1], row[2]);
        discs.push((Disc { centre, normal: normal_of(dip, direction), radius: 0.5 * diameter, group: 0 }, place));
    }
    Some(JointSource::Discs(discs))
}

/// A row in the case.
fn row(reader: &Reader, item: &Node) -> Option<(Vec<f64>, Place)> {
    const DISC: [Dimension; 6] =
        [Dimension::LENGTH, Dimension::LENGTH, Dimension::LENGTH, Dimension::NONE, Dimension::NONE, Dimension::LENGTH];
    let cells = match &item.value {
        Value::Array(cells) if cells.len() == 4 || cells.len() == 6 => cells,
        _ => {
            let expected = "x, y, x, y of a trace, or x, y, z, dip, dip direction, diameter of a disc";
            reader.note(Diagnostic::error(&item.place, item.found()).expected(expected));
            return None;
        }
    };
    let dimension = |column: usize| if cells.len() == 4 { Dimension::LENGTH } else { DISC[column] };
    let read: Vec<Option<f64>> =
        cells.iter().enumerate().map(|(column, cell)| reader.quantity(cell, dimension(column))).collect();
    Some((read.into_iter().collect::<Option<_>>()?, item.place.clone()))
}

fn grains(table: Table<'_>) -> Option<GrainsWithin> {
    let size = table.quantity("size").positive().required();
    let seed = table.integer("seed").or(1);
    let rounds = table.integer("regularity").check(|rounds| *rounds <= 20, "0 to 20").or(2) as u32;
    let share = table.quantity("share").check(|share| (0.1..=1.0).contains(share), "from 0.1 to 1").or(1.0);
    let mut phases: Vec<(String, f64)> = Vec::new();
    if let Some(parts) = table.table("phases") {
        for entry in parts.entries() {
            let part = table.reader.quantity(&entry.node, Dimension::NONE)?;
            if part <= 0.0 {
                let note = Diagnostic::error(&entry.node.place, entry.node.found());
                table.reader.note(note.expected("a part of the grains above 0"));
                return None;
            }
            phases.push((entry.name.clone(), part));
        }
        parts.finish("here");
    }
    if share < 1.0 && phases.is_empty() {
        phases.push(("grains".to_owned(), 1.0));
    }
    if share == 1.0 {
        table.set_aside("matrix", "without share: grains fill the body");
    }
    let matrix = table.text("matrix").or("matrix".to_owned());
    let boundary = table.text("boundaries").or("grain-boundaries".to_owned());
    let within = names::read(&table, "within", "mesh groups");
    let place = table.place.clone();
    table.finish("here");
    let grains = Grains { size: size?, rounds, share, phases, matrix, boundary, seed };
    Some(GrainsWithin { place, within: within?, grains })
}
