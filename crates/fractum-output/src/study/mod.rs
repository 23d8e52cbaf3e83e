//! What many runs of one case or of several say together: one column per varied key, run time beside error.
//!
//! - [`run`] is what came of a study, run by run
//! - [`list`] is the list of runs, and the same lines with every number of the summaries
//! - [`compare`] finds orders of convergence, scatter over seeds, and the cheapest setting within an error
//! - [`table`] writes all that as text, CSV and JSON

pub mod compare;
pub mod list;
pub mod run;
pub mod table;
