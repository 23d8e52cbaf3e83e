//! Lists of names.

use crate::reader::Table;
use crate::tree::Value;
use crate::{Diagnostic, Spanned};

/// A list of names; empty where the key is absent.
///
/// - `of`: what has these names, for messages
pub(super) fn read(table: &Table<'_>, key: &str, of: &str) -> Option<Vec<Spanned<String>>> {
    let Some(node) = table.node(key) else { return Some(Vec::new()) };
    let wrong = || {
        let note = Diagnostic::error(&node.place, node.found());
        table.reader.note(note.expected(format!("a list of names of {of}")));
    };
    let Value::Array(items) = &node.value else {
        wrong();
        return None;
    };
    let mut names = Vec::new();
    for item in items {
        let Value::Text(name) = &item.value else {
            wrong();
            return None;
        };
        names.push(Spanned::new(name.clone(), item.place.clone()));
    }
    Some(names)
}
