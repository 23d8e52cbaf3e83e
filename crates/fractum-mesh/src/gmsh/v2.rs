//! Sections of MSH 2.2.

use fractum_math::Vec3;

use super::binary::Layout;
use crate::tagged::cursor::{Cursor, What};
use crate::tagged::element_type::ElementType;
use crate::tagged::error::Fault;
use crate::tagged::raw::{Membership, Raw, Records};

/// Reads `$Nodes`, or `$ParametricNodes` whose lines end with an entity and up to two parameters.
pub(super) fn read_nodes(
    cursor: &mut Cursor,
    layout: Option<Layout>,
    parametric: bool,
    raw: &mut Raw,
) -> Result<(), Fault> {
    let count = read_count(cursor, "the number of nodes")?;
    let room = cursor.capacity(count, if layout.is_some() { 28 } else { 8 });
    raw.node_tags.reserve(room);
    raw.nodes.reserve(room);
    match layout {
        None => read_nodes_ascii(cursor, count, parametric, raw),
        Some(layout) if parametric => read_nodes_parametric(cursor, layout, count, raw),
        Some(layout) => read_nodes_binary(cursor, layout, count, raw),
    }
}

fn read_nodes_ascii(cursor: &mut Cursor, count: u64, parametric: bool, raw: &mut Raw) -> Result<(), Fault> {
    raw.node_blocks.push((raw.nodes.len(), Records { at: cursor.at, stride: 0 }));
    for index in 0..count {
        let what = What { noun: "node", index: index as usize, count: count as usize };
        let mut record = cursor.record(what)?;
        raw.node_tags.push(record.unsigned("the tag")?);
        raw.nodes.push(Vec3::new(record.real("x")?, record.real("y")?, record.real("z")?));
        if !parametric {
            record.end()?;
        }
    }
    Ok(())
}

fn read_nodes_binary(cursor: &mut Cursor, layout: Layout, count: u64, raw: &mut Raw) -> Result<(), Fault> {
    let start = cursor.at;
    let block = cursor.take_records(count, 28, What { noun: "node", index: 0, count: count as usize })?;
    raw.node_blocks.push((raw.nodes.len(), Records { at: start, stride: 28 }));
    for (index, record) in block.chunks_exact(28).enumerate() {
        push_node(raw, layout, record, start + 28 * index)?;
    }
    Ok(())
}

fn read_nodes_parametric(cursor: &mut Cursor, layout: Layout, count: u64, raw: &mut Raw) -> Result<(), Fault> {
    for index in 0..count {
        let what = What { noun: "parametric node", index: index as usize, count: count as usize };
        let start = cursor.at;
        let record = cursor.take(36, what)?;
        raw.node_blocks.push((raw.nodes.len(), Records { at: start, stride: 36 }));
        push_node(raw, layout, record, start)?;
        let parameters = match layout.i32(&record[28..32]) {
            0 | 3 => 0,
            1 => 1,
            2 => 2,
            other => {
                let found = format!("a node on an entity of dimension {other}");
                return Err(Fault::unexpected(start + 28, found, "0 to 3"));
            }
        };
        cursor.take(8 * parameters, what)?;
    }
    Ok(())
}

fn push_node(raw: &mut Raw, layout: Layout, record: &[u8], at: usize) -> Result<(), Fault> {
    raw.node_tags.push(positive(layout.i32(&record[..4]), at, "node tag")?);
    let position = Vec3::from_fn(|axis, _| layout.f64(&record[4 + 8 * axis..12 + 8 * axis]));
    if !position.iter().all(|x| x.is_finite()) {
        return Err(Fault::unexpected(at + 4, format!("coordinates {:?}", position.data.0[0]), "finite numbers"));
    }
    raw.nodes.push(position);
    Ok(())
}

/// Reads `$Elements`.
pub(super) fn read_elements(cursor: &mut Cursor, layout: Option<Layout>, raw: &mut Raw) -> Result<(), Fault> {
    let count = read_count(cursor, "the number of elements")?;
    match layout {
        None => read_elements_ascii(cursor, count, raw),
        Some(layout) => read_elements_binary(cursor, layout, count, raw),
    }
}

