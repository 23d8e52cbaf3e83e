//! Sections of MSH 4.1 that hold nodes and elements; [`super::entities`] reads those that hold entities.

use fractum_math::Vec3;

use super::binary::Layout;
use super::v2::element_type;
use crate::tagged::cursor::{Cursor, What};
use crate::tagged::element_type::ElementType;
use crate::tagged::error::Fault;
use crate::tagged::raw::{Membership, Raw, Records};

/// Reads `$Nodes`.
pub(super) fn read_nodes(cursor: &mut Cursor, layout: Option<Layout>, raw: &mut Raw) -> Result<(), Fault> {
    let header_at = cursor.at;
    let [blocks, count] = read_totals(cursor, layout, "the totals of the nodes")?;
    let room = cursor.capacity(count, if layout.is_some() { 28 } else { 8 });
    raw.node_tags.reserve(room);
    raw.nodes.reserve(room);
    for _ in 0..blocks {
        let block_at = cursor.at;
        let (dimension, _, parametric, block_count) = read_block_header(cursor, layout, "a block of nodes")?;
        if !(0..=3).contains(&dimension) {
            return Err(Fault::unexpected(block_at, format!("nodes on an entity of dimension {dimension}"), "0 to 3"));
        }
        let parameters = match parametric {
            0 => 0,
            1 => dimension as usize,
            other => return Err(Fault::unexpected(block_at, format!("parametric = {other}"), "0 or 1")),
        };
        match layout {
            None => read_node_block_ascii(cursor, block_count, parameters, raw)?,
            Some(layout) => read_node_block_binary(cursor, layout, block_count, parameters, raw)?,
        }
    }
    compare_totals(header_at, "nodes", raw.nodes.len(), count)
}

fn read_node_block_ascii(cursor: &mut Cursor, count: u64, parameters: usize, raw: &mut Raw) -> Result<(), Fault> {
    raw.node_blocks.push((raw.nodes.len(), Records { at: cursor.at, stride: 0 }));
    let what = |noun, index: u64| What { noun, index: index as usize, count: count as usize };
    for index in 0..count {
        let mut record = cursor.record(what("node tag", index))?;
        raw.node_tags.push(record.unsigned("the tag")?);
        record.end()?;
    }
    for index in 0..count {
        let mut record = cursor.record(what("node coordinates", index))?;
        raw.nodes.push(Vec3::new(record.real("x")?, record.real("y")?, record.real("z")?));
        for _ in 0..parameters {
            record.real("a parameter")?;
        }
        record.end()?;
    }
    Ok(())
}

fn read_node_block_binary(
    cursor: &mut Cursor,
    layout: Layout,
    count: u64,
    parameters: usize,
    raw: &mut Raw,
) -> Result<(), Fault> {
    let what = |noun| What { noun, index: 0, count: count as usize };
    raw.node_blocks.push((raw.nodes.len(), Records { at: cursor.at, stride: layout.word }));
    let tags = cursor.take_records(count, layout.word, what("node tag"))?;
    raw.node_tags.extend(tags.chunks_exact(layout.word).map(|tag| layout.word(tag)));
    let stride = 8 * (3 + parameters);
    let start = cursor.at;
    let coordinates = cursor.take_records(count, stride, what("node coordinates"))?;
    for (index, record) in coordinates.chunks_exact(stride).enumerate() {
        let [x, y, z] = [0, 8, 16].map(|from| layout.f64(&record[from..from + 8]));
        if !(x.is_finite() && y.is_finite() && z.is_finite()) {
            let found = format!("coordinates {x} {y} {z}");
            return Err(Fault::unexpected(start + index * stride, found, "finite numbers"));
        }
        raw.nodes.push(Vec3::new(x, y, z));
    }
    Ok(())
}

