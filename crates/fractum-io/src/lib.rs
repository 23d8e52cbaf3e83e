//! What goes into fractum and what comes out of it: cases, results, checkpoints and reports.
//!
//! - in: [`case`] reads and checks a case file
//! - to compute with: [`history`] (`history.csv`), [`summary`] (`summary.json`, `verify.json`), [`expectation`], [`fragments`]
//! - to look at: [`vtk`] (ParaView), [`picture`] (PNG), [`plot`] (SVG), [`report`] (`report.html`)
//! - while it runs: [`log`] (`run.log` and the progress line), [`checkpoint`] (stop and go on, bit for bit)
//! - beneath: [`atomic`] (files that are whole or absent), [`number`] (numbers and units as text), [`error`]
//!
//! The output modules know no simulation: they take slices and small structs, so that any part of the program, or
//! another program, can write results. They leave out what to write and when; that is the run's business. Equal numbers
//! make equal files, for any number of threads; only what tells of the clock differs.
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

pub mod assemble;
pub mod atomic;
pub mod case;
pub mod checkpoint;
mod compress;
pub mod error;
pub mod expectation;
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
