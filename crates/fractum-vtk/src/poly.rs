//! VTP: particles as points with a radius, bonds as lines, facets as triangles.

use super::document::Document;
use super::pending::PendingFile;
use super::{Compression, Field, VtkError, check_points};

/// The cells of a VTP; one kind per file.
#[derive(Clone, Copy, Debug)]
pub enum PolyCells<'a> {
    /// A vertex at each point.
    Points,
    /// Lines between two points each.
    Lines(&'a [[u32; 2]]),
    /// Triangles.
    Triangles(&'a [[u32; 3]]),
    /// Polygons of six corners.
    Hexagons(&'a [[u32; 6]]),
}

/// What goes into one VTP. For particles, give the radius as a field at the points: ParaView's glyphs take it as scale.
#[derive(Clone, Copy, Debug)]
pub struct PolyData<'a> {
    /// Positions [m].
    pub points: &'a [[f64; 3]],
    /// What connects them.
    pub cells: PolyCells<'a>,
    /// Fields at the points.
    pub point_data: &'a [Field<'a>],
    /// Fields in the cells.
    pub cell_data: &'a [Field<'a>],
    /// Simulated time [s].
    pub time: Option<f64>,
}

impl PolyData<'_> {
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
        let all: Vec<u32>;
        let (nodes, per_cell) = match cells {
            PolyCells::Points => {
                all = (0..points.len() as u32).collect();
                (&all[..], 1)
            }
            PolyCells::Lines(lines) => (lines.as_flattened(), 2),
            PolyCells::Triangles(triangles) => (triangles.as_flattened(), 3),
            PolyCells::Hexagons(hexagons) => (hexagons.as_flattened(), 6),
        };
        check_points(nodes, points.len())?;
        let count = nodes.len() / per_cell;
        point_data.iter().try_for_each(|field| field.check(points.len()))?;
        cell_data.iter().try_for_each(|field| field.check(count))?;

        let size = per_cell.min(3);
        let count_if = |other| if other == size { count } else { 0 };
        let mut document = Document::new("PolyData", time);
        document.text(&format!(
            "    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" NumberOfStrips=\"0\" \
             NumberOfPolys=\"{}\">\n",
            points.len(),
            count_if(1),
            count_if(2),
            count_if(3)
        ));
        document.points(points);
        let section = ["Verts", "Lines", "Polys"][size - 1];
        document.text(&format!("      <{section}>\n"));
        document.cells(nodes, (1..=count).map(|cell| cell * per_cell));
        document.text(&format!("      </{section}>\n"));
        document.fields("PointData", point_data);
        document.fields("CellData", cell_data);
        document.text("    </Piece>\n");
        Ok(document)
    }
}

#[cfg(test)]
mod tests {
    use super::super::decode::decode;
    use super::*;

    const POINTS: [[f64; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    fn says(file: &[u8], words: &str) -> bool {
        file.windows(words.len()).any(|window| window == words.as_bytes())
    }

    #[test]
    fn particles_are_vertices_with_a_radius() {
        let particles = PolyData {
            points: &POINTS,
            cells: PolyCells::Points,
            point_data: &[Field::scalar("radius", &[0.1, 0.2, 0.3])],
            cell_data: &[],
            time: Some(1.0),
        };
        let bytes = particles.to_bytes(Compression::Fast).unwrap();
        assert!(says(&bytes, "NumberOfVerts=\"3\"") && says(&bytes, "NumberOfPolys=\"0\""));
        let file = decode(&bytes);
        assert_eq!(file.i32("connectivity"), [0, 1, 2]);
        assert_eq!(file.i32("offsets"), [1, 2, 3]);
        assert_eq!(file.f64("radius"), [0.1, 0.2, 0.3]);
    }

    #[test]
    fn bonds_are_lines_and_facets_are_polygons() {
        let bonds = PolyData {
            points: &POINTS,
            cells: PolyCells::Lines(&[[0, 1], [1, 2]]),
            point_data: &[],
            cell_data: &[Field::flag("broken", &[0, 1])],
            time: None,
        };
        let bytes = bonds.to_bytes(Compression::None).unwrap();
        assert!(says(&bytes, "NumberOfLines=\"2\""));
        let file = decode(&bytes);
        assert_eq!(file.i32("offsets"), [2, 4]);
        assert_eq!(file.bytes("broken"), [0, 1]);

        let facets = PolyData { cells: PolyCells::Triangles(&[[0, 1, 2]]), cell_data: &[], ..bonds };
        let bytes = facets.to_bytes(Compression::Fast).unwrap();
        assert!(says(&bytes, "NumberOfPolys=\"1\""));
        assert_eq!(decode(&bytes).i32("connectivity"), [0, 1, 2]);
    }

    #[test]
    fn no_particle_at_all_is_a_valid_file() {
        let none = PolyData {
            points: &[],
            cells: PolyCells::Points,
            point_data: &[Field::scalar("radius", &[])],
            cell_data: &[],
            time: None,
        };
        let bytes = none.to_bytes(Compression::Fast).unwrap();
        assert_eq!(decode(&bytes).sizes(), [0, 0]);
    }
}
