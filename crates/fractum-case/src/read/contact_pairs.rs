//! `[[contact_pairs]]`: coefficients of contact of two materials.

use super::{materials, names};
use crate::Diagnostic;
use crate::model::{ContactPair, Material};
use crate::reader::Table;

/// Keys of which a pair gives one at least.
const COEFFICIENTS: [&str; 5] = ["friction", "rolling_friction", "restitution", "damping_ratio", "work_of_adhesion"];

/// Reads all pairs against the materials read before; nothing where one of them is wrong.
pub(super) fn read(root: &Table<'_>, materials: &[(String, Option<Material>)]) -> Option<Vec<ContactPair>> {
    let tables = root.tables("contact_pairs");
    let read: Vec<Option<ContactPair>> = tables.into_iter().map(|table| pair(table, materials)).collect();
    let mut complete = true;
    let mut pairs: Vec<ContactPair> = Vec::new();
    for pair in read {
        let Some(pair) = pair else {
            complete = false;
            continue;
        };
        let [first, second] = pair.materials;
        if let Some(other) = pairs.iter().find(|other| other.is_of(first, second)) {
            let [first, second] = pair.materials.map(|index| materials[index].0.as_str());
            let found = format!(
                ": \"{first}\" and \"{second}\" have their coefficients at line {}, in whatever order",
                other.place.line
            );
            root.reader.note(Diagnostic::error(&pair.place, found).remedy("write them into one table"));
            complete = false;
        }
        pairs.push(pair);
    }
    complete.then_some(pairs)
}

fn pair(table: Table<'_>, materials: &[(String, Option<Material>)]) -> Option<ContactPair> {
    let between = between(&table, materials);
    let coefficients = materials::coefficients(&table);
    let is_empty = !COEFFICIENTS.iter().any(|key| table.has(key));
    if is_empty {
        table.reader.note_missing(&table.place_of("friction"), format!("one at least of {}", COEFFICIENTS.join(", ")));
    }
    let place = table.place.clone();
    table.finish("here");
    Some(ContactPair { materials: between?, place, coefficients }).filter(|_| !is_empty)
}

/// The two materials.
fn between(table: &Table<'_>, materials: &[(String, Option<Material>)]) -> Option<[usize; 2]> {
    let expected = "two materials, or one twice for bodies of the same material";
    if !table.has("between") {
        table.reader.note_missing(&table.place_of("between"), expected);
        return None;
    }
    let named = names::read(table, "between", "materials")?;
    let [first, second] = named.as_slice() else {
        let found = match named.len() {
            1 => "names 1 material".to_owned(),
            count => format!("names {count} materials"),
        };
        table.reader.note(Diagnostic::error(&table.place_below("between"), found).expected(expected));
        return None;
    };
    let [first, second] = [first, second].map(|name| materials::named(table.reader, name, materials));
    Some([first?, second?])
}
