//! From tags to indices: everything that needs the whole file to be known.

use std::collections::BTreeMap;

use super::element_type::Shape;
use super::error::{Fault, Problem};
use super::raw::{Membership, Raw, Run};
use super::shape_check;
use super::table::Table;
use super::tags::{NodeIndex, repeated_tag};
use crate::{Group, Mesh};

/// Checks a raw mesh against itself and builds the mesh of it.
pub(super) fn assemble(mut raw: Raw, bytes: &[u8]) -> Result<Mesh, Fault> {
    if raw.element_tags.is_empty() {
        return Err(Fault::truncated(bytes.len(), NO_ELEMENTS));
    }
    refuse_unheld_shapes(&mut raw, bytes)?;
    let index = index_nodes(&raw, bytes)?;
    let mut points = Table::<1>::collect(&raw, &index, Shape::Point, bytes)?;
    let mut lines = Table::<2>::collect(&raw, &index, Shape::Line, bytes)?;
    let mut triangles = Table::<3>::collect(&raw, &index, Shape::Triangle, bytes)?;
    let mut quads = Table::<4>::collect(&raw, &index, Shape::Quad, bytes)?;
    let mut tetrahedra = Table::<4>::collect(&raw, &index, Shape::Tetrahedron, bytes)?;
    let mut notices = std::mem::take(&mut raw.notices);

    let node_count = raw.nodes.len();
    let merged = points.merge_duplicates(node_count)
        + lines.merge_duplicates(node_count)
        + triangles.merge_duplicates(node_count)
        + quads.merge_duplicates(node_count)
        + tetrahedra.merge_duplicates(node_count);
    if merged > 0 {
        notices.push(format!("{merged} element(s) occurred again with the same nodes and were merged"));
    }
    refuse_repeated_tags(&raw, [&points.kept, &lines.kept, &triangles.kept, &quads.kept, &tetrahedra.kept], bytes)?;

    shape_check::check_tetrahedra(&raw, &mut tetrahedra, bytes, &mut notices)?;
    shape_check::check_flat(&raw, &mut triangles, &mut quads, tetrahedra.elements.is_empty(), bytes, &mut notices)?;
    shape_check::check_lines(&raw, &lines, bytes)?;
    note_mid_nodes(&raw, &mut notices);

    let groups = build_groups(&raw, &points, &lines, &triangles, &quads, &tetrahedra, &mut notices)?;
    let mut mesh = Mesh {
        nodes: raw.nodes,
        node_tags: raw.node_tags,
        point_tags: points.tags(&raw.element_tags),
        line_tags: lines.tags(&raw.element_tags),
        triangle_tags: triangles.tags(&raw.element_tags),
        quad_tags: quads.tags(&raw.element_tags),
        tetrahedron_tags: tetrahedra.tags(&raw.element_tags),
        points: points.elements,
        lines: lines.elements,
        triangles: triangles.elements,
        quads: quads.elements,
        tetrahedra: tetrahedra.elements,
        groups,
        notices,
    };
    drop_unused_nodes(&mut mesh);
    Ok(mesh)
}

const NO_ELEMENTS: &str = "at least one element; mesh the model before saving it (gmsh -3 in.geo), and where it has \
                           physical groups, put the parts to save into one";

/// The tag-to-index table of the nodes.
fn index_nodes(raw: &Raw, bytes: &[u8]) -> Result<NodeIndex, Fault> {
    if raw.nodes.len() >= u32::MAX as usize || raw.element_tags.len() >= u32::MAX as usize {
        let message = format!(
            "{} nodes and {} elements; fractum holds fewer than 4294967295 of each",
            raw.nodes.len(),
            raw.element_tags.len()
        );
        return Err(Fault::unsupported(bytes.len(), message));
    }
    NodeIndex::new(&raw.node_tags).map_err(|second| {
        let block = raw.node_blocks.partition_point(|(first, _)| *first <= second) - 1;
        let (first, records) = raw.node_blocks[block];
        let message = format!("node tag {} occurs twice; expected each once", raw.node_tags[second]);
        Fault::inconsistent(records.locate(bytes, second - first), message)
    })
}

/// Hexahedra, prisms and pyramids are an error where they are meant to be computed with: in a physical group, or in a
/// file without any. Elsewhere they are skipped.
fn refuse_unheld_shapes(raw: &mut Raw, bytes: &[u8]) -> Result<(), Fault> {
    let any_group = raw.runs.iter().any(|run| !physical_tags(raw, run).is_empty());
    let mut skipped: BTreeMap<Shape, usize> = BTreeMap::new();
    for run in raw.runs.iter().filter(|run| run.kind.shape.corners() == 0) {
        let physical = physical_tags(raw, run);
        if let Some(tag) = physical.first() {
            return Err(unheld(raw, run, &format!(" of group \"{}\"", group_name(raw, 3, *tag)), bytes));
        }
        if !any_group {
            return Err(unheld(raw, run, "", bytes));
        }
        *skipped.entry(run.kind.shape).or_default() += run.count;
    }
    for (shape, count) in skipped {
        raw.notices.push(format!("{} in no physical group skipped", shape.counted(count)));
    }
    Ok(())
}

