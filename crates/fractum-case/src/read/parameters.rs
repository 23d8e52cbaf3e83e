//! `[parameters]`: named quantities.

use std::collections::BTreeMap;

use fractum_output::warning::Code;

use crate::expression::functions;
use crate::reader::{Parameter, Reader, Table};
use crate::tree::{Node, Value};
use crate::{Diagnostic, Place};

/// Names of the parameters that the file declares.
pub(super) fn declared(root: &Node) -> Vec<String> {
    let Value::Table(entries) = &root.value else { return Vec::new() };
    match entries.iter().find(|entry| entry.name == "parameters").map(|entry| &entry.node.value) {
        Some(Value::Table(entries)) => entries.iter().map(|entry| entry.name.clone()).collect(),
        _ => Vec::new(),
    }
}

/// Reads the parameters in the order of the file, so that one may use those above it.
pub(super) fn read(root: &Table<'_>) -> BTreeMap<String, (f64, String)> {
    let reader = root.reader;
    let Some(table) = root.table("parameters") else { return BTreeMap::new() };
    for entry in table.entries() {
        check_name(reader, &entry.name, &entry.key_place);
        if let Some((value, kind)) = reader.constant(&entry.node, "a quantity such as \"21 GPa\"") {
            let mut parameters = reader.parameters.borrow_mut();
            // Read once for every stage: what one of them uses stays used.
            let used = parameters.get(&entry.name).is_some_and(|known| known.used);
            let parameter = Parameter { value, kind, place: entry.node.place.clone(), used };
            parameters.insert(entry.name.clone(), parameter);
        }
    }
    table.finish("here");
    let parameters = reader.parameters.borrow();
    parameters.iter().map(|(name, Parameter { value, kind, .. })| (name.clone(), (*value, kind.symbol()))).collect()
}

/// Notes a name that an expression could not use.
pub(super) fn check_name(reader: &Reader, name: &str, place: &Place) {
    if name.contains(char::is_control) {
        return; // noted where the name was read
    }
    let starts_well = name.starts_with(|c: char| c.is_alphabetic() || c == '_');
    if !starts_well || !name.chars().all(|c| c.is_alphanumeric() || c == '_') {
        let note = Diagnostic::error(place, "is not a name an expression can use");
        reader.note(note.remedy("begin with a letter and go on with letters, digits and underscores"));
    } else if ["t", "x", "y", "z", "pi"].contains(&name) || functions().any(|function| function == name) {
        let found = format!("is called {name}, which expressions use for something else");
        reader.note(Diagnostic::error(place, found).remedy("rename it"));
    }
}

/// Notes parameters that nothing uses: an error for `--set`, which then has no effect, else a warning.
pub(super) fn report_unused(reader: &Reader) {
    for parameter in reader.parameters.borrow().values().filter(|parameter| !parameter.used) {
        let place = &parameter.place;
        let found = "is not used anywhere";
        let note = if place.line == 0 {
            Diagnostic::error(place, found)
        } else {
            Diagnostic::warning(Code::Unused, place, found)
        };
        reader.note(note);
    }
}
