//! An independent reader of what the writers make, for their tests: it follows the published format, not the writer.

use std::collections::BTreeMap;
use std::io::Read;

/// Attributes of the first tag that bears them, and arrays by name.
pub(super) struct Decoded {
    attributes: BTreeMap<String, String>,
    arrays: BTreeMap<String, (String, usize, Vec<u8>)>,
}

impl Decoded {
    pub(super) fn attribute(&self, name: &str) -> &str {
        &self.attributes[name]
    }

    pub(super) fn bytes(&self, name: &str) -> &[u8] {
        &self.arrays[name].2
    }

    pub(super) fn components(&self, name: &str) -> usize {
        self.arrays[name].1
    }

    pub(super) fn f64(&self, name: &str) -> Vec<f64> {
        assert_eq!(self.arrays[name].0, "Float64");
        self.bytes(name).chunks_exact(8).map(|bytes| f64::from_ne_bytes(bytes.try_into().unwrap())).collect()
    }

    pub(super) fn i32(&self, name: &str) -> Vec<i32> {
        assert_eq!(self.arrays[name].0, "Int32");
        self.bytes(name).chunks_exact(4).map(|bytes| i32::from_ne_bytes(bytes.try_into().unwrap())).collect()
    }
}

pub(super) fn decode(file: &[u8]) -> Decoded {
    let start = find(file, b"<AppendedData encoding=\"raw\">").unwrap();
    let xml = std::str::from_utf8(&file[..start]).unwrap();
    let underscore = start + find(&file[start..], b"_").unwrap();
    let data = &file[underscore + 1..];
    let compressed = xml.contains("compressor=\"vtkZLibDataCompressor\"");
    let mut decoded = Decoded { attributes: BTreeMap::new(), arrays: BTreeMap::new() };
    let mut end = 0;
    for tag in xml.split('<').skip(1) {
        let attributes = attributes(tag);
        if tag.starts_with("DataArray") {
            let offset: usize = attributes["offset"].parse().unwrap();
            assert_eq!(offset, end, "arrays follow each other without gaps");
            let (bytes, length) = if compressed { inflate(&data[offset..]) } else { plain(&data[offset..]) };
            end = offset + length;
            let components = attributes.get("NumberOfComponents").map_or(1, |text| text.parse().unwrap());
            decoded.arrays.insert(attributes["Name"].clone(), (attributes["type"].clone(), components, bytes));
        } else {
            for (name, value) in attributes {
                decoded.attributes.entry(name).or_insert(value);
            }
        }
    }
    assert_eq!(&data[end..], b"\n  </AppendedData>\n</VTKFile>\n");
    assert_eq!(decoded.attributes["header_type"], "UInt64");
    decoded
}

fn attributes(tag: &str) -> BTreeMap<String, String> {
    let mut attributes = BTreeMap::new();
    let mut rest = tag;
    while let Some((before, after)) = rest.split_once("=\"") {
        let name = before.rsplit(' ').next().unwrap();
        let (value, after) = after.split_once('"').unwrap();
        attributes.insert(name.to_string(), value.to_string());
        rest = after;
    }
    attributes
}

fn number(data: &[u8], index: usize) -> usize {
    u64::from_ne_bytes(data[8 * index..8 * index + 8].try_into().unwrap()) as usize
}

/// Bytes of an array and the length that it takes in the file.
fn plain(data: &[u8]) -> (Vec<u8>, usize) {
    let length = number(data, 0);
    (data[8..8 + length].to_vec(), 8 + length)
}

fn inflate(data: &[u8]) -> (Vec<u8>, usize) {
    let (blocks, size, partial) = (number(data, 0), number(data, 1), number(data, 2));
    let mut bytes = Vec::new();
    let mut position = 8 * (3 + blocks);
    for block in 0..blocks {
        let stored = number(data, 3 + block);
        let before = bytes.len();
        flate2::read::ZlibDecoder::new(&data[position..position + stored]).read_to_end(&mut bytes).unwrap();
        let expected = if block + 1 == blocks && partial > 0 { partial } else { size };
        assert_eq!(bytes.len() - before, expected, "block {block} of {blocks}");
        position += stored;
    }
    (bytes, position)
}

fn find(bytes: &[u8], pattern: &[u8]) -> Option<usize> {
    bytes.windows(pattern.len()).position(|window| window == pattern)
}
