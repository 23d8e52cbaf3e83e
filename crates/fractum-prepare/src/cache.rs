//! What takes seconds to make and depends on a few numbers only, kept by the hash of these numbers.

use std::fs;
use std::path::PathBuf;

use fractum_io::atomic;

/// A folder of entries named by their kind and key. Without a folder nothing is found and nothing kept.
#[derive(Clone, Debug, Default)]
pub struct Cache {
    folder: Option<PathBuf>,
}

impl Cache {
    /// A cache in a folder, which is made when the first entry comes; none without a folder.
    pub fn new(folder: Option<PathBuf>) -> Self {
        Cache { folder }
    }

    /// The entry of a key as `read` understands it. One that it refuses counts as absent, and will be made again.
    pub(crate) fn find<T>(&self, kind: &str, key: u128, read: impl FnOnce(&[u8]) -> Option<T>) -> Option<T> {
        read(&fs::read(self.path(kind, key)?).ok()?)
    }

    /// Keeps an entry, whole or not at all. That a folder cannot be written only costs time in the next run.
    pub(crate) fn keep(&self, kind: &str, key: u128, bytes: &[u8]) {
        if let (Some(folder), Some(path)) = (&self.folder, self.path(kind, key)) {
            let _ = atomic::create_folder(folder).and_then(|()| atomic::write(&path, bytes));
        }
    }

    fn path(&self, kind: &str, key: u128) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{key:032x}.{kind}")))
    }
}

/// Raised whenever packings or beams come out differently for the same numbers: older entries are then made anew.
const METHOD: u32 = 3;

/// Key of an entry: everything that decides what it holds, and the program that makes it.
pub(crate) fn key(what: &impl serde::Serialize) -> u128 {
    // Serialising plain numbers and strings into memory has no way to fail.
    let bytes = postcard::to_stdvec(&(env!("CARGO_PKG_VERSION"), METHOD, what)).unwrap_or_default();
    xxhash_rust::xxh3::xxh3_128(&bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_entry_is_found_by_its_key_and_a_refused_one_is_absent() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(Some(folder.path().join("deep")));
        let whole = |bytes: &[u8]| (bytes.len() == 3).then(|| bytes.to_vec());
        assert_eq!(cache.find("x", 7, whole), None);
        cache.keep("x", 7, b"abc");
        assert_eq!(cache.find("x", 7, whole), Some(b"abc".to_vec()));
        assert_eq!(cache.find("x", 8, whole), None);
        assert_eq!(cache.find("y", 7, whole), None);
        cache.keep("x", 7, b"ab");
        assert_eq!(cache.find("x", 7, whole), None);
        Cache::default().keep("x", 7, b"abc");
        assert_eq!(Cache::default().find("x", 7, whole), None);
    }
}
