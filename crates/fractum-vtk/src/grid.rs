//! VTU: elements of a body with what is known at their nodes and in them.

use std::borrow::Cow;

use super::document::Document;
use super::pending::PendingFile;
use super::{Compression, Field, VtkError, check_points};

/// Shape of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// A point.
    Vertex,
    /// A line between two nodes.
    Line,
    /// T3.
    Triangle,
    /// T4.
    Tetrahedron,
}

impl CellKind {
    /// Nodes of one cell.
    pub fn nodes(self) -> usize {
        match self {
            Self::Vertex => 1,
            Self::Line => 2,
            Self::Triangle => 3,
            Self::Tetrahedron => 4,
        }
    }

    fn vtk_number(self) -> u8 {
        match self {
            Self::Vertex => 1,
            Self::Line => 3,
            Self::Triangle => 5,
            Self::Tetrahedron => 10,
        }
    }
}

/// Cells of one kind.
#[derive(Clone, Copy, Debug)]
pub struct CellBlock<'a> {
    /// Their shape.
    pub kind: CellKind,
    /// Nodes of the first cell, of the second, ...
    pub nodes: &'a [u32],
}

/// What goes into one VTU.
#[derive(Clone, Copy, Debug)]
pub struct UnstructuredGrid<'a> {
    /// Positions [m].
    pub points: &'a [[f64; 3]],
    /// Cells, block after block; `cell_data` is in the same order.
    pub cells: &'a [CellBlock<'a>],
    /// Fields at the points.
    pub point_data: &'a [Field<'a>],
    /// Fields in the cells.
    pub cell_data: &'a [Field<'a>],
    /// Simulated time [s], shown by ParaView.
    pub time: Option<f64>,
}

