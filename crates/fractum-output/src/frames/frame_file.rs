//! What a population of a frame is written to.

use fractum_vtk::{Compression, Cut, PendingFile, Pieces, PolyData, UnstructuredGrid};
use serde::{Deserialize, Serialize};

use crate::OutputError;

/// One file, or pieces and a file that lists them.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) enum FrameFile {
    Whole(PendingFile),
    Cut(Pieces),
}

impl FrameFile {
    /// Elements, in as many pieces as asked for.
    ///
    /// - `numbers`: those of the points in the whole, where this process has no other elements than those of its piece
    pub(crate) fn of_grid(grid: &UnstructuredGrid, cut: Cut, numbers: &[i32]) -> Result<Self, OutputError> {
        if cut.is_divided {
            return grid.own_piece(cut, numbers, Compression::Fast).map(FrameFile::Cut).map_err(OutputError::from);
        }
        let whole = || grid.pending(Compression::Fast).map(FrameFile::Whole);
        let pieces = || grid.pieces(cut, Compression::Fast).map(FrameFile::Cut);
        if cut.count > 1 { pieces() } else { whole() }.map_err(OutputError::from)
    }

    /// Points, in as many pieces as asked for.
    pub(crate) fn of_points(points: &PolyData, cut: Cut) -> Result<Self, OutputError> {
        let whole = || points.pending(Compression::Fast).map(FrameFile::Whole);
        let pieces = || points.pieces(cut, Compression::Fast).map(FrameFile::Cut);
        if cut.count > 1 { pieces() } else { whole() }.map_err(OutputError::from)
    }
}
