//! Frames are compressed and written on a thread of their own, while the run goes on.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::{self, JoinHandle};

use serde::{Deserialize, Serialize};

use super::Compression;
use super::document::Document;
use crate::atomic;
use crate::error::WriteError;

/// A file of which everything is known, but which is neither compressed nor written yet.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct PendingFile(Content);

#[derive(Clone, Debug, Serialize, Deserialize)]
enum Content {
    Document(Document<'static>, Compression),
    Text(String),
}

impl PendingFile {
    pub(super) fn of_document(document: Document<'_>, compression: Compression) -> Self {
        PendingFile(Content::Document(document.into_owned(), compression))
    }

    /// A file of text.
    pub fn of_text(text: String) -> Self {
        PendingFile(Content::Text(text))
    }

    /// Writes the file at `path`.
    ///
    /// # Errors
    /// [`WriteError`].
    pub fn write(&self, path: &Path) -> Result<(), WriteError> {
        match &self.0 {
            Content::Document(document, compression) => atomic::write(path, &document.to_bytes(*compression)),
            Content::Text(text) => atomic::write(path, text.as_bytes()),
        }
    }
}

/// Writes frame after frame on a thread of its own; at most one is under way.
#[derive(Debug, Default)]
pub struct FrameWriter {
    under_way: Option<JoinHandle<Result<(), WriteError>>>,
}

impl FrameWriter {
    /// Begins to write the files of a frame at their paths, one after the other, once the frame before is written.
    ///
    /// # Errors
    /// [`WriteError`] of the frame before; of this one where there is no thread for it.
    pub fn begin(&mut self, frame: Vec<(PathBuf, PendingFile)>) -> Result<(), WriteError> {
        self.finish()?;
        let frame = Arc::new(frame);
        let own = Arc::clone(&frame);
        let write = |frame: &[(PathBuf, PendingFile)]| frame.iter().try_for_each(|(path, file)| file.write(path));
        match thread::Builder::new().name("frames".into()).spawn(move || write(&own)) {
            Ok(thread) => self.under_way = Some(thread),
            // A system without a thread to spare: the run waits for its frame.
            Err(_) => write(&frame)?,
        }
        Ok(())
    }

    /// The error of the last frame, if it has ended with one by now.
    ///
    /// # Errors
    /// [`WriteError`], once.
    pub fn check(&mut self) -> Result<(), WriteError> {
        if self.under_way.as_ref().is_some_and(JoinHandle::is_finished) { self.finish() } else { Ok(()) }
    }

    /// Waits for the last frame.
    ///
    /// # Errors
    /// [`WriteError`] of that frame.
    pub fn finish(&mut self) -> Result<(), WriteError> {
        let Some(thread) = self.under_way.take() else { return Ok(()) };
        // A panic there is one here.
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

impl Drop for FrameWriter {
    /// A frame that was begun is written, also where the run ends by an error, which is the one to report.
    fn drop(&mut self) {
        let _ = self.under_way.take().map(JoinHandle::join);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vtk::{Collection, Field, PolyCells, PolyData};
    use std::fs;

    fn cloud(points: &[[f64; 3]], path: &Path) -> ((PathBuf, PendingFile), Vec<u8>) {
        let data = PolyData {
            points,
            cells: PolyCells::Points,
            point_data: &[Field::vector("velocity", points)],
            cell_data: &[],
            time: Some(0.5),
        };
        ((path.to_owned(), data.pending(Compression::Fast).unwrap()), data.to_bytes(Compression::Fast).unwrap())
    }

    #[test]
    fn frames_written_beside_the_run_are_those_of_their_instants() {
        let folder = tempfile::tempdir().unwrap();
        let mut writer = FrameWriter::default();
        let mut points: Vec<[f64; 3]> = (0..30_000).map(|i| [f64::from(i).sin(), f64::from(i).cos(), 1.0]).collect();
        let mut expected = Vec::new();
        for frame in 0..4 {
            let path = folder.path().join(format!("{frame}.vtp"));
            let (pending, bytes) = cloud(&points, &path);
            let mut collection = Collection::default();
            collection.push(0.5, 0, "cloud", format!("{frame}.vtp"));
            writer.begin(vec![pending, (folder.path().join("fields.pvd"), collection.pending())]).unwrap();
            points.iter_mut().for_each(|point| point[2] += 1.0);
            expected.push((path, bytes));
        }
        writer.finish().unwrap();
        assert!(expected.iter().all(|(path, bytes)| fs::read(path).unwrap() == *bytes));
        assert!(fs::read_to_string(folder.path().join("fields.pvd")).unwrap().contains("file=\"3.vtp\""));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 5);
    }

    #[test]
    fn a_frame_that_fails_is_told_once_and_those_after_it_are_not_begun() {
        let folder = tempfile::tempdir().unwrap();
        let [bad, good] = ["absent/a.vtp", "b.vtp"].map(|name| folder.path().join(name));
        let mut writer = FrameWriter::default();
        writer.begin(vec![cloud(&[[0.0; 3]], &bad).0, cloud(&[[0.0; 3]], &good).0]).unwrap();
        let error = writer.begin(vec![cloud(&[[0.0; 3]], &good).0]).unwrap_err();
        assert!(matches!(error, WriteError::MissingFolder { .. }), "{error}");
        assert!(!good.exists());
        writer.check().unwrap();
        writer.finish().unwrap();
    }
}
