use std::collections::BTreeMap;
use std::io::{self, Write};

use fractum_math::Ragged;

use super::sink::Sink;
use crate::{Group, Mesh};

/// Version and encoding of a mesh file; binary is little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MshFormat {
    /// MSH 2.2 as text.
    V2_2Ascii,
    /// MSH 2.2, binary.
    V2_2Binary,
    /// MSH 4.1 as text.
    V4_1Ascii,
    /// MSH 4.1, binary with words of eight bytes.
    V4_1Binary,
}

impl MshFormat {
    fn is_binary(self) -> bool {
        matches!(self, MshFormat::V2_2Binary | MshFormat::V4_1Binary)
    }
}

/// Writes a mesh in the Gmsh format.
///
/// Nodes and elements keep their order and tags, so that reading the file gives an equal mesh; only MSH 2.2, which
/// lists an element once per group, adds tags for the repetitions.
///
/// # Errors
/// Those of `out`; and [`io::ErrorKind::InvalidInput`] for what the format cannot hold: a name with a quote or a line
/// break, a group tag below 1 or used twice in a dimension, a group member, a node or a tag list that does not
/// fit the arrays, a tag beyond 32 bits in MSH 2.2.
pub fn write_msh(mesh: &Mesh, format: MshFormat, out: &mut impl Write) -> io::Result<()> {
    check_groups(mesh)?;
    let families = families(mesh)?;
    let mut sink = Sink::new(out, format.is_binary());
    match format {
        MshFormat::V2_2Ascii | MshFormat::V2_2Binary => {
            write_header(&mut sink, "2.2")?;
            write_names(&mut sink, mesh)?;
            write_v2(&mut sink, mesh, &families)?;
        }
        MshFormat::V4_1Ascii | MshFormat::V4_1Binary => {
            write_header(&mut sink, "4.1")?;
            write_names(&mut sink, mesh)?;
            write_v4(&mut sink, mesh, &families)?;
        }
    }
    sink.flush()
}

/// Elements of one shape as the file wants them.
struct Family<'a> {
    code: i32,
    dimension: u8,
    /// Nodes per element.
    size: usize,
    nodes: &'a [u32],
    tags: &'a [u64],
    /// Groups of each element, as indices into [`Mesh::groups`].
    groups: Ragged,
}

/// The elements of each shape.
fn families(mesh: &Mesh) -> io::Result<[Family<'_>; 4]> {
    let members = |select: fn(&Group) -> &Vec<u32>| mesh.groups.iter().map(move |group| select(group).as_slice());
    let node_count = mesh.nodes.len();
    Ok([
        family(15, 0, mesh.points.as_flattened(), 1, &mesh.point_tags, node_count, members(|group| &group.points))?,
        family(1, 1, mesh.lines.as_flattened(), 2, &mesh.line_tags, node_count, members(|group| &group.lines))?,
        family(
            2,
            2,
            mesh.triangles.as_flattened(),
            3,
            &mesh.triangle_tags,
            node_count,
            members(|group| &group.triangles),
        )?,
        family(
            4,
            3,
            mesh.tetrahedra.as_flattened(),
            4,
            &mesh.tetrahedron_tags,
            node_count,
            members(|group| &group.tetrahedra),
        )?,
    ])
}

fn family<'a>(
    code: i32,
    dimension: u8,
    nodes: &'a [u32],
    size: usize,
    tags: &'a [u64],
    node_count: usize,
    members: impl Iterator<Item = &'a [u32]> + Clone,
) -> io::Result<Family<'a>> {
    let count = nodes.len() / size;
    if tags.len() != count {
        return Err(invalid(format!("{count} elements of Gmsh type {code} have {} tags", tags.len())));
    }
    if let Some(member) = members.clone().flatten().find(|&&member| member as usize >= count) {
        return Err(invalid(format!("a group names element {member} of {count} of Gmsh type {code}")));
    }
    if let Some(node) = nodes.iter().find(|&&node| node as usize >= node_count) {
        return Err(invalid(format!("an element of Gmsh type {code} names node {node} of {node_count}")));
    }
    Ok(Family { code, dimension, size, nodes, tags, groups: Ragged::inverse(count, members) })
}

