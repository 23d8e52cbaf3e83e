//! Edges of a body, and the elements around each.

use std::borrow::Cow;
use std::sync::Arc;

use fractum_math::{Ragged, Vec3};
use fractum_mesh::topology::{TETRAHEDRON_EDGES, edges_of_tetrahedra, edges_of_triangles};
use rayon::prelude::*;

use crate::body::{Body, ElementKind};

/// Edges of a body, numbered by their nodes, lower first, ascending.
#[derive(Clone, Debug)]
pub struct BodyEdges(Kept);

#[derive(Clone, Debug)]
enum Kept {
    Tables(Tables),
    Sought(Sought),
}

/// Edges, and what is around them, in tables: some 60 bytes of every tetrahedron.
#[derive(Clone, Debug)]
struct Tables {
    nodes: Vec<[u32; 2]>,
    /// Triangles use the first three entries.
    of_element: Vec<[u32; 6]>,
    around: Ragged,
}

/// Edges that are sought among the elements around their nodes whenever one is asked for: a third of that.
#[derive(Clone, Debug)]
struct Sought {
    elements: Arc<Vec<[u32; 4]>>,
    /// Elements around every node.
    around: Ragged,
    /// First edge of which every node is the lower one, and the end.
    first: Vec<u32>,
    /// Edges that are asked for often, ascending, and their nodes.
    often: Vec<u32>,
    of_often: Vec<[u32; 2]>,
}

impl Body {
    /// Sees the nodes of every edge, in the order that [`crate::DamageZone`] uses, ascending.
    ///
    /// - `nodes`: how many there are
    pub fn each_edge(&self, nodes: usize, mut see: impl FnMut([u32; 2])) {
        let edges = match self.shape {
            ElementKind::T4 => BodyEdges::sought(self, nodes, Vec::new()),
            ElementKind::T3 => BodyEdges::tables(self),
        };
        edges.for_each(|_, ends, _| see(ends));
    }

    /// Midpoints of the edges, in the order that [`crate::DamageZone`] uses [m].
    pub fn edge_midpoints(&self, nodes: &[Vec3]) -> Vec<Vec3> {
        let mut midpoints = Vec::new();
        self.each_edge(nodes.len(), |[i, j]| midpoints.push((nodes[i as usize] + nodes[j as usize]) * 0.5));
        midpoints
    }
}

impl BodyEdges {
    /// Those of a body, in tables.
    pub(crate) fn tables(body: &Body) -> Self {
        let (nodes, of_element): (_, Vec<[u32; 6]>) = match body.shape {
            ElementKind::T4 => {
                let edges = edges_of_tetrahedra(&body.elements);
                (edges.nodes, edges.of_element)
            }
            ElementKind::T3 => {
                let triangles: Vec<[u32; 3]> = body.elements.iter().map(|e| [e[0], e[1], e[2]]).collect();
                let edges = edges_of_triangles(&triangles);
                (edges.nodes, edges.of_element.iter().map(|e| [e[0], e[1], e[2], 0, 0, 0]).collect())
            }
        };
        let rows = of_element.iter().map(|of| &of[..body.shape.edge_count()]);
        let around = Ragged::inverse(nodes.len(), rows);
        BodyEdges(Kept::Tables(Tables { nodes, of_element, around }))
    }

    /// Those of a body of tetrahedra, sought whenever one is asked for.
    ///
    /// - `nodes`: how many there are; `often`: nodes of edges that are asked for often, ascending
    pub(crate) fn sought(body: &Body, nodes: usize, often: Vec<[u32; 2]>) -> Self {
        let elements = Arc::clone(&body.elements);
        let around = Ragged::inverse(nodes, elements.iter().map(|nodes| &nodes[..]));
        let mut sought = Sought { elements, around, first: Vec::new(), often: Vec::new(), of_often: Vec::new() };
        let mut first: Vec<u32> =
            (0..nodes as u32).into_par_iter().map(|node| sought.above(node).len() as u32).collect();
        first.push(0);
        first.iter_mut().fold(0, |sum, count| sum + std::mem::replace(count, sum));
        sought.first = first;
        let of_node: Vec<&[[u32; 2]]> = often.chunk_by(|a, b| a[0] == b[0]).collect();
        let numbers = |of_node: &&[[u32; 2]]| {
            let above = sought.above(of_node[0][0]);
            of_node
                .iter()
                .map(|&nodes| sought.number(nodes, &above).expect("an edge of the body"))
                .collect::<Vec<u32>>()
        };
        sought.often = of_node.par_iter().flat_map_iter(numbers).collect();
        sought.of_often = often;
        BodyEdges(Kept::Sought(sought))
    }

    /// How many there are.
    #[expect(clippy::len_without_is_empty, reason = "a body has edges")]
    pub fn len(&self) -> usize {
        match &self.0 {
            Kept::Tables(tables) => tables.nodes.len(),
            Kept::Sought(sought) => sought.first.last().map_or(0, |&count| count as usize),
        }
    }

    /// The two nodes of an edge, ascending.
    pub fn nodes(&self, edge: u32) -> [u32; 2] {
        match &self.0 {
            Kept::Tables(tables) => tables.nodes[edge as usize],
            Kept::Sought(sought) => sought.nodes(edge),
        }
    }

    /// The edge between two nodes (ascending); none where no element of the body has both.
    pub fn find(&self, nodes: [u32; 2]) -> Option<u32> {
        match &self.0 {
            Kept::Tables(tables) => tables.nodes.binary_search(&nodes).ok().map(|edge| edge as u32),
            Kept::Sought(sought) => sought.find(nodes),
        }
    }

