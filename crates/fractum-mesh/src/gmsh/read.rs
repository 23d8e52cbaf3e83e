use std::collections::BTreeMap;

use super::binary::Layout;
use super::{entities, names, v2, v4};
use crate::Mesh;
use crate::mesh::list;
use crate::tagged::assemble;
use crate::tagged::cursor::{Cursor, What, quote};
use crate::tagged::error::{Fault, MeshError, Problem};
use crate::tagged::raw::Raw;

/// Reads a Gmsh mesh: MSH 2.2 or 4.1, ASCII or binary of either byte order.
///
/// - `bytes`: the whole file
///
/// Elements of higher order are read with their corners only, tetrahedra of negative volume are flipped, and in a
/// plane mesh clockwise triangles too; elements listed once per group are merged. [`Mesh::notices`] tells what was
/// done. Elements that belong to no physical group are kept, in no [`crate::Group`].
///
/// # Errors
/// With the place in the file, for anything that is not such a mesh: other versions and formats, malformed or
/// truncated sections, coordinates that are not finite, missing or repeated tags, element types that fractum does not
/// hold where a physical group asks for them, and elements without volume, area or length.
pub fn read_msh(bytes: &[u8]) -> Result<Mesh, MeshError> {
    let mut binary = false;
    read(bytes, &mut binary).map_err(|fault| fault.into_error(bytes, binary))
}

fn read(bytes: &[u8], binary: &mut bool) -> Result<Mesh, Fault> {
    let mut cursor = Cursor::new(bytes);
    let format = read_format(&mut cursor)?;
    *binary = format.layout.is_some();
    let raw = read_sections(&mut cursor, format)?;
    assemble(raw, bytes)
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Version {
    Two,
    Four,
}

struct Format {
    version: Version,
    /// Layout of binary data; none for ASCII.
    layout: Option<Layout>,
}

/// Reads `$MeshFormat` up to and with its end.
fn read_format(cursor: &mut Cursor) -> Result<Format, Fault> {
    cursor.skip_byte_order_mark();
    let Some((mut at, mut line)) = cursor.line() else { return Err(Fault { at: 0, problem: Problem::Empty }) };
    while line == b"$Comments" {
        cursor.skip_section("Comments")?;
        let missing = || Fault::truncated(cursor.bytes.len(), "section $MeshFormat");
        (at, line) = cursor.line().ok_or_else(missing)?;
    }
    if line != b"$MeshFormat" {
        return Err(Fault { at, problem: Problem::NotGmsh { found: quote(line), hint: hint_for(cursor.bytes, line) } });
    }
    let mut record = cursor.record(What::one("the mesh format"))?;
    let at = record.at();
    let number = record.real("the version")?;
    let file_type = record.unsigned("the file type")?;
    let data_size = record.unsigned("the data size")?;
    record.end()?;
    let version = match number {
        2.0..=2.2 => Version::Two,
        4.1 => Version::Four,
        _ => return Err(Fault { at, problem: Problem::Version(number.to_string()) }),
    };
    let layout = match file_type {
        0 => None,
        1 => Some(read_layout(cursor, version, data_size, at)?),
        other => return Err(Fault::unexpected(at, format!("file type {other}"), "0 (ASCII) or 1 (binary)")),
    };
    cursor.end_section("MeshFormat")?;
    Ok(Format { version, layout })
}

/// Checks the data size and finds the byte order from the number 1 that follows the header.
fn read_layout(cursor: &mut Cursor, version: Version, data_size: u64, at: usize) -> Result<Layout, Fault> {
    let word = match (version, data_size) {
        (_, 8) => 8,
        (Version::Four, 4) => 4,
        (Version::Four, other) => return Err(Fault::unexpected(at, format!("data size {other}"), "4 or 8 bytes")),
        (Version::Two, other) => return Err(Fault::unexpected(at, format!("data size {other}"), "8 bytes")),
    };
    let one_at = cursor.at;
    match cursor.take(4, What::one("the number 1 that tells the byte order"))? {
        [1, 0, 0, 0] => Ok(Layout { big_endian: false, word }),
        [0, 0, 0, 1] => Ok(Layout { big_endian: true, word }),
        other => Err(Fault::unexpected(
            one_at,
            format!("bytes {other:02x?}"),
            "the number 1 in four bytes; was the file transferred as text?",
        )),
    }
}

/// What a file of another program is, and how to convert it.
fn hint_for(bytes: &[u8], line: &[u8]) -> &'static str {
    let has_line =
        |start: &[u8]| bytes.split(|&byte| byte == b'\n').any(|line| line.trim_ascii_start().starts_with(start));
    let begins = |starts: &[&[u8]]| starts.iter().any(|start| line.starts_with(start));
    if bytes.starts_with(crate::GIT_LFS) {
        "; this is a pointer of Git LFS, which stands for the mesh; fetch the mesh itself with: git lfs pull"
    } else if line == b"$NOD" {
        "; this is MSH version 1, convert with: gmsh in.msh -save -format msh41 -o out.msh"
    } else if line.starts_with(b"(") {
        "; this is an Ansys mesh, convert with: meshio convert --input-format ansys --output-format gmsh22 IN.msh OUT.msh, \
         or export an Abaqus .inp with its sets"
    } else if begins(&[b"BEGIN BULK", b"CEND", b"SOL ", b"GRID"]) || has_line(b"GRID") {
        "; this is a Nastran file, convert with: meshio convert --input-format nastran IN OUT.vtu (it needs the line BEGIN BULK)"
    } else if begins(&[b"solid", b"\x89HDF", b"-1"]) {
        "; convert with: gmsh FILE -save -format msh41 -o out.msh"
    } else if begins(&[b"# vtk", b"MeshVersionFormatted", b"NDIME", b"mesh3d", b"OFF", b"ply", b"* GRIDPOINTS"]) {
        "; convert with: meshio convert IN OUT.vtu"
    } else {
        ""
    }
}

