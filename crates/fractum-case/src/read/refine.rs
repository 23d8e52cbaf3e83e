//! `[[mesh.refine]]`: where elements become smaller.

use crate::model::{RefineZone, Rows};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::condition;

/// Reads the zones; nothing where one is wrong.
pub(super) fn read(mesh: &Table<'_>) -> Option<Vec<RefineZone>> {
    let read: Vec<Option<RefineZone>> = mesh.tables("refine").into_iter().map(zone).collect();
    read.into_iter().collect()
}

fn zone(table: Table<'_>) -> Option<RefineZone> {
    let condition = optional(&table, "where", |name| condition(&table, name).spanned().given());
    let size = table.quantity("size").positive().required();
    let rows = table.choice("rows").or(Rows::Break);
    if rows == Rows::Keep {
        table.set_aside("seed", "where rows are kept: no node moves");
    }
    let seed = table.integer("seed").or(1);
    let place = table.place.clone();
    table.finish("here");
    Some(RefineZone { place, condition: condition?, size: size?, seed: (rows == Rows::Break).then_some(seed) })
}
