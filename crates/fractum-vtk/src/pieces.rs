//! Grids and clouds of points cut into pieces: files that several processes write side by side, and one that lists them for
//! ParaView.
//!
//! A piece has a run of the cells, the points that they touch, and the number of each point in the whole. A point that no cell
//! touches is in one of the pieces, so that together they are the whole ([`Arrays`](super::Arrays) puts them together).

use std::fmt::Write;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::document::{BYTE_ORDER, described};
use super::pending::PendingFile;
use super::{CellBlock, Compression, Field, PolyCells, PolyData, UnstructuredGrid, Values, VtkError};
use crate::text::escape;

/// The numbers of the points of a piece in the whole, by the name under which ParaView knows them.
pub(super) const NUMBERS: &str = "GlobalNodeId";

/// Into how many pieces something is cut, and which of them are wanted: `first`, `first + step`, ...
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Number of pieces, from 1.
    pub count: usize,
    /// First piece that is wanted.
    pub first: usize,
    /// Distance to the next one, from 1.
    pub step: usize,
    /// Who wants the first piece has nothing of others, see [`UnstructuredGrid::own_piece`].
    pub is_divided: bool,
}

impl Cut {
    /// One piece.
    pub const WHOLE: Cut = Cut { count: 1, first: 0, step: 1, is_divided: false };

    /// Whether the first piece is wanted: by the process that also writes what is not cut.
    pub fn is_leading(self) -> bool {
        self.first == 0
    }

    fn wanted(self) -> impl Iterator<Item = usize> {
        (self.first..self.count).step_by(self.step)
    }
}

/// Things `0..count` of piece `piece` of `pieces`.
fn run(count: usize, piece: usize, pieces: usize) -> Range<usize> {
    count * piece / pieces..count * (piece + 1) / pieces
}

/// The pieces that were wanted, and the file that lists all of them, neither written yet.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Pieces {
    /// Number and file of each.
    pub files: Vec<(usize, PendingFile)>,
    kind: String,
    ending: String,
    /// Arrays that the pieces have.
    arrays: String,
    count: usize,
}

impl Pieces {
    /// The file that lists the pieces.
    ///
    /// - `stem`: what their names begin with, see [`Pieces::name`]
    pub fn index(&self, stem: &str) -> PendingFile {
        let Pieces { kind, arrays, count, .. } = self;
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"P{kind}\" version=\"1.0\" byte_order=\"{BYTE_ORDER}\" header_type=\"UInt64\">\n  \
             <P{kind} GhostLevel=\"0\">\n{arrays}"
        );
        for piece in 0..*count {
            // Writing to a String cannot fail.
            let _ = writeln!(text, "    <Piece Source=\"{}\"/>", escape(&self.name(stem, piece)));
        }
        let _ = write!(text, "  </P{kind}>\n</VTKFile>\n");
        PendingFile::of_text(text)
    }

    /// File name of a piece: `solid-00012` and 3 make `solid-00012-0003.vtu`.
    pub fn name(&self, stem: &str, piece: usize) -> String {
        format!("{stem}-{piece:04}.{}", self.ending)
    }
}

/// The lines that declare arrays in a file that lists pieces.
fn declared(points: &[Field], cells: &[Field]) -> String {
    let line = |field: &Field| {
        format!("      <PDataArray {}/>\n", described(field.values.kind(), field.name, field.components))
    };
    let section = |name: &str, fields: &[Field]| {
        let lines: String = fields.iter().map(line).collect();
        format!("    <{name}>\n{lines}    </{name}>\n")
    };
    let place = Field { name: "Points", components: 3, values: Values::F64(&[]) };
    section("PPoints", &[place]) + &section("PPointData", points) + &section("PCellData", cells)
}

