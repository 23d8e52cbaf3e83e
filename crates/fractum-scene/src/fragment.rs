use std::borrow::Cow;

use fractum_fem::{Solid, neighbours};
use fractum_math::{Connected, Vec3, connected};

use crate::conditions::SurfaceSupports;

/// A connected piece of a solid or of a bonded body. A fragment has at least two nodes or particles; what is left are
/// single ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Fragment {
    /// Nodes in the piece; particles in that of a bonded body, and after the nodes where both are tied.
    pub nodes: Vec<u32>,
    /// Elements that are still there with all their nodes in the piece.
    pub elements: usize,
    /// Bonds that still hold.
    pub bonds: usize,
    /// Mass [kg].
    pub mass: f64,
    /// Volume [m³]: every element that is still there gives each of its nodes an equal part; of the continuum that its
    /// particles stand for in a bonded body.
    pub volume: f64,
    /// Centre of mass [m].
    pub centroid: Vec3,
    /// Velocity of the centre of mass [m/s].
    pub velocity: Vec3,
    /// Corners of the box around it [m].
    pub bounds: [Vec3; 2],
    /// Whether an absorbing or elastic boundary holds it: it stands for all that lies beyond, and its own size tells nothing.
    pub stays: bool,
}

impl Fragment {
    /// Largest side of the box around it [m].
    pub fn extent(&self) -> f64 {
        (self.bounds[1] - self.bounds[0]).max()
    }

    /// One piece of both.
    fn take(&mut self, other: Fragment) {
        let mass = self.mass + other.mass;
        let mean = |a: Vec3, b: Vec3| (a * self.mass + b * other.mass) / mass;
        (self.centroid, self.velocity) = (mean(self.centroid, other.centroid), mean(self.velocity, other.velocity));
        self.bounds = [self.bounds[0].inf(&other.bounds[0]), self.bounds[1].sup(&other.bounds[1])];
        self.mass = mass;
        self.stays |= other.stays;
        self.volume += other.volume;
        self.elements += other.elements;
        self.bonds += other.bonds;
        self.nodes.extend(other.nodes);
    }
}

/// Pieces of solids and of bonded bodies, those that ties hold together as one.
///
/// - `links`: pairs of a particle and a node that are tied
pub(crate) fn joined(
    mut solids: Vec<Fragment>,
    mut bonded: Vec<Fragment>,
    links: impl Iterator<Item = (u32, u32)>,
) -> Vec<Fragment> {
    let owners = |pieces: &[Fragment]| {
        let size = pieces.iter().flat_map(|p| &p.nodes).max().map_or(0, |n| *n as usize + 1);
        let mut owner = vec![0u32; size];
        for (index, piece) in (0..).zip(pieces) {
            piece.nodes.iter().for_each(|&n| owner[n as usize] = index);
        }
        owner
    };
    let (of_node, of_particle) = (owners(&solids), owners(&bonded));
    let shift = solids.len() as u32;
    solids.append(&mut bonded);
    let pairs = links.map(|(particle, node)| [of_node[node as usize], shift + of_particle[particle as usize]]);
    let part = connected(solids.len(), pairs);
    by_part(solids, &part)
}

/// Pieces of solids connected by edges that have lost less than `joined_below` of their strength, heaviest first; bodies
/// without damage hold together as long as their elements. Single nodes are pieces of their own.
pub fn solid_pieces(solid: &Solid, joined_below: f64) -> Vec<Fragment> {
    let part = joined_nodes(solid, joined_below);
    let mut elements = vec![0usize; part.len()];
    let mut volume = vec![0.0; part.len()];
    for body in 0..solid.body_count() {
        let connected = neighbours::connected_pieces(solid, body);
        for &(node, count) in connected.iter().flat_map(|connected| &connected.pieces) {
            elements[part[node as usize] as usize] += count;
        }
        let own = connected.map_or_else(|| Cow::Owned(nodal_volumes(solid, body)), |own| Cow::Borrowed(&own.volumes));
        volume.iter_mut().zip(&*own).for_each(|(sum, own)| *sum += own);
        if connected.is_some() {
            continue;
        }
        let corners = solid.body(body).shape.node_count();
        let alive = solid.body(body).elements.iter().zip(solid.alive(body)).filter(|(_, alive)| **alive);
        for (nodes, _) in alive {
            let first = part[nodes[0] as usize] as usize;
            let is_inside = nodes[..corners].iter().all(|&node| part[node as usize] as usize == first);
            elements[first] += usize::from(is_inside);
        }
    }
    let mut members: Vec<Vec<u32>> = vec![Vec::new(); part.len()];
    for (node, &place) in (0..).zip(&part) {
        members[place as usize].push(node);
    }
    let mut pieces: Vec<Fragment> = members
        .into_iter()
        .enumerate()
        .filter(|(_, nodes)| !nodes.is_empty())
        .map(|(place, nodes)| {
            let volume = nodes.iter().map(|&node| volume[node as usize]).sum();
            piece(solid, nodes, elements[place], volume)
        })
        .collect();
    pieces.sort_by(|a, b| b.mass.total_cmp(&a.mass).then(a.nodes[0].cmp(&b.nodes[0])));
    pieces
}