fn check_groups(mesh: &Mesh) -> io::Result<()> {
    let mut names = BTreeMap::new();
    for group in &mesh.groups {
        if group.name.contains(['"', '\n', '\r']) {
            return Err(invalid(format!("group name {:?} holds a quote or a line break", group.name)));
        }
        if group.tag < 1 || group.dimension > 3 {
            let (tag, dimension) = (group.tag, group.dimension);
            return Err(invalid(format!("group \"{}\" has tag {tag} and dimension {dimension}", group.name)));
        }
        if let Some(other) = names.insert((group.dimension, group.tag), &group.name) {
            let message = format!("groups \"{other}\" and \"{}\" have the same tag {}", group.name, group.tag);
            return Err(invalid(message));
        }
        let lists = [(0, &group.points), (1, &group.lines), (2, &group.triangles), (3, &group.tetrahedra)];
        for (dimension, members) in lists {
            if dimension != group.dimension && !members.is_empty() {
                let message = format!(
                    "group \"{}\" of dimension {} has elements of dimension {dimension}",
                    group.name, group.dimension
                );
                return Err(invalid(message));
            }
        }
    }
    if mesh.node_tags.len() != mesh.nodes.len() {
        return Err(invalid(format!("{} nodes have {} tags", mesh.nodes.len(), mesh.node_tags.len())));
    }
    Ok(())
}

fn write_header(sink: &mut Sink<impl Write>, version: &str) -> io::Result<()> {
    sink.text(&format!("$MeshFormat\n{version} {} 8\n", u8::from(sink.is_binary())))?;
    if sink.is_binary() {
        sink.int(1)?;
        sink.end_block()?;
    }
    sink.text("$EndMeshFormat\n")
}

fn write_names(sink: &mut Sink<impl Write>, mesh: &Mesh) -> io::Result<()> {
    if mesh.groups.is_empty() {
        return Ok(());
    }
    sink.text(&format!("$PhysicalNames\n{}\n", mesh.groups.len()))?;
    for group in &mesh.groups {
        sink.text(&format!("{} {} \"{}\"\n", group.dimension, group.tag, group.name))?;
    }
    sink.text("$EndPhysicalNames\n")
}

fn write_v2(sink: &mut Sink<impl Write>, mesh: &Mesh, families: &[Family; 4]) -> io::Result<()> {
    sink.text(&format!("$Nodes\n{}\n", mesh.nodes.len()))?;
    for (position, &tag) in mesh.nodes.iter().zip(&mesh.node_tags) {
        sink.int(tag_32(tag)?)?;
        for &x in position {
            sink.real(x)?;
        }
        sink.end_record()?;
    }
    sink.end_block()?;
    sink.text("$EndNodes\n")?;

    let listings = |family: &Family| family.groups.rows().map(|groups| groups.len().max(1)).sum::<usize>();
    sink.text(&format!("$Elements\n{}\n", families.iter().map(listings).sum::<usize>()))?;
    let mut fresh = families.iter().flat_map(|family| family.tags).copied().max().unwrap_or(0);
    for family in families {
        if sink.is_binary() && !family.tags.is_empty() {
            for number in [family.code, listings(family) as i32, 2] {
                sink.int(number)?;
            }
        }
        for (element, nodes) in family.nodes.chunks_exact(family.size).enumerate() {
            let groups = family.groups.row(element);
            for listing in 0..groups.len().max(1) {
                let mut tag = family.tags[element];
                if listing > 0 {
                    fresh = fresh.saturating_add(1);
                    tag = fresh;
                }
                let physical = groups.get(listing).map_or(0, |&group| mesh.groups[group as usize].tag);
                sink.int(tag_32(tag)?)?;
                if !sink.is_binary() {
                    sink.int(family.code)?;
                    sink.int(2)?;
                }
                sink.int(physical)?;
                sink.int(physical.max(1))?; // the elementary entity: one per group will do
                for &node in nodes {
                    sink.int(tag_32(mesh.node_tags[node as usize])?)?;
                }
                sink.end_record()?;
            }
        }
    }
    sink.end_block()?;
    sink.text("$EndElements\n")
}