impl UnstructuredGrid<'_> {
    /// The file's bytes.
    ///
    /// # Errors
    /// [`VtkError`] where lengths do not fit together or a cell names a point that does not exist.
    pub fn to_bytes(&self, compression: Compression) -> Result<Vec<u8>, VtkError> {
        Ok(self.document()?.to_bytes(compression))
    }

    /// The file, to be written later; all of its content is of now.
    ///
    /// # Errors
    /// As [`to_bytes`](Self::to_bytes).
    pub fn pending(&self, compression: Compression) -> Result<PendingFile, VtkError> {
        Ok(PendingFile::of_document(self.document()?, compression))
    }

    fn document(&self) -> Result<Document<'_>, VtkError> {
        let Self { points, cells, point_data, cell_data, time } = *self;
        let mut count = 0;
        for CellBlock { kind, nodes } in cells {
            let nodes_per_cell = kind.nodes();
            if nodes.len() % nodes_per_cell != 0 {
                return Err(VtkError::BrokenCells { nodes_per_cell, found: nodes.len() });
            }
            check_points(nodes, points.len())?;
            count += nodes.len() / nodes_per_cell;
        }
        point_data.iter().try_for_each(|field| field.check(points.len()))?;
        cell_data.iter().try_for_each(|field| field.check(count))?;

        let mut document = Document::new("UnstructuredGrid", time);
        let points_count = points.len();
        document.text(&format!("    <Piece NumberOfPoints=\"{points_count}\" NumberOfCells=\"{count}\">\n"));
        document.points(points);
        document.text("      <Cells>\n");
        let kinds =
            || cells.iter().flat_map(|block| std::iter::repeat_n(block.kind, block.nodes.len() / block.kind.nodes()));
        let nodes: Vec<u32> = cells.iter().flat_map(|block| block.nodes).copied().collect();
        let mut end = 0;
        document.cells(
            &nodes,
            kinds().map(|kind| {
                end += kind.nodes();
                end
            }),
        );
        document.array("UInt8", "types", 1, Cow::Owned(kinds().map(CellKind::vtk_number).collect()));
        document.text("      </Cells>\n");
        document.fields("PointData", point_data);
        document.fields("CellData", cell_data);
        document.text("    </Piece>\n");
        Ok(document)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Values;
    use super::super::decode::decode;
    use super::*;
    use proptest::prelude::*;

    const POINTS: [[f64; 3]; 5] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 1.0]];

    fn cells() -> [CellBlock<'static>; 3] {
        [
            CellBlock { kind: CellKind::Tetrahedron, nodes: &[0, 1, 2, 3, 1, 2, 3, 4] },
            CellBlock { kind: CellKind::Triangle, nodes: &[0, 1, 2] },
            CellBlock { kind: CellKind::Line, nodes: &[3, 4] },
        ]
    }

    #[test]
    fn cells_points_and_fields_come_back() {
        for compression in [Compression::None, Compression::Fast] {
            let velocity = [[1.0, -2.0, 0.5]; 5];
            let grid = UnstructuredGrid {
                points: &POINTS,
                cells: &cells(),
                point_data: &[Field::vector("velocity", &velocity)],
                cell_data: &[
                    Field::integer("group", &[1, 1, 2, -3]),
                    Field::flag("broken <&\"edge\">", &[0, 1, 0, 1]),
                    Field { name: "damage", components: 1, values: Values::F32(&[0.0, 0.25, f32::NAN, 1.0]) },
                ],
                time: Some(0.125),
            };
            let bytes = grid.to_bytes(compression).unwrap();
            let file = decode(&bytes);
            assert_eq!(file.sizes(), [5, 4]);
            assert_eq!(file.f64("TimeValue"), [0.125]);
            assert_eq!(file.f64("Points"), POINTS.as_flattened());
            assert_eq!(file.i32("connectivity"), [0, 1, 2, 3, 1, 2, 3, 4, 0, 1, 2, 3, 4]);
            assert_eq!(file.i32("offsets"), [4, 8, 11, 13]);
            assert_eq!(file.bytes("types"), [10, 10, 5, 3]);
            assert_eq!(file.f64("velocity"), velocity.as_flattened());
            assert_eq!(file.i32("group"), [1, 1, 2, -3]);
            assert_eq!(file.bytes("broken <&\"edge\">"), [0, 1, 0, 1]);
            assert_eq!(file.components("velocity"), 3);
            assert_eq!(file.bytes("damage")[4..8], 0.25f32.to_ne_bytes());
        }
    }

    /// The header of compressed arrays is where writers go wrong: no block, whole blocks only, one byte more.
    #[test]
    fn any_length_around_whole_blocks_comes_back() {
        use super::super::document::BLOCK;
        for count in [0, 1, BLOCK - 1, BLOCK, BLOCK + 1, 2 * BLOCK, 3 * BLOCK + 7] {
            let points = vec![[0.5, 1.5, 2.5]; count];
            let values: Vec<u8> = (0..count).map(|i| (i * i % 251) as u8).collect();
            for compression in [Compression::None, Compression::Fast] {
                let point_data = [Field::flag("value", &values)];
                let grid = UnstructuredGrid {
                    points: &points,
                    cells: &[],
                    point_data: &point_data,
                    cell_data: &[],
                    time: None,
                };
                let bytes = grid.to_bytes(compression).unwrap();
                let file = decode(&bytes);
                if count == 0 {
                    assert!(!file.has("value"), "an empty piece has no arrays to read");
                    continue;
                }
                assert_eq!(file.bytes("value"), values);
                assert_eq!(file.f64("Points").len(), 3 * count);
                assert_eq!(file.bytes("connectivity").len(), 0);
            }
        }
    }

    proptest! {
        #[test]
        fn any_bits_come_back(bits in proptest::collection::vec(any::<u64>(), 1..400)) {
            let values: Vec<f64> = bits.iter().map(|&bits| f64::from_bits(bits)).collect();
            let points = vec![[0.0; 3]; values.len()];
            let point_data = [Field::scalar("value", &values)];
            let grid = UnstructuredGrid { points: &points, cells: &[], point_data: &point_data, cell_data: &[], time: None };
            let file = grid.to_bytes(Compression::Fast).unwrap();
            let expected: Vec<u8> = bits.iter().flat_map(|bits| bits.to_ne_bytes()).collect();
            prop_assert_eq!(decode(&file).bytes("value"), expected);
        }
    }

    #[test]
    fn arrays_that_do_not_fit_are_refused() {
        let grid = UnstructuredGrid { points: &POINTS, cells: &cells(), point_data: &[], cell_data: &[], time: None };
        let error = |grid: UnstructuredGrid| grid.to_bytes(Compression::Fast).unwrap_err();
        let point_data = [Field::scalar("short", &[0.0; 4])];
        let wrong = error(UnstructuredGrid { point_data: &point_data, ..grid });
        assert!(matches!(wrong, VtkError::WrongLength { found: 4, expected: 5, .. }), "{wrong}");
        let cell_data = [Field::scalar("long", &[0.0; 5])];
        let wrong = error(UnstructuredGrid { cell_data: &cell_data, ..grid });
        assert!(matches!(wrong, VtkError::WrongLength { found: 5, expected: 4, .. }), "{wrong}");
        let torn = [CellBlock { kind: CellKind::Tetrahedron, nodes: &[0, 1, 2] }];
        assert!(matches!(error(UnstructuredGrid { cells: &torn, ..grid }), VtkError::BrokenCells { found: 3, .. }));
        let beyond = [CellBlock { kind: CellKind::Line, nodes: &[0, 5] }];
        assert!(matches!(
            error(UnstructuredGrid { cells: &beyond, ..grid }),
            VtkError::NoSuchPoint { point: 5, points: 5 }
        ));
    }
}
