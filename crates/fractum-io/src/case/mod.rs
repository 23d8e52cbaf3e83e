//! The case file: TOML with units in, a typed and checked [`Case`] out.

mod choice;
mod diagnostic;
pub mod expression;
mod hash;
pub mod model;
mod place;
mod time_function;

pub use choice::Choice;
pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use model::Case;
pub use place::{Place, Spanned};
pub use time_function::{Field, TimeFunction};
