//! The network of cells that liquid flows through: a cell for every place at which nodes are doubled, and a slit for every face.

use fractum_fem::Solid;
use fractum_math::Vec3;

use crate::interfaces::Interfaces;
use crate::interfaces::joints::{Joint, PointPlace};

/// A point of an interface that liquid wets.
#[derive(Clone, Debug)]
pub(crate) struct WetPoint {
    /// Its place among the points of interfaces.
    pub(crate) at: PointPlace,
    /// Pair of nodes that it is between.
    pub(crate) joint: u32,
    /// Cell that it is a part of.
    pub(crate) cell: u32,
    /// Normal, for the jump of the pair.
    pub(crate) normal: Vec3,
    /// Area [m²].
    pub(crate) area: f64,
    /// Whether liquid comes in before it has begun to break.
    pub(crate) is_permeable: bool,
}

/// The room for liquid at one place: the points of interfaces there; none of a hole.
#[derive(Clone, Debug, Default)]
pub(crate) struct Cell {
    /// Its points.
    pub(crate) points: Vec<u32>,
    /// Their area [m²].
    pub(crate) area: f64,
    /// Its place without load [m].
    pub(crate) place: Vec3,
}

/// A face that liquid flows along.
#[derive(Clone, Debug)]
pub(crate) struct Slit {
    /// Points at its corners; none at tips.
    pub(crate) points: [Option<u32>; 3],
    /// Number of corners.
    pub(crate) corners: usize,
    /// Cells of two corners, and the width over the length of the way between them.
    pub(crate) ways: Vec<([u32; 2], f64)>,
}

/// Cells and slits.
#[derive(Clone, Debug, Default)]
pub(crate) struct Network {
    pub(crate) points: Vec<WetPoint>,
    pub(crate) cells: Vec<Cell>,
    pub(crate) slits: Vec<Slit>,
    /// Slits of each cell.
    pub(crate) slits_of: Vec<Vec<u32>>,
    /// Wet points of each pair of nodes.
    pub(crate) points_of_joint: Vec<Vec<u32>>,
    /// Cluster of nodes of each cell, ascending.
    clusters: Vec<u32>,
    /// Wet points by their places among those of interfaces, ascending.
    places: Vec<(PointPlace, u32)>,
}

impl Network {
    /// The network of some interfaces.
    ///
    /// - `kinds`: their numbers; `is_open`: whether liquid enters those that are whole
    pub(crate) fn new(solid: &Solid, interfaces: &Interfaces, joints: &[Joint], kinds: &[u32], is_open: bool) -> Self {
        let mut network = Network { points_of_joint: vec![Vec::new(); joints.len()], ..Network::default() };
        for (index, joint) in (0u32..).zip(joints) {
            for own in joint.points.iter().filter(|own| kinds.contains(&own.kind)) {
                let cluster = own.at.0;
                if network.clusters.last() != Some(&cluster) {
                    network.clusters.push(cluster);
                    network.cells.push(Cell { place: interfaces.place_of(own.at), ..Cell::default() });
                }
                let cell = network.cells.len() - 1;
                let point = network.points.len() as u32;
                network.cells[cell].points.push(point);
                network.cells[cell].area += own.area;
                network.points_of_joint[index as usize].push(point);
                network.places.push((own.at, point));
                network.points.push(WetPoint {
                    at: own.at,
                    joint: index,
                    cell: cell as u32,
                    normal: own.frame.row(0).transpose(),
                    area: own.area,
                    is_permeable: is_open || !own.interface.law.is_bonded(),
                });
            }
        }
        network.places.sort_unstable_by_key(|(at, _)| *at);
        for (index, face) in interfaces.faces().iter().enumerate().filter(|(_, face)| kinds.contains(&face.kind)) {
            let points = interfaces.points_of_face(index).map(|at| network.point_at(at?));
            let corners = face.corners();
            let place = face.sides[0].map(|node| solid.reference[node as usize]);
            let depth = solid.body(face.elements[0].0 as usize).thickness;
            let pairs: &[[usize; 2]] = if corners == 2 { &[[0, 1]] } else { &[[0, 1], [1, 2], [2, 0]] };
            let way = |&[a, b]: &[usize; 2]| {
                let cells = [points[a]?, points[b]?].map(|point| network.points[point as usize].cell);
                let ratio =
                    if corners == 2 { depth / (place[b] - place[a]).norm() } else { half_cotangent(&place, a, b) };
                Some((cells, ratio))
            };
            let ways: Vec<([u32; 2], f64)> = pairs.iter().filter_map(way).filter(|(_, ratio)| *ratio > 0.0).collect();
            if !ways.is_empty() {
                network.slits.push(Slit { points, corners, ways });
            }
        }
        network.slits_of = vec![Vec::new(); network.cells.len()];
        for (index, slit) in (0u32..).zip(&network.slits) {
            for point in slit.points.iter().flatten() {
                network.slits_of[network.points[*point as usize].cell as usize].push(index);
            }
        }
        network
    }

    /// The wet point at a place among those of interfaces.
    pub(crate) fn point_at(&self, at: PointPlace) -> Option<u32> {
        let found = self.places.binary_search_by_key(&at, |(at, _)| *at).ok()?;
        Some(self.places[found].1)
    }

    /// The cells at which some nodes lie, ascending.
    pub(crate) fn cells_at(&self, interfaces: &Interfaces, nodes: &[u32]) -> Vec<u32> {
        let has = |cluster: &u32| interfaces.nodes_of(*cluster).iter().any(|node| nodes.binary_search(node).is_ok());
        (0u32..).zip(&self.clusters).filter(|(_, cluster)| has(cluster)).map(|(cell, _)| cell).collect()
    }
}

/// Half of the cotangent of the angle of a triangle opposite to the edge from one corner to another: what linear pressures flow along that edge.
fn half_cotangent(place: &[Vec3; 3], a: usize, b: usize) -> f64 {
    let third = place[3 - a - b];
    let [to_a, to_b] = [place[a] - third, place[b] - third];
    0.5 * to_a.dot(&to_b) / to_a.cross(&to_b).norm()
}