/// Reads `$Elements`.
pub(super) fn read_elements(cursor: &mut Cursor, layout: Option<Layout>, raw: &mut Raw) -> Result<(), Fault> {
    let header_at = cursor.at;
    let [blocks, count] = read_totals(cursor, layout, "the totals of the elements")?;
    let room = cursor.capacity(count, if layout.is_some() { 8 } else { 4 });
    raw.element_tags.reserve(room);
    raw.corners.reserve(4 * cursor.capacity(count, if layout.is_some() { 20 } else { 10 }));
    for _ in 0..blocks {
        let block_at = cursor.at;
        let (dimension, entity, code, block_count) = read_block_header(cursor, layout, "a block of elements")?;
        let kind = element_type(code.into(), block_at)?;
        if i64::from(dimension) != i64::from(kind.shape.dimension()) {
            let found = format!("a block of {} on an entity of dimension {dimension}", kind.shape.plural());
            return Err(Fault::unexpected(block_at, found, format!("dimension {}", kind.shape.dimension())));
        }
        let stride = layout.map_or(0, |layout| layout.word * (1 + kind.nodes));
        let (first, records) = (raw.element_tags.len(), Records { at: cursor.at, stride });
        raw.push_run(kind, Membership::Entity(entity), 0, records);
        match layout {
            None => read_element_block_ascii(cursor, block_count, kind, raw)?,
            Some(layout) => read_element_block_binary(cursor, layout, block_count, kind, raw)?,
        }
        raw.runs.last_mut().expect("pushed above").count = raw.element_tags.len() - first;
    }
    compare_totals(header_at, "elements", raw.element_tags.len(), count)
}

fn read_element_block_ascii(cursor: &mut Cursor, count: u64, kind: ElementType, raw: &mut Raw) -> Result<(), Fault> {
    for index in 0..count {
        let mut record = cursor.record(What { noun: "element", index: index as usize, count: count as usize })?;
        raw.element_tags.push(record.unsigned("the tag")?);
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

fn read_element_block_binary(
    cursor: &mut Cursor,
    layout: Layout,
    count: u64,
    kind: ElementType,
    raw: &mut Raw,
) -> Result<(), Fault> {
    let stride = layout.word * (1 + kind.nodes);
    let block = cursor.take_records(count, stride, What { noun: "element", index: 0, count: count as usize })?;
    for record in block.chunks_exact(stride) {
        let mut words = record.chunks_exact(layout.word).map(|word| layout.word(word));
        raw.element_tags.extend(words.next());
        raw.corners.extend(words.take(kind.shape.corners()));
    }
    Ok(())
}

/// Number of blocks and of items; the extreme tags that follow are not needed.
fn read_totals(cursor: &mut Cursor, layout: Option<Layout>, noun: &'static str) -> Result<[u64; 2], Fault> {
    match layout {
        None => {
            let mut record = cursor.record(What::one(noun))?;
            let totals = [record.unsigned("the number of blocks")?, record.unsigned("the count")?];
            record.unsigned("the lowest tag")?;
            record.unsigned("the highest tag")?;
            record.end()?;
            Ok(totals)
        }
        Some(layout) => {
            let block = cursor.take(4 * layout.word, What::one(noun))?;
            Ok([layout.word(&block[..layout.word]), layout.word(&block[layout.word..2 * layout.word])])
        }
    }
}

/// Dimension, entity, third number (parametric flag or element type) and count of a block.
fn read_block_header(
    cursor: &mut Cursor,
    layout: Option<Layout>,
    noun: &'static str,
) -> Result<(i32, i32, i32, u64), Fault> {
    match layout {
        None => {
            let mut record = cursor.record(What::one(noun))?;
            let [dimension, entity, third] =
                [record.integer32("the dimension")?, record.integer32("the entity")?, record.integer32("the type")?];
            let count = record.unsigned("the count")?;
            record.end()?;
            Ok((dimension, entity, third, count))
        }
        Some(layout) => {
            let block = cursor.take(12, What::one(noun))?;
            let [dimension, entity, third] = [0, 4, 8].map(|from| layout.i32(&block[from..from + 4]));
            Ok((dimension, entity, third, layout.take_word(cursor, noun)?))
        }
    }
}

fn compare_totals(at: usize, noun: &str, read: usize, announced: u64) -> Result<(), Fault> {
    if read as u64 == announced {
        return Ok(());
    }
    Err(Fault::inconsistent(at, format!("the section announces {announced} {noun}, its blocks hold {read}")))
}
