//! Abaqus input files, also as CalculiX, Gmsh and others write them: nodes, elements, sets and surfaces.
//!
//! [`deck`] takes lines apart, [`read`] collects what they define, [`sets`] resolves sets, and [`assembly`] makes a
//! [`crate::tagged::raw::Raw`] mesh of it, whose groups are the sets.

mod assembly;
mod deck;
mod element;
mod read;
mod sets;

use crate::Mesh;
use crate::tagged::error::MeshError;
use read::Deck;

/// Reads an Abaqus input file: nodes, elements, sets and surfaces of one part, at most one instance of it.
///
/// - `bytes`: the whole file
///
/// Element sets and surfaces of element faces become groups of elements, node sets groups of points. A name that a set of
/// another kind has already gets `-surface` or `-nodes` behind it. Elements of higher order are read with their corners only;
/// springs, masses and the like are left out. [`Mesh::notices`] tells what was done.
///
/// # Errors
/// With the line, for malformed lines, several parts, moved instances, further files, hexahedra and their like, and everything
/// that [`crate::read_msh`] refuses too.
pub fn read_inp(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let read = || {
        let deck = Deck::read(bytes)?;
        crate::tagged::assemble(assembly::raw(deck, bytes)?, bytes)
    };
    read().map_err(|fault| fault.into_error(bytes, false))
}
