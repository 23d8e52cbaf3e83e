//! Identity of a case by content.

use xxhash_rust::xxh3::Xxh3;

use super::Case;

impl Case {
    /// Hash of everything read besides the mesh: text, overrides, tables. The path plays no part, so a case keeps its
    /// hash when it moves.
    pub fn hash(&self) -> u128 {
        let source = &self.source;
        let mut hasher = Xxh3::new();
        add(&mut hasher, source.text.as_bytes());
        add(&mut hasher, &(source.overrides.len() as u64).to_le_bytes());
        for (name, value) in &source.overrides {
            add(&mut hasher, name.as_bytes());
            add(&mut hasher, value.as_bytes());
        }
        self.add_tables(&mut hasher);
        hasher.digest128()
    }

    /// Hash of everything that a resumed run must find as it was: values and tables, without the end of the run and without
    /// comments.
    pub fn hash_but_end(&self) -> u128 {
        let mut hasher = Xxh3::new();
        hasher.update(&self.source.hash_but_end.to_le_bytes());
        self.add_tables(&mut hasher);
        hasher.digest128()
    }

    /// Adds the tables read from other files.
    fn add_tables(&self, hasher: &mut Xxh3) {
        for (name, content) in &self.source.tables {
            add(hasher, name.as_bytes());
            add(hasher, content);
        }
    }

    /// End of the last stage, or of the only one [s].
    pub fn end(&self) -> f64 {
        self.later.last().unwrap_or(self).solver.end
    }
}

/// Adds a part with its length, so that parts cannot run into one another.
pub(super) fn add(hasher: &mut Xxh3, part: &[u8]) {
    hasher.update(&(part.len() as u64).to_le_bytes());
    hasher.update(part);
}
