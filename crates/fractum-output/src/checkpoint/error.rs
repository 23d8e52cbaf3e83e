use std::io;
use std::path::PathBuf;

use super::FORMAT;
use crate::error::WriteError;
use crate::memory::TooLarge;

/// Why a checkpoint could not be saved or is refused.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The state has no form that a file can hold.
    #[error("the state cannot be stored: {reason}")]
    NotStorable {
        /// What the serialiser said.
        reason: String,
    },
    /// The operating system refuses to read it.
    #[error("{}: the checkpoint cannot be read: {source}", path.display())]
    Unreadable {
        /// The file or folder.
        path: PathBuf,
        /// What the operating system said.
        source: io::Error,
    },
    /// Something else bears the name of a checkpoint.
    #[error("{}: not a fractum checkpoint; move it out of the folder", path.display())]
    NotACheckpoint {
        /// The file.
        path: PathBuf,
    },
    /// The container is of another format.
    #[error(
        "{}: checkpoint format {found}, this program reads {FORMAT}; continue with the program that wrote it, \
         or start again with --overwrite",
        path.display()
    )]
    OtherFormat {
        /// The file.
        path: PathBuf,
        /// Format of the file.
        found: u32,
    },
    /// The file ends too early.
    #[error("{}: the checkpoint is cut off; delete it to continue from an older one", path.display())]
    Truncated {
        /// The file.
        path: PathBuf,
    },
    /// A checksum or a length is wrong.
    #[error("{}: the checkpoint is damaged ({what}); delete it to continue from an older one", path.display())]
    Corrupt {
        /// The file.
        path: PathBuf,
        /// Where.
        what: String,
    },
    /// Written by another version of the program.
    #[error(
        "{}: saved by fractum {found}, this is {expected}; continue with that version, \
         or start again with --overwrite",
        path.display()
    )]
    OtherProgram {
        /// The file.
        path: PathBuf,
        /// Version that wrote it.
        found: String,
        /// Version that reads it.
        expected: String,
    },
    /// The case is another one, or was changed.
    #[error(
        "{}: saved from another case, or the case was changed since; only the end of the run (solver.end) may change: \
         restore the case, or start again with --overwrite",
        path.display()
    )]
    OtherCase {
        /// The file.
        path: PathBuf,
    },
    /// The mesh is another one, or was changed.
    #[error(
        "{}: saved with another mesh, or the mesh was changed since; restore the mesh, \
         or start again with --overwrite",
        path.display()
    )]
    OtherMesh {
        /// The file.
        path: PathBuf,
    },
    /// A part of another state.
    #[error("{}: part of the state of step {found}, which is another one; delete both to continue from an older one", path.display())]
    OtherStep {
        /// The file.
        path: PathBuf,
        /// The step that it is of.
        found: u64,
    },
    /// The bytes are whole but hold another kind of state.
    #[error("{}: holds a state of another layout ({reason}); start again with --overwrite", path.display())]
    OtherLayout {
        /// The file.
        path: PathBuf,
        /// What the deserialiser said.
        reason: String,
    },
    /// The state is larger than the memory.
    #[error("{}: {source}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// How much larger.
        source: TooLarge,
    },
}
