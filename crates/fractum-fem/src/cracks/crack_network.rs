//! Cracks that are open to a surface: removed elements that facets of the surface and of one another join.
//!
//! Pressure and gas enter them. The network grows with the removal of elements, by what each removal opens; nothing is
//! sought from scratch.

use std::collections::VecDeque;

use fractum_math::Vec3;
use fractum_mesh::topology::{TETRAHEDRON_FACETS, TRIANGLE_SIDES};
use serde::{Deserialize, Serialize};

use crate::body::ElementKind;
use crate::body::facet_area;
use crate::element::{measure_and_gradients, regular_edge};
use crate::solid::Solid;
use crate::solid::depths::facet_depth;

const NONE: u32 = u32::MAX;

/// A set of facets on the surface of the solids from which cracks are entered: the wall of a hole, the faces of a notch.
#[derive(Clone, Debug, PartialEq)]
pub struct CrackMouth {
    /// Nodes of its outward facets; an edge in the plane repeats its second one.
    pub facets: Vec<[u32; 3]>,
    /// Whether the element behind each facet is still there.
    pub live: Vec<bool>,
}

/// What is beyond a side of a removed element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CrackSide {
    /// An element that is still there.
    Wall,
    /// Another cell, by its index.
    Cell(u32),
    /// A mouth, by its index.
    Mouth(u32),
    /// The surface of the solids.
    Outside,
    /// A removed element that cannot be reached: never lasting, and the fourth side of a triangle.
    Closed,
}

/// A removed element that is open to a mouth.
#[derive(Clone, Debug, PartialEq)]
pub struct CrackCell {
    /// Body of the element.
    pub body: u32,
    /// Element.
    pub element: u32,
    /// The mouth it was reached from first.
    pub mouth: u32,
    /// Shortest way from the mouth through the network, between the centres of cells without load [m].
    pub path: f64,
    /// What is beyond each side.
    pub sides: [CrackSide; 4],
    /// Nodes of each side, their normal pointing into the cell; an edge in the plane repeats its second one.
    pub nodes: [[u32; 3]; 4],
}

/// Removed elements that are open to the mouths, in the order in which they were reached.
#[derive(Clone, Debug)]
pub struct CrackNetwork {
    mouths: Vec<CrackMouth>,
    cells: Vec<CrackCell>,
    /// Cells that were reached from each mouth first, ascending.
    cells_of: Vec<Vec<u32>>,
    /// Index of the first element of each body among all.
    first: Vec<u32>,
    /// Elements beyond the sides of every element.
    beyond: Vec<[u32; 4]>,
    /// Cell of every element.
    cell_of: Vec<u32>,
    /// Facets of the mouths by their ascending nodes: mouth and index there.
    mouth_of: Vec<([u32; 3], u32, u32)>,
}

/// The order in which cells were reached: body and element of each. All else follows from it.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CrackNetworkState(Vec<(u32, u32)>);

impl CrackNetwork {
    /// The network of a solid from which nothing has been removed.
    ///
    /// - `mouths`: outward facets of each; no facet is in two of them
    pub fn new(solid: &Solid, mouths: Vec<Vec<[u32; 3]>>) -> Self {
        let counts = solid.bodies.iter().map(|model| model.body.elements.len() as u32);
        let first: Vec<u32> = counts
            .scan(0, |next, count| {
                let first = *next;
                *next += count;
                Some(first)
            })
            .collect();
        let mut mouth_of: Vec<([u32; 3], u32, u32)> = Vec::new();
        for (mouth, facets) in (0..).zip(&mouths) {
            mouth_of.extend((0..).zip(facets).map(|(index, facet)| (ascending(*facet), mouth, index)));
        }
        mouth_of.sort_unstable();
        let beyond = neighbours(solid);
        CrackNetwork {
            cells_of: vec![Vec::new(); mouths.len()],
            mouths: mouths.into_iter().map(|facets| CrackMouth { live: vec![true; facets.len()], facets }).collect(),
            cells: Vec::new(),
            cell_of: vec![NONE; beyond.len()],
            first,
            beyond,
            mouth_of,
        }
    }

