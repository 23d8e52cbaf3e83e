//! `[[output.ppv]]`.

use super::names;
use crate::Diagnostic;
use crate::model::{Ppv, Scaling, StationLine};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::{direction, point};

/// Most stations of one line.
const MOST: u64 = 10_000;

pub(super) fn read(output: &Table<'_>) -> Option<Vec<Ppv>> {
    let all: Vec<Option<Ppv>> = output.tables("ppv").into_iter().map(ppv).collect();
    let all: Vec<Ppv> = all.into_iter().collect::<Option<_>>()?;
    for (index, ppv) in all.iter().enumerate() {
        if all[..index].iter().any(|other| other.name.value == ppv.name.value) {
            let found = format!("= \"{}\" is the name of an earlier table", ppv.name.value);
            output.reader.note(Diagnostic::error(&ppv.name.place, found).remedy("rename it"));
        }
    }
    Some(all)
}

fn ppv(table: Table<'_>) -> Option<Ppv> {
    let name = table.text("name").spanned().required();
    let hole = table.text("hole").spanned().required();
    let centre = optional(&table, "centre", |key| point(&table, key).given());
    let axis = optional(&table, "axis", |key| direction(&table, key).given());
    let charge = optional(&table, "charge", |key| table.quantity(key).positive().given());
    if charge == Some(None) {
        table.refuse("scaling", "without charge: distances are then in radii of the hole");
    }
    let scaling = table.choice("scaling").or(Scaling::SquareRoot);
    let line = optional(&table, "line", |_| line(&table));
    let groups = names::read(&table, "groups", "mesh groups");
    if line == Some(None) && groups.as_ref().is_some_and(Vec::is_empty) {
        let note = Diagnostic::error(&table.place, "has no station");
        table.reader.note(note.expected("a line, groups, or both"));
        return None;
    }
    table.finish("here");
    let (name, hole, centre, axis) = (name?, hole?, centre?, axis?);
    Some(Ppv { name, hole, centre, axis, charge: charge?, scaling, line: line?, groups: groups? })
}

fn line(table: &Table<'_>) -> Option<StationLine> {
    let inner = table.table("line")?;
    let [from, to] = ["from", "to"].map(|key| point(&inner, key).required());
    let stations = inner.integer("stations").check(|count| (1..=MOST).contains(count), "a number from 1 to 10000");
    let stations = stations.required();
    inner.finish("here");
    Some(StationLine { from: from?, to: to?, stations: stations? })
}
