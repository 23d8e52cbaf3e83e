//! Quadrilaterals as triangles; hexahedra, prisms and pyramids as tetrahedra.
//!
//! Every face of four corners is cut from the least of its nodes, so that whatever meets there has the same diagonal: both
//! elements at a face, and quadrilaterals upon it. A solid is cut from its least node: it makes a tetrahedron with each
//! triangle of the faces that lie opposite. (J. Dompierre, P. Labbé, M.-G. Vallet, R. Camarero: How to subdivide pyramids,
//! prisms, and hexahedra into tetrahedra, 8th International Meshing Roundtable, 1999.) Nodes in one place count as the least
//! of them, so that bodies with nodes of their own fit together too.

use std::collections::BTreeMap;

use fractum_math::{Vec3, connected};

use super::element_type::{ElementType, Shape};
use super::error::{Fault, Problem};
use super::raw::{Raw, Run};
use super::shape_check::has_volume;
use super::table::missing_node;
use super::tags::NodeIndex;
use crate::Mesh;
use crate::coincident::same_places;
use crate::quality::{area_vector, signed_volume};

/// What the tag of the second piece of an element has above that of the first, which is the element's own; the same in all files of a mesh.
const TAG_STEP: u64 = 1_000_000_000_000;

/// Puts simplices in the place of all other elements, in the same groups; returns how many of them were of higher order.
pub(super) fn split(
    raw: &mut Raw,
    index: &NodeIndex,
    bytes: &[u8],
    notices: &mut Vec<String>,
) -> Result<BTreeMap<Shape, usize>, Fault> {
    let mut higher_order: BTreeMap<Shape, usize> = BTreeMap::new();
    if raw.runs.iter().all(|run| simplex(run.kind.shape).is_none()) {
        return Ok(higher_order);
    }
    let places = same_places(&Mesh { nodes: raw.nodes.clone(), ..Mesh::default() });
    let joined = join_collapsed(raw, index, &places);
    let rank = |node: u32| [places[node as usize], node].map(|node| raw.node_tags[node as usize]);
    let mut counts: BTreeMap<Shape, (usize, usize)> = BTreeMap::new();
    let mut pieces: Vec<Piece> = Vec::new();
    let (mut runs, mut element_tags, mut corners): (Vec<Run>, Vec<u64>, Vec<u64>) = Default::default();
    for run in &raw.runs {
        let size = run.kind.shape.corners();
        let of_run = &raw.corners[run.first_corner..run.first_corner + size * run.count];
        let tags = &raw.element_tags[run.first..run.first + run.count];
        let (first, first_corner) = (element_tags.len(), corners.len());
        let mut kind = run.kind;
        let mut sources = run.pieces.clone();
        match simplex(run.kind.shape) {
            None => {
                corners.extend_from_slice(of_run);
                element_tags.extend_from_slice(tags);
            }
            Some(shape) => {
                kind = ElementType { shape, nodes: shape.corners() };
                let sources = sources.insert(Vec::new());
                for (element, of_element) in of_run.chunks_exact(size).enumerate() {
                    let missing = || missing_node(raw, index, run, element, of_element, bytes);
                    let mut nodes = [0u32; 8];
                    for (node, &tag) in nodes.iter_mut().zip(of_element) {
                        *node = index.find(tag).ok_or_else(missing)?;
                    }
                    let nodes = &nodes[..size];
                    cut(run.kind.shape, nodes, rank, &mut pieces);
                    if !turn_outside_out(run.kind.shape, &mut pieces, &raw.nodes) {
                        return Err(inverted(raw, run, element, nodes, bytes));
                    }
                    for (number, piece) in (0..).zip(&pieces) {
                        corners.extend(piece[..shape.corners()].iter().map(|&node| raw.node_tags[node as usize]));
                        element_tags.push(tags[element].wrapping_add(number * TAG_STEP));
                        sources.push(element as u32);
                    }
                }
                let count = counts.entry(run.kind.shape).or_default();
                *count = (count.0 + run.count, count.1 + sources.len());
                if run.kind.has_mid_nodes() {
                    *higher_order.entry(run.kind.shape).or_default() += run.count;
                }
            }
        }
        let (membership, records, count) = (run.membership, run.records, element_tags.len() - first);
        runs.push(Run { kind, membership, count, first, first_corner, records, pieces: sources });
    }
    (raw.runs, raw.element_tags, raw.corners) = (runs, element_tags, corners);
    raw.limit_counts(bytes)?;
    notices.push(told(&counts));
    if joined > 0 {
        notices.push(format!(
            "{joined} corners that lie in the place of another one of their element are one node with it"
        ));
    }
    Ok(higher_order)
}

