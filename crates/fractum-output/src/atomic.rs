//! Files that are either whole or absent.
//!
//! A result is written under `NAME.part` beside its final name, brought to the disk, and renamed. Whoever reads the
//! results folder during a run, or after the machine lost power, finds complete files under their names; what still
//! ends in `.part` is unfinished. Files that are made together wait for the disk together ([`Group`]). A file that grows
//! with the run ([`GrowingFile`]) keeps the `.part` until the run ends.

mod group;

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

pub use group::Group;

use crate::error::WriteError;

/// What an unfinished file's name ends with.
pub const UNFINISHED: &str = ".part";

/// Creates `folder` and those above it; an existing folder is fine.
///
/// # Errors
/// [`WriteError`] where the folder cannot be made.
pub fn create_folder(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|error| WriteError::new(folder, error))
}

/// Writes `bytes` to `path`, whole or not at all; a file of that name is replaced.
///
/// # Errors
/// [`WriteError`]; the former file, if any, is then untouched.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    write_with(path, |file| file.write_all(bytes))
}

/// As [`write`], for content produced piece by piece: `content` writes into a buffered file.
///
/// # Errors
/// [`WriteError`], also for an error that `content` returns; the former file, if any, is then untouched.
pub fn write_with(path: &Path, content: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<(), WriteError> {
    let unfinished = unfinished_name(path);
    let written = File::create(&unfinished).and_then(|file| {
        let mut file = BufWriter::with_capacity(1 << 18, file);
        content(&mut file)?;
        let file = file.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.sync_all()?;
        rename(&unfinished, path)
    });
    written.map_err(|error| {
        // Best effort: the first error is the one to report.
        let _ = fs::remove_file(&unfinished);
        WriteError::new(path, error)
    })
}

/// What a growing file held at a moment: kept with a saved state, and checked when a run goes on from it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Written {
    /// Bytes.
    pub length: u64,
    /// Their CRC-32.
    pub checksum: u32,
}

/// A file that grows with the run: `NAME.part` until [`finish`](GrowingFile::finish) gives it its name.
#[derive(Debug)]
pub struct GrowingFile {
    path: PathBuf,
    file: File,
    written: Written,
}

impl GrowingFile {
    /// Starts an empty `NAME.part`. A finished file of that name stays until this one is finished.
    ///
    /// # Errors
    /// [`WriteError`] where it cannot be created.
    pub fn create(path: &Path) -> Result<Self, WriteError> {
        let file = File::create(unfinished_name(path)).map_err(|error| WriteError::new(path, error))?;
        Ok(Self { path: path.to_path_buf(), file, written: Written::default() })
    }

    /// Goes on with the file that held `written` when the state was saved; what was written after that is cut off.
    /// Takes `NAME.part`, or else the finished `NAME`, which becomes unfinished again.
    ///
    /// # Errors
    /// [`WriteError::Shortened`] if the file is absent or shorter, [`WriteError::Damaged`] if its bytes are others; else as
    /// the operating system says.
    pub fn resume(path: &Path, written: Written) -> Result<Self, WriteError> {
        let length = written.length;
        let unfinished = unfinished_name(path);
        let shortened = |found| WriteError::Shortened { path: path.to_path_buf(), found, expected: length };
        let source: &Path = if unfinished.exists() { &unfinished } else { path };
        let found = match fs::metadata(source) {
            Ok(metadata) => metadata.len(),
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(shortened(0)),
            Err(error) => return Err(WriteError::new(path, error)),
        };
        if found < length {
            return Err(shortened(found));
        }
        if checksum(source, length).map_err(|error| WriteError::new(path, error))? != written.checksum {
            return Err(WriteError::Damaged { path: source.to_path_buf() });
        }
        let open = || {
            if source != unfinished {
                rename(source, &unfinished)?;
            }
            let mut file = File::options().write(true).open(&unfinished)?;
            file.set_len(length)?;
            io::Seek::seek(&mut file, io::SeekFrom::End(0))?;
            Ok(file)
        };
        let file = open().map_err(|error| WriteError::new(path, error))?;
        Ok(Self { path: path.to_path_buf(), file, written })
    }

    /// The name that the finished file will have.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Adds `bytes` at the end, in one piece. They reach the operating system at once, so that a killed program loses
    /// none; they survive a power failure once [`sync`](Self::sync) returned.
    ///
    /// # Errors
    /// [`WriteError`]; part of `bytes` may then be in the file.
    pub fn append(&mut self, bytes: &[u8]) -> Result<(), WriteError> {
        self.file.write_all(bytes).map_err(|error| WriteError::new(&self.path, error))?;
        let Written { length, checksum } = self.written;
        let mut hasher = crc32fast::Hasher::new_with_initial(checksum);
        hasher.update(bytes);
        self.written = Written { length: length + bytes.len() as u64, checksum: hasher.finalize() };
        Ok(())
    }

    /// What was appended so far, before a resume included.
    pub fn written(&self) -> Written {
        self.written
    }

    /// Brings everything to the disk and returns what is to be kept with the saved state.
    ///
    /// # Errors
    /// [`WriteError`] where the disk refuses.
    pub fn sync(&mut self) -> Result<Written, WriteError> {
        self.file.sync_data().map_err(|error| WriteError::new(&self.path, error))?;
        Ok(self.written)
    }

    /// Brings everything to the disk and gives the file its name.
    ///
    /// # Errors
    /// [`WriteError`]; the content then stays in `NAME.part`.
    pub fn finish(self) -> Result<(), WriteError> {
        let done = self.file.sync_all().and_then(|()| rename(&unfinished_name(&self.path), &self.path));
        done.map_err(|error| WriteError::new(&self.path, error))
    }