    /// The mouths.
    pub fn mouths(&self) -> &[CrackMouth] {
        &self.mouths
    }

    /// The cells, in the order in which they were reached.
    pub fn cells(&self) -> &[CrackCell] {
        &self.cells
    }

    /// The cells that were reached from a mouth first, in their order.
    pub fn cells_of(&self, mouth: usize) -> impl Iterator<Item = &CrackCell> {
        self.cells_of[mouth].iter().map(|&cell| &self.cells[cell as usize])
    }

    /// Outward facets of elements on the surface of the solids that are in no mouth.
    pub fn outer_sides(&self, solid: &Solid) -> impl Iterator<Item = [u32; 3]> {
        let elements = (0..self.beyond.len() as u32).map(|index| (index, self.body_and_element(index)));
        let sides = elements.flat_map(|(index, (body, element))| {
            (0..side_count(solid, body)).map(move |side| (index, body, element, side))
        });
        let outer = sides.filter(|&(index, body, element, side)| {
            self.beyond[index as usize][side] == NONE && self.find_mouth(solid, body, element, side).is_none()
        });
        outer.map(|(_, body, element, side)| {
            let [a, b, c] = inward_side(solid, body, element, side);
            if b == c { [b, a, a] } else { [a, c, b] }
        })
    }

    /// Area of the mouths and of the walls of the cells that were reached from a mouth, without load [m²].
    pub fn wetted_area(&self, solid: &Solid, mouth: usize) -> f64 {
        let of_mouth = &self.mouths[mouth];
        let live = of_mouth.facets.iter().zip(&of_mouth.live).filter(|(_, live)| **live).map(|(facet, _)| facet);
        let walls = self.cells_of(mouth).flat_map(CrackCell::walls);
        live.chain(walls).map(|facet| area_at(solid, facet, |node| solid.reference[node as usize]).norm()).sum()
    }

    /// Takes over elements that have just been removed.
    pub fn extend(&mut self, solid: &Solid, removed: impl Iterator<Item = (usize, u32)> + Clone) {
        let mut queue = VecDeque::new();
        for (body, element) in removed {
            let index = (self.first[body] + element) as usize;
            let reached = (0..side_count(solid, body)).any(|side| match self.beyond[index][side] {
                NONE => self.find_mouth(solid, body, element, side).is_some(),
                other => self.cell_of[other as usize] != NONE,
            });
            if reached {
                queue.push_back((body, element));
            }
        }
        while let Some((body, element)) = queue.pop_front() {
            self.join(solid, body, element, &mut queue);
        }
    }

    /// All removed elements of a solid that the network does not know yet.
    pub fn extend_by_all(&mut self, solid: &Solid) {
        let bodies = (0..solid.bodies.len()).map(|body| (body, &solid.bodies[body].alive));
        self.extend(
            solid,
            bodies.flat_map(|(body, alive)| {
                (0..).zip(alive).filter(|(_, alive)| !**alive).map(move |(element, _)| (body, element))
            }),
        );
    }

    /// What changes during a run.
    pub fn state(&self) -> CrackNetworkState {
        CrackNetworkState(self.cells.iter().map(|cell| (cell.body, cell.element)).collect())
    }

    /// Finds the network of a saved state again, in a network without cells.
    pub fn restore(&mut self, solid: &Solid, state: &CrackNetworkState) {
        for &(body, element) in &state.0 {
            self.join(solid, body as usize, element, &mut VecDeque::new());
        }
    }

