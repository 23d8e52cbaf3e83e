//! The program behind the command line: read a case, run it, leave results.
//!
//! - [`run`]: one case from file to results folder
//! - [`plan`]: what a run will do, before it does it
//! - [`report`]: the page of a results folder
//! - [`terminal`]: lines on stdout and stderr
//! - [`verify`]: the gallery against its references

pub mod cracks;
mod error;
mod gallery;
mod input;
pub mod plan;
mod quasi_static;
mod record;
mod record_bonded;
pub mod report;
pub mod run;
pub mod terminal;
pub mod verify;

pub use error::{ExitCode, Failure};
pub use input::{Input, load};