    /// Gives the file its name with the others of a group; without that the content stays in `NAME.part`.
    pub fn finish_in(self, group: &mut Group) {
        group.add_grown(self.path, self.file);
    }
}

/// CRC-32 of the first bytes of a file.
fn checksum(path: &Path, length: u64) -> io::Result<u32> {
    let mut rest = BufReader::with_capacity(1 << 18, File::open(path)?.take(length));
    let mut hasher = crc32fast::Hasher::new();
    loop {
        let bytes = rest.fill_buf()?;
        if bytes.is_empty() {
            return Ok(hasher.finalize());
        }
        hasher.update(bytes);
        let count = bytes.len();
        rest.consume(count);
    }
}

/// `NAME.part` for `NAME`.
pub(crate) fn unfinished_name(path: &Path) -> PathBuf {
    let mut name: OsString = path.as_os_str().to_os_string();
    name.push(UNFINISHED);
    name.into()
}

/// Renames and, where the system can, brings the folder's entry to the disk: else a power failure undoes the rename.
fn rename(from: &Path, to: &Path) -> io::Result<()> {
    fs::rename(from, to)?;
    sync_folder(to.parent().unwrap_or(Path::new("")))
}

/// Brings the entries of a folder to the disk, where the system can.
fn sync_folder(folder: &Path) -> io::Result<()> {
    #[cfg(unix)]
    File::open(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?.sync_all()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Names in a folder, in order.
    pub(super) fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_written_file_is_whole_and_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        write(&path, b"old").unwrap();
        write(&path, b"new").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"new");
        assert_eq!(names(folder.path()), ["summary.json"]);
    }

    #[test]
    fn a_failed_write_leaves_the_former_file_and_no_rest() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        write(&path, b"old").unwrap();
        let error = write_with(&path, |file| {
            file.write_all(b"half")?;
            Err(io::Error::from(io::ErrorKind::StorageFull))
        })
        .unwrap_err();
        assert!(matches!(error, WriteError::DiskFull { .. }), "{error}");
        assert_eq!(error.path(), path);
        assert_eq!(fs::read(&path).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["summary.json"]);
    }

    #[test]
    fn a_full_device_is_told_as_such() {
        // A device that is always full exists on Linux only.
        let full = Path::new("/dev/full");
        if let Ok(mut file) = File::options().write(true).open(full) {
            let error = WriteError::new(full, file.write_all(b"x").unwrap_err());
            assert!(matches!(error, WriteError::DiskFull { .. }), "{error}");
        }
    }

    #[test]
    fn a_missing_folder_and_a_taken_name_are_told_apart() {
        let folder = tempfile::tempdir().unwrap();
        let error = write(&folder.path().join("absent").join("a.csv"), b"x").unwrap_err();
        assert!(matches!(error, WriteError::MissingFolder { .. }), "{error}");
        let taken = folder.path().join("taken");
        fs::create_dir(&taken).unwrap();
        let error = write(&taken, b"x").unwrap_err();
        assert!(matches!(error, WriteError::NameTaken { .. }), "{error}");
        assert!(error.to_string().contains("taken: this name is taken"), "{error}");
        let file = folder.path().join("file");
        write(&file, b"x").unwrap();
        let error = create_folder(&file.join("below")).unwrap_err();
        assert!(matches!(error, WriteError::NameTaken { .. }), "{error}");
    }

    #[test]
    fn a_growing_file_is_unfinished_until_finished() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut file = GrowingFile::create(&path).unwrap();
        file.append(b"one\n").unwrap();
        assert_eq!(names(folder.path()), ["history.csv.part"]);
        assert_eq!(file.sync().unwrap().length, 4);
        file.finish().unwrap();
        assert_eq!(names(folder.path()), ["history.csv"]);
    }

    #[test]
    fn resuming_cuts_off_what_came_after_the_saved_state() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let mut file = GrowingFile::create(&path).unwrap();
        file.append(b"one\n").unwrap();
        let saved = file.written();
        file.append(b"lost\n").unwrap();
        drop(file);
        let mut file = GrowingFile::resume(&path, saved).unwrap();
        file.append(b"two\n").unwrap();
        let saved = file.written();
        file.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one\ntwo\n");

        // Finished after an interrupt, then taken up again.
        let mut file = GrowingFile::resume(&path, saved).unwrap();
        assert_eq!(names(folder.path()), ["history.csv.part"]);
        file.append(b"three\n").unwrap();
        assert_eq!(file.written(), Written { length: 14, checksum: crc32fast::hash(b"one\ntwo\nthree\n") });
        file.finish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"one\ntwo\nthree\n");
    }

    #[test]
    fn resuming_a_shortened_damaged_or_absent_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let saved = Written { length: 5, checksum: crc32fast::hash(b"abcde") };
        let error = GrowingFile::resume(&path, saved).unwrap_err();
        assert!(matches!(error, WriteError::Shortened { found: 0, expected: 5, .. }), "{error}");
        write(&path, b"abc").unwrap();
        let error = GrowingFile::resume(&path, saved).unwrap_err();
        assert!(matches!(error, WriteError::Shortened { found: 3, expected: 5, .. }), "{error}");
        write(&path, b"abXdefg").unwrap();
        let error = GrowingFile::resume(&path, saved).unwrap_err();
        assert!(matches!(error, WriteError::Damaged { .. }), "{error}");
        assert_eq!(names(folder.path()), ["history.csv"]);
    }
}