fn write_v4(sink: &mut Sink<impl Write>, mesh: &Mesh, families: &[Family; 4]) -> io::Result<()> {
    // one entity per dimension and set of groups, numbered as they first occur
    let mut entities: [BTreeMap<&[u32], i32>; 4] = Default::default();
    let mut blocks: Vec<(usize, i32, usize, usize)> = Vec::new(); // family, entity, first element, count
    for (number, family) in families.iter().enumerate() {
        let known = &mut entities[family.dimension as usize];
        for (element, groups) in family.groups.rows().enumerate() {
            match blocks.last_mut() {
                Some((last, _, first, count)) if *last == number && family.groups.row(*first) == groups => *count += 1,
                _ => {
                    let next = known.len() as i32 + 1;
                    let entity = *known.entry(groups).or_insert(next);
                    blocks.push((number, entity, element, 1));
                }
            }
        }
    }
    write_entities(sink, mesh, &entities)?;
    write_v4_nodes(sink, mesh, &entities)?;

    sink.text("$Elements\n")?;
    let tags = || families.iter().flat_map(|family| family.tags).copied();
    write_totals(sink, blocks.len(), tags())?;
    for (number, entity, first, count) in blocks {
        let family = &families[number];
        for value in [family.dimension.into(), entity, family.code] {
            sink.int(value)?;
        }
        sink.word(count as u64)?;
        sink.end_record()?;
        let nodes = &family.nodes[first * family.size..(first + count) * family.size];
        for (element, nodes) in nodes.chunks_exact(family.size).enumerate() {
            sink.word(family.tags[first + element])?;
            for &node in nodes {
                sink.word(mesh.node_tags[node as usize])?;
            }
            sink.end_record()?;
        }
    }
    sink.end_block()?;
    sink.text("$EndElements\n")
}

fn write_entities(sink: &mut Sink<impl Write>, mesh: &Mesh, entities: &[BTreeMap<&[u32], i32>; 4]) -> io::Result<()> {
    sink.text("$Entities\n")?;
    for known in entities {
        sink.word(known.len() as u64)?;
    }
    sink.end_record()?;
    let (low, high) = mesh.bounding_box();
    for (dimension, known) in entities.iter().enumerate() {
        let mut ordered: Vec<_> = known.iter().map(|(groups, entity)| (*entity, *groups)).collect();
        ordered.sort_unstable();
        for (entity, groups) in ordered {
            sink.int(entity)?;
            for &x in low.iter().chain(high.iter().filter(|_| dimension > 0)) {
                sink.real(x)?;
            }
            sink.word(groups.len() as u64)?;
            for &group in groups {
                sink.int(mesh.groups[group as usize].tag)?;
            }
            if dimension > 0 {
                sink.word(0)?;
            }
            sink.end_record()?;
        }
    }
    sink.end_block()?;
    sink.text("$EndEntities\n")
}

fn write_v4_nodes(sink: &mut Sink<impl Write>, mesh: &Mesh, entities: &[BTreeMap<&[u32], i32>; 4]) -> io::Result<()> {
    sink.text("$Nodes\n")?;
    let highest = entities.iter().rposition(|known| !known.is_empty());
    write_totals(sink, usize::from(highest.is_some()), mesh.node_tags.iter().copied())?;
    if let Some(dimension) = highest {
        for value in [dimension as i32, 1, 0] {
            sink.int(value)?;
        }
        sink.word(mesh.nodes.len() as u64)?;
        sink.end_record()?;
        for &tag in &mesh.node_tags {
            sink.word(tag)?;
            sink.end_record()?;
        }
        for position in &mesh.nodes {
            for &x in position {
                sink.real(x)?;
            }
            sink.end_record()?;
        }
    }
    sink.end_block()?;
    sink.text("$EndNodes\n")
}

/// Number of blocks and of items, lowest and highest tag.
fn write_totals(sink: &mut Sink<impl Write>, blocks: usize, tags: impl Iterator<Item = u64> + Clone) -> io::Result<()> {
    sink.word(blocks as u64)?;
    sink.word(tags.clone().count() as u64)?;
    sink.word(tags.clone().min().unwrap_or(0))?;
    sink.word(tags.max().unwrap_or(0))?;
    sink.end_record()
}

fn tag_32(tag: u64) -> io::Result<i32> {
    i32::try_from(tag).map_err(|_| invalid(format!("tag {tag} does not fit into the 32 bits of MSH 2.2")))
}

fn invalid(message: String) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidInput, message)
}
