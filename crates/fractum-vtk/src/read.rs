//! Reading the files that the writers here make, for pictures and movies: arrays by name, pieces as one, instants of a collection.

mod together;

use std::collections::BTreeMap;

use crate::collection::{Collection, Entry};
use crate::file::{Document, tags};
pub use together::PieceList;

/// Arrays of a VTU or VTP by name; numbers of every type as doubles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrays(BTreeMap<String, Vec<f64>>);

impl Arrays {
    /// Reads the arrays of these names, and decodes nothing else of a file; what is not there is left out. None of a file that is
    /// damaged.
    pub fn read(file: &[u8], wanted: &[&str]) -> Option<Self> {
        let document = Document::read(file, &["UnstructuredGrid", "PolyData"]).ok()?;
        let arrays = document.arrays.iter().filter(|array| wanted.contains(&array.name.as_str()));
        let read = arrays.map(|array| Some((array.name.clone(), document.numbers(array)?)));
        Some(Arrays(read.collect::<Option<_>>()?))
    }

    /// The numbers of an array; none of one that is not there.
    pub fn get(&self, name: &str) -> &[f64] {
        self.0.get(name).map_or(&[], Vec::as_slice)
    }

    /// The vectors of an array.
    pub fn vectors(&self, name: &str) -> Vec<[f64; 3]> {
        self.get(name).chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
    }

    /// The cells with this number of corners.
    pub fn cells<const N: usize>(&self) -> Vec<[u32; N]> {
        let (nodes, ends) = (self.get("connectivity"), self.get("offsets"));
        let points = self.get("Points").len() / 3;
        let begins = std::iter::once(0).chain(ends.iter().map(|&end| end as usize));
        let ranges = begins.zip(ends.iter().map(|&end| end as usize));
        let cell = |(begin, end): (usize, usize)| {
            let corners: [f64; N] = nodes.get(begin..end)?.try_into().ok()?;
            corners.iter().all(|&n| (n as usize) < points).then(|| corners.map(|n| n as u32))
        };
        ranges.filter_map(cell).collect()
    }
}

impl Collection {
    /// Reads the text of a PVD; none of one that [`to_xml`](Collection::to_xml) did not make.
    pub fn parse(text: &str) -> Option<Self> {
        let mut entries = Vec::new();
        for tag in tags(text)?.iter().filter(|tag| tag.name == "DataSet") {
            entries.push(Entry {
                time: tag.attribute("timestep")?.parse().ok()?,
                part: tag.attribute("part")?.parse().ok()?,
                name: tag.attribute("name")?,
                file: tag.attribute("file")?,
            });
        }
        Some(Collection { entries })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compress::Compression;
    use crate::{Field, PolyCells, PolyData};

    #[test]
    fn what_was_written_is_read_and_what_is_cut_off_is_refused() {
        let points: Vec<[f64; 3]> = (0..20_000).map(|i| [f64::from(i), 0.5, -1.0]).collect();
        let radius: Vec<f64> = points.iter().map(|p| p[0] + 1.0).collect();
        let triangles: Vec<[u32; 3]> = (2..20_000).map(|i| [0, i - 1, i]).collect();
        let data = PolyData {
            points: &points,
            cells: PolyCells::Triangles(&triangles),
            point_data: &[Field::scalar("radius", &radius)],
            cell_data: &[],
            time: Some(0.5),
        };
        let read = |bytes: &[u8], wanted: &[&str]| Arrays::read(bytes, wanted);
        for compression in [Compression::Fast, Compression::None] {
            let bytes = data.to_bytes(compression).unwrap();
            let all = ["Points", "radius", "connectivity", "offsets", "TimeValue", "absent"];
            let arrays = read(&bytes, &all).unwrap();
            assert_eq!((arrays.vectors("Points"), arrays.get("radius")), (points.clone(), &radius[..]));
            assert_eq!((arrays.cells::<3>(), arrays.get("TimeValue")), (triangles.clone(), &[0.5][..]));
            assert!(arrays.cells::<4>().is_empty() && arrays.get("absent").is_empty());
            for part in [0, 10, bytes.len() / 3, bytes.len() / 2] {
                assert!(read(&bytes[..part], &all).is_none(), "{part}");
            }
            // The arrays that nobody wants are not looked at.
            let time = read(&bytes[..bytes.len() / 2], &["TimeValue"]).unwrap();
            assert_eq!((time.get("TimeValue"), time.get("Points")), (&[0.5][..], &[][..]));
        }
    }

    #[test]
    fn a_collection_reads_back() {
        let mut collection = Collection::default();
        collection.push(0.0, 0, "solid", "fields/solid-00000.vtu");
        collection.push(1.5e-4, 1, "particles", "particles/particles-00001.vtp");
        assert_eq!(Collection::parse(&collection.to_xml()), Some(collection));
        assert_eq!(Collection::parse("<DataSet timestep=\"x\"/>"), None);
    }
}
