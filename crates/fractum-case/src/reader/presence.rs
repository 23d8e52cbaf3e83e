//! Keys that may be absent, or of which one must be there.

use crate::Diagnostic;
use crate::reader::Table;

/// `Some(None)` where the key is absent, nothing where its value is wrong.
pub(crate) fn optional<T>(
    table: &Table<'_>,
    name: &'static str,
    read: impl FnOnce(&'static str) -> Option<T>,
) -> Option<Option<T>> {
    if table.has(name) { read(name).map(Some) } else { Some(None) }
}

/// The one of these keys that a table has; notes where there is none, or several.
pub(crate) fn exactly_one(table: &Table<'_>, keys: &[&'static str]) -> Option<&'static str> {
    let here: Vec<_> = keys.iter().filter(|key| table.has(key)).copied().collect();
    match here[..] {
        [one] => return Some(one),
        [] => {
            let note = Diagnostic::error(&table.place, format!("has none of {}", keys.join(", ")));
            table.reader.note(note.expected("exactly one"));
        }
        [_, ref others @ ..] => {
            for other in others {
                let place = table.peek(other).map_or_else(|| table.place.clone(), |node| node.place.clone());
                let note = Diagnostic::error(&place, format!("stands beside {}", here[0]));
                table.reader.note(note.expected(format!("exactly one of {}", keys.join(", "))));
            }
        }
    }
    None
}
