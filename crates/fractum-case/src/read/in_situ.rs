//! `[in_situ]`: stress of the solids before the run.

use super::names;
use crate::Diagnostic;
use crate::model::InSitu;
use crate::reader::Table;
use crate::reader::vectors::field;

const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// Reads the stress; none where the case has none, nothing where it is wrong.
pub(super) fn read(root: &Table<'_>) -> Option<Option<InSitu>> {
    let Some(table) = root.table("in_situ") else { return Some(None) };
    let groups = names::read(&table, "groups", "mesh groups");
    let mut complete = true;
    let stress = table.table("stress").map(|stress| {
        let components = COMPONENTS.map(|name| {
            let value = stress.has(name).then(|| field(&stress, name).spanned().given());
            complete &= !matches!(value, Some(None));
            value.flatten()
        });
        if complete && components.iter().all(Option::is_none) {
            let note = Diagnostic::error(&stress.place, "has no component");
            stress.reader.note(note.expected("at least one of xx, yy, zz, xy, yz, zx"));
            complete = false;
        }
        stress.finish("here");
        components
    });
    if stress.is_none() {
        root.reader.note_missing(&table.place_of("stress"), "a table such as { xx = \"-5 MPa\", yy = \"-8 MPa\" }");
    }
    let place = table.place.clone();
    table.finish("here");
    Some(Some(InSitu { place, stress: stress.filter(|_| complete)?, groups: groups? }))
}