fn read_elements_ascii(cursor: &mut Cursor, count: u64, raw: &mut Raw) -> Result<(), Fault> {
    raw.element_tags.reserve(cursor.capacity(count, 8));
    raw.corners.reserve(4 * cursor.capacity(count, 16));
    for index in 0..count {
        let what = What { noun: "element", index: index as usize, count: count as usize };
        let mut record = cursor.record(what)?;
        let at = record.at();
        let tag = record.unsigned("the tag")?;
        let code = record.integer("the type")?;
        let kind = element_type(code, at)?;
        let tag_count = record.unsigned("the number of tags")?;
        let mut physical = 0;
        for index in 0..tag_count {
            let value = record.integer32("a tag")?;
            if index == 0 {
                physical = value.saturating_abs(); // negative: the group sees the element reversed
            }
        }
        raw.extend_runs(kind, Membership::Physical(physical), Records { at, stride: 0 });
        raw.element_tags.push(tag);
        for corner in 0..kind.nodes {
            let node = record.unsigned("a node")?;
            if corner < kind.shape.corners() {
                raw.corners.push(node);
            }
        }
        record.end()?;
    }
    Ok(())
}

fn read_elements_binary(cursor: &mut Cursor, layout: Layout, count: u64, raw: &mut Raw) -> Result<(), Fault> {
    let what = What { noun: "element", index: 0, count: count as usize };
    let room = cursor.capacity(count, 8);
    raw.element_tags.reserve(room);
    raw.corners.reserve(4 * cursor.capacity(count, 20));
    let mut read = 0u64;
    while read < count {
        let what = What { index: read as usize, ..what };
        let header_at = cursor.at;
        let header = cursor.take(12, what)?;
        let [code, batch, tag_count] = [0, 4, 8].map(|from| layout.i32(&header[from..from + 4]));
        let kind = element_type(code.into(), header_at)?;
        if batch <= 0 || batch as u64 > count - read {
            let expected = format!("1 to {} (of {count} elements, {read} are read)", count - read);
            return Err(Fault::unexpected(header_at + 4, format!("a block of {batch} elements"), expected));
        }
        let Ok(tag_count) = usize::try_from(tag_count) else {
            return Err(Fault::unexpected(header_at + 8, format!("{tag_count} tags per element"), "at least 0"));
        };
        let stride = 4 * (1 + tag_count + kind.nodes);
        let start = cursor.at;
        let block = cursor.take_records(batch as u64, stride, what)?;
        push_elements(raw, layout, kind, tag_count, block, start)?;
        read += batch as u64;
    }
    Ok(())
}

/// Appends a block of equal records; a change of the physical tag starts a new run.
fn push_elements(
    raw: &mut Raw,
    layout: Layout,
    kind: ElementType,
    tag_count: usize,
    block: &[u8],
    start: usize,
) -> Result<(), Fault> {
    let stride = 4 * (1 + tag_count + kind.nodes);
    let first_node = 4 * (1 + tag_count);
    let last_corner = first_node + 4 * kind.shape.corners();
    let mut current = None;
    for (index, record) in block.chunks_exact(stride).enumerate() {
        let at = start + index * stride;
        let physical = if tag_count == 0 { 0 } else { layout.i32(&record[4..8]).saturating_abs() };
        if current == Some(physical) {
            raw.runs.last_mut().expect("a run is open").count += 1;
        } else {
            raw.push_run(kind, Membership::Physical(physical), 1, Records { at, stride });
            current = Some(physical);
        }
        raw.element_tags.push(positive(layout.i32(&record[..4]), at, "element tag")?);
        for node in record[first_node..last_corner].chunks_exact(4) {
            raw.corners.push(positive(layout.i32(node), at, "node tag")?);
        }
    }
    Ok(())
}

fn read_count(cursor: &mut Cursor, noun: &'static str) -> Result<u64, Fault> {
    let mut record = cursor.record(What::one(noun))?;
    let count = record.unsigned("the count")?;
    record.end()?;
    Ok(count)
}

fn positive(tag: i32, at: usize, noun: &str) -> Result<u64, Fault> {
    u64::try_from(tag).map_err(|_| Fault::unexpected(at, format!("{noun} {tag}"), "at least 0"))
}

/// The element type of a number, or the refusal that names it.
pub(super) fn element_type(code: i64, at: usize) -> Result<ElementType, Fault> {
    u64::try_from(code).ok().and_then(ElementType::from_code).ok_or_else(|| {
        let name = ElementType::name_of_unknown(code);
        let expected = "points, lines, triangles, quadrilaterals, tetrahedra, hexahedra, prisms or pyramids; mesh the part again with these";
        Fault::unexpected(at, name, expected)
    })
}
