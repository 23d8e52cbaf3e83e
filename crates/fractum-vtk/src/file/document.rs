//! The arrays of a file and how they are stored.

use super::fault::{Fault, Wrong};
use super::xml::{Tag, Tags};
use crate::text::{BYTE_ORDER_MARK, quote};

/// What a file says of itself.
#[derive(Default)]
pub struct Document<'a> {
    pub(super) big_endian: bool,
    /// Bytes of a number in the head of an array: 4 or 8.
    pub(super) word: usize,
    /// Compressed by zlib.
    pub(super) compressed: bool,
    /// Number of points.
    pub points: usize,
    /// Number of cells.
    pub cells: usize,
    /// All arrays, in the order of the file.
    pub arrays: Vec<Array>,
    /// Appended data, behind the `_`.
    pub(super) appended: &'a [u8],
    /// Appended data in base64.
    pub(super) encoded: bool,
}

/// What an array belongs to.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Section {
    /// The positions.
    Points,
    /// The cells.
    Cells,
    /// Fields at the points.
    PointData,
    /// Fields in the cells.
    CellData,
    /// What belongs to the whole, such as its time.
    FieldData,
}

/// An array, not decoded yet.
pub struct Array {
    /// What it belongs to.
    pub section: Section,
    /// Its name.
    pub name: String,
    /// Such as `Int32`.
    pub(super) kind: String,
    /// Numbers of a point or cell, from 1.
    pub components: usize,
    pub(super) stored: Stored,
    /// Byte of the file where its tag begins.
    pub at: usize,
}

/// Where the numbers of an array are.
pub(super) enum Stored {
    Text(Vec<u8>),
    Base64(Vec<u8>),
    /// From this byte of the appended data.
    Appended(usize),
}

impl<'a> Document<'a> {
    /// Finds the arrays; decodes none.
    ///
    /// - `kinds`: of VTK files that are wanted, such as `UnstructuredGrid`
    ///
    /// # Errors
    /// Malformed files, other kinds of VTK files, several pieces, other compressors.
    pub fn read(bytes: &'a [u8], kinds: &[&str]) -> Result<Self, Fault> {
        let begin = if bytes.starts_with(BYTE_ORDER_MARK) { BYTE_ORDER_MARK.len() } else { 0 };
        let mut tags = Tags { bytes, at: begin };
        let mut document = Document::default();
        let mut section = None;
        let opens = |tag: &Tag| !tag.closes && !tag.empty;
        let mut root = false;
        let (mut pieces, mut is_empty) = (0, false);
        while let Some(tag) = tags.next()? {
            match tag.name {
                "VTKFile" if !tag.closes => {
                    document.head(&tag, kinds)?;
                    root = true;
                }
                _ if !root => return Err(not_vtk(&tag, bytes)),
                "Piece" if !tag.closes => {
                    let sizes = (tag.count("NumberOfPoints")?, tag.count("NumberOfCells")?);
                    is_empty = sizes == (0, 0);
                    pieces += usize::from(!is_empty);
                    if pieces > 1 {
                        return Err(Fault::unsupported(tag.at, SEVERAL_PIECES));
                    }
                    if !is_empty {
                        (document.points, document.cells) = sizes;
                    }
                }
                "Points" => section = opens(&tag).then_some(Section::Points),
                "FieldData" => section = opens(&tag).then_some(Section::FieldData),
                "Cells" | "Verts" | "Lines" | "Polys" => section = opens(&tag).then_some(Section::Cells),
                "PointData" => section = opens(&tag).then_some(Section::PointData),
                "CellData" => section = opens(&tag).then_some(Section::CellData),
                "DataArray" if !tag.closes => {
                    let text = if tag.empty { Vec::new() } else { text_of_array(&mut tags)? };
                    // An empty piece has arrays, of nothing.
                    if let Some(section) = section.filter(|_| !is_empty) {
                        document.arrays.push(Array::of(&tag, section, text)?);
                    }
                }
                "AppendedData" if !tag.closes => {
                    document.append(&tag, &bytes[tags.at..])?;
                    return Ok(document);
                }
                _ => {}
            }
        }
        if root { Ok(document) } else { Err(Fault { at: 0, wrong: Wrong::Empty }) }
    }