impl UnstructuredGrid<'_> {
    /// The wanted pieces of this grid, to be written later.
    ///
    /// # Errors
    /// As [`to_bytes`](Self::to_bytes).
    pub fn pieces(&self, cut: Cut, compression: Compression) -> Result<Pieces, VtkError> {
        let Self { points, cells, point_data, cell_data, time } = *self;
        let cell_count: usize = cells.iter().map(|block| block.nodes.len() / block.kind.nodes()).sum();
        let mut is_touched = vec![false; points.len()];
        for &node in cells.iter().flat_map(|block| block.nodes) {
            let point = is_touched.get_mut(node as usize);
            *point.ok_or(VtkError::NoSuchPoint { point: node, points: points.len() })? = true;
        }
        let mut place = vec![u32::MAX; points.len()];
        let mut files = Vec::new();
        for piece in cut.wanted() {
            let range = run(cell_count, piece, cut.count);
            let own = blocks_of(cells, &range);
            let mut numbers: Vec<u32> = own.iter().flat_map(|block| block.nodes).copied().collect();
            let alone = run(points.len(), piece, cut.count).filter(|&point| !is_touched[point]);
            numbers.extend(alone.map(|point| point as u32));
            numbers.sort_unstable();
            numbers.dedup();
            (0..).zip(&numbers).for_each(|(local, &point)| place[point as usize] = local);
            let local = |block: &CellBlock| block.nodes.iter().map(|&node| place[node as usize]).collect();
            let nodes: Vec<Vec<u32>> = own.iter().map(local).collect();
            let own: Vec<CellBlock> =
                own.iter().zip(&nodes).map(|(block, nodes)| CellBlock { kind: block.kind, nodes }).collect();
            let some = Rows::of(points, point_data, &numbers)?;
            let cell_data = cell_data.iter().map(|field| field.rows(range.clone())).collect::<Result<Vec<_>, _>>()?;
            let grid = UnstructuredGrid {
                points: &some.points,
                cells: &own,
                point_data: &some.fields(point_data),
                cell_data: &cell_data,
                time,
            };
            files.push((piece, grid.pending(compression)?));
        }
        let arrays = declared(&with_numbers(point_data), cell_data);
        Ok(Pieces { files, kind: "UnstructuredGrid".into(), ending: "vtu".into(), arrays, count: cut.count })
    }

    /// This grid as the first wanted piece of a larger one.
    ///
    /// - `numbers`: of its points in the larger one
    ///
    /// # Errors
    /// As [`to_bytes`](Self::to_bytes).
    pub fn own_piece(&self, cut: Cut, numbers: &[i32], compression: Compression) -> Result<Pieces, VtkError> {
        let Self { point_data, cell_data, .. } = *self;
        let with_own: Vec<Field> = point_data.iter().copied().chain([Field::integer(NUMBERS, numbers)]).collect();
        let files = vec![(cut.first, UnstructuredGrid { point_data: &with_own, ..*self }.pending(compression)?)];
        let arrays = declared(&with_own, cell_data);
        Ok(Pieces { files, kind: "UnstructuredGrid".into(), ending: "vtu".into(), arrays, count: cut.count })
    }
}

impl PolyData<'_> {
    /// The wanted pieces of a cloud of points, to be written later; other cells than points are left out.
    ///
    /// # Errors
    /// As [`to_bytes`](Self::to_bytes).
    pub fn pieces(&self, cut: Cut, compression: Compression) -> Result<Pieces, VtkError> {
        let Self { points, point_data, time, .. } = *self;
        let mut files = Vec::new();
        for piece in cut.wanted() {
            let numbers: Vec<u32> = run(points.len(), piece, cut.count).map(|point| point as u32).collect();
            let some = Rows::of(points, point_data, &numbers)?;
            let data = PolyData {
                points: &some.points,
                cells: PolyCells::Points,
                point_data: &some.fields(point_data),
                cell_data: &[],
                time,
            };
            files.push((piece, data.pending(compression)?));
        }
        let arrays = declared(&with_numbers(point_data), &[]);
        Ok(Pieces { files, kind: "PolyData".into(), ending: "vtp".into(), arrays, count: cut.count })
    }
}

fn with_numbers<'a>(fields: &[Field<'a>]) -> Vec<Field<'a>> {
    fields.iter().copied().chain([Field::integer(NUMBERS, &[])]).collect()
}

/// The parts of blocks that hold cells of a range, counted over all blocks.
fn blocks_of<'a>(cells: &[CellBlock<'a>], range: &Range<usize>) -> Vec<CellBlock<'a>> {
    let mut begin = 0;
    let of = |block: &CellBlock<'a>| {
        let (size, first) = (block.kind.nodes(), begin);
        let count = block.nodes.len() / size;
        begin += count;
        let [from, to] = [range.start, range.end].map(|cell| cell.clamp(first, first + count) - first);
        CellBlock { kind: block.kind, nodes: &block.nodes[size * from..size * to] }
    };
    cells.iter().map(of).filter(|block| !block.nodes.is_empty()).collect()
}

