//! Studies: many runs of one case or of several.
//!
//! - [`list`] is a table of runs for programs that start them
//! - [`plan`] says what to run: the product of varied keys, from the command line or from a study file

pub mod list;
pub mod plan;
