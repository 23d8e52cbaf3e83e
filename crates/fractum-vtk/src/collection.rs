//! PVD: which file shows which part at which time.

use serde::{Deserialize, Serialize};

use crate::pending::PendingFile;
use crate::text::escape;

/// One file of a time series.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Simulated time [s].
    pub time: f64,
    /// Number of the part (body, particles, ...) among those of the same time.
    pub part: u32,
    /// Name of the part that ParaView shows.
    pub name: String,
    /// Path of the file relative to the collection's, with forward slashes.
    pub file: String,
}

/// A time series in the making. It is rewritten, whole, whenever files were added: readers always find a valid one. Its
/// value belongs into a checkpoint, so that a resumed run lists the files that the uninterrupted one would list.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Collection {
    /// The files, in the order of their times.
    pub entries: Vec<Entry>,
}

impl Collection {
    /// Adds a file.
    pub fn push(&mut self, time: f64, part: u32, name: impl Into<String>, file: impl Into<String>) {
        self.entries.push(Entry { time, part, name: name.into(), file: file.into() });
    }

    /// The file's text.
    pub fn to_xml(&self) -> String {
        let mut text =
            String::from("<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"1.0\">\n  <Collection>\n");
        for Entry { time, part, name, file } in &self.entries {
            // The shortest text that reads back as exactly this number, `1e-7` for a small one.
            let time = format!("{time:?}");
            let (time, name, file) = (time.strip_suffix(".0").unwrap_or(&time), escape(name), escape(file));
            let line = format!("timestep=\"{time}\" group=\"\" part=\"{part}\" name=\"{name}\" file=\"{file}\"");
            text.push_str(&format!("    <DataSet {line}/>\n"));
        }
        text.push_str("  </Collection>\n</VTKFile>\n");
        text
    }

    /// The file, to be written once its files are.
    pub fn pending(&self) -> PendingFile {
        PendingFile::of_text(self.to_xml())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_file_is_listed_with_time_and_part() {
        let mut collection = Collection::default();
        collection.push(0.0, 0, "disc", "fields/000000.vtu");
        collection.push(1e-4, 1, "a & b", "particles/000010.vtp");
        let text = collection.to_xml();
        assert!(text.contains("timestep=\"0\" group=\"\" part=\"0\" name=\"disc\" file=\"fields/000000.vtu\""));
        assert!(text.contains("timestep=\"0.0001\" group=\"\" part=\"1\" name=\"a &amp; b\""));
        assert_eq!(text.matches("<DataSet ").count(), 2);
    }
}
