//! Grids and polygons of any program: arrays as text, as base64 or appended, as they are or compressed by zlib.
//!
//! [`Document::read`] takes tags apart and finds the arrays; [`Document::reals`], [`Document::wholes`] and
//! [`Document::numbers`] decode one.

mod document;
mod fault;
mod numbers;
mod xml;

pub use document::{Array, Document, Section};
pub use fault::{Fault, Wrong};
pub(crate) use xml::tags;
