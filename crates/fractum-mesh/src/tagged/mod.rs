//! Meshes as files tell them: in tags, with the place of each record, before anything is cross-checked.
//!
//! The readers of formats make a [`raw::Raw`]; [`assemble()`] checks it against itself and turns tags into indices.

mod assemble;
pub(crate) mod builder;
pub(crate) mod cursor;
pub(crate) mod element_type;
pub(crate) mod error;
mod groups;
pub(crate) mod raw;
mod shape_check;
mod split;
mod table;
mod tags;

pub(crate) use assemble::assemble;
pub use error::{MeshError, Place, Problem};
