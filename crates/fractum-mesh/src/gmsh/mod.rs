//! The Gmsh mesh format: MSH 2.2 and 4.1, ASCII and binary.
//!
//! Reading has two halves: [`v2`] and [`v4`] turn sections into a [`raw::Raw`] mesh that still speaks in the file's
//! tags and knows where each record lies; [`assemble`] turns that into a checked [`crate::Mesh`].

mod assemble;
mod binary;
mod cursor;
mod element_type;
mod entities;
mod error;
mod groups;
mod names;
mod raw;
mod read;
mod shape_check;
mod sink;
mod table;
mod tags;
mod v2;
mod v4;
mod write;

pub use error::{MeshError, Place, Problem};
pub use read::read_msh;
pub use write::{MshFormat, write_msh};
