//! Expressions of the case file: text in, a checked flat program out.

mod program;

pub use program::Program;
pub(crate) use program::{Binary, Op, Unary};
