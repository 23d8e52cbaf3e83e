//! Unstructured grids of VTK (`.vtu`), as ParaView, PyVista, meshio and fractum write them.
//!
//! `fractum-vtk` finds the arrays and decodes them, and [`grid`] makes a [`crate::tagged::raw::Raw`] mesh of them, whose
//! groups are arrays of zeros and ones.

mod grid;

use fractum_vtk::file::{Document, Fault as VtkFault, Wrong};

use crate::Mesh;
use crate::tagged::error::{Fault, MeshError, Problem};

/// Reads an unstructured grid of VTK: arrays as text, as base64 or appended, as they are or compressed by zlib.
///
/// - `bytes`: the whole file
///
/// An array of whole numbers that are all 0 or 1 is a group of what has 1: of elements on cells, of points on points. Ours
/// have the dimension behind the name, as in `left (2d)`; the group is called `left`. In files without these, cell
/// arrays that number parts, such as `gmsh:physical`, `medit:ref`, `nastran:ref` or `CellEntityIds`, make groups `physical-1` and so on. Cells of higher order are
/// read with their corners only. Nodes and elements are numbered from 1 in the order of the file.
/// [`Mesh::notices`] tells what was done.
///
/// # Errors
/// With the line, for malformed files, other kinds of VTK files, several pieces, other compressors, cells without a fixed
/// shape, and everything that [`crate::read_msh`] refuses too.
pub fn read_vtu(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let read = || {
        let document = Document::read(bytes, &["UnstructuredGrid"])?;
        crate::tagged::assemble(grid::raw(&document, bytes)?, bytes)
    };
    read().map_err(|fault| fault.into_error(bytes, false))
}

impl From<VtkFault> for Fault {
    fn from(fault: VtkFault) -> Self {
        let problem = match fault.wrong {
            Wrong::Empty => Problem::Empty,
            Wrong::Foreign { found, hint } => Problem::NotGmsh { found, hint },
            Wrong::Unexpected { found, expected } => Problem::Unexpected { found, expected },
            Wrong::Truncated(expected) => Problem::Truncated { expected },
            Wrong::Unsupported(message) => Problem::Unsupported(message),
            Wrong::Inconsistent(message) => Problem::Inconsistent(message),
        };
        Fault { at: fault.at, problem }
    }
}