/// Pieces of solids, those that links between nodes hold together as one, heaviest first.
pub(crate) fn linked(pieces: Vec<Fragment>, links: impl Iterator<Item = [u32; 2]>) -> Vec<Fragment> {
    let size = pieces.iter().flat_map(|piece| &piece.nodes).max().map_or(0, |node| *node as usize + 1);
    let mut owner = vec![0u32; size];
    for (index, piece) in (0..).zip(&pieces) {
        piece.nodes.iter().for_each(|&node| owner[node as usize] = index);
    }
    let part = connected(pieces.len(), links.map(|pair| pair.map(|node| owner[node as usize])));
    let mut whole = by_part(pieces, &part);
    whole.iter_mut().for_each(|piece| piece.nodes.sort_unstable());
    whole.sort_by(|a, b| b.mass.total_cmp(&a.mass).then(a.nodes[0].cmp(&b.nodes[0])));
    whole
}

/// One piece of all with the same first one.
fn by_part(pieces: Vec<Fragment>, part: &[u32]) -> Vec<Fragment> {
    let mut whole: Vec<Option<Fragment>> = pieces.into_iter().map(Some).collect();
    for index in (0..whole.len()).rev() {
        let first = part[index] as usize;
        if first != index
            && let Some(part) = whole[index].take()
            && let Some(first) = &mut whole[first]
        {
            first.take(part);
        }
    }
    whole.into_iter().flatten().collect()
}

/// [`solid_pieces`], of which those are marked that boundaries hold.
pub(crate) fn marked_pieces(solid: &Solid, joined_below: f64, boundaries: &SurfaceSupports) -> Vec<Fragment> {
    let mut pieces = solid_pieces(solid, joined_below);
    pieces.iter_mut().for_each(|piece| piece.stays = piece.nodes.iter().any(|&node| boundaries.act_on(node)));
    pieces
}

/// What every node has of the volume of a body [m³]: an equal part of each element around it that is still there.
fn nodal_volumes(solid: &Solid, body: usize) -> Vec<f64> {
    let corners = solid.body(body).shape.node_count();
    let (alive, volumes) = (solid.alive(body), solid.element_volumes(body));
    let mut of_nodes = vec![0.0; solid.reference.len()];
    for (element, nodes) in solid.body(body).elements.iter().enumerate().filter(|(e, _)| alive[*e]) {
        let share = volumes[element] / corners as f64;
        nodes[..corners].iter().for_each(|&node| of_nodes[node as usize] += share);
    }
    of_nodes
}

/// Share of the mass of every solid body that is in single nodes, of what has not left.
pub(crate) fn single_share(solid: &Solid, joined_below: f64, has_left: impl Fn(u32) -> bool) -> Vec<f64> {
    let part = joined_nodes(solid, joined_below);
    let mut members = vec![0u32; part.len()];
    part.iter().for_each(|&place| members[place as usize] += 1);
    let of_body = |body: usize| {
        if neighbours::connected_pieces(solid, body).is_some() {
            return 0.0;
        }
        let corners = solid.body(body).shape.node_count();
        let mut nodes: Vec<u32> = solid.body(body).elements.iter().flat_map(|e| &e[..corners]).copied().collect();
        nodes.sort_unstable();
        nodes.dedup();
        let (mut single, mut whole) = (0.0, 0.0);
        for node in nodes.into_iter().filter(|&node| !has_left(node)).map(|node| node as usize) {
            whole += solid.mass[node];
            single += if members[part[node] as usize] == 1 { solid.mass[node] } else { 0.0 };
        }
        if whole > 0.0 { single / whole } else { 0.0 }
    };
    (0..solid.body_count()).map(of_body).collect()
}