fn unheld(raw: &Raw, run: &Run, group: &str, bytes: &[u8]) -> Fault {
    let message = format!(
        "element {}{group} is a {}; fractum computes with tetrahedra: mesh the volume without recombination, extruded \
         layers or transfinite blocks (in gmsh remove Recombine and Mesh.RecombineAll), or leave it out of the group",
        raw.element_tags[run.first],
        run.kind.shape.singular()
    );
    Fault::unsupported(run.records.locate(bytes, 0), message)
}

fn refuse_repeated_tags(raw: &Raw, kept: [&[u32]; 5], bytes: &[u8]) -> Result<(), Fault> {
    let Some(second) = repeated_tag(&raw.element_tags, kept) else { return Ok(()) };
    let run = &raw.runs[raw.runs.partition_point(|run| run.first <= second) - 1];
    let message =
        format!("element tag {} occurs twice with different nodes; expected each once", raw.element_tags[second]);
    Err(Fault::inconsistent(run.records.locate(bytes, second - run.first), message))
}

fn note_mid_nodes(raw: &Raw, notices: &mut Vec<String>) {
    let mut counts: BTreeMap<Shape, usize> = BTreeMap::new();
    for run in raw.runs.iter().filter(|run| run.kind.has_mid_nodes()) {
        *counts.entry(run.kind.shape).or_default() += run.count;
    }
    for (shape, count) in counts {
        notices.push(format!(
            "{} of higher order read with corners only: mid nodes dropped, curved sides straight",
            shape.counted(count)
        ));
    }
}

/// Physical tags of a run, without sign.
fn physical_tags(raw: &Raw, run: &Run) -> Vec<i32> {
    match run.membership {
        Membership::Physical(0) => Vec::new(),
        Membership::Physical(tag) => vec![tag.saturating_abs()],
        Membership::Entity(tag) => {
            let entities = raw.entities.as_ref();
            entities.and_then(|map| map.get(&(run.kind.shape.dimension(), tag))).cloned().unwrap_or_default()
        }
    }
}

fn group_name(raw: &Raw, dimension: u8, tag: i32) -> String {
    let named = raw.names.iter().find(|name| (name.dimension, name.tag) == (dimension, tag));
    named.map_or_else(|| format!("physical-{tag}"), |name| name.name.clone())
}

fn build_groups(
    raw: &Raw,
    points: &Table<1>,
    lines: &Table<2>,
    triangles: &Table<3>,
    quads: &Table<4>,
    tetrahedra: &Table<4>,
    notices: &mut Vec<String>,
) -> Result<Vec<Group>, Fault> {
    let mut groups: BTreeMap<(u8, i32), Group> = BTreeMap::new();
    for name in &raw.names {
        let key = (name.dimension, name.tag);
        let group = Group { name: name.name.clone(), dimension: name.dimension, tag: name.tag, ..Group::default() };
        if let Some(other) = groups.insert(key, group) {
            let message = format!(
                "physical tag {} of dimension {} is named \"{}\" and \"{}\"; expected one name",
                name.tag, name.dimension, other.name, name.name
            );
            return Err(Fault { at: name.at, problem: Problem::Inconsistent(message) });
        }
    }
    let mut positions = [0usize; 5];
    for run in &raw.runs {
        let shape = run.kind.shape;
        if shape.corners() == 0 {
            continue;
        }
        let from = positions[shape as usize];
        positions[shape as usize] += run.count;
        for tag in physical_tags(raw, run) {
            let key = (shape.dimension(), tag);
            let group = groups.entry(key).or_insert_with(|| {
                let name = format!("physical-{tag}");
                notices.push(format!("physical group {tag} of dimension {} has no name; called \"{name}\"", key.0));
                Group { name, dimension: key.0, tag, ..Group::default() }
            });
            let range = from..from + run.count;
            match shape {
                Shape::Point => points.push_members(range, &mut group.points),
                Shape::Line => lines.push_members(range, &mut group.lines),
                Shape::Triangle => triangles.push_members(range, &mut group.triangles),
                Shape::Quad => quads.push_members(range, &mut group.quads),
                _ => tetrahedra.push_members(range, &mut group.tetrahedra),
            }
        }
    }
    let mut groups: Vec<Group> = groups.into_values().collect();
    for group in &mut groups {
        for members in
            [&mut group.points, &mut group.lines, &mut group.triangles, &mut group.quads, &mut group.tetrahedra]
        {
            members.sort_unstable();
            members.dedup();
        }
        if group.element_count() == 0 {
            notices.push(format!("group \"{}\" of dimension {} has no elements", group.name, group.dimension));
        }
    }
    Ok(groups)
}

/// Removes the nodes that no element uses; the others keep their order.
fn drop_unused_nodes(mesh: &mut Mesh) {
    let mut used = vec![false; mesh.nodes.len()];
    let mut mark = |nodes: &[u32]| nodes.iter().for_each(|&node| used[node as usize] = true);
    mark(mesh.points.as_flattened());
    mark(mesh.lines.as_flattened());
    mark(mesh.triangles.as_flattened());
    mark(mesh.quads.as_flattened());
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
    renumber(mesh.quads.as_flattened_mut());
    renumber(mesh.tetrahedra.as_flattened_mut());
}