    /// Edges of an element, in the order of [`TETRAHEDRON_EDGES`]; triangles use the first three entries.
    pub fn of_element(&self, element: u32) -> [u32; 6] {
        match &self.0 {
            Kept::Tables(tables) => tables.of_element[element as usize],
            Kept::Sought(sought) => sought.of_element(element),
        }
    }

    /// Elements around an edge, ascending, whether they are still there or not.
    pub fn around(&self, edge: u32) -> Cow<'_, [u32]> {
        match &self.0 {
            Kept::Tables(tables) => Cow::Borrowed(tables.around.row(edge as usize)),
            Kept::Sought(sought) => {
                let [a, b] = sought.nodes(edge);
                let has = |element: &u32| sought.elements[*element as usize].contains(&b);
                Cow::Owned(sought.around.row(a as usize).iter().copied().filter(has).collect())
            }
        }
    }

    /// Sees every edge in their order: its number, its nodes, and the elements around it.
    pub fn for_each(&self, mut see: impl FnMut(u32, [u32; 2], &[u32])) {
        match &self.0 {
            Kept::Tables(tables) => {
                for (edge, &nodes) in (0..).zip(&tables.nodes) {
                    see(edge, nodes, tables.around.row(edge as usize));
                }
            }
            Kept::Sought(sought) => sought.for_each(see),
        }
    }

    /// Elements around every edge, where they are in a table.
    pub(crate) fn table_of_elements(&self) -> Option<&Ragged> {
        if let Kept::Tables(tables) = &self.0 { Some(&tables.around) } else { None }
    }
}

impl Sought {
    /// Nodes above a node that elements join to it, ascending.
    fn above(&self, node: u32) -> Vec<u32> {
        let around = self.around.row(node as usize).iter();
        let mut above: Vec<u32> = around.flat_map(|&element| self.elements[element as usize]).collect();
        above.retain(|&other| other > node);
        above.sort_unstable();
        above.dedup();
        above
    }

    /// Number of an edge; none where the nodes have no element in common.
    ///
    /// - `above`: nodes above the lower of the two that elements join to it, ascending
    fn number(&self, [a, b]: [u32; 2], above: &[u32]) -> Option<u32> {
        Some(self.first[a as usize] + above.binary_search(&b).ok()? as u32)
    }

    fn find(&self, nodes: [u32; 2]) -> Option<u32> {
        match self.of_often.binary_search(&nodes) {
            Ok(place) => Some(self.often[place]),
            Err(_) => self.number(nodes, &self.above(nodes[0])),
        }
    }

    fn nodes(&self, edge: u32) -> [u32; 2] {
        if let Ok(place) = self.often.binary_search(&edge) {
            return self.of_often[place];
        }
        let node = self.first.partition_point(|&first| first <= edge) - 1;
        [node as u32, self.above(node as u32)[(edge - self.first[node]) as usize]]
    }

    fn of_element(&self, element: u32) -> [u32; 6] {
        let nodes = self.elements[element as usize];
        TETRAHEDRON_EDGES.map(|ends| {
            let [a, b] = ends.map(|end| nodes[end]);
            self.find([a.min(b), a.max(b)]).expect("an element joins its nodes")
        })
    }

    fn for_each(&self, mut see: impl FnMut(u32, [u32; 2], &[u32])) {
        let (mut joined, mut around) = (Vec::<(u32, u32)>::new(), Vec::new());
        let mut edge = 0;
        for node in 0..self.around.len() as u32 {
            joined.clear();
            for &element in self.around.row(node as usize) {
                let others = self.elements[element as usize].into_iter().filter(|&other| other > node);
                joined.extend(others.map(|other| (other, element)));
            }
            joined.sort_unstable();
            for of_edge in joined.chunk_by(|a, b| a.0 == b.0) {
                around.clear();
                around.extend(of_edge.iter().map(|(_, element)| element));
                see(edge, [node, of_edge[0].0], &around);
                edge += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::Elastic;
    use fractum_mesh::generate::{Jitter, structured_box};

    use super::*;

    #[test]
    fn edges_that_are_sought_are_those_of_the_tables() {
        let mesh = structured_box([3, 2, 4], Vec3::repeat(1.0), Some(Jitter { fraction: 0.1, seed: 1 }));
        let elastic = Elastic { density: 1.0, young_modulus: 1.0, poisson_ratio: 0.0 };
        let body = Body::new("box", ElementKind::T4, mesh.tetrahedra, elastic);
        let tables = BodyEdges::tables(&body);
        let often = [5, 6, 40].map(|edge| tables.nodes(edge)).to_vec();
        let sought = BodyEdges::sought(&body, mesh.nodes.len() + 2, often);
        assert_eq!(tables.len(), sought.len());
        let mut seen = Vec::new();
        sought.for_each(|edge, nodes, around| seen.push((edge, nodes, around.to_vec())));
        let mut next = seen.into_iter();
        tables.for_each(|edge, nodes, around| {
            assert_eq!(next.next(), Some((edge, nodes, around.to_vec())));
            assert_eq!((sought.nodes(edge), sought.find(nodes)), (nodes, Some(edge)));
            assert_eq!(&*sought.around(edge), around);
        });
        for element in 0..body.elements.len() as u32 {
            assert_eq!(tables.of_element(element), sought.of_element(element));
        }
        assert_eq!([tables.find([0, 59]), sought.find([0, 59])], [None; 2]);
    }
}
