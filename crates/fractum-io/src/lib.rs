//! What goes into fractum and what comes out of it: results, checkpoints and reports.
//!
//! Output modules know no simulation: they take slices and small structs, and write files that are whole or absent
//! ([`atomic`]).

pub mod assemble;
pub mod atomic;
pub mod case;
pub mod checkpoint;
mod compress;
pub mod error;
pub mod fragments;
pub mod history;
pub mod log;
mod markup;
pub mod number;
pub mod picture;
pub mod plot;
pub mod report;
pub mod summary;
pub mod vtk;

pub use compress::Compression;
pub use error::{OutputError, ReadError, WriteError};
