//! Whole bodies, of which a rank may have a part.

use std::borrow::Cow;
use std::sync::Arc;

use fractum_mesh::topology::{boundary_of_tetrahedra, edges_of_tetrahedra};

use super::body_subdomain::BodySubdomain;
use super::subdomain::{Subdomain, SubdomainSize};
use super::{subdomain, subdomain_mut};
use crate::body::ElementKind;
use crate::body::edges::BodyEdges;
use crate::divided::{ConnectedPieces, DividedBody, SharedNodes};
use crate::solid::Solid;

fn part(solid: &Solid, body: usize) -> Option<&BodySubdomain> {
    subdomain(solid)?.bodies.get(body)
}

fn divided(solid: &Solid, body: usize) -> Option<&DividedBody> {
    part(solid, body)?.divided.as_deref()
}

/// Whether several ranks advance the solid.
pub fn is_distributed(solid: &Solid) -> bool {
    subdomain(solid).is_some()
}

/// Whether there are bodies that no rank has whole.
pub fn is_divided(solid: &Solid) -> bool {
    subdomain(solid).is_some_and(Subdomain::is_divided)
}

/// What this rank does of the work; none where there is one process.
pub fn subdomain_size(solid: &Solid) -> Option<SubdomainSize> {
    Some(subdomain(solid)?.size(&solid.blocks))
}

/// Steps in which every rank moved all nodes, and all steps that ranks have done together; none where there is one process.
pub fn steps(solid: &Solid) -> Option<[u64; 2]> {
    Some(subdomain(solid)?.steps)
}

/// How the elements of a body hang together that no rank has whole; none where each has all of them.
pub fn connected_pieces(solid: &Solid, body: usize) -> Option<&ConnectedPieces> {
    Some(&divided(solid, body)?.pieces)
}

/// Nodes of a body, some of them more than once.
pub fn nodes_of(solid: &Solid, body: usize) -> impl Iterator<Item = u32> + '_ {
    let divided = divided(solid, body);
    let elements = if divided.is_some() { &[][..] } else { &solid.body(body).elements };
    let volumes = divided.into_iter().flat_map(|divided| &divided.pieces.volumes);
    let nodes = (0..).zip(volumes).filter(|(_, volume)| **volume > 0.0).map(|(node, _)| node);
    nodes.chain(elements.iter().flatten().copied())
}

/// Number of an element of this rank in the whole body.
pub fn element_number(solid: &Solid, body: usize, element: u32) -> u32 {
    solid.neighbours.number(body, element)
}

/// The element of this rank that has a number in the whole body; none where it does not have that.
pub fn element_of_number(solid: &Solid, body: usize, number: u32) -> Option<u32> {
    match divided(solid, body) {
        Some(divided) => divided.numbers.binary_search(&number).ok().map(|element| element as u32),
        None => Some(number),
    }
}

/// Number of blocks of cells of all ranks.
pub fn block_count(solid: &Solid) -> usize {
    solid.blocks.len()
}

/// Elements of a body on all ranks.
pub fn element_count(solid: &Solid, body: usize) -> usize {
    solid.neighbours.element_count(body, solid.body(body).elements.len())
}

/// Volume of a body without load [m³].
pub fn volume(solid: &Solid, body: usize) -> f64 {
    let sum = || (0..solid.body(body).elements.len() as u32).map(|e| solid.element_volume(body, e)).sum();
    divided(solid, body).map_or_else(sum, |divided| divided.volume)
}

/// Notes which facets of a body are seen from outside, of the elements that this rank owns.
///
/// - `facets`: those of the whole body
pub fn note_skin(solid: &mut Solid, body: usize, facets: &[[u32; 3]]) {
    let Solid { neighbours, bodies, .. } = solid;
    if let Some(part) = subdomain_mut(neighbours).and_then(|own| own.bodies.get_mut(body)) {
        part.note_skin(&bodies[body].body.elements, facets);
    }
}

/// Facets of a body that are seen from outside, each with its element: of the elements that this rank owns.
pub fn skin(solid: &Solid, body: usize) -> Vec<([u32; 3], u32)> {
    if let Some(divided) = divided(solid, body) {
        return divided.skin.clone();
    }
    let (alive, elements, shape) = (solid.alive(body), &solid.body(body).elements, solid.body(body).shape);
    if shape == ElementKind::T3 {
        let alive = (0..).zip(&**elements).zip(alive).filter(|(_, alive)| **alive);
        return alive.map(|((element, &[a, b, c, _]), _)| ([a, b, c], element)).collect();
    }
    let alive: Vec<u32> = (0..).zip(alive).filter(|(_, alive)| **alive).map(|(e, _)| e).collect();
    let elements: Vec<[u32; 4]> = alive.iter().map(|&e| elements[e as usize]).collect();
    let facets = boundary_of_tetrahedra(&elements).into_iter();
    let facets = facets.map(|facet| (facet.nodes, alive[facet.element as usize]));
    facets.filter(|(_, element)| solid.owns(body, *element)).collect()
}

/// Edges of the elements of a body that this rank owns.
pub fn owned_edges(solid: &Solid, index: usize) -> Vec<[u32; 2]> {
    let (body, edges) = (solid.body(index), solid.body_edges(index));
    let is_owned = part(solid, index).map_or(&[][..], |part| &part.is_owned);
    if !is_owned.contains(&false) {
        let mut nodes = Vec::new();
        let edges = edges.map_or_else(|| Cow::Owned(BodyEdges::tables(body)), Cow::Borrowed);
        edges.for_each(|_, ends, _| nodes.push(ends));
        return nodes;
    }
    let owned: Vec<[u32; 4]> =
        body.elements.iter().zip(is_owned).filter(|(_, is_owned)| **is_owned).map(|(nodes, _)| *nodes).collect();
    edges_of_tetrahedra(&owned).nodes
}

/// The nodes of the elements that ranks own; none where each has all elements.
pub fn shared_nodes(solid: &Solid) -> Option<SharedNodes> {
    let own = subdomain(solid).filter(|own| own.is_divided())?;
    let owned = |(body, part): (usize, &BodySubdomain)| {
        let owned = solid.body(body).elements.iter().zip(&part.is_owned).filter(|(_, is_owned)| **is_owned);
        owned.flat_map(|(nodes, _)| *nodes).collect::<Vec<u32>>()
    };
    let mut nodes: Vec<u32> = own.bodies.iter().enumerate().flat_map(owned).collect();
    nodes.sort_unstable();
    nodes.dedup();
    Some(SharedNodes::new(Arc::clone(&own.exchange), solid.reference.len(), &nodes))
}
