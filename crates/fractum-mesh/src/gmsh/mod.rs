//! The Gmsh mesh format: MSH 2.2 and 4.1, ASCII and binary.
//!
//! [`v2`] and [`v4`] turn sections into a [`crate::tagged::raw::Raw`] mesh.

mod binary;
mod entities;
mod names;
mod partitions;
mod read;
mod sink;
mod v2;
mod v4;
mod write;

pub use partitions::partitions;
pub use read::read_msh;
pub use write::{MshFormat, write_msh};
