//! Identity of a case by content.

use xxhash_rust::xxh3::Xxh3;

use super::Case;

impl Case {
    /// Hash of everything read besides the mesh: text, overrides, tables. The path plays no part, so a case keeps its
    /// hash when it moves.
    pub fn hash(&self) -> u128 {
        let source = &self.source;
        let mut hasher = Xxh3::new();
        let mut add = |part: &[u8]| {
            hasher.update(&(part.len() as u64).to_le_bytes()); // so that parts cannot run into one another
            hasher.update(part);
        };
        add(source.text.as_bytes());
        add(&(source.overrides.len() as u64).to_le_bytes());
        for (name, value) in &source.overrides {
            add(name.as_bytes());
            add(value.as_bytes());
        }
        for (name, content) in &source.tables {
            add(name.as_bytes());
            add(content);
        }
        hasher.digest128()
    }
}
