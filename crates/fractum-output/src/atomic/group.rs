//! Files that the disk takes together.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::{Duration, Instant};

use super::{sync_folder, unfinished_name};
use crate::error::WriteError;

/// Files that are brought to the disk at a time: the disk writes them in one go instead of one after the other.
const SIDE_BY_SIDE: usize = 8;
/// A disk that takes longer for a file is given several at a time; for a faster one waiting for threads would take longer.
const SLOW: Duration = Duration::from_millis(2);

/// Files that are brought to the disk together and then get their names, in the order in which they were added.
///
/// Each of them is whole or absent, as with [`write`](super::write), and the disk is waited for once instead of twice a
/// file. After an error nothing more is written; the files that were added before it get their names all the same.
#[derive(Debug, Default)]
pub struct Group {
    files: Vec<Member>,
    error: Option<WriteError>,
}

/// A file that waits for its name.
#[derive(Debug)]
struct Member {
    path: PathBuf,
    file: File,
    /// Whether it stays under its unfinished name where it cannot get its own.
    stays: bool,
}

impl Group {
    /// Adds a file, in place of one of the same name that was added before. Where it cannot be written, the one before stays.
    pub fn add(&mut self, path: &Path, bytes: &[u8]) {
        if self.error.is_some() {
            return;
        }
        let unfinished = unfinished_name(path);
        let earlier = self.files.iter().position(|member| member.path == path);
        let place = if earlier.is_some() { unfinished_name(&unfinished) } else { unfinished.clone() };
        let written = File::create(&place).and_then(|mut file| {
            file.write_all(bytes)?;
            if earlier.is_some() {
                fs::rename(&place, &unfinished)?;
            }
            Ok(file)
        });
        match written {
            Ok(file) => {
                earlier.map(|earlier| self.files.remove(earlier));
                self.files.push(Member { path: path.to_path_buf(), file, stays: false });
            }
            Err(error) => {
                // Best effort: the first error is the one to report.
                let _ = fs::remove_file(&place);
                self.error = Some(WriteError::new(path, error));
            }
        }
    }

    /// Adds a file that has grown under its unfinished name, where it stays if the group is not finished.
    pub(super) fn add_grown(&mut self, path: PathBuf, file: File) {
        self.files.push(Member { path, file, stays: true });
    }

    /// Where the content of `path` lies until the group is finished.
    pub fn place_of(&self, path: &Path) -> PathBuf {
        let is_there = self.files.iter().any(|member| member.path == path);
        if is_there { unfinished_name(path) } else { path.to_path_buf() }
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
        let synced = sync_all(&self.files, |member| member.file.sync_all());
        let files = std::mem::take(&mut self.files);
        let mut folders: Vec<&Path> = Vec::new();
        let mut error = None;
        for (member, synced) in files.iter().zip(synced) {
            let path = &member.path;
            if error.is_none() {
                match synced.and_then(|()| fs::rename(unfinished_name(path), path)) {
                    Ok(()) => folders.extend(path.parent().filter(|folder| !folders.contains(folder))),
                    Err(failed) => error = Some(WriteError::new(path, failed)),
                }
            }
            if error.is_some() {
                member.give_up();
            }
        }
        let mut error = error.or(self.error.take());
        for (folder, synced) in folders.iter().zip(sync_all(&folders, |folder| sync_folder(folder))) {
            if let Err(failed) = synced {
                error.get_or_insert_with(|| WriteError::new(folder, failed));
            }
        }
        error.map_or(Ok(()), Err)
    }
}

impl Member {
    fn give_up(&self) {
        if !self.stays {
            let _ = fs::remove_file(unfinished_name(&self.path));
        }
    }
}

impl Drop for Group {
    /// What was not finished leaves nothing behind.
    fn drop(&mut self) {
        self.files.iter().for_each(Member::give_up);
    }
}

/// Brings files or folders to the disk, to a slow one several at a time; what became of each.
fn sync_all<T: Sync>(all: &[T], sync: impl Fn(&T) -> io::Result<()> + Sync) -> Vec<io::Result<()>> {
    let results: Vec<OnceLock<io::Result<()>>> = all.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let work = |until: Option<Instant>| {
        while until.is_none_or(|until| Instant::now() < until)
            && let index = next.fetch_add(1, Ordering::Relaxed)
            && let Some((one, result)) = all.get(index).zip(results.get(index))
        {
            result.get_or_init(|| sync(one));
        }
    };
    work(Some(Instant::now() + SLOW));
    let left = all.len().saturating_sub(next.load(Ordering::Relaxed));
    thread::scope(|scope| {
        for _ in 1..left.min(SIDE_BY_SIDE) {
            // A system without a thread to spare: the others do its work.
            let _ = thread::Builder::new().spawn_scoped(scope, || work(None));
        }
        work(None);
    });
    results.into_iter().map(|result| result.into_inner().unwrap_or(Ok(()))).collect()
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
    fn a_file_that_cannot_be_replaced_stays() {
        let folder = tempfile::tempdir().unwrap();
        let list = folder.path().join("list");
        let mut group = Group::default();
        group.add(&list, b"first");
        // In the way of the second one.
        fs::create_dir(folder.path().join("list.part.part")).unwrap();
        group.add(&list, b"second");
        assert!(group.finish().is_err());
        assert_eq!(fs::read(&list).unwrap(), b"first");
    }

    #[test]
    fn a_grown_file_stays_unfinished_where_its_group_is_given_up() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let grown = |group: &mut Group| {
            let mut file = super::super::GrowingFile::create(&path).unwrap();
            file.append(b"rows").unwrap();
            file.finish_in(group);
        };
        let mut group = Group::default();
        grown(&mut group);
        assert_eq!(fs::read(group.place_of(&path)).unwrap(), b"rows");
        drop(group);
        assert_eq!(names(folder.path()), ["history.csv.part"]);
        let mut group = Group::default();
        grown(&mut group);
        group.finish().unwrap();
        assert_eq!(names(folder.path()), ["history.csv"]);
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
