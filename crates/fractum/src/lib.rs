//! The program behind the command line: read a case, run it, leave results.
//!
//! - [`run`]: one case from file to results folder
//! - [`bonded`]: bonded bodies packed, bonded and calibrated, or found in the [`Cache`]
//! - [`plan`]: what a run will do, before it does it
//! - [`report`]: the page of a results folder
//! - [`terminal`]: lines on stdout and stderr
//! - [`verify`]: the gallery against its references

pub mod bonded;
mod cache;
mod choice;
pub mod cracks;
mod error;
mod gallery;
mod input;
mod loose;
pub mod plan;
mod quasi_static;
mod record;
mod record_bonded;
mod region;
pub mod report;
pub mod run;
pub mod terminal;
pub mod verify;

pub use cache::Cache;
pub use error::{ExitCode, Failure};
pub use input::{Input, load};
