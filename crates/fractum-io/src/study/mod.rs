//! Studies: many runs of one case or of several, and what they say together about run time and error.
//!
//! - [`list`] is a table of runs for programs that start them
//! - [`plan`] says what to run: the product of varied keys, from the command line or from a study file
//! - [`run`] is what came of it, run by run
//! - [`compare`] finds orders of convergence, scatter over seeds, and the cheapest setting within an error
//! - [`table`] writes all that as text, CSV and JSON, [`page`] as `study.html` and `study.svg`

pub mod compare;
pub mod list;
pub mod page;
pub mod plan;
pub mod run;
pub mod table;
