//! Abaqus input files, also as CalculiX, Gmsh and others write them: nodes, elements, sets and surfaces.
//!
//! [`include`] puts further files in their places, [`deck`] takes lines apart, [`read`] collects what they define, [`instance`] places parts, [`sets`] resolves sets, and [`assembly`] makes a
//! [`crate::tagged::raw::Raw`] mesh of it, whose groups are the sets.

mod assembly;
mod deck;
mod element;
mod include;
mod instance;
mod read;
mod sets;

use crate::Mesh;
use crate::tagged::error::MeshError;
pub use include::Gathered;
use read::Deck;

/// Reads an Abaqus input file: nodes, elements, sets and surfaces of all instances of its parts, or of a file without parts.
///
/// - `bytes`: the whole file
///
/// Element sets and surfaces of element faces become groups of elements, node sets groups of points. A name that a set of
/// another kind has already gets `-surface` or `-nodes` behind it, one that sets of several instances have that of the instance and a
/// point before it. Where there are several instances, each is a group. Elements of higher order are read with their corners only;
/// springs, masses and the like are left out. [`Mesh::notices`] tells what was done. Files that this one names must be in it: [`Gathered`].
///
/// # Errors
/// With the line, for malformed lines, nodes and elements that are made by rules, and everything
/// that [`crate::read_msh`] refuses too.
pub fn read_inp(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let read = || {
        let deck = Deck::read(bytes)?;
        crate::tagged::assemble(assembly::raw(deck, bytes)?, bytes)
    };
    read().map_err(|fault| fault.into_error(bytes, false))
}