fn read_sections(cursor: &mut Cursor, format: Format) -> Result<Raw, Fault> {
    let Format { version, layout } = format;
    let mut raw = Raw::default();
    let mut seen: Vec<String> = Vec::new();
    let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
    let mut stray = 0;
    while let Some((at, line)) = cursor.line() {
        let Some(name) = line.strip_prefix(b"$") else {
            stray += 1;
            continue;
        };
        let Some(name) = std::str::from_utf8(name).ok().filter(|name| is_section_name(name)) else {
            return Err(Fault::unexpected(at, quote(line), "the name of a section"));
        };
        let once = matches!(
            name,
            "MeshFormat"
                | "PhysicalNames"
                | "Entities"
                | "PartitionedEntities"
                | "Nodes"
                | "ParametricNodes"
                | "Elements"
        );
        if once && seen.iter().any(|other| other == name) {
            return Err(Fault::inconsistent(at, format!("section ${name} occurs twice; expected one")));
        }
        seen.push(name.to_owned());
        match (version, name) {
            (_, "PhysicalNames") => {
                raw.names = names::read(cursor)?;
                continue;
            }
            (Version::Two, "Nodes") => v2::read_nodes(cursor, layout, false, &mut raw)?,
            (Version::Two, "ParametricNodes") => v2::read_nodes(cursor, layout, true, &mut raw)?,
            (Version::Two, "Elements") => v2::read_elements(cursor, layout, &mut raw)?,
            (Version::Four, "Nodes") => v4::read_nodes(cursor, layout, &mut raw)?,
            (Version::Four, "Elements") => v4::read_elements(cursor, layout, &mut raw)?,
            (Version::Four, "Entities") => entities::read(cursor, layout, raw.entities.get_or_insert_default())?,
            (Version::Four, "PartitionedEntities") => {
                // parts replace the whole: their tags continue those of the entities they split
                entities::read_partitioned(cursor, layout, raw.entities.get_or_insert_default())?;
            }
            _ if name.starts_with("End") => {
                let expected = "the start of a section; the count at the start of the section before may be wrong";
                return Err(Fault::unexpected(at, quote(line), expected));
            }
            _ => {
                cursor.skip_section(name)?;
                if name != "Comments" {
                    *skipped.entry(name.to_owned()).or_default() += 1;
                }
                continue;
            }
        }
        cursor.end_section(name)?;
    }
    for required in ["Nodes", "Elements"] {
        let parametric = required == "Nodes" && seen.iter().any(|name| name == "ParametricNodes");
        if !parametric && !seen.iter().any(|name| name == required) {
            return Err(Fault::truncated(cursor.bytes.len(), format!("section ${required}")));
        }
    }
    if !skipped.is_empty() {
        let name = |(name, count)| if count == 1 { format!("${name}") } else { format!("${name} ({count} times)") };
        raw.notices.push(format!("section(s) skipped: {}", list(&skipped.into_iter().map(name).collect::<Vec<_>>())));
    }
    if stray > 0 {
        raw.notices.push(format!("{stray} line(s) outside any section were skipped"));
    }
    Ok(raw)
}

fn is_section_name(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|byte| byte.is_ascii_alphanumeric() || byte == b'_')
}
