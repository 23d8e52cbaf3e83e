//! Unstructured grids of VTK (`.vtu`), as ParaView, PyVista, meshio and fractum write them.
//!
//! [`xml`] takes tags apart, [`document`] finds the arrays, [`numbers`] decodes them, and [`grid`] makes a
//! [`crate::tagged::raw::Raw`] mesh of them, whose groups are arrays of zeros and ones.

mod document;
mod grid;
mod numbers;
mod xml;

use crate::Mesh;
use crate::tagged::error::MeshError;
use document::Document;

/// Reads an unstructured grid of VTK: arrays as text, as base64 or appended, as they are or compressed by zlib.
///
/// - `bytes`: the whole file
///
/// An array of whole numbers that are all 0 or 1 is a group of what has 1: of elements on cells, of points on points. Ours
/// have the dimension behind the name, as in `left (2d)`; the group is called `left`. In files without these, cell
/// arrays `gmsh:physical`, `medit:ref` or `CellEntityIds` make groups `physical-1` and so on. Cells of higher order are
/// read with their corners only. Nodes and elements are numbered from 1 in the order of the file.
/// [`Mesh::notices`] tells what was done.
///
/// # Errors
/// With the line, for malformed files, other kinds of VTK files, several pieces, other compressors, cells without a fixed
/// shape, and everything that [`crate::read_msh`] refuses too.
pub fn read_vtu(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let read = || {
        let document = Document::read(bytes)?;
        crate::tagged::assemble(grid::raw(&document, bytes)?, bytes)
    };
    read().map_err(|fault| fault.into_error(bytes, false))
}
