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

/// The facets of tetrahedra (S = 3 nodes, N = 4 per element), or the sides of triangles (S = 2, N = 3), with the
/// elements on both sides.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Facets<const N: usize, const S: usize> {
    /// Nodes of each facet, ascending; the facets ascend.
    pub nodes: Vec<[u32; S]>,
    /// The elements of each facet, lower first; the second is [`NO_ELEMENT`] on the boundary.
    pub elements: Vec<[u32; 2]>,
    /// The facets of each element; facet k lies opposite local node k.
    pub of_element: Vec<[u32; N]>,
}

/// Stands for the element beyond the boundary in [`Facets::elements`].
pub const NO_ELEMENT: u32 = u32::MAX;

/// Elements that no solid can have: more than two at one facet.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("elements {elements:?} share the facet of nodes {nodes:?}; expected two at most: they overlap")]
pub struct Overlap {
    /// Nodes of the facet.
    pub nodes: Vec<u32>,
    /// All elements that have it, ascending.
    pub elements: Vec<u32>,
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
/// Local nodes of the sides of a counter-clockwise triangle, in its sense; side k lies opposite node k.
pub const TRIANGLE_SIDES: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

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

/// The elements of each edge, ascending.
pub fn elements_of_edges<const M: usize>(edges: &Edges<M>) -> Ragged {
    Ragged::inverse(edges.nodes.len(), edges.of_element.iter().map(|edges| edges.as_slice()))
}

/// The facets of tetrahedra with the elements on both sides.
///
/// # Errors
/// [`Overlap`] for the first facet that more than two elements have.
pub fn facets_of_tetrahedra(elements: &[[u32; 4]]) -> Result<Facets<4, 3>, Overlap> {
    facets(elements, TETRAHEDRON_FACETS)
}

/// The sides of triangles with the elements on both sides.
///
/// # Errors
/// [`Overlap`] for the first side that more than two elements have.
pub fn sides_of_triangles(elements: &[[u32; 3]]) -> Result<Facets<3, 2>, Overlap> {
    facets(elements, TRIANGLE_SIDES)
}

/// The facets that belong to one tetrahedron only, ascending by element and local facet.
///
/// - `elements`: tetrahedra of positive volume
pub fn boundary_of_tetrahedra(elements: &[[u32; 4]]) -> Vec<Facet> {
    let facet = |element: u32, local: usize| TETRAHEDRON_FACETS[local].map(|i| elements[element as usize][i]);
    let single = single_sides(elements, TETRAHEDRON_FACETS);
    single.into_iter().map(|(element, local)| Facet { nodes: facet(element, local), element }).collect()
}

/// The edges that belong to one triangle only, ascending by element and local side.
///
/// - `elements`: counter-clockwise triangles in the xy-plane
pub fn boundary_of_triangles(elements: &[[u32; 3]]) -> Vec<BoundaryEdge> {
    let edge = |element: u32, local: usize| TRIANGLE_SIDES[local].map(|i| elements[element as usize][i]);
    let single = single_sides(elements, TRIANGLE_SIDES);
    single.into_iter().map(|(element, local)| BoundaryEdge { nodes: edge(element, local), element }).collect()
}

fn node_count<const N: usize>(elements: &[[u32; N]]) -> usize {
    elements.as_flattened().iter().max().map_or(0, |&highest| highest as usize + 1)
}

/// Each node gathers the higher nodes of its elements: its row of edges.
fn edges<const N: usize, const M: usize>(elements: &[[u32; N]], local: [[usize; 2]; M]) -> Edges<M> {
    let node_count = node_count(elements);
    let of_node = elements_of_nodes(node_count, elements);
    let tasks: Vec<(Vec<u32>, Vec<u32>)> = (0..node_count.div_ceil(NODES_PER_TASK))
        .into_par_iter()
        .map(|task| {
            let (mut others, mut lengths, mut row) = (Vec::new(), Vec::new(), Vec::new());
            for node in task * NODES_PER_TASK..((task + 1) * NODES_PER_TASK).min(node_count) {
                gather_higher(node as u32, of_node.row(node), elements, &mut row);
                others.extend_from_slice(&row);
                lengths.push(row.len() as u32);
            }
            (others, lengths)
        })
        .collect();
    let mut offsets = Vec::with_capacity(node_count + 1);
    let mut end = 0u32;
    offsets.push(end);
    for length in tasks.iter().flat_map(|(_, lengths)| lengths) {
        end += length;
        offsets.push(end);
    }
    let others: Vec<u32> = tasks.into_iter().flat_map(|(others, _)| others).collect();
    let find = |a: u32, b: u32| {
        let (low, high) = (a.min(b) as usize, a.max(b));
        let (start, end) = (offsets[low], offsets[low + 1]);
        let row = &others[start as usize..end as usize];
        start + if row.len() <= FEW { count_below(row, high) } else { row.partition_point(|&x| x < high) as u32 }
    };
    let of_element = elements.par_iter().map(|e| local.map(|[a, b]| find(e[a], e[b]))).collect();
    let row = |node: usize| &others[offsets[node] as usize..offsets[node + 1] as usize];
    let nodes = (0..node_count).flat_map(|node| row(node).iter().map(move |&other| [node as u32, other])).collect();
    Edges { nodes, of_element }
}

/// Lengths up to which counting comparisons is faster than the mispredicted branches of sorting and searching.
const FEW: usize = 24;

/// The distinct nodes above `node` in its elements, ascending, into `row`.
fn gather_higher<const N: usize>(node: u32, owners: &[u32], elements: &[[u32; N]], row: &mut Vec<u32>) {
    row.clear();
    let mut found = [0u32; FEW + 1];
    let mut count = 0;
    for &owner in owners {
        for other in elements[owner as usize] {
            let known = found[..count].iter().fold(false, |known, &x| known | (x == other));
            found[count] = other;
            count += usize::from(!known & (other > node));
        }
        if count + N > FEW {
            // a node of many edges: sort
            let all = owners.iter().flat_map(|&owner| elements[owner as usize]);
            row.extend(all.filter(|&other| other > node));
            row.sort_unstable();
            row.dedup();
            return;
        }
    }
    let found = &found[..count];
    row.resize(count, 0);
    for &other in found {
        row[count_below(found, other) as usize] = other;
    }
}

fn count_below(values: &[u32], limit: u32) -> u32 {
    values.iter().map(|&value| u32::from(value < limit)).sum()
}

/// A side of an element: its nodes ascending, the element, the local side.
pub(crate) type Side<const S: usize> = ([u32; S], u32, usize);

/// Gathers the sides of all elements by their lowest node, sorted, and hands those of one task to `collect`.
pub(crate) fn by_sides<const N: usize, const S: usize, T: Send>(
    elements: &[[u32; N]],
    local: [[usize; S]; N],
    collect: impl Fn(&[Side<S>]) -> T + Sync,
) -> Vec<T> {
    let of_node = elements_of_nodes(node_count(elements), elements);
    let task = |task: usize| {
        let (mut keys, mut sides) = (Vec::new(), Vec::new());
        for node in (task * NODES_PER_TASK) as u32..((task + 1) * NODES_PER_TASK).min(of_node.len()) as u32 {
            keys.clear();
            for &element in of_node.row(node as usize) {
                for (side, corners) in local.iter().enumerate() {
                    let mut nodes = corners.map(|corner| elements[element as usize][corner]);
                    if nodes.iter().min() == Some(&node) {
                        nodes.sort_unstable();
                        keys.push(pack(nodes, element, side));
                    }
                }
            }
            keys.sort_unstable();
            sides.extend(keys.iter().map(|&key| unpack::<S>(node, key)));
        }
        collect(&sides)
    };
    (0..of_node.len().div_ceil(NODES_PER_TASK)).into_par_iter().map(task).collect()
}

/// A side as one number that sorts as the side does, without its lowest node; S is 3 at most.
fn pack<const S: usize>(nodes: [u32; S], element: u32, side: usize) -> u128 {
    let higher = nodes[1..].iter().fold(0u128, |key, &node| key << 32 | u128::from(node));
    higher << 40 | u128::from(element) << 8 | side as u128
}

fn unpack<const S: usize>(lowest: u32, key: u128) -> Side<S> {
    let mut nodes = [lowest; S];
    for (place, node) in nodes[1..].iter_mut().rev().enumerate() {
        *node = (key >> (40 + 32 * place)) as u32;
    }
    (nodes, (key >> 8) as u32, (key & 0xff) as usize)
}

/// Sides that occur once, as element and local side, ascending.
fn single_sides<const N: usize, const S: usize>(elements: &[[u32; N]], local: [[usize; S]; N]) -> Vec<(u32, usize)> {
    let tasks = by_sides(elements, local, |sides| {
        let alone = sides.chunk_by(|a, b| a.0 == b.0).filter(|equal| equal.len() == 1);
        alone.map(|equal| (equal[0].1, equal[0].2)).collect::<Vec<_>>()
    });
    let mut single = tasks.concat();
    single.par_sort_unstable();
    single
}

fn facets<const N: usize, const S: usize>(
    elements: &[[u32; N]],
    local: [[usize; S]; N],
) -> Result<Facets<N, S>, Overlap> {
    let tasks = by_sides(elements, local, |sides| sides.to_vec());
    let count = (N * elements.len()).div_ceil(2);
    let mut facets = Facets {
        nodes: Vec::with_capacity(count),
        elements: Vec::with_capacity(count),
        of_element: vec![[0; N]; elements.len()],
    };
    for equal in tasks.iter().flat_map(|sides| sides.chunk_by(|a, b| a.0 == b.0)) {
        let nodes = equal[0].0;
        if equal.len() > 2 {
            let elements = equal.iter().map(|side| side.1).collect();
            return Err(Overlap { nodes: nodes.to_vec(), elements });
        }
        for &(_, element, side) in equal {
            facets.of_element[element as usize][side] = facets.nodes.len() as u32;
        }
        facets.nodes.push(nodes);
        facets.elements.push([equal[0].1, equal.get(1).map_or(NO_ELEMENT, |side| side.1)]);
    }
    Ok(facets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;
    use crate::generate::{structured_box, structured_rectangle};
    use proptest::prelude::*;
    use std::collections::{BTreeMap, BTreeSet};

    /// Distinct random elements over few nodes, as no mesh would be.
    fn tangle() -> impl Strategy<Value = Vec<[u32; 4]>> {
        let element = prop::array::uniform4(0u32..12)
            .prop_filter("distinct nodes", |nodes| nodes.iter().collect::<BTreeSet<_>>().len() == 4);
        prop::collection::vec(element, 0..40)
    }

    proptest! {
        #[test]
        fn edges_are_the_distinct_pairs_of_each_element(elements in tangle()) {
            let edges = edges_of_tetrahedra(&elements);
            let mut expected = BTreeSet::new();
            for (nodes, of_element) in elements.iter().zip(&edges.of_element) {
                for ([a, b], edge) in TETRAHEDRON_EDGES.into_iter().zip(of_element) {
                    let pair = [nodes[a].min(nodes[b]), nodes[a].max(nodes[b])];
                    prop_assert_eq!(edges.nodes[*edge as usize], pair);
                    expected.insert(pair);
                }
            }
            prop_assert!(edges.nodes.iter().eq(expected.iter()));
            let of_edges = elements_of_edges(&edges);
            for (element, of_element) in edges.of_element.iter().enumerate() {
                prop_assert!(of_element.iter().all(|&edge| of_edges.row(edge as usize).contains(&(element as u32))));
            }
        }

        #[test]
        fn facets_agree_with_counting_them(elements in tangle()) {
            let mut owners: BTreeMap<[u32; 3], Vec<u32>> = BTreeMap::new();
            for (element, nodes) in elements.iter().enumerate() {
                for corners in TETRAHEDRON_FACETS {
                    let mut facet = corners.map(|i| nodes[i]);
                    facet.sort_unstable();
                    owners.entry(facet).or_default().push(element as u32);
                }
            }
            let mut single: Vec<[u32; 3]> = boundary_of_tetrahedra(&elements).iter().map(|facet| facet.nodes).collect();
            single.iter_mut().for_each(|nodes| nodes.sort_unstable());
            single.sort_unstable();
            prop_assert!(single.iter().eq(owners.iter().filter(|entry| entry.1.len() == 1).map(|entry| entry.0)));
            match facets_of_tetrahedra(&elements) {
                Err(overlap) => {
                    let (nodes, elements) = owners.iter().find(|entry| entry.1.len() > 2).unwrap();
                    prop_assert_eq!((&overlap.nodes[..], &overlap.elements), (&nodes[..], elements));
                }
                Ok(facets) => {
                    prop_assert!(facets.nodes.iter().eq(owners.keys()));
                    for (pair, owners) in facets.elements.iter().zip(owners.values()) {
                        prop_assert_eq!(pair[0], owners[0]);
                        prop_assert_eq!(pair[1], owners.get(1).copied().unwrap_or(NO_ELEMENT));
                    }
                    for (nodes, of_element) in elements.iter().zip(&facets.of_element) {
                        for (opposite, facet) in of_element.iter().enumerate() {
                            prop_assert!(!facets.nodes[*facet as usize].contains(&nodes[opposite]));
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn boundary_of_a_rectangle_runs_counter_clockwise_around_it() {
        let mesh = structured_rectangle([3, 2], [3.0, 2.0], None);
        let boundary = boundary_of_triangles(&mesh.triangles);
        assert_eq!(boundary.len(), 10);
        let center = Vec3::new(1.5, 1.0, 0.0);
        for edge in &boundary {
            let [a, b] = edge.nodes.map(|node| mesh.nodes[node as usize]);
            let outward = Vec3::new(b.y - a.y, a.x - b.x, 0.0);
            assert!(outward.dot(&(a - center)) > 0.0);
            assert!(edge.nodes.iter().all(|node| mesh.triangles[edge.element as usize].contains(node)));
        }
        let sides = sides_of_triangles(&mesh.triangles).unwrap();
        assert_eq!(sides.elements.iter().filter(|pair| pair[1] == NO_ELEMENT).count(), 10);
        assert_eq!(edges_of_triangles(&mesh.triangles).nodes, sides.nodes);
    }

    #[test]
    fn topology_is_the_same_for_any_number_of_threads() {
        let mesh = structured_box([24, 20, 22], Vec3::new(1.0, 1.0, 1.0), None);
        let derive = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let elements = &mesh.tetrahedra;
                (edges_of_tetrahedra(elements), boundary_of_tetrahedra(elements), facets_of_tetrahedra(elements))
            })
        };
        let serial = derive(1);
        assert!(serial == derive(2) && serial == derive(5));
    }

    #[test]
    fn nothing_has_no_topology() {
        assert!(edges_of_tetrahedra(&[]).nodes.is_empty());
        assert!(boundary_of_triangles(&[]).is_empty());
        assert!(facets_of_tetrahedra(&[]).unwrap().nodes.is_empty());
    }
}
