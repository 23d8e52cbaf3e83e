//! Studies: many runs of one case or of several.
//!
//! - [`plan`] says what to run: the product of varied keys, from the command line or from a study file, or a list
//! - [`list`] reads a list of runs
//! - [`quantity`] is what runs are compared by beside their references

pub mod list;
pub mod plan;
pub mod quantity;
