//! Reading the files that the writers here make, for pictures and movies.
//!
//! Only what the writers here make is read: arrays appended as raw bytes, in this machine's byte order. A file that is
//! damaged or from elsewhere is an error, and no size that it states is believed before the bytes are there.

mod together;

use std::collections::BTreeMap;
use std::io::{BufRead, Read, Seek, SeekFrom};

use crate::collection::{Collection, Entry};
pub use together::PieceList;

/// Largest array that is read [bytes].
const LARGEST: usize = 1 << 32;

/// Arrays of a VTU or VTP by name; numbers of every type as doubles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrays(BTreeMap<String, Vec<f64>>);

impl Arrays {
    /// Reads the arrays of these names, and nothing else of a file; what is not there is left out. None of what these writers
    /// did not make.
    pub fn read(file: &mut (impl BufRead + Seek), wanted: &[&str]) -> Option<Self> {
        decode(file, wanted).map(Arrays)
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
        let entry = |tag| {
            let attributes = attributes(tag);
            let get = |name: &str| attributes.get(name).copied();
            Some(Entry {
                time: get("timestep")?.parse().ok()?,
                part: get("part")?.parse().ok()?,
                name: get("name")?.to_owned(),
                file: get("file")?.to_owned(),
            })
        };
        let entries = text.split('<').filter(|tag| tag.starts_with("DataSet")).map(entry);
        Some(Collection { entries: entries.collect::<Option<_>>()? })
    }
}

fn decode(file: &mut (impl BufRead + Seek), wanted: &[&str]) -> Option<BTreeMap<String, Vec<f64>>> {
    let xml = head(file)?;
    let begin = file.stream_position().ok()?;
    let compressed = xml.contains("compressor=\"vtkZLibDataCompressor\"");
    let mut arrays = BTreeMap::new();
    for tag in xml.split('<').filter(|tag| tag.starts_with("DataArray")) {
        let attributes = attributes(tag);
        let name = *attributes.get("Name")?;
        if !wanted.contains(&name) {
            continue;
        }
        let offset: u64 = attributes.get("offset")?.parse().ok()?;
        file.seek(SeekFrom::Start(begin.checked_add(offset)?)).ok()?;
        let bytes = if compressed { inflate(file)? } else { plain(file)? };
        arrays.insert(name.to_owned(), numbers(attributes.get("type")?, &bytes)?);
    }
    Some(arrays)
}

/// The text before the arrays; leaves the file where they begin.
fn head(file: &mut impl BufRead) -> Option<String> {
    let mut text = Vec::new();
    while !text.ends_with(b"<AppendedData encoding=\"raw\">") {
        file.read_until(b'>', &mut text).ok().filter(|&read| read > 0)?;
    }
    file.read_until(b'_', &mut text).ok()?;
    text.ends_with(b"_").then(|| String::from_utf8(text).ok())?
}

fn attributes(tag: &str) -> BTreeMap<&str, &str> {
    let mut attributes = BTreeMap::new();
    let mut rest = tag;
    while let Some((before, after)) = rest.split_once("=\"") {
        let Some((value, after)) = after.split_once('"') else { break };
        attributes.insert(before.rsplit([' ', '\n']).next().unwrap_or_default(), value);
        rest = after;
    }
    attributes
}

fn numbers(kind: &str, bytes: &[u8]) -> Option<Vec<f64>> {
    fn of<const N: usize>(bytes: &[u8], number: fn([u8; N]) -> f64) -> Vec<f64> {
        bytes.chunks_exact(N).filter_map(|bytes| bytes.try_into().ok()).map(number).collect()
    }
    Some(match kind {
        "Float64" => of(bytes, f64::from_ne_bytes),
        "Float32" => of(bytes, |b| f64::from(f32::from_ne_bytes(b))),
        "Int64" => of(bytes, |b| i64::from_ne_bytes(b) as f64),
        "Int32" => of(bytes, |b| f64::from(i32::from_ne_bytes(b))),
        "UInt8" => of(bytes, |[b]: [u8; 1]| f64::from(b)),
        "Int8" => of(bytes, |[b]: [u8; 1]| f64::from(b as i8)),
        // Text and other types show in no picture.
        _ => Vec::new(),
    })
}

fn number(file: &mut impl Read) -> Option<usize> {
    let mut bytes = [0; 8];
    file.read_exact(&mut bytes).ok()?;
    usize::try_from(u64::from_ne_bytes(bytes)).ok()
}

/// The next bytes, which grow only as far as the file has them.
fn take(file: &mut impl Read, length: usize) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    file.take(length as u64).read_to_end(&mut bytes).ok()?;
    (bytes.len() == length).then_some(bytes)
}

fn plain(file: &mut impl Read) -> Option<Vec<u8>> {
    let length = number(file)?;
    take(file, length)
}

fn inflate(file: &mut impl Read) -> Option<Vec<u8>> {
    let (blocks, _size, _partial) = (number(file)?, number(file)?, number(file)?);
    let sizes = take(file, blocks.checked_mul(8)?)?;
    let mut bytes = Vec::new();
    for size in sizes.chunks_exact(8) {
        let block = take(file, number(&mut &size[..])?)?;
        let room = LARGEST.checked_sub(bytes.len())? as u64;
        flate2::read::ZlibDecoder::new(&block[..]).take(room).read_to_end(&mut bytes).ok()?;
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

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
        let read = |bytes: &[u8], wanted: &[&str]| Arrays::read(&mut Cursor::new(bytes), wanted);
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
