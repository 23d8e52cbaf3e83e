//! From tags to indices: everything that needs the whole file to be known.

use std::collections::BTreeMap;

use super::element_type::Shape;
use super::error::Fault;
use super::raw::Raw;
use super::split::split;
use super::table::{Table, Tables};
use super::tags::{NodeIndex, repeated_tag};
use super::{groups, shape_check};
use crate::Mesh;

/// Checks a raw mesh against itself and builds the mesh of it.
pub(crate) fn assemble(mut raw: Raw, bytes: &[u8]) -> Result<Mesh, Fault> {
    if raw.element_tags.is_empty() {
        return Err(Fault::truncated(bytes.len(), NO_ELEMENTS));
    }
    groups::limit_memberships(&raw, bytes)?;
    let mut notices = std::mem::take(&mut raw.notices);
    let index = index_nodes(&raw, bytes)?;
    let higher_order = split(&mut raw, &index, bytes, &mut notices)?;
    let mut tables = Tables {
        points: Table::collect(&raw, &index, Shape::Point, bytes)?,
        lines: Table::collect(&raw, &index, Shape::Line, bytes)?,
        triangles: Table::collect(&raw, &index, Shape::Triangle, bytes)?,
        tetrahedra: Table::collect(&raw, &index, Shape::Tetrahedron, bytes)?,
    };
    let merged = tables.merge_duplicates(raw.nodes.len());
    if merged > 0 {
        notices.push(format!("{merged} repeated listing(s) of an element merged with the first"));
    }
    refuse_repeated_tags(&raw, tables.kept(), bytes)?;

    shape_check::check_tetrahedra(&raw, &mut tables.tetrahedra, bytes, &mut notices)?;
    shape_check::check_flat(&raw, &mut tables, bytes, &mut notices)?;
    shape_check::check_lines(&raw, &tables.lines, bytes)?;
    note_mid_nodes(&raw, tables.kept(), higher_order, &mut notices);

    let groups = groups::build(&raw, &tables, bytes, &mut notices)?;
    let Tables { points, lines, triangles, tetrahedra } = tables;
    let mut mesh = Mesh {
        nodes: raw.nodes,
        node_tags: raw.node_tags,
        point_tags: points.tags(&raw.element_tags),
        line_tags: lines.tags(&raw.element_tags),
        triangle_tags: triangles.tags(&raw.element_tags),
        tetrahedron_tags: tetrahedra.tags(&raw.element_tags),
        points: points.elements,
        lines: lines.elements,
        triangles: triangles.elements,
        tetrahedra: tetrahedra.elements,
        groups,
        notices,
        ..Mesh::default()
    };
    drop_unused_nodes(&mut mesh);
    Ok(mesh)
}

const NO_ELEMENTS: &str = "at least one element; mesh the model before saving it (gmsh -3 in.geo), and where it has \
                           physical groups, put the parts to save into one";

/// The tag-to-index table of the nodes.
fn index_nodes(raw: &Raw, bytes: &[u8]) -> Result<NodeIndex, Fault> {
    raw.limit_counts(bytes)?;
    NodeIndex::new(&raw.node_tags).map_err(|second| {
        let block = raw.node_blocks.partition_point(|(first, _)| *first <= second) - 1;
        let (first, records) = raw.node_blocks[block];
        let message = format!("node tag {} occurs twice; expected each once", raw.node_tags[second]);
        Fault::inconsistent(records.locate(bytes, second - first), message)
    })
}

fn refuse_repeated_tags(raw: &Raw, kept: [&[u32]; 5], bytes: &[u8]) -> Result<(), Fault> {
    let Some(second) = repeated_tag(&raw.element_tags, kept) else { return Ok(()) };
    let run = &raw.runs[raw.runs.partition_point(|run| run.first <= second) - 1];
    let message =
        format!("element tag {} occurs twice with different nodes; expected each once", raw.element_tags[second]);
    Err(Fault::inconsistent(run.locate(bytes, second - run.first), message))
}

/// - `counts`: elements of higher order that were split
fn note_mid_nodes(raw: &Raw, kept: [&[u32]; 5], mut counts: BTreeMap<Shape, usize>, notices: &mut Vec<String>) {
    for run in raw.runs.iter().filter(|run| run.kind.has_mid_nodes()) {
        let below = |end: usize| kept[run.kind.shape as usize].partition_point(|&index| (index as usize) < end);
        *counts.entry(run.kind.shape).or_default() += below(run.first + run.count) - below(run.first);
    }
    let counted: Vec<String> = counts.into_iter().map(|(shape, count)| shape.counted(count)).collect();
    if !counted.is_empty() {
        let list = counted.join(", ");
        notices
            .push(format!("{list} of higher order read with corners only: mid nodes dropped, curved sides straight"));
    }
}

/// Removes the nodes that no element uses; the others keep their order.
fn drop_unused_nodes(mesh: &mut Mesh) {
    let mut used = vec![false; mesh.nodes.len()];
    let mut mark = |nodes: &[u32]| nodes.iter().for_each(|&node| used[node as usize] = true);
    mark(mesh.points.as_flattened());
    mark(mesh.lines.as_flattened());
    mark(mesh.triangles.as_flattened());
    mark(mesh.tetrahedra.as_flattened());
    let unused = used.iter().filter(|&&used| !used).count();
    if unused == 0 {
        return;
    }
    mesh.notices.push(format!("{unused} node(s) that no element uses were dropped"));
    let mut new_index = vec![0u32; used.len()];
    let mut next = 0;
    for (node, &used) in used.iter().enumerate() {
        new_index[node] = next;
        next += u32::from(used);
    }
    let mut keep = used.iter();
    mesh.nodes.retain(|_| *keep.next().expect("one flag per node"));
    let mut keep = used.iter();
    mesh.node_tags.retain(|_| *keep.next().expect("one flag per node"));
    let renumber = |nodes: &mut [u32]| nodes.iter_mut().for_each(|node| *node = new_index[*node as usize]);
    renumber(mesh.points.as_flattened_mut());
    renumber(mesh.lines.as_flattened_mut());
    renumber(mesh.triangles.as_flattened_mut());
    renumber(mesh.tetrahedra.as_flattened_mut());
}
