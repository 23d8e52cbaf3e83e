//! What can go wrong with files, in the user's words: which file, what was found, what helps.

use std::io;
use std::path::{Path, PathBuf};

/// Why a result written earlier could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The operating system refuses.
    #[error("{}: cannot be read: {source}", path.display())]
    Refused {
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The content is not what this file should hold.
    #[error("{}:{line}: {found}; expected {expected}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is there.
        found: String,
        /// What should be there.
        expected: String,
    },
}

/// Why a file or folder could not be written, where, and what helps.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// Another run is writing there.
    #[error("{}: another run is writing into this folder; wait for it, or choose another folder with -o", path.display())]
    Busy {
        /// The file that the other run holds.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// No space left, or the user's quota is used up.
    #[error("{}: the disk is full; free some space or choose another folder with -o", path.display())]
    DiskFull {
        /// The file that was being written.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The user may not write here, or the file system is read-only.
    #[error("{}: no permission to write here; choose another folder with -o or change its permissions", path.display())]
    PermissionDenied {
        /// The file that was to be written.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The folder that should hold the file does not exist.
    #[error("{}: its folder does not exist; create it or choose another with -o", path.display())]
    MissingFolder {
        /// The file that was to be written.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// The name is taken: by a folder where a file is written, or by a file where a folder should be.
    #[error("{}: this name is taken ({source}); move it away or choose another folder with -o", path.display())]
    NameTaken {
        /// The file or folder that was to be written.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// A growing file lacks bytes that it held when the state to resume from was saved.
    #[error(
        "{}: it has {found} bytes but had {expected} when the state was saved; \
         restore the file or start the run again with --overwrite",
        path.display()
    )]
    Shortened {
        /// The growing file.
        path: PathBuf,
        /// Its length now [bytes].
        found: u64,
        /// Its length when the state was saved [bytes].
        expected: u64,
    },
    /// A growing file holds other bytes than when the state to resume from was saved.
    #[error(
        "{}: it was changed or damaged since the state was saved; restore the file or start the run again with --overwrite",
        path.display()
    )]
    Damaged {
        /// The growing file.
        path: PathBuf,
    },
    /// Anything else the operating system refuses.
    #[error("{}: cannot be written: {source}; check the disk, then try again or choose another folder with -o", path.display())]
    Other {
        /// The file that was being written.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
}

impl WriteError {
    /// Sorts the operating system's `source` error about `path` into the cases that a user can act upon.
    pub fn new(path: &Path, source: io::Error) -> Self {
        use io::ErrorKind as Kind;
        let path = path.to_path_buf();
        match source.kind() {
            Kind::StorageFull | Kind::QuotaExceeded => Self::DiskFull { path, source },
            Kind::PermissionDenied | Kind::ReadOnlyFilesystem => Self::PermissionDenied { path, source },
            Kind::WouldBlock | Kind::ResourceBusy => Self::Busy { path, source },
            Kind::NotFound => Self::MissingFolder { path, source },
            Kind::IsADirectory | Kind::NotADirectory | Kind::AlreadyExists | Kind::DirectoryNotEmpty => {
                Self::NameTaken { path, source }
            }
            _ => Self::Other { path, source },
        }
    }

    /// The file or folder concerned.
    pub fn path(&self) -> &Path {
        match self {
            Self::Busy { path, .. }
            | Self::DiskFull { path, .. }
            | Self::PermissionDenied { path, .. }
            | Self::MissingFolder { path, .. }
            | Self::NameTaken { path, .. }
            | Self::Shortened { path, .. }
            | Self::Damaged { path }
            | Self::Other { path, .. } => path,
        }
    }
}
