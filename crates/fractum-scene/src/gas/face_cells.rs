//! Interfaces that gas flows in: every face is a cell, between whose sides gas flows to the next one, to holes and to the outside.

use std::collections::{BTreeMap, BTreeSet};

use fractum_fem::{CrackNetwork, Solid, cracks};
use fractum_gas::Passage;
use fractum_math::{Vec3, connected};

use super::cavity::Cavity;
use super::hole_ends::SymmetryPlanes;
use super::settings::GasHole;
use crate::interfaces::Interfaces;

/// The faces of interfaces as cells of gas.
#[derive(Clone, Debug, Default)]
pub(super) struct FaceCells {
    /// Outward facets of the elements on both sides of each face.
    pub(super) sides: Vec<[[u32; 3]; 2]>,
    /// Whether gas may come in: faces that were never joined, or have begun to break.
    pub(super) is_open: Vec<bool>,
    /// The hole that each got gas from first.
    pub(super) from: Vec<Option<u32>>,
}

/// An edge of a face in space, or a point of one in the plane: the places of its ends.
type Edge = [u32; 2];

impl FaceCells {
    pub(super) fn new(interfaces: &Interfaces) -> Self {
        let sides = interfaces.faces().iter().map(|face| [face.sides[0], turned(face.sides[1])]);
        let sides: Vec<[[u32; 3]; 2]> = sides.collect();
        FaceCells { is_open: vec![false; sides.len()], from: vec![None; sides.len()], sides }
    }

    /// Rooms of the faces.
    pub(super) fn cavities(&self, solid: &Solid, least_opening: f64) -> impl Iterator<Item = Cavity> {
        let area = |nodes: &[u32; 3]| cracks::area_at(solid, nodes, |node| solid.reference[node as usize]).norm();
        self.sides.iter().map(move |[side, _]| Cavity::face(area(side), least_opening))
    }

    /// Volume between the sides of a face as its nodes lie; negative where they overlap [m³].
    pub(super) fn enclosed(&self, solid: &Solid, face: usize) -> f64 {
        let at = |node: u32| solid.position(node as usize);
        let [a, b] = self.sides[face].map(|side| cracks::area_at(solid, &side, at));
        let [from, to] = self.sides[face].map(|side| middle(&side, at));
        0.5 * (a - b).dot(&(to - from))
    }

    /// Looks which faces gas may enter by now.
    pub(super) fn look(&mut self, interfaces: &Interfaces) {
        for (face, is_open) in self.is_open.iter_mut().enumerate() {
            *is_open = *is_open || interfaces.lets_in(face);
        }
    }

    /// Passages between faces that have an edge in common, to the holes on whose walls they end, and to the outside, closed.
    ///
    /// - `cracks`: with the holes and then these faces as mouths
    pub(super) fn passages(
        &self,
        solid: &Solid,
        cracks: &CrackNetwork,
        holes: &[GasHole],
        symmetry: SymmetryPlanes,
    ) -> Vec<Passage> {
        if self.sides.is_empty() {
            return Vec::new();
        }
        let corner_pairs = |[first, second]: [[u32; 3]; 2]| {
            let second = turned(second);
            [0, 1, 2].map(|corner| [first[corner], second[corner]])
        };
        let pairs = || self.sides.iter().copied().flat_map(corner_pairs).filter(|[a, b]| a != b);
        let root = connected(solid.reference.len(), pairs());
        let parted: BTreeSet<u32> = pairs().map(|[a, _]| root[a as usize]).collect();
        let at = |node: u32| solid.reference[node as usize];
        let edges = |nodes: &[u32; 3]| {
            let places = |edge: Edge| edge.map(|node| root[node as usize]);
            edges(nodes).map(places).map(|[a, b]| [a.min(b), a.max(b)]).collect::<Vec<Edge>>()
        };
        let mut walls: BTreeMap<Edge, u32> = BTreeMap::new();
        for (hole, own) in (0u32..).zip(holes) {
            for edge in own.facets.iter().flat_map(edges) {
                walls.entry(edge).or_insert(hole);
            }
        }
        let is_outside = |nodes: &[u32; 3]| !symmetry.hold(solid, nodes, (at(nodes[1]) - at(nodes[0])).norm());
        let surface: BTreeSet<Edge> =
            cracks.outer_sides(solid).filter(is_outside).flat_map(|nodes| edges(&nodes)).collect();
        let mut faces_at: BTreeMap<Edge, Vec<(u32, f64)>> = BTreeMap::new();
        for (cell, [side, _]) in (holes.len() as u32..).zip(&self.sides) {
            let centre = middle(side, at);
            // Nothing flows through a tip.
            for edge in edges(side).into_iter().filter(|edge| edge.iter().any(|place| parted.contains(place))) {
                // Square to the edge: on right triangles the way to its middle would resist by 7 % too much.
                let to = centre - at(edge[0]);
                let along = (at(edge[1]) - at(edge[0])).try_normalize(0.0).unwrap_or_default();
                faces_at.entry(edge).or_default().push((cell, (to - along * along.dot(&to)).norm()));
            }
        }
        let mut passages = Vec::new();
        for (edge, faces) in &faces_at {
            let side = &self.sides[faces[0].0 as usize - holes.len()][0];
            let width = match edge {
                [a, b] if a == b => cracks::area_at(solid, side, at).norm() / (at(side[1]) - at(side[0])).norm(),
                [a, b] => (at(*b) - at(*a)).norm(),
            };
            let mut add = |cells: [u32; 2], length: f64| passages.push(Passage { cells, length, width, opening: 0.0 });
            for (index, &(cell, way)) in faces.iter().enumerate() {
                faces[..index].iter().for_each(|&(other, rest)| add([cell, other], way + rest));
                match walls.get(edge) {
                    Some(&hole) => add([cell, hole], way),
                    None if surface.contains(edge) => add([cell, Passage::OUTSIDE], way),
                    None => {}
                }
            }
        }
        passages
    }
}

/// The facet whose normal points the other way.
fn turned([a, b, c]: [u32; 3]) -> [u32; 3] {
    if b == c { [b, a, a] } else { [a, c, b] }
}

/// Edges of a facet in space; the ends of one in the plane.
fn edges(&[a, b, c]: &[u32; 3]) -> impl Iterator<Item = Edge> {
    let (edges, count) = if b == c { ([[a, a], [b, b], [b, b]], 2) } else { ([[a, b], [b, c], [c, a]], 3) };
    edges.into_iter().take(count)
}

fn middle(nodes: &[u32; 3], at: impl Fn(u32) -> Vec3) -> Vec3 {
    let [a, b, c] = nodes.map(at);
    if nodes[1] == nodes[2] { (a + b) * 0.5 } else { (a + b + c) / 3.0 }
}
