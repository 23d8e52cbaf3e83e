//! What takes seconds to make and depends on a few numbers only, kept by the hash of these numbers.
//!
//! An entry is [`MAGIC`], a checksum (16 bytes, little-endian) of its kind, its key and its content, and the content.

use std::fs;
use std::path::PathBuf;

use fractum_output::atomic;

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

    /// The entry of a key as `read` understands it. One that is damaged, of another format, or refused by `read`, counts
    /// as absent, and will be made again.
    pub(crate) fn find<T>(&self, kind: &str, key: u128, read: impl FnOnce(&[u8]) -> Option<T>) -> Option<T> {
        let entry = fs::read(self.path(kind, key)?).ok()?;
        let (sum, content) = entry.strip_prefix(MAGIC)?.split_at_checked(size_of::<u128>())?;
        if sum != checksum(kind, key, content).to_le_bytes() {
            return None;
        }
        read(content)
    }

    /// Keeps an entry, whole or not at all. That a folder cannot be written only costs time in the next run.
    pub(crate) fn keep(&self, kind: &str, key: u128, content: &[u8]) {
        if let (Some(folder), Some(path)) = (&self.folder, self.path(kind, key)) {
            let entry = [MAGIC, &checksum(kind, key, content).to_le_bytes(), content].concat();
            let _ = atomic::create_folder(folder).and_then(|()| atomic::write(&path, &entry));
        }
    }

    fn path(&self, kind: &str, key: u128) -> Option<PathBuf> {
        Some(self.folder.as_ref()?.join(format!("{key:032x}.{kind}")))
    }
}

/// First bytes of an entry; the last tells the version of its form.
const MAGIC: &[u8] = b"fractKE1";

fn checksum(kind: &str, key: u128, content: &[u8]) -> u128 {
    let mut hasher = xxhash_rust::xxh3::Xxh3::new();
    hasher.update(kind.as_bytes());
    hasher.update(&key.to_le_bytes());
    hasher.update(content);
    hasher.digest128()
}

/// Raised whenever packings, beams or strengths come out differently for the same numbers: older entries are then made anew.
const METHOD: u32 = 6;

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

    #[test]
    fn no_entry_is_believed_with_a_flipped_bit_cut_short_or_under_another_name() {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache::new(Some(folder.path().to_path_buf()));
        let all = |bytes: &[u8]| Some(bytes.to_vec());
        cache.keep("strength", 7, &1.25f64.to_le_bytes());
        let path = cache.path("strength", 7).unwrap();
        let whole = fs::read(&path).unwrap();
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            fs::write(&path, bytes).unwrap();
            assert_eq!(cache.find("strength", 7, all), None, "bit {bit}");
        }
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert_eq!(cache.find("strength", 7, all), None, "{length} bytes");
        }
        for (kind, key) in [("strength", 8), ("beams", 7)] {
            fs::write(cache.path(kind, key).unwrap(), &whole).unwrap();
            assert_eq!(cache.find(kind, key, all), None, "{kind} {key}");
        }
        // As entries were before: the bare number.
        fs::write(&path, 1.25f64.to_le_bytes()).unwrap();
        assert_eq!(cache.find("strength", 7, all), None);
    }
}
