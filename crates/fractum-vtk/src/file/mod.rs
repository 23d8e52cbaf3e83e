//! Unstructured grids of any program, read whole: arrays as text, as base64 or appended, as they are or compressed by zlib.
//!
//! [`Document::read`] takes tags apart and finds the arrays; [`Document::reals`] and [`Document::wholes`] decode one.

mod document;
mod fault;
mod numbers;
mod xml;

pub use document::{Array, Document, Section};
pub use fault::{Fault, Wrong};
