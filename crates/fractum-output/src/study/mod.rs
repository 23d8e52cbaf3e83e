//! What many runs of one case or of several say together about run time and error.
//!
//! - [`run`] is what came of a study, run by run
//! - [`compare`] finds orders of convergence, scatter over seeds, and the cheapest setting within an error
//! - [`table`] writes all that as text, CSV and JSON

pub mod compare;
pub mod run;
pub mod table;
