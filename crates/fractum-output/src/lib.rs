//! What a run writes and reads again: numbers to compute with, frames to look at, states to go on from.
//!
//! - To compute with: [`history`] (`history.csv`, whose [`columns`] are one list), [`summary`] (`summary.json`), [`verified`]
//!   (`verify.json`), [`expectation`], [`fragments`], [`attenuation`], [`accuracy`]; [`study`] is what several runs say together
//! - To look at: [`frames`] (ParaView), whose [`fields`] are one list, and [`notes`] for the report
//! - While it runs: [`log`] (`run.log` and the progress line), [`checkpoint`] (stop and go on, bit for bit)
//! - For all of them: [`atomic`] (files that are whole or absent), [`number`] (numbers and units as text), [`warning`] (the
//!   list of warnings), [`memory`] (what does not fit is refused), [`error`]
//!
//! What to write and when is the run's business. Equal numbers make equal files, for any number of threads; only what tells of
//! the clock differs.
//!
//! ```
//! use fractum_output::history::{self, Column, History};
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("history.csv");
//! let mut file = History::create(&path, &[Column::new("time", "s"), Column::new("load", "N")])?;
//! file.record(&[0.0, 0.1])?;
//! file.record(&[1e-7, 0.3])?;
//! file.finish()?;
//! assert_eq!(std::fs::read_to_string(&path)?, "time [s],load [N]\n0,0.1\n1e-7,0.3\n");
//! assert_eq!(history::read(&path)?.column("load"), Some((&[0.1, 0.3][..], "N")));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

pub mod accuracy;
pub mod atomic;
pub mod attenuation;
pub mod beside;
pub mod checkpoint;
pub mod columns;
pub mod error;
pub mod expectation;
pub mod fields;
pub mod fragments;
pub mod frames;
pub mod history;
pub mod log;
pub mod memory;
pub mod notes;
pub mod number;
pub mod origin;
pub mod study;
pub mod summary;
pub mod verified;
pub mod warning;

use fractum_vtk::VtkError;

pub use error::{ReadError, WriteError};

use checkpoint::CheckpointError;

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
