//! Abaqus input files, also as CalculiX, Gmsh and others write them: nodes, elements, sets and surfaces.
//!
//! [`deck`] takes lines apart, [`read`] collects what they define, [`sets`] resolves sets, and [`assembly`] makes a
//! [`crate::tagged::raw::Raw`] mesh of it, whose groups are the sets.

mod assembly;
mod deck;
mod element;
mod read;
mod sets;

pub use read::read_inp;
