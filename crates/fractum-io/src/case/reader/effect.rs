//! Keys without effect.

use super::Table;
use crate::case::Diagnostic;
use crate::case::tree::Entry;
use crate::warning::Code;

impl Table<'_> {
    /// Notes that a key which is there has no effect, and why.
    pub(in crate::case) fn refuse(&self, name: &str, why: &str) {
        if let Some((entry, used)) = self.entries.iter().find(|(entry, _)| entry.name == name) {
            used.set(true);
            self.no_effect(entry, why);
        }
    }

    /// Notes that a key which is there has no effect while something is switched off: it may stay for later.
    pub(in crate::case) fn set_aside(&self, name: &str, why: &str) {
        if let Some((entry, used)) = self.entries.iter().find(|(entry, _)| entry.name == name) {
            used.set(true);
            self.reader.note(Diagnostic::warning(Code::NoEffect, &entry.key_place, format!("has no effect {why}")));
        }
    }

    /// Whether `--set` gives a value of this table.
    pub(in crate::case) fn is_overridden(&self) -> bool {
        self.entries.iter().any(|(entry, _)| entry.node.place.is_override())
    }

    /// A key without effect is a mistake; but what the file says may stay where `--set` has switched it off.
    fn no_effect(&self, entry: &Entry, why: &str) {
        let found = format!("has no effect {why}");
        self.reader.note(if self.is_overridden() && !entry.node.place.is_override() {
            Diagnostic::warning(Code::NoEffect, &entry.key_place, found)
        } else {
            Diagnostic::error(&entry.key_place, found).remedy("remove it")
        });
    }

    /// Reports the keys that nobody asked for: they have no effect, for the reason given.
    pub(in crate::case) fn finish(self, why: &str) {
        for (entry, _) in self.entries.iter().filter(|(_, used)| !used.get()) {
            self.no_effect(entry, why);
        }
    }
}