    fn head(&mut self, tag: &Tag, kinds: &[&str]) -> Result<(), Fault> {
        let kind = tag.attribute("type").unwrap_or_default();
        if !kinds.contains(&kind.as_str()) {
            let message = format!("a VTK file of type {kind}; expected UnstructuredGrid (.vtu): {SAVE_AS_VTU}");
            return Err(Fault::unsupported(tag.at, message));
        }
        self.big_endian = tag.attribute("byte_order").is_some_and(|order| order == "BigEndian");
        self.word = if tag.attribute("header_type").is_some_and(|kind| kind == "UInt64") { 8 } else { 4 };
        self.compressed = match tag.attribute("compressor").as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                let message = format!("compressed by {other}; expected vtkZLibDataCompressor or none: {SAVE_AS_VTU}");
                return Err(Fault::unsupported(tag.at, message));
            }
        };
        Ok(())
    }

    fn append(&mut self, tag: &Tag, rest: &'a [u8]) -> Result<(), Fault> {
        self.encoded = tag.attribute("encoding").is_some_and(|encoding| encoding == "base64");
        let mark = rest.iter().position(|byte| !byte.is_ascii_whitespace()).filter(|&at| rest[at] == b'_');
        let mark = mark.ok_or_else(|| Fault::unexpected(tag.at, quote(rest), "_ before the appended data"))?;
        self.appended = &rest[mark + 1..];
        Ok(())
    }

    /// The array of a section, which a grid must have.
    ///
    /// # Errors
    /// None of that name.
    pub fn array(&self, section: Section, name: &str) -> Result<&Array, Fault> {
        let found = self
            .arrays
            .iter()
            .find(|array| array.section == section && (section == Section::Points || array.name == name));
        found.ok_or_else(|| Fault::truncated(usize::MAX, format!("the array {name} of the grid")))
    }
}

const SAVE_AS_VTU: &str = "in ParaView, File, Save Data, .vtu with the compressor ZLib or None";

const SEVERAL_PIECES: &str =
    "a second piece; fractum reads grids of one piece: in ParaView apply Merge Blocks and save the data as .vtu";

fn not_vtk(tag: &Tag, bytes: &[u8]) -> Fault {
    let hint = "; of files in XML only VTK's unstructured grids (.vtu) are meshes";
    Fault { at: tag.at, wrong: Wrong::Foreign { found: quote(&bytes[tag.at..]), hint } }
}

/// The text of an array, without that of the tags inside of it; goes on behind its end.
fn text_of_array(tags: &mut Tags) -> Result<Vec<u8>, Fault> {
    let mut text = Vec::new();
    let mut depth = 0usize;
    loop {
        let Some(tag) = tags.next()? else { return Err(Fault::truncated(tags.bytes.len(), "</DataArray>")) };
        if depth == 0 {
            text.extend_from_slice(tag.text);
        }
        match (tag.closes, tag.empty) {
            (true, _) if depth == 0 => return Ok(text),
            (true, _) => depth -= 1,
            (false, true) => {}
            (false, false) => depth += 1,
        }
    }
}

impl Array {
    fn of(tag: &Tag, section: Section, text: Vec<u8>) -> Result<Self, Fault> {
        let stored = match tag.attribute("format").as_deref() {
            Some("appended") => Stored::Appended(tag.count("offset")?),
            Some("binary") => Stored::Base64(text),
            None | Some("ascii") => Stored::Text(text),
            Some(other) => return Err(Fault::unexpected(tag.at, quote(other.as_bytes()), "ascii, binary or appended")),
        };
        Ok(Array {
            section,
            name: tag.attribute("Name").unwrap_or_default(),
            kind: tag.attribute("type").unwrap_or_default(),
            components: tag.count("NumberOfComponents")?.max(1),
            stored,
            at: tag.at,
        })
    }

    /// Whether its numbers are whole.
    pub fn is_whole(&self) -> bool {
        self.kind.trim_start_matches('U').starts_with("Int")
    }
}