/// The smallest node that live elements, and links between nodes, connect each node to.
pub(crate) fn parts(solid: &Solid, links: &[[u32; 2]]) -> Vec<u32> {
    let elements = (0..solid.body_count()).flat_map(|body| element_links(solid, body));
    connected(solid.reference.len(), elements.chain(links.iter().copied()))
}

/// The smallest node that edges with some strength left connect each node to.
fn joined_nodes(solid: &Solid, joined_below: f64) -> Vec<u32> {
    let mut parts = Connected::new(solid.reference.len());
    for body in 0..solid.body_count() {
        if solid.body(body).damage.is_some() {
            solid.each_joined(body, joined_below, |nodes| parts.join(nodes));
        } else {
            element_links(solid, body).for_each(|nodes| parts.join(nodes));
        }
    }
    parts.smallest()
}

/// Pairs of nodes that live elements join.
fn element_links(solid: &Solid, body: usize) -> impl Iterator<Item = [u32; 2]> + '_ {
    let connected = neighbours::connected_pieces(solid, body);
    let known = connected.into_iter().flat_map(|connected| &connected.links).copied();
    let corners = solid.body(body).shape.node_count();
    let alive = solid.body(body).elements.iter().zip(solid.alive(body)).filter(|(_, alive)| **alive);
    let alive = alive.take(if connected.is_some() { 0 } else { usize::MAX });
    known.chain(alive.flat_map(move |(nodes, _)| nodes[1..corners].iter().map(|&node| [nodes[0], node])))
}

fn piece(solid: &Solid, nodes: Vec<u32>, elements: usize, volume: f64) -> Fragment {
    let (mut mass, mut centroid, mut velocity) = (0.0, Vec3::zeros(), Vec3::zeros());
    let (mut low, mut high) = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    for &node in &nodes {
        let (i, position) = (node as usize, solid.position(node as usize));
        mass += solid.mass[i];
        centroid += position * solid.mass[i];
        velocity += solid.velocity[i] * solid.mass[i];
        low = low.inf(&position);
        high = high.sup(&position);
    }
    let bounds = [low, high];
    let (centroid, velocity) = (centroid / mass, velocity / mass);
    Fragment { nodes, elements, bonds: 0, mass, volume, centroid, velocity, bounds, stays: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_fem::{Body, DamageLaw, Elastic, ElementKind};
    use fractum_mesh::generate::structured_box;

    /// Three cubes in a row; the elements of the middle one are pulled apart.
    fn pulled_bar() -> Solid {
        let law = DamageLaw::rankine(3e6, 100.0);
        let mesh = structured_box([3, 1, 1], Vec3::new(0.03, 0.01, 0.01), None);
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let body = Body::new("bar", ElementKind::T4, mesh.tetrahedra, elastic).smoothed().with_damage(law);
        Solid::new(mesh.nodes, vec![body]).unwrap()
    }

    #[test]
    fn pieces_are_joined_by_edges_that_keep_some_strength() {
        let mut solid = pulled_bar();
        let counted =
            |solid: &Solid, limit: f64| solid_pieces(solid, limit).iter().filter(|p| p.nodes.len() > 1).count();
        assert_eq!(counted(&solid, 0.5), 1);
        let far: Vec<usize> = (0..solid.reference.len()).filter(|&i| solid.reference[i].x > 0.015).collect();
        let mut opening = 1e-6;
        while counted(&solid, 0.5) == 1 && opening < 1e-3 {
            opening *= 1.05;
            far.iter().for_each(|&i| solid.displacement[i].x = opening);
            solid.update_internal_forces(1e-7, false);
        }
        // Half the strength is gone across the bar: by far not all of it, and every element is still there.
        assert_eq!((counted(&solid, 0.5), counted(&solid, 0.9)), (2, 1));
        let halves = solid_pieces(&solid, 0.5);
        let (mass, volume) = halves.iter().fold((0.0, 0.0), |(m, v), p| (m + p.mass, v + p.volume));
        assert!((mass / (2400.0 * 3e-6) - 1.0).abs() < 1e-12 && (volume / 3e-6 - 1.0).abs() < 1e-12);
        assert_eq!(halves.iter().map(|p| p.elements).sum::<usize>(), solid.body(0).elements.len() * 2 / 3);
        assert_eq!(single_share(&solid, 0.5, |_| false), [0.0]);
        assert_eq!(single_share(&solid, 0.0, |_| false), [1.0]);
    }
}