/// Makes one node of the corners of an element that lie in one place, as at the axis around which hexahedra were turned; returns how many nodes that
/// takes. The element stands for the shape that is left.
fn join_collapsed(raw: &mut Raw, index: &NodeIndex, places: &[u32]) -> usize {
    let mut links: Vec<[u32; 2]> = Vec::new();
    for run in raw.runs.iter().filter(|run| simplex(run.kind.shape).is_some()) {
        let size = run.kind.shape.corners();
        for element in raw.corners[run.first_corner..run.first_corner + size * run.count].chunks_exact(size) {
            let mut nodes = [0u32; 8];
            let found = nodes.iter_mut().zip(element.iter().filter_map(|&tag| index.find(tag)));
            let count = found.map(|(node, own)| *node = own).count();
            for (corner, &a) in nodes[..count].iter().enumerate() {
                let twins = nodes[..corner].iter().filter(|&&b| b != a && places[b as usize] == places[a as usize]);
                links.extend(twins.map(|&b| [a, b]));
            }
        }
    }
    if links.is_empty() {
        return 0;
    }
    let root = connected(raw.nodes.len(), links);
    for tag in &mut raw.corners {
        *tag = index.find(*tag).map_or(*tag, |node| raw.node_tags[root[node as usize] as usize]);
    }
    (0..).zip(&root).filter(|(node, root)| node != *root).count()
}

/// What a shape is split into; none of what stays.
fn simplex(shape: Shape) -> Option<Shape> {
    match shape {
        Shape::Point | Shape::Line | Shape::Triangle | Shape::Tetrahedron => None,
        Shape::Quad => Some(Shape::Triangle),
        Shape::Hexahedron | Shape::Prism | Shape::Pyramid => Some(Shape::Tetrahedron),
    }
}

fn told(counts: &BTreeMap<Shape, (usize, usize)>) -> String {
    let list = |simplex_is: Shape| {
        let of = counts.iter().filter(|(shape, _)| simplex(**shape) == Some(simplex_is));
        let pieces: usize = of.clone().map(|(_, count)| count.1).sum();
        let names: Vec<String> = of.map(|(shape, count)| shape.counted(count.0)).collect();
        (pieces > 0).then(|| format!("{} split into {}", names.join(", "), simplex_is.counted(pieces)))
    };
    let lists: Vec<String> = [Shape::Tetrahedron, Shape::Triangle].into_iter().filter_map(list).collect();
    format!("{}: the nodes stay, groups mean the pieces", lists.join("; "))
}

/// Nodes of a triangle, of which the last is there twice, or of a tetrahedron.
type Piece = [u32; 4];

/// The pieces of an element. Where corners are one node some of them vanish.
///
/// - `rank`: orders the nodes
fn cut<R: Ord>(shape: Shape, nodes: &[u32], rank: impl Fn(u32) -> R, pieces: &mut Vec<Piece>) {
    pieces.clear();
    let fan = |face: &[u32], pieces: &mut Vec<Piece>, apex: Option<u32>| {
        let least = (0..face.len()).min_by_key(|&corner| rank(face[corner])).unwrap_or(0);
        let at = |step: usize| face[(least + step) % face.len()];
        for step in 1..face.len() - 1 {
            let [a, b, c] = [at(0), at(step), at(step + 1)];
            if a != b && b != c && c != a {
                pieces.push([a, b, c, apex.unwrap_or(c)]);
            }
        }
    };
    if shape == Shape::Quad {
        return fan(nodes, pieces, None);
    }
    let apex = nodes.iter().copied().min_by_key(|&node| rank(node)).expect("an element has nodes");
    for face in shape.faces() {
        let mut corners = [0u32; 4];
        corners.iter_mut().zip(*face).for_each(|(corner, &local)| *corner = nodes[local]);
        let corners = &corners[..face.len()];
        if !corners.contains(&apex) {
            fan(corners, pieces, Some(apex));
        }
    }
}

/// Turns the tetrahedra of an element whose corners are told the other way round; false where some lie within each other.
fn turn_outside_out(shape: Shape, pieces: &mut [Piece], at: &[Vec3]) -> bool {
    let corners = |piece: &Piece| piece.map(|node| at[node as usize]);
    if shape == Shape::Quad {
        let area = |piece: &Piece| corners(piece).first_chunk().map_or_else(Vec3::zeros, |three| area_vector(*three));
        let whole: Vec3 = pieces.iter().map(area).sum();
        return !pieces.is_empty() && pieces.iter().all(|piece| area(piece).dot(&whole) > 0.0);
    }
    let whole: f64 = pieces.iter().map(|piece| signed_volume(corners(piece))).sum();
    if whole < 0.0 {
        pieces.iter_mut().for_each(|piece| piece.swap(2, 3));
    }
    !pieces.is_empty()
        && pieces.iter().all(|piece| {
            let corners = corners(piece);
            let volume = signed_volume(corners);
            volume > 0.0 && has_volume(volume, &corners)
        })
}

fn inverted(raw: &Raw, run: &Run, element: usize, nodes: &[u32], bytes: &[u8]) -> Fault {
    let shape = run.kind.shape;
    let middle = nodes.iter().map(|&node| raw.nodes[node as usize]).sum::<Vec3>() / nodes.len() as f64;
    let tags: Vec<u64> = nodes.iter().map(|&node| raw.node_tags[node as usize]).collect();
    let parts = match simplex(shape) {
        Some(Shape::Triangle) => "triangles",
        _ => "tetrahedra",
    };
    let message = format!(
        "{} {} (nodes {tags:?}) at {:e} {:e} {:e} is flat, or so warped that the {parts} it is split into lie within each \
         other; mesh again, or with {parts}",
        shape.singular(),
        raw.element_tags[run.first + element],
        middle.x,
        middle.y,
        middle.z
    );
    Fault { at: run.locate(bytes, element), problem: Problem::Degenerate(message) }
}