    /// Makes a removed element a cell, and queues the removed elements beyond it.
    fn join(&mut self, solid: &Solid, body: usize, element: u32, queue: &mut VecDeque<(usize, u32)>) {
        let index = (self.first[body] + element) as usize;
        if self.cell_of[index] != NONE {
            return;
        }
        let number = self.cells.len() as u32;
        self.cell_of[index] = number;
        let of = u32::try_from(body).unwrap_or(NONE);
        let mut cell = CrackCell {
            body: of,
            element,
            mouth: NONE,
            path: f64::INFINITY,
            sides: [CrackSide::Closed; 4],
            nodes: [[0; 3]; 4],
        };
        for side in 0..side_count(solid, body) {
            cell.nodes[side] = inward_side(solid, body, element, side);
            cell.sides[side] = match self.beyond[index][side] {
                NONE => match self.find_mouth(solid, body, element, side) {
                    Some((mouth, facet)) => {
                        self.mouths[mouth as usize].live[facet as usize] = false;
                        cell.mouth = cell.mouth.min(mouth);
                        CrackSide::Mouth(mouth)
                    }
                    None => CrackSide::Outside,
                },
                other => self.beyond_side(solid, other, number, index as u32, &mut cell, queue),
            };
        }
        if let Some(cells) = self.cells_of.get_mut(cell.mouth as usize) {
            cells.push(number);
        }
        self.cells.push(cell);
        self.shorten_paths(solid, number);
    }

    /// What is beyond the side of a new cell towards the element `other`; the side of that cell opens too.
    fn beyond_side(
        &mut self,
        solid: &Solid,
        other: u32,
        number: u32,
        index: u32,
        cell: &mut CrackCell,
        queue: &mut VecDeque<(usize, u32)>,
    ) -> CrackSide {
        let (body, element) = self.body_and_element(other);
        if solid.bodies[body].alive[element as usize] {
            return CrackSide::Wall;
        }
        let known = self.cell_of[other as usize];
        if known == NONE {
            queue.push_back((body, element));
            return CrackSide::Closed;
        }
        let neighbour = &mut self.cells[known as usize];
        if cell.mouth == NONE {
            cell.mouth = neighbour.mouth;
        }
        for (side, beyond) in neighbour.sides.iter_mut().zip(&self.beyond[other as usize]) {
            if *beyond == index {
                *side = CrackSide::Cell(number);
            }
        }
        CrackSide::Cell(known)
    }

    /// Shortest ways after a cell has joined: that of the cell, and of those to which it is a short cut.
    fn shorten_paths(&mut self, solid: &Solid, number: u32) {
        let mut queue = VecDeque::from([number]);
        while let Some(number) = queue.pop_front() {
            let centre = self.centre(solid, number);
            let cell = &self.cells[number as usize];
            let mut path = cell.path;
            for (side, nodes) in cell.sides.iter().zip(&cell.nodes) {
                path = path.min(match side {
                    CrackSide::Mouth(_) => (facet_centre(solid, nodes) - centre).norm(),
                    CrackSide::Cell(other) => {
                        self.cells[*other as usize].path + (self.centre(solid, *other) - centre).norm()
                    }
                    _ => f64::INFINITY,
                });
            }
            if path >= self.cells[number as usize].path {
                continue; // No news for its neighbours: without this the queue would double from cell to cell.
            }
            self.cells[number as usize].path = path;
            for side in self.cells[number as usize].sides {
                let CrackSide::Cell(other) = side else { continue };
                if path + (self.centre(solid, other) - centre).norm() < self.cells[other as usize].path {
                    queue.push_back(other);
                }
            }
        }
    }

    fn centre(&self, solid: &Solid, cell: u32) -> Vec3 {
        let cell = &self.cells[cell as usize];
        solid.element_middle(cell.body as usize, cell.element)
    }

    fn body_and_element(&self, index: u32) -> (usize, u32) {
        let body = self.first.partition_point(|&first| first <= index) - 1;
        (body, index - self.first[body])
    }

