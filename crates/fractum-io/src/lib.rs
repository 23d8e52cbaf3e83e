//! What goes into fractum and what comes out of it: cases, results, checkpoints and reports.
//!
//! Four rooms:
//! - [`case`] reads and checks a case file
//! - [`build`] makes the scene of a case on its mesh
//! - `output` writes results. To compute with: [`history`] (`history.csv`), [`summary`] (`summary.json`), [`verified`] (`verify.json`),
//!   [`expectation`], [`fragments`]; to look at: [`vtk`] (ParaView), [`picture`] (PNG), [`plot`] (SVG), [`report`]
//!   (`report.html`); while it runs: [`log`] (`run.log` and the progress line)
//! - [`study`] says what a study runs, and what its runs say together
//!
//! Beside them: [`checkpoint`] (stop and go on, bit for bit), [`atomic`] (files that are whole or absent), [`number`]
//! (numbers and units as text), [`warning`] (the list of warnings), [`memory`] (what does not fit is refused), [`error`].
//!
//! ```
//! use fractum_io::history::{self, Column, History};
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

pub mod atomic;
pub mod build;
pub mod case;
pub mod checkpoint;
mod compress;
pub mod error;
pub mod memory;
pub mod number;
mod output;
pub mod study;
pub mod warning;

pub use compress::Compression;
pub use error::{ReadError, WriteError};
pub use output::{
    OutputError, attenuation, beside, expectation, fragments, history, log, origin, picture, plot, report, summary,
    verified, vtk,
};
