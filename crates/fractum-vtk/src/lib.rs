//! Files for ParaView: VTU (elements), VTP (particles, bonds, facets), both also in pieces (PVTU, PVTP), and PVD (the same over
//! time).
//!
//! Arrays are stored as raw appended data with 64-bit headers, compressed by zlib in blocks. ParaView and
//! PyVista read all of them, meshio the VTU. [`Arrays`] reads them back; [`file`] reads the grids of any program. The crate opens
//! no file: bytes go in and out.
//!
//! ```
//! use fractum_vtk::{CellBlock, CellKind, Compression, Field, UnstructuredGrid};
//! let grid = UnstructuredGrid {
//!     points: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
//!     cells: &[CellBlock { kind: CellKind::Tetrahedron, nodes: &[0, 1, 2, 3] }],
//!     point_data: &[Field::scalar("damage", &[0.0, 0.0, 0.5, 1.0])],
//!     cell_data: &[],
//!     time: Some(1e-4),
//! };
//! let bytes = grid.to_bytes(Compression::Fast)?;
//! assert!(bytes.starts_with(b"<?xml"));
//! # Ok::<(), fractum_vtk::VtkError>(())
//! ```

#![forbid(unsafe_code)]

mod collection;
mod compress;
#[cfg(test)]
mod decode;
mod document;
pub mod file;
mod grid;
mod pending;
mod pieces;
mod poly;
mod read;
pub mod text;
mod unit;

use std::borrow::Cow;

pub use collection::{Collection, Entry};
pub use compress::{Compression, compressor, deflate};
pub use grid::{CellBlock, CellKind, UnstructuredGrid};
pub use pending::PendingFile;
pub use pieces::{Cut, Pieces};
pub use poly::{PolyCells, PolyData};
pub use read::{Arrays, PieceList};

/// Why arrays cannot become a VTK file.
#[derive(Debug, thiserror::Error)]
pub enum VtkError {
    /// An array has another length than what it describes.
    #[error("field `{field}` has {found} values; expected {expected}")]
    WrongLength {
        /// Name of the field.
        field: String,
        /// Values in it.
        found: usize,
        /// Points (or cells) times components.
        expected: usize,
    },
    /// The node list of a block is not a whole number of cells.
    #[error("a block of cells with {nodes_per_cell} nodes each lists {found} nodes")]
    BrokenCells {
        /// Nodes of one cell.
        nodes_per_cell: usize,
        /// Nodes listed.
        found: usize,
    },
    /// A cell names a point that does not exist.
    #[error("a cell names point {point}; there are {points}")]
    NoSuchPoint {
        /// The point named.
        point: u32,
        /// How many there are.
        points: usize,
    },
}

/// The values of a field, component by component and point by point (or cell by cell).
#[derive(Clone, Copy, Debug)]
pub enum Values<'a> {
    /// Double precision.
    F64(&'a [f64]),
    /// Single precision.
    F32(&'a [f32]),
    /// Whole numbers.
    I32(&'a [i32]),
    /// Small whole numbers, flags.
    U8(&'a [u8]),
}

/// A named quantity at points or cells.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Name that ParaView shows.
    pub name: &'a str,
    /// Values per point or cell: 1 scalar, 3 vector, 6 symmetric tensor (ParaView's order xx yy zz xy yz xz), 9 tensor.
    pub components: usize,
    /// The values; as many as points (or cells) times `components`.
    pub values: Values<'a>,
}

impl<'a> Field<'a> {
    /// A scalar in double precision.
    pub fn scalar(name: &'a str, values: &'a [f64]) -> Self {
        Self { name, components: 1, values: Values::F64(values) }
    }

    /// A vector in double precision.
    pub fn vector(name: &'a str, values: &'a [[f64; 3]]) -> Self {
        Self { name, components: 3, values: Values::F64(values.as_flattened()) }
    }

    /// A symmetric tensor, xx yy zz xy yz zx, in double precision.
    pub fn tensor(name: &'a str, values: &'a [[f64; 6]]) -> Self {
        Self { name, components: 6, values: Values::F64(values.as_flattened()) }
    }

    /// A whole number.
    pub fn integer(name: &'a str, values: &'a [i32]) -> Self {
        Self { name, components: 1, values: Values::I32(values) }
    }

    /// A flag or small whole number.
    pub fn flag(name: &'a str, values: &'a [u8]) -> Self {
        Self { name, components: 1, values: Values::U8(values) }
    }

    fn check(&self, count: usize) -> Result<(), VtkError> {
        let found = self.values.len();
        let expected = count * self.components;
        let wrong = found != expected || self.components == 0;
        if wrong { Err(VtkError::WrongLength { field: self.name.into(), found, expected }) } else { Ok(()) }
    }
}

impl<'a> Values<'a> {
    fn len(&self) -> usize {
        match self {
            Self::F64(values) => values.len(),
            Self::F32(values) => values.len(),
            Self::I32(values) => values.len(),
            Self::U8(values) => values.len(),
        }
    }

    fn kind(&self) -> &'static str {
        match self {
            Self::F64(_) => "Float64",
            Self::F32(_) => "Float32",
            Self::I32(_) => "Int32",
            Self::U8(_) => "UInt8",
        }
    }

    fn bytes(&self) -> Cow<'a, [u8]> {
        Cow::Borrowed(match self {
            Self::F64(values) => bytemuck::cast_slice(values),
            Self::F32(values) => bytemuck::cast_slice(values),
            Self::I32(values) => bytemuck::cast_slice(values),
            Self::U8(values) => values,
        })
    }
}

/// Refuses cells that name points beyond `points`.
fn check_points(nodes: &[u32], points: usize) -> Result<(), VtkError> {
    match nodes.iter().find(|&&node| node as usize >= points) {
        Some(&point) => Err(VtkError::NoSuchPoint { point, points }),
        None => Ok(()),
    }
}
