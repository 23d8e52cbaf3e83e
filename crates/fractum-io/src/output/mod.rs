//! What a run writes: numbers to compute with, fields and pictures to look at, and what it tells while it goes.
//!
//! These modules know no simulation: they take slices and small structs, so that any part of the program, or another
//! program, can write results. What to write and when is the run's business. Equal numbers make equal files, for any
//! number of threads; only what tells of the clock differs.

pub mod attenuation;
pub mod beside;
pub mod expectation;
pub mod fragments;
pub mod history;
pub mod log;
pub(crate) mod markup;
pub mod origin;
pub mod picture;
pub mod plot;
pub mod report;
pub mod summary;
pub mod verified;
pub mod vtk;

use crate::checkpoint::CheckpointError;
use crate::error::{ReadError, WriteError};
use vtk::VtkError;

/// Any error of the output modules.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// A file or folder could not be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A result could not be read back.
    #[error(transparent)]
    Read(#[from] ReadError),
    /// A checkpoint could not be saved or loaded.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// Arrays for ParaView do not fit together, or could not be written.
    #[error(transparent)]
    Vtk(#[from] VtkError),
}
