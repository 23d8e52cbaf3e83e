//! The file around the arrays: XML that tells where each begins, then their bytes.

use std::borrow::Cow;
use std::fmt::Write;

use flate2::Compress;
use serde::{Deserialize, Serialize};

use crate::Field;
use crate::compress::{Compression, compressor, deflate};
use crate::text::escape;
use crate::unit::unit_of;

/// Bytes compressed at a time, each block for itself.
pub(super) const BLOCK: usize = 1 << 16;

/// Order of the bytes of numbers, which is that of this machine.
pub(super) const BYTE_ORDER: &str = if cfg!(target_endian = "little") { "LittleEndian" } else { "BigEndian" };

/// Type, name and components of an array, as its tag has them.
pub(super) fn described(kind: &str, name: &str, components: usize) -> String {
    let escaped = escape(name);
    // One component is the default; meshio makes a matrix with one column of a scalar that says so.
    let components = if components == 1 { String::new() } else { format!(" NumberOfComponents=\"{components}\"") };
    format!("type=\"{kind}\" Name=\"{escaped}\"{components}")
}

/// A VTK file in the making: text and arrays in their order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Document<'a> {
    kind: Cow<'static, str>,
    pieces: Vec<Piece<'a>>,
}

#[derive(Clone, Debug, Serialize, Deserialize)]
enum Piece<'a> {
    Text(String),
    Array {
        tag: String,
        /// Name and unit as VTK keeps them beside an array; empty without a unit.
        unit: String,
        bytes: Cow<'a, [u8]>,
    },
}

impl<'a> Document<'a> {
    /// Starts a file of that kind, with the time if it is known.
    pub(super) fn new(kind: &'static str, time: Option<f64>) -> Self {
        let mut document = Self { kind: Cow::Borrowed(kind), pieces: Vec::new() };
        if let Some(time) = time {
            document.text("    <FieldData>\n");
            let tag = "type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\"";
            document.tagged(tag.into(), "TimeValue", Cow::Owned(time.to_ne_bytes().to_vec()));
            document.text("    </FieldData>\n");
        }
        document
    }

    pub(super) fn text(&mut self, text: &str) {
        match self.pieces.last_mut() {
            Some(Piece::Text(last)) => last.push_str(text),
            _ => self.pieces.push(Piece::Text(text.to_string())),
        }
    }

    /// Adds an array of `kind` (`Float64`, ...).
    pub(super) fn array(&mut self, kind: &str, name: &str, components: usize, bytes: Cow<'a, [u8]>) {
        self.tagged(described(kind, name, components), name, bytes);
    }

    /// Adds the points.
    pub(super) fn points(&mut self, points: &'a [[f64; 3]]) {
        self.text("      <Points>\n");
        self.array("Float64", "Points", 3, Cow::Borrowed(bytemuck::cast_slice(points)));
        self.text("      </Points>\n");
    }

    /// Adds a `PointData` or `CellData` section.
    pub(super) fn fields(&mut self, section: &str, fields: &[Field<'a>]) {
        self.text(&format!("      <{section}>\n"));
        for field in fields {
            self.array(field.values.kind(), field.name, field.components, field.values.bytes());
        }
        self.text(&format!("      </{section}>\n"));
    }

    /// Adds cells: the points of one after the other, and where in that list each cell ends.
    pub(super) fn cells(&mut self, nodes: &[u32], ends: impl Iterator<Item = usize>) {
        // 32 bits as long as all numbers fit; the file says which.
        if i32::try_from(nodes.len()).is_ok() && nodes.iter().all(|&node| i32::try_from(node).is_ok()) {
            let nodes: Vec<i32> = nodes.iter().map(|&node| node as i32).collect();
            let offsets: Vec<i32> = ends.map(|end| end as i32).collect();
            self.array("Int32", "connectivity", 1, Cow::Owned(bytemuck::cast_slice(&nodes).to_vec()));
            self.array("Int32", "offsets", 1, Cow::Owned(bytemuck::cast_slice(&offsets).to_vec()));
        } else {
            let nodes: Vec<i64> = nodes.iter().map(|&node| i64::from(node)).collect();
            let offsets: Vec<i64> = ends.map(|end| end as i64).collect();
            self.array("Int64", "connectivity", 1, Cow::Owned(bytemuck::cast_slice(&nodes).to_vec()));
            self.array("Int64", "offsets", 1, Cow::Owned(bytemuck::cast_slice(&offsets).to_vec()));
        }
    }

    fn tagged(&mut self, tag: String, name: &str, bytes: Cow<'a, [u8]>) {
        let key =
            |unit| format!("<InformationKey name=\"UNITS_LABEL\" location=\"vtkDataArray\">{unit}</InformationKey>");
        self.pieces.push(Piece::Array { tag, unit: unit_of(name).map_or(String::new(), key), bytes });
    }

    /// Bytes of its text and arrays.
    pub(super) fn size(&self) -> usize {
        let of = |piece: &Piece| match piece {
            Piece::Text(text) => text.len(),
            Piece::Array { bytes, .. } => bytes.len(),
        };
        self.pieces.iter().map(of).sum()
    }

    /// The same with arrays of its own.
    pub(super) fn into_owned(self) -> Document<'static> {
        let owned = |piece| match piece {
            Piece::Text(text) => Piece::Text(text),
            Piece::Array { tag, unit, bytes } => Piece::Array { tag, unit, bytes: Cow::Owned(bytes.into_owned()) },
        };
        Document { kind: self.kind, pieces: self.pieces.into_iter().map(owned).collect() }
    }

