//! The boundary of bodies whose elements several ranks have read.

use fractum_mesh::topology::{TETRAHEDRON_FACETS, boundary_of_tetrahedra};
use fractum_parallel::{Exchange, gather, post};

/// Outward facets of whole bodies.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DividedBoundary {
    /// Of all bodies as one: those that no other element has.
    pub all: Vec<[u32; 3]>,
    /// Of each body by itself.
    pub of_bodies: Vec<Vec<[u32; 3]>>,
}

/// A facet that no other element of its body has on this rank.
struct Named {
    /// Nodes, outward.
    nodes: [u32; 3],
    body: usize,
    /// Number of its element among those of the body and which facet of that it is.
    number: u64,
}

/// The boundary of bodies of tetrahedra. All ranks must call it, with the same bodies in the same order.
///
/// - `bodies`: nodes of the elements that this rank has read; the whole body has those of rank 0 first, then those of rank 1 and so on
/// - returns facets in the order of their elements, the same on every rank
pub fn divided_boundary(exchange: &dyn Exchange, bodies: &[Vec<[u32; 4]>], node_count: usize) -> DividedBoundary {
    let counts = gather(exchange, &bodies.iter().map(Vec::len).collect::<Vec<_>>());
    let (me, size) = (exchange.rank(), exchange.size());
    let mut words = vec![Vec::new(); size];
    for (body, elements) in bodies.iter().enumerate() {
        let first: usize = counts[..me].iter().map(|counts| counts[body]).sum();
        for facet in boundary_of_tetrahedra(elements) {
            let element = elements[facet.element as usize];
            let side = TETRAHEDRON_FACETS.iter().position(|side| side.map(|corner| element[corner]) == facet.nodes);
            let number = 4 * (first + facet.element as usize) + side.expect("a facet of its element");
            let [a, b, c] = facet.nodes.map(u64::from);
            // Facets of the same nodes meet on one rank.
            let to = a.min(b).min(c) as usize * size / node_count;
            words[to].extend([a << 32 | b, c << 32 | body as u64, number as u64]);
        }
    }
    let read = |&[ab, c, number]: &[u64; 3]| {
        let nodes = [(ab >> 32) as u32, ab as u32, (c >> 32) as u32];
        Named { nodes, body: c as u32 as usize, number }
    };
    let received = post(exchange, words);
    let mut facets: Vec<Named> = received.iter().flat_map(|words| words.as_chunks().0).map(read).collect();
    let sorted = |facet: &Named| {
        let mut nodes = facet.nodes;
        nodes.sort_unstable();
        nodes
    };
    facets.sort_by_cached_key(|facet| (sorted(facet), facet.body, facet.number));
    let mut single: Vec<(usize, u64, [u32; 3], bool)> = Vec::new();
    for same in facets.chunk_by(|a, b| sorted(a) == sorted(b)) {
        for of_body in same.chunk_by(|a, b| a.body == b.body) {
            if let [Named { nodes, body, number }] = of_body {
                single.push((*body, *number, *nodes, same.len() == 1));
            }
        }
    }
    let mut all = gather(exchange, &single).concat();
    all.sort_unstable();
    let mut boundary = DividedBoundary { all: Vec::new(), of_bodies: vec![Vec::new(); bodies.len()] };
    for (body, _, nodes, is_alone) in all {
        boundary.all.extend(is_alone.then_some(nodes));
        boundary.of_bodies[body].push(nodes);
    }
    boundary
}