/// Some of the points, with their fields.
struct Rows {
    points: Vec<[f64; 3]>,
    fields: Vec<Numbers>,
    numbers: Vec<i32>,
}

enum Numbers {
    F64(Vec<f64>),
    F32(Vec<f32>),
    I32(Vec<i32>),
    U8(Vec<u8>),
}

impl Rows {
    fn of(points: &[[f64; 3]], fields: &[Field], numbers: &[u32]) -> Result<Self, VtkError> {
        fields.iter().try_for_each(|field| field.check(points.len()))?;
        Ok(Rows {
            points: numbers.iter().map(|&point| points[point as usize]).collect(),
            fields: fields.iter().map(|field| Numbers::of(field, numbers)).collect(),
            numbers: numbers.iter().map(|&point| point as i32).collect(),
        })
    }

    /// - `whole`: the fields of all points
    fn fields<'a>(&'a self, whole: &[Field<'a>]) -> Vec<Field<'a>> {
        let own = whole.iter().zip(&self.fields).map(|(field, rows)| Field { values: rows.values(), ..*field });
        own.chain([Field::integer(NUMBERS, &self.numbers)]).collect()
    }
}

impl Numbers {
    fn of(field: &Field, rows: &[u32]) -> Self {
        fn some<T: Copy>(values: &[T], components: usize, rows: &[u32]) -> Vec<T> {
            let row = |&row: &u32| &values[components * row as usize..components * (row as usize + 1)];
            rows.iter().flat_map(row).copied().collect()
        }
        let components = field.components;
        match field.values {
            Values::F64(values) => Numbers::F64(some(values, components, rows)),
            Values::F32(values) => Numbers::F32(some(values, components, rows)),
            Values::I32(values) => Numbers::I32(some(values, components, rows)),
            Values::U8(values) => Numbers::U8(some(values, components, rows)),
        }
    }

    fn values(&self) -> Values<'_> {
        match self {
            Numbers::F64(values) => Values::F64(values),
            Numbers::F32(values) => Values::F32(values),
            Numbers::I32(values) => Values::I32(values),
            Numbers::U8(values) => Values::U8(values),
        }
    }
}

impl<'a> Field<'a> {
    /// The same of a range of its points or cells.
    fn rows(&self, range: Range<usize>) -> Result<Field<'a>, VtkError> {
        let entries = self.components * range.start..self.components * range.end;
        let values = match self.values {
            Values::F64(values) => values.get(entries).map(Values::F64),
            Values::F32(values) => values.get(entries).map(Values::F32),
            Values::I32(values) => values.get(entries).map(Values::I32),
            Values::U8(values) => values.get(entries).map(Values::U8),
        };
        let found = self.values.len();
        let wrong = || VtkError::WrongLength { field: self.name.into(), found, expected: self.components * range.end };
        Ok(Field { values: values.ok_or_else(wrong)?, ..*self })
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::super::{Arrays, CellKind, PieceList};
    use super::*;
    use proptest::prelude::*;

