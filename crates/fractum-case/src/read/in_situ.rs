//! `[in_situ]`: stress of the solids before the run.

use super::names;
use crate::model::{Body, BodyKind, InSitu, Layer, StressField};
use crate::reader::Table;
use crate::reader::vectors::field;
use crate::{Diagnostic, Spanned};

const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// Reads the stress against the bodies read before; none where the case has none, nothing where it is wrong.
pub(super) fn read(root: &Table<'_>, bodies: Option<&[Body]>) -> Option<Option<InSitu>> {
    let Some(table) = root.table("in_situ") else { return Some(None) };
    let groups = names::read(&table, "groups", "mesh groups");
    let layers: Vec<Option<Layer>> = table.tables("layers").into_iter().map(layer).collect();
    let far = table.has("stress").then(|| stress(&table));
    if far.is_none() && layers.is_empty() {
        tell_missing(&table);
    }
    if table.has("settle") && layers.is_empty() {
        let note = Diagnostic::error(&table.place_below("settle"), "has no effect without layers");
        table.reader.note(
            note.expected("in_situ.layers; the stress of a far field is always that of solids that have settled"),
        );
    }
    let settles = table.flag("settle").or(false);
    let named: Vec<&Spanned<String>> = layers.iter().flatten().flat_map(|layer| &layer.bodies).collect();
    bodies.into_iter().for_each(|bodies| check_names(&table, &named, bodies));
    let place = table.place.clone();
    table.finish("here");
    let stress = match far {
        Some(stress) => Some(stress?),
        None if layers.is_empty() => return None,
        None => None,
    };
    Some(Some(InSitu { place, stress, layers: layers.into_iter().collect::<Option<_>>()?, settles, groups: groups? }))
}

fn layer(table: Table<'_>) -> Option<Layer> {
    let bodies = names::read(&table, "bodies", "solid bodies");
    if bodies.as_ref().is_some_and(Vec::is_empty) {
        let note = Diagnostic::error(&table.place_of("bodies"), "is missing");
        table.reader.note(note.expected("a list of names of solid bodies"));
    }
    let own = if table.has("stress") { stress(&table) } else { None };
    if !table.has("stress") {
        tell_missing(&table);
    }
    table.finish("here");
    Some(Layer { bodies: bodies?, stress: own? })
}

/// Layers name solid bodies, each once.
fn check_names(table: &Table<'_>, named: &[&Spanned<String>], bodies: &[Body]) {
    let solids = bodies.iter().filter(|body| matches!(body.kind, BodyKind::Solid(_)));
    let names = solids.map(|body| body.name.value.as_str());
    for (index, name) in named.iter().enumerate() {
        if !names.clone().any(|known| known == name.value) {
            let note = Diagnostic::error(&name.place, format!("= \"{}\" is no solid body", name.value));
            table.reader.note(table.reader.suggest(note, &name.value, names.clone(), "solid bodies"));
        } else if named[..index].iter().any(|before| before.value == name.value) {
            let note = Diagnostic::error(&name.place, format!("= \"{}\" is named twice", name.value));
            table.reader.note(note.remedy("a body has one stress; name it in one layer"));
        }
    }
}

/// Reads a table of components.
fn stress(table: &Table<'_>) -> Option<StressField> {
    let stress = table.table("stress")?;
    let mut complete = true;
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
    let place = stress.place.clone();
    stress.finish("here");
    complete.then_some(StressField { place, components })
}

fn tell_missing(table: &Table<'_>) {
    let note = "a table such as { xx = \"-5 MPa\", yy = \"-8 MPa\" }";
    table.reader.note_missing(&table.place_of("stress"), note);
}