    /// The whole file.
    pub(super) fn to_bytes(&self, compression: Compression) -> Vec<u8> {
        let arrays: Vec<&[u8]> = self
            .pieces
            .iter()
            .filter_map(|piece| match piece {
                Piece::Array { bytes, .. } => Some(&bytes[..]),
                Piece::Text(_) => None,
            })
            .collect();
        let stored: Vec<Vec<u8>> = match compression {
            Compression::None => arrays.iter().map(|bytes| raw(bytes)).collect(),
            Compression::Fast => {
                let mut compressor = compressor();
                arrays.iter().map(|bytes| compressed(&mut compressor, bytes)).collect()
            }
        };

        let kind = &self.kind;
        let compressed_by = match compression {
            Compression::None => "",
            Compression::Fast => " compressor=\"vtkZLibDataCompressor\"",
        };
        let mut xml = format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" byte_order=\"{BYTE_ORDER}\" \
             header_type=\"UInt64\"{compressed_by}>\n  <{kind}>\n"
        );
        let mut offset = 0;
        let mut lengths = stored.iter().map(Vec::len);
        for piece in &self.pieces {
            match piece {
                Piece::Text(text) => xml.push_str(text),
                Piece::Array { tag, unit, .. } => {
                    let _ = write!(xml, "        <DataArray {tag} format=\"appended\" offset=\"{offset}\"");
                    // Writing to a String cannot fail.
                    let _ = if unit.is_empty() { writeln!(xml, "/>") } else { writeln!(xml, ">{unit}</DataArray>") };
                    offset += lengths.next().unwrap_or(0);
                }
            }
        }
        let _ = write!(xml, "  </{kind}>\n  <AppendedData encoding=\"raw\">\n   _");
        // One line break between the data and the closing tag: meshio counts on it.
        let end = b"\n  </AppendedData>\n</VTKFile>\n";
        let mut file = Vec::with_capacity(xml.len() + offset + end.len());
        file.extend_from_slice(xml.as_bytes());
        stored.iter().for_each(|bytes| file.extend_from_slice(bytes));
        file.extend_from_slice(end);
        file
    }
}

/// Length, then the bytes.
fn raw(bytes: &[u8]) -> Vec<u8> {
    let mut stored = Vec::with_capacity(8 + bytes.len());
    stored.extend_from_slice(&(bytes.len() as u64).to_ne_bytes());
    stored.extend_from_slice(bytes);
    stored
}

/// Number of blocks, size of a block, size of the last block if it is partial (else 0), compressed sizes; then the
/// compressed blocks.
fn compressed(compressor: &mut Compress, bytes: &[u8]) -> Vec<u8> {
    let blocks: Vec<Vec<u8>> = bytes.chunks(BLOCK).map(|block| deflate(compressor, block)).collect();
    let header = [blocks.len(), BLOCK, bytes.len() % BLOCK].into_iter().chain(blocks.iter().map(Vec::len));
    let mut stored = Vec::with_capacity(8 * (3 + blocks.len()) + blocks.iter().map(Vec::len).sum::<usize>());
    header.for_each(|number| stored.extend_from_slice(&(number as u64).to_ne_bytes()));
    blocks.iter().for_each(|block| stored.extend_from_slice(block));
    stored
}