    /// Pieces and their list as the processes of a run write them; the arrays read together.
    fn together(pieces: &[Pieces], wanted: &[&str]) -> Arrays {
        let mut files = BTreeMap::new();
        for pieces in pieces {
            files.extend(pieces.files.iter().map(|(piece, file)| (pieces.name("a", *piece), file.bytes())));
        }
        let text = String::from_utf8(pieces[0].index("a").bytes().to_vec()).unwrap();
        let list = PieceList::parse(&text).unwrap();
        let names = [wanted, &[PieceList::NUMBERS]].concat();
        let read = |piece: &String| Arrays::read(&files[piece], &names).unwrap();
        list.joined(&list.pieces.iter().map(read).collect::<Vec<_>>(), wanted).unwrap()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        /// Whatever the cells are and however many processes write, the pieces are the whole.
        #[test]
        fn pieces_are_the_whole(
            tetrahedra in proptest::collection::vec(proptest::array::uniform4(0u32..40), 0..60),
            triangles in proptest::collection::vec(proptest::array::uniform3(0u32..40), 0..20),
            count in 1usize..9,
            step in 1usize..4,
        ) {
            let points: Vec<[f64; 3]> = (0..40).map(|i| [f64::from(i).sin(), f64::from(i), -1.0]).collect();
            let held: Vec<u8> = (0..40).collect();
            let stress: Vec<[f32; 6]> = (0..tetrahedra.len() + triangles.len()).map(|i| [i as f32; 6]).collect();
            let cells = [
                CellBlock { kind: CellKind::Tetrahedron, nodes: tetrahedra.as_flattened() },
                CellBlock { kind: CellKind::Triangle, nodes: triangles.as_flattened() },
            ];
            let grid = UnstructuredGrid {
                points: &points,
                cells: &cells,
                point_data: &[Field::vector("velocity", &points), Field::flag("held", &held)],
                cell_data: &[Field { name: "stress", components: 6, values: Values::F32(stress.as_flattened()) }],
                time: Some(0.25),
            };
            let names = ["Points", "velocity", "held", "stress", "connectivity", "offsets", "TimeValue"];
            let whole = grid.to_bytes(Compression::Fast).unwrap();
            let of = |first| grid.pieces(Cut { count, first, step, is_divided: false }, Compression::Fast).unwrap();
            let pieces: Vec<Pieces> = (0..step).map(of).collect();
            prop_assert_eq!(pieces.iter().map(|of| of.files.len()).sum::<usize>(), count);
            let whole = Arrays::read(&whole, &names).unwrap();
            prop_assert_eq!(together(&pieces, &names), whole);
        }
    }

    #[test]
    fn a_cloud_is_cut_and_put_together() {
        let points: Vec<[f64; 3]> = (0..11).map(|i| [f64::from(i), 0.0, 2.0]).collect();
        let radius: Vec<f64> = (0..11).map(f64::from).collect();
        let cloud = PolyData {
            points: &points,
            cells: PolyCells::Points,
            point_data: &[Field::scalar("radius", &radius)],
            cell_data: &[],
            time: None,
        };
        let pieces = cloud.pieces(Cut { count: 3, first: 0, step: 1, is_divided: false }, Compression::Fast).unwrap();
        let together = together(&[pieces], &["Points", "radius"]);
        assert_eq!((together.vectors("Points"), together.get("radius")), (points, &radius[..]));
    }

    #[test]
    fn the_list_declares_arrays_and_names_pieces() {
        let grid = UnstructuredGrid {
            points: &[[0.0; 3]; 3],
            cells: &[CellBlock { kind: CellKind::Triangle, nodes: &[0, 1, 2] }],
            point_data: &[Field::vector("velocity", &[[0.0; 3]; 3])],
            cell_data: &[Field::integer("body", &[0])],
            time: Some(1.0),
        };
        let pieces = grid.pieces(Cut { count: 2, first: 1, step: 2, is_divided: false }, Compression::None).unwrap();
        let list = String::from_utf8(pieces.index("solid-00003").bytes().to_vec()).unwrap();
        for line in [
            "<VTKFile type=\"PUnstructuredGrid\"",
            "<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>",
            "<PDataArray type=\"Float64\" Name=\"velocity\" NumberOfComponents=\"3\"/>",
            "<PDataArray type=\"Int32\" Name=\"GlobalNodeId\"/>",
            "<PDataArray type=\"Int32\" Name=\"body\"/>",
            "<Piece Source=\"solid-00003-0000.vtu\"/>",
            "<Piece Source=\"solid-00003-0001.vtu\"/>",
        ] {
            assert!(list.contains(line), "{line}: {list}");
        }
        let short = UnstructuredGrid { cell_data: &[Field::integer("body", &[])], ..grid };
        assert!(matches!(short.pieces(Cut::WHOLE, Compression::None), Err(VtkError::WrongLength { .. })));
        let beyond = [CellBlock { kind: CellKind::Line, nodes: &[0, 5] }];
        let beyond = UnstructuredGrid { cells: &beyond, cell_data: &[], ..grid };
        assert!(matches!(beyond.pieces(Cut::WHOLE, Compression::None), Err(VtkError::NoSuchPoint { point: 5, .. })));
    }
}
