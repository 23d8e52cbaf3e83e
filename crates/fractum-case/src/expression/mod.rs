//! Expressions of the case file: text in, a checked flat program out.
//!
//! A number followed by a unit is one quantity (`100 MPa*exp(-t/5 ms)` divides t by 5 ms), and every operation is
//! checked for its dimensions. A number without a unit takes the dimension of what it is added to or compared with, SI
//! then being meant; in a product it is a pure number.

mod compile;
mod lexer;
mod program;
mod rules;
mod types;
mod units;

pub(crate) use compile::{Compiled, compile, functions};
#[cfg(test)]
pub(crate) use program::Unary;
pub(crate) use program::{Op, Program};
pub(crate) use types::{Named, Names, NoNames, Type};
pub(crate) use units::parse_unit;

/// What is wrong in an expression.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ExpressionError {
    /// Byte offset into the text.
    pub(crate) offset: usize,
    /// What is wrong.
    pub(crate) message: String,
    /// What to do; may be empty.
    pub(crate) remedy: String,
}

impl ExpressionError {
    pub(crate) fn new(offset: usize, message: impl Into<String>) -> Self {
        Self { offset, message: message.into(), remedy: String::new() }
    }

    pub(crate) fn remedy(mut self, remedy: impl Into<String>) -> Self {
        self.remedy = remedy.into();
        self
    }
}
