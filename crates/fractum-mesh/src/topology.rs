//! Edges, facets and boundary of simplices.

use fractum_math::Ragged;
use rayon::prelude::*;

/// The edges of a set of simplices with M edges each (3 of a triangle, 6 of a tetrahedron).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Edges<const M: usize> {
    /// Nodes of each edge, lower first; the edges ascend.
    pub nodes: Vec<[u32; 2]>,
    /// The edges of each element. Tetrahedra: local nodes 01 02 03 12 13 23; triangles: 01 12 02.
    pub of_element: Vec<[u32; M]>,
}

/// A boundary triangle of tetrahedra.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Facet {
    /// Nodes, counter-clockwise seen from outside: the right-hand normal points out of the element.
    pub nodes: [u32; 3],
    /// The element it belongs to.
    pub element: u32,
}

/// A boundary edge of triangles in the xy-plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct BoundaryEdge {
    /// Nodes in the sense of a counter-clockwise triangle: the outward normal lies to the right of the way from the
    /// first to the second, (Δy, −Δx).
    pub nodes: [u32; 2],
    /// The element it belongs to.
    pub element: u32,
}

/// Local nodes of the edges of a tetrahedron, in the order of [`Edges::of_element`].
pub const TETRAHEDRON_EDGES: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];
/// Local nodes of the edges of a triangle, in the order of [`Edges::of_element`].
pub const TRIANGLE_EDGES: [[usize; 2]; 3] = [[0, 1], [1, 2], [0, 2]];
/// Local nodes of the facets of a tetrahedron of positive volume, normals outward; facet k lies opposite node k.
pub const TETRAHEDRON_FACETS: [[usize; 3]; 4] = [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]];
/// Local nodes of the boundary of a counter-clockwise triangle in its sense.
const TRIANGLE_SIDES: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// Nodes treated as one piece of parallel work.
const NODES_PER_TASK: usize = 2048;

/// The edges of tetrahedra; independent of the number of threads.
pub fn edges_of_tetrahedra(elements: &[[u32; 4]]) -> Edges<6> {
    edges(elements, TETRAHEDRON_EDGES)
}

/// The edges of triangles; independent of the number of threads.
pub fn edges_of_triangles(elements: &[[u32; 3]]) -> Edges<3> {
    edges(elements, TRIANGLE_EDGES)
}

/// The elements that name each node, ascending.
///
/// # Panics
/// If an element names a node that is not below `node_count`.
pub fn elements_of_nodes<const N: usize>(node_count: usize, elements: &[[u32; N]]) -> Ragged {
    Ragged::inverse(node_count, elements.iter().map(|nodes| nodes.as_slice()))
}

/// The facets that belong to one tetrahedron only, ascending by element and local facet.
///
/// - `elements`: tetrahedra of positive volume
pub fn boundary_of_tetrahedra(elements: &[[u32; 4]]) -> Vec<Facet> {
    let of_node = elements_of_nodes(node_count(elements), elements);
    let facet = |element: u32, local: usize| TETRAHEDRON_FACETS[local].map(|i| elements[element as usize][i]);
    let single = single_sides::<4, 3>(elements, &of_node, TETRAHEDRON_FACETS);
    single.into_iter().map(|(element, local)| Facet { nodes: facet(element, local), element }).collect()
}

/// The edges that belong to one triangle only, ascending by element and local edge.
///
/// - `elements`: counter-clockwise triangles in the xy-plane
pub fn boundary_of_triangles(elements: &[[u32; 3]]) -> Vec<BoundaryEdge> {
    let of_node = elements_of_nodes(node_count(elements), elements);
    let edge = |element: u32, local: usize| TRIANGLE_SIDES[local].map(|i| elements[element as usize][i]);
    let single = single_sides::<3, 2>(elements, &of_node, TRIANGLE_SIDES);
    single.into_iter().map(|(element, local)| BoundaryEdge { nodes: edge(element, local), element }).collect()
}

fn node_count<const N: usize>(elements: &[[u32; N]]) -> usize {
    elements.as_flattened().iter().max().map_or(0, |&highest| highest as usize + 1)
}

/// Each node gathers the higher nodes of its elements: its row of edges. Rows need no order among themselves.
fn edges<const N: usize, const M: usize>(elements: &[[u32; N]], local: [[usize; 2]; M]) -> Edges<M> {
    let node_count = node_count(elements);
    let of_node = elements_of_nodes(node_count, elements);
    let tasks: Vec<(Vec<[u32; 2]>, Vec<u32>)> = (0..node_count.div_ceil(NODES_PER_TASK))
        .into_par_iter()
        .map(|task| {
            let (mut edges, mut lengths, mut row) = (Vec::new(), Vec::new(), Vec::new());
            for node in task * NODES_PER_TASK..((task + 1) * NODES_PER_TASK).min(node_count) {
                row.clear();
                for &element in of_node.row(node) {
                    row.extend(elements[element as usize].iter().copied().filter(|&other| other > node as u32));
                }
                row.sort_unstable();
                row.dedup();
                edges.extend(row.iter().map(|&other| [node as u32, other]));
                lengths.push(row.len() as u32);
            }
            (edges, lengths)
        })
        .collect();
    let mut nodes = Vec::with_capacity(tasks.iter().map(|(edges, _)| edges.len()).sum());
    let mut offsets = Vec::with_capacity(node_count + 1);
    offsets.push(0u32);
    for (edges, lengths) in tasks {
        nodes.extend_from_slice(&edges);
        offsets.extend(lengths.iter().scan(*offsets.last().expect("starts at 0"), |end, length| {
            *end += length;
            Some(*end)
        }));
    }
    let find = |a: u32, b: u32| {
        let (low, high) = (a.min(b), a.max(b));
        let (start, end) = (offsets[low as usize], offsets[low as usize + 1]);
        let row = &nodes[start as usize..end as usize];
        start + row.partition_point(|edge| edge[1] < high) as u32
    };
    let of_element = elements.par_iter().map(|e| local.map(|[a, b]| find(e[a], e[b]))).collect();
    Edges { nodes, of_element }
}

/// Sides (N − 1 nodes) that occur once, as element and local side, ascending. Each side is looked at by its lowest
/// node.
fn single_sides<const N: usize, const S: usize>(
    elements: &[[u32; N]],
    of_node: &Ragged,
    local: [[usize; S]; N],
) -> Vec<(u32, usize)> {
    let tasks: Vec<Vec<(u32, usize)>> = (0..of_node.len().div_ceil(NODES_PER_TASK))
        .into_par_iter()
        .map(|task| {
            let (mut single, mut sides) = (Vec::new(), Vec::new());
            for node in task * NODES_PER_TASK..((task + 1) * NODES_PER_TASK).min(of_node.len()) {
                sides.clear();
                for &element in of_node.row(node) {
                    for (side, corners) in local.iter().enumerate() {
                        let mut nodes = corners.map(|corner| elements[element as usize][corner]);
                        nodes.sort_unstable();
                        if nodes[0] == node as u32 {
                            sides.push((nodes, element, side));
                        }
                    }
                }
                sides.sort_unstable();
                let alone = sides.chunk_by(|a, b| a.0 == b.0).filter(|equal| equal.len() == 1);
                single.extend(alone.map(|equal| (equal[0].1, equal[0].2)));
            }
            single
        })
        .collect();
    let mut single = tasks.concat();
    single.par_sort_unstable();
    single
}
