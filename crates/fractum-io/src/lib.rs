//! Case files, results, checkpoints and reports.

pub mod case;
