//! Keys without effect.

use fractum_output::warning::Code;

use super::Table;
use crate::Diagnostic;
use crate::tree::Entry;

impl Table<'_> {
    /// Notes that a key which is there has no effect, and why.
    pub(crate) fn refuse(&self, name: &str, why: &str) {
        if let Some((entry, used)) = self.entries.iter().find(|(entry, _)| entry.name == name) {
            used.set(true);
            self.no_effect(entry, why);
        }
    }

    /// Notes that a key which is there has no effect while something is switched off: it may stay for later.
    pub(crate) fn set_aside(&self, name: &str, why: &str) {
        if let Some((entry, used)) = self.entries.iter().find(|(entry, _)| entry.name == name) {
            used.set(true);
            self.reader.note(Diagnostic::warning(Code::NoEffect, &entry.key_place, format!("has no effect {why}")));
        }
    }

    /// Whether `--set` gives a value of this table.
    pub(crate) fn is_overridden(&self) -> bool {
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

    /// Reports the keys that nobody asked for: they have no effect, for the reason given. Where no better reason than "here" is known and
    /// something in the table is wrong, the reading may have ended before it came to them.
    pub(crate) fn finish(self, why: &str) {
        if why == "here" && self.reader.has_mistake_below(&self.place.key) {
            return;
        }
        for (entry, _) in self.entries.iter().filter(|(_, used)| !used.get()) {
            self.no_effect(entry, why);
        }
    }
}