    fn find_mouth(&self, solid: &Solid, body: usize, element: u32, side: usize) -> Option<(u32, u32)> {
        let key = ascending(inward_side(solid, body, element, side));
        let found = self.mouth_of.binary_search_by(|(nodes, ..)| nodes.cmp(&key)).ok()?;
        Some((self.mouth_of[found].1, self.mouth_of[found].2))
    }
}

impl CrackCell {
    /// Sides towards elements that are still there: outward facets of these.
    pub fn walls(&self) -> impl Iterator<Item = &[u32; 3]> {
        self.sides.iter().zip(&self.nodes).filter(|(side, _)| **side == CrackSide::Wall).map(|(_, nodes)| nodes)
    }
}

/// Area times unit normal of a facet with its nodes at these places [m²]; of an edge in the plane length times depth.
pub fn area_at(solid: &Solid, nodes: &[u32; 3], at: impl Fn(u32) -> Vec3) -> Vec3 {
    facet_area(nodes.map(at), facet_depth(solid, nodes))
}

/// Volume of an element at tⁿ [m³]; negative where it is turned inside out.
pub fn present_volume(solid: &Solid, body: usize, element: u32) -> f64 {
    let body = &solid.bodies[body].body;
    let places = body.elements[element as usize].map(|node| solid.position(node as usize));
    measure_and_gradients(body.shape, &places).0 * body.depth_of(&places)
}

/// Characteristic length of an element: the mean over its edges that may be damaged, else the edge of the regular
/// element of its size [m].
pub fn characteristic_length(solid: &Solid, body: usize, element: u32) -> f64 {
    let model = &solid.bodies[body];
    let count = model.body.shape.edge_count();
    let edges = model.edges.iter().flat_map(|edges| edges.of_element(element).into_iter().take(count));
    let lengths = edges.filter_map(|edge| solid.length_of_edge(body, edge));
    let (sum, number) = lengths.fold((0.0, 0.0), |(sum, number), length| (sum + length, number + 1.0));
    if number > 0.0 {
        return sum / number;
    }
    let nodes = model.body.elements[element as usize].map(|node| solid.reference[node as usize]);
    regular_edge(model.body.shape, measure_and_gradients(model.body.shape, &nodes).0)
}

fn side_count(solid: &Solid, body: usize) -> usize {
    solid.bodies[body].body.shape.node_count()
}

/// Nodes of a side opposite to its local node, the normal pointing into the element.
fn inward_side(solid: &Solid, body: usize, element: u32, side: usize) -> [u32; 3] {
    let nodes = solid.bodies[body].body.elements[element as usize];
    match solid.bodies[body].body.shape {
        ElementKind::T4 => {
            let [a, b, c] = TETRAHEDRON_FACETS[side].map(|k| nodes[k]);
            [a, c, b]
        }
        ElementKind::T3 => {
            let [a, b] = TRIANGLE_SIDES[side].map(|k| nodes[k]);
            [b, a, a]
        }
    }
}

fn facet_centre(solid: &Solid, &[a, b, c]: &[u32; 3]) -> Vec3 {
    let at = |node: u32| solid.reference[node as usize];
    if b == c { (at(a) + at(b)) * 0.5 } else { (at(a) + at(b) + at(c)) / 3.0 }
}

/// Nodes of a facet in ascending order; an edge has its larger one twice.
fn ascending(nodes: [u32; 3]) -> [u32; 3] {
    let [a, b, c] = nodes;
    let mut sorted = if b == c { [a.min(b), a.max(b), a.max(b)] } else { nodes };
    sorted.sort_unstable();
    sorted
}

