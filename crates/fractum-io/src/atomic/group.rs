//! Files that the disk takes together.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use super::{sync_folder, unfinished_name};
use crate::error::WriteError;

/// Files that are brought to the disk at a time: the disk writes them in one go instead of one after the other.
const SIDE_BY_SIDE: usize = 8;

/// Files that are brought to the disk together and then get their names, in the order in which they were added.
///
/// Each of them is whole or absent, as with [`write`](super::write), and the disk is waited for once instead of twice a
/// file. After an error nothing more is written; the files that were added before it get their names all the same.
#[derive(Debug, Default)]
pub struct Group {
    files: Vec<(PathBuf, File)>,
    error: Option<WriteError>,
}

impl Group {
    /// Adds a file, in place of one of the same name that was added before, which is gone even if this one cannot be written.
    pub fn add(&mut self, path: &Path, bytes: &[u8]) {
        if self.error.is_some() {
            return;
        }
        let unfinished = unfinished_name(path);
        self.files.retain(|(other, _)| other != path);
        let written = File::create(&unfinished).and_then(|mut file| {
            file.write_all(bytes)?;
            Ok(file)
        });
        match written {
            Ok(file) => self.files.push((path.to_path_buf(), file)),
            Err(error) => {
                // Best effort: the first error is the one to report.
                let _ = fs::remove_file(&unfinished);
                self.error = Some(WriteError::new(path, error));
            }
        }
    }

    /// Number of files that were added.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// Whether no file was added.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Brings the files to the disk and gives them their names.
    ///
    /// # Errors
    /// [`WriteError`] of the first file that cannot be written; neither it nor those after it get their names.
    pub fn finish(mut self) -> Result<(), WriteError> {
        let synced = sync_all(&self.files);
        let files = std::mem::take(&mut self.files);
        let mut folders: Vec<&Path> = Vec::new();
        let mut error = None;
        for ((path, _), synced) in files.iter().zip(synced) {
            let unfinished = unfinished_name(path);
            if error.is_none() {
                match synced.and_then(|()| fs::rename(&unfinished, path)) {
                    Ok(()) => folders.extend(path.parent().filter(|folder| !folders.contains(folder))),
                    Err(failed) => error = Some(WriteError::new(path, failed)),
                }
            }
            if error.is_some() {
                let _ = fs::remove_file(&unfinished);
            }
        }
        let mut error = error.or(self.error.take());
        for folder in folders {
            if let Err(failed) = sync_folder(folder) {
                error.get_or_insert_with(|| WriteError::new(folder, failed));
            }
        }
        error.map_or(Ok(()), Err)
    }
}

impl Drop for Group {
    /// What was not finished leaves nothing behind.
    fn drop(&mut self) {
        for (path, _) in &self.files {
            let _ = fs::remove_file(unfinished_name(path));
        }
    }
}

/// Brings files to the disk, several at a time; what became of each.
fn sync_all(files: &[(PathBuf, File)]) -> Vec<io::Result<()>> {
    let results: Vec<OnceLock<io::Result<()>>> = files.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        while let Some(((_, file), result)) = pick(files, &results, next.fetch_add(1, Ordering::Relaxed)) {
            result.get_or_init(|| file.sync_all());
        }
    };
    thread::scope(|scope| {
        for _ in 1..files.len().min(SIDE_BY_SIDE) {
            // A system without a thread to spare: the others do its work.
            let _ = thread::Builder::new().spawn_scoped(scope, work);
        }
        work();
    });
    results.into_iter().map(|result| result.into_inner().unwrap_or(Ok(()))).collect()
}

fn pick<'a, A, B>(files: &'a [A], results: &'a [B], index: usize) -> Option<(&'a A, &'a B)> {
    files.get(index).zip(results.get(index))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::atomic::tests::names;

    #[test]
    fn files_get_their_names_together_and_the_last_of_one_name_counts() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let mut group = Group::default();
        for index in 0..20 {
            group.add(&path(&format!("{index:02}.png")), &[index; 1000]);
            group.add(&path("list"), &[index]);
        }
        assert!(names(folder.path()).iter().all(|name| name.ends_with(".part")));
        group.finish().unwrap();
        assert_eq!(names(folder.path()).len(), 21);
        assert_eq!(fs::read(path("07.png")).unwrap(), [7; 1000]);
        assert_eq!(fs::read(path("list")).unwrap(), [19]);
    }

    #[test]
    fn after_an_error_files_before_it_have_their_names_and_nothing_is_left_of_the_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("taken")).unwrap();
        let mut group = Group::default();
        ["a", "taken", "b"].iter().for_each(|name| group.add(&path(name), b"x"));
        let error = group.finish().unwrap_err();
        assert!(matches!(error, WriteError::NameTaken { .. }), "{error}");
        assert_eq!(names(folder.path()), ["a", "taken"]);
        let mut group = Group::default();
        ["c", "absent/d", "e"].iter().for_each(|name| group.add(&path(name), b"x"));
        let error = group.finish().unwrap_err();
        assert!(matches!(error, WriteError::MissingFolder { .. }), "{error}");
        assert_eq!(names(folder.path()), ["a", "c", "taken"]);
    }

    #[test]
    fn a_group_that_is_given_up_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let mut group = Group::default();
        group.add(&folder.path().join("a"), b"x");
        drop(group);
        assert!(names(folder.path()).is_empty());
    }
}