/// Elements beyond the sides of every element, all bodies together; side k lies opposite the local node k.
fn neighbours(solid: &Solid) -> Vec<[u32; 4]> {
    let mut facets: Vec<([u32; 3], u32, u8)> = Vec::new();
    let mut index = 0;
    for body in 0..solid.bodies.len() {
        for element in 0..solid.bodies[body].body.elements.len() as u32 {
            let sides = 0..side_count(solid, body);
            facets.extend(sides.map(|side| (ascending(inward_side(solid, body, element, side)), index, side as u8)));
            index += 1;
        }
    }
    facets.sort_unstable();
    let mut beyond = vec![[NONE; 4]; index as usize];
    for pair in facets.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, one, side), (_, other, its)] = *pair {
            beyond[one as usize][side as usize] = other;
            beyond[other as usize][its as usize] = one;
        }
    }
    beyond
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::Elastic;

    use super::*;
    use crate::body::Body;
    use fractum_mesh::generate::{structured_box, structured_rectangle};

    fn solid(shape: ElementKind) -> Solid {
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let (nodes, elements) = match shape {
            ElementKind::T3 => {
                let mesh = structured_rectangle([12, 5], [1.2, 0.5], None);
                (mesh.nodes, mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect())
            }
            ElementKind::T4 => {
                let mesh = structured_box([8, 4, 3], Vec3::new(0.8, 0.4, 0.3), None);
                (mesh.nodes, mesh.tetrahedra)
            }
        };
        Solid::new(nodes, vec![Body::new("block", shape, elements, elastic)]).unwrap()
    }

    /// The left side of the block as a mouth.
    fn left_side(solid: &Solid) -> Vec<[u32; 3]> {
        let mut found = Vec::new();
        for element in 0..solid.bodies[0].body.elements.len() as u32 {
            for side in 0..side_count(solid, 0) {
                let [a, b, c] = inward_side(solid, 0, element, side);
                if [a, b, c].iter().all(|&n| solid.reference[n as usize].x == 0.0) {
                    found.push(if b == c { [b, a, a] } else { [a, c, b] });
                }
            }
        }
        found
    }

    fn remove(solid: &mut Solid, which: impl Fn(&Vec3) -> bool) -> Vec<(usize, u32)> {
        let gone: Vec<u32> = (0..solid.bodies[0].body.elements.len() as u32)
            .filter(|&e| solid.bodies[0].alive[e as usize] && which(&solid.element_middle(0, e)))
            .collect();
        gone.iter().for_each(|&e| solid.bodies[0].alive[e as usize] = false);
        gone.into_iter().map(|e| (0, e)).collect()
    }

    fn in_row(p: &Vec3) -> bool {
        p.y > 0.2 && p.y < 0.3
    }

    #[test]
    fn a_crack_is_entered_once_a_way_to_the_mouth_is_open() {
        for shape in [ElementKind::T3, ElementKind::T4] {
            let mut solid = solid(shape);
            let mut network = CrackNetwork::new(&solid, vec![left_side(&solid)]);
            let whole = network.wetted_area(&solid, 0);
            // The far part of a row, then the element in between, then the rest up to the mouth.
            let far = remove(&mut solid, |p| in_row(p) && p.x > 0.3 && p.x < 0.7);
            network.extend(&solid, far.iter().copied());
            assert!(network.cells().is_empty());
            let near = remove(&mut solid, |p| in_row(p) && p.x < 0.3);
            network.extend(&solid, near.iter().copied());
            assert_eq!(network.cells().len(), far.len() + near.len());
            for cell in network.cells() {
                assert_eq!(cell.mouth, 0);
                assert!(!cell.sides[..side_count(&solid, 0)].contains(&CrackSide::Closed));
                let x = solid.element_middle(0, cell.element).x;
                assert!(cell.path > x - 0.02 && cell.path < 2.0 * x + 0.1, "{} {x}", cell.path);
            }
            // The walls of a slot with an end, less the mouth itself; in space the sides of the block are open.
            let depth = if shape == ElementKind::T3 { 1.0 } else { 0.3 };
            let slot = (2.0 * 0.7 + 0.1 - 0.1) * depth;
            assert!((network.wetted_area(&solid, 0) - whole - slot).abs() < 1e-12);
            let outside = network.cells().iter().flat_map(|cell| cell.sides).any(|side| side == CrackSide::Outside);
            assert_eq!(outside, shape == ElementKind::T4);
        }
    }

    #[test]
    fn growing_step_by_step_is_growing_at_once() {
        for shape in [ElementKind::T3, ElementKind::T4] {
            let mut solid = solid(shape);
            let mut network = CrackNetwork::new(&solid, vec![left_side(&solid)]);
            for end in 1..8 {
                let x = 0.1 * f64::from(end);
                let gone = remove(&mut solid, |p| in_row(p) && p.x < x);
                network.extend(&solid, gone.iter().copied());
            }
            // A second way round, shorter for some of the cells.
            let gone = remove(&mut solid, |p| p.y > 0.3 && p.x < 0.2);
            network.extend(&solid, gone.iter().copied());
            let mut at_once = CrackNetwork::new(&solid, vec![left_side(&solid)]);
            at_once.extend_by_all(&solid);
            let mut restored = CrackNetwork::new(&solid, vec![left_side(&solid)]);
            restored.restore(&solid, &network.state());
            assert_eq!(restored.cells(), network.cells());
            assert_eq!(restored.mouths(), network.mouths());
            assert_eq!(at_once.mouths(), network.mouths());
            let sorted = |network: &CrackNetwork| {
                let mut cells: Vec<_> = network.cells().iter().map(|c| (c.element, c.path, c.mouth)).collect();
                cells.sort_by_key(|cell| cell.0);
                cells
            };
            assert_eq!(sorted(&at_once), sorted(&network));
            assert!((at_once.wetted_area(&solid, 0) - network.wetted_area(&solid, 0)).abs() < 1e-12);
        }
    }

    #[test]
    fn the_way_into_a_crushed_region_is_found_without_trying_all_ways() {
        let mesh = structured_rectangle([24, 24], [1.0, 1.0], None);
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let elastic = Elastic { density: 1.0, young_modulus: 1.0, poisson_ratio: 0.0 };
        let mut solid = Solid::new(mesh.nodes, vec![Body::new("plate", ElementKind::T3, elements, elastic)]).unwrap();
        let mut gone = remove(&mut solid, |_| true);
        // The element at the mouth comes last: all others learn of it at once, over some 10^13 ways.
        gone.sort_by(|a, b| solid.element_middle(0, b.1).x.total_cmp(&solid.element_middle(0, a.1).x));
        let mut network = CrackNetwork::new(&solid, vec![left_side(&solid)]);
        network.restore(&solid, &CrackNetworkState(gone.iter().map(|&(_, element)| (0, element)).collect()));
        let longest = network.cells().iter().map(|cell| cell.path).fold(0.0, f64::max);
        assert!(network.cells().len() == gone.len() && longest > 0.9 && longest < 1.5, "{longest}");
    }

    #[test]
    fn the_walls_of_a_closed_cavity_have_no_resultant() {
        let mut solid = solid(ElementKind::T4);
        let centre = Vec3::new(0.35, 0.2, 0.15);
        let gone = remove(&mut solid, |p| (p - centre).norm() < 0.12);
        let mouth: Vec<[u32; 3]> = vec![inward_side(&solid, 0, gone[0].1, 0)];
        let mut network = CrackNetwork::new(&solid, vec![mouth]);
        // Entered from inside: as a mouth only a facet of the surface counts.
        network.extend(&solid, gone.iter().copied());
        assert!(network.cells().is_empty());
        let state = CrackNetworkState(gone.iter().map(|&(body, element)| (body as u32, element)).collect());
        network.restore(&solid, &state);
        let total: Vec3 = network
            .cells()
            .iter()
            .flat_map(CrackCell::walls)
            .map(|wall| area_at(&solid, wall, |node| solid.reference[node as usize]))
            .sum();
        assert!(gone.len() > 10 && total.norm() < 1e-15, "{total:?}");
    }
}
