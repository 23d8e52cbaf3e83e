//! What nodes of solids meet beside the nodes of their own kind: facets of rigid bodies and of other solids, containers, and
//! particles with nodes of their own.

use std::collections::BTreeMap;

use fractum_contact::law::ContactMemory;
use fractum_contact::{Spheres, Touch};
use fractum_dem::Particles;
use fractum_fem::{Solid, neighbours};
use fractum_math::{Work, connected};
use serde::{Deserialize, Serialize};

use super::debris_among::{DebrisAmong, Made};
use super::edge_contacts::{EdgeContacts, EdgeContactsState};
use super::nodes_on_surface::{NodesOnSurface, frequency_square};
use super::rigid_body::{Form, RigidBody};
use super::solid_surface::SolidSurface;
use super::{Contacts, OverlapWith, SKIN};
use crate::coupling::Debris;

/// What nodes of solids touch beside the nodes of their own kind.
#[derive(Clone, Debug, Default)]
pub(super) struct NodeContacts {
    /// Nodes on each rigid body that has facets or is a container.
    pub(super) on_tools: Vec<Option<NodesOnSurface>>,
    /// Discrete elements among the particles.
    pub(super) debris: Option<DebrisAmong>,
    /// Sharp edges on each other.
    pub(super) edges: Option<EdgeContacts>,
    /// Largest squared frequency that contacts have given to nodes of solids so far [1/s²].
    pub(super) frequency_square: f64,
}

/// The same for a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct NodeContactsState {
    on_tools: Vec<Vec<Touch<ContactMemory>>>,
    debris: Vec<([u32; 2], ContactMemory)>,
    edges: EdgeContactsState,
    frequency_square: f64,
}

impl NodeContacts {
    /// Nothing on a number of rigid bodies.
    pub(super) fn none(rigid_bodies: usize) -> Self {
        NodeContacts { on_tools: vec![None; rigid_bodies], ..NodeContacts::default() }
    }

    pub(super) fn state(&self) -> NodeContactsState {
        let of = |nodes: &Option<NodesOnSurface>| nodes.as_ref().map_or_else(Vec::new, |n| n.contacts().state());
        NodeContactsState {
            on_tools: self.on_tools.iter().map(of).collect(),
            debris: self.debris.as_ref().map_or_else(Vec::new, DebrisAmong::state),
            edges: self.edges.as_ref().map_or_else(EdgeContactsState::default, EdgeContacts::state),
            frequency_square: self.frequency_square,
        }
    }

    /// Puts a saved state back; `solids` without the facets that had gone.
    pub(super) fn restore(&mut self, debris: &Debris, solids: &[SolidSurface], state: NodeContactsState) {
        for (nodes, touches) in self.on_tools.iter_mut().zip(state.on_tools) {
            nodes.iter_mut().for_each(|nodes| nodes.restore(debris, touches.clone()));
        }
        if let Some(among) = &mut self.debris {
            among.restore(state.debris);
        }
        if let Some(edges) = &mut self.edges {
            edges.restore(state.edges, solids);
        }
        self.frequency_square = state.frequency_square;
    }
}

impl Contacts {
    /// Has the nodes of solids meet what there is; those of plane ones meet each other's lines, and their discrete elements discs too.
    ///
    /// - `surface`: nodes on the surfaces of the solids, ascending
    /// - `joined`: bodies that interfaces join
    pub(crate) fn set_node_contacts(
        &mut self,
        solid: &Solid,
        debris: &mut Debris,
        particles: &Particles,
        surface: &[u32],
        joined: &[[u32; 2]],
    ) {
        let is_plane = solid.is_plane();
        if solid.body_count() == 0 || is_plane && particles.thickness.is_none() && self.solids.is_empty() {
            return;
        }
        if !particles.is_empty() {
            let smallest = particles.radius.iter().map(|radius| radius.abs()).fold(f64::INFINITY, f64::min);
            self.nodes.debris = Some(DebrisAmong::new(SKIN * smallest));
        }
        let piece = pieces(solid, joined);
        let apart = |body: usize| -> Vec<bool> { piece.iter().map(|other| *other != piece[body]).collect() };
        let meets = self.solids.iter().any(|ground| apart(ground.body()).contains(&true));
        if meets || !is_plane && self.rigid_bodies.iter().any(has_walls) {
            debris.prepare_holders(solid);
        }
        for ground in &mut self.solids {
            let bodies = apart(ground.body());
            if bodies.contains(&true) {
                ground.has_node_contacts(surface, bodies, debris);
            }
        }
        self.solids.retain(|ground| ground.visitors().is_some() || !particles.is_empty());
        if is_plane {
            find_corners(&mut self.solids, debris);
            for ground in &mut self.solids {
                ground.expect_nodes(solid, debris);
                self.nodes.frequency_square = self.nodes.frequency_square.max(ground.frequency_square());
            }
            return;
        }
        self.nodes.edges = EdgeContacts::new(&self.solids);
        for (rigid_body, nodes) in self.rigid_bodies.iter().zip(&mut self.nodes.on_tools) {
            *nodes = has_walls(rigid_body).then(|| NodesOnSurface::new(surface, vec![true; piece.len()], debris));
        }
    }

    /// Whether nodes of solids that are no discrete elements yet may touch something here.
    pub fn has_node_contacts(&self) -> bool {
        self.nodes.on_tools.iter().any(Option::is_some) || self.solids.iter().any(|ground| ground.visitors().is_some())
    }

    /// Visits every node of a solid that something here looks at, some of them more than once.
    pub(crate) fn each_node(&self, mut visit: impl FnMut(u32)) {
        let visitors =
            self.solids.iter().filter_map(SolidSurface::visitors).chain(self.nodes.on_tools.iter().flatten());
        visitors.flat_map(NodesOnSurface::nodes).for_each(|&node| visit(node));
        self.solids.iter().flat_map(SolidSurface::nodes).for_each(|&node| visit(node));
    }

    /// Adds the forces of nodes of solids; after those of the particles, which put rigid bodies and facets in their places.
    ///
    /// - `searches`: whether to look up particles near discrete elements, where that is due; `dt` [s]: the step that led here
    pub(crate) fn add_node_forces(
        &mut self,
        solid: &mut Solid,
        debris: &mut Debris,
        particles: &mut Particles,
        searches: bool,
        dt: f64,
    ) -> Work {
        let mut work = Work::default();
        let mut fastest = self.nodes.frequency_square;
        for (index, (rigid_body, nodes)) in self.rigid_bodies.iter_mut().zip(&mut self.nodes.on_tools).enumerate() {
            let Some(nodes) = nodes else { continue };
            let surface = rigid_body.surface;
            let law = |solid: &Solid, debris: &Debris, node: u32| {
                debris.wall_law(node, solid.mass[node as usize], Some(index), surface)
            };
            work += nodes.add_forces(&rigid_body.ground(), solid, debris, law, dt);
            for (touch, place, node) in nodes.touches() {
                rigid_body.push(&-touch.force, &-touch.couple, &place, solid.mass[node as usize]);
                let mobility = 1.0 / solid.mass[node as usize];
                fastest = fastest.max(frequency_square(&law(solid, debris, node), mobility));
            }
        }
        for ground in &mut self.solids {
            work += ground.add_node_forces(solid, debris, dt);
            fastest = fastest.max(ground.frequency_square());
        }
        if let Some(edges) = &mut self.nodes.edges {
            work += edges.add_forces(solid, debris, &self.solids, dt);
            fastest = fastest.max(edges.frequency_square());
        }
        if let Some(among) = self.nodes.debris.as_mut().filter(|_| !debris.is_empty()) {
            let made = Made { body: &self.body, materials: &self.materials };
            work += among.add_forces(solid, debris, particles, made, searches, dt);
            fastest = fastest.max(among.frequency_square(solid, debris, particles));
        }
        self.nodes.frequency_square = fastest;
        work
    }

    /// Facets of removed elements go; new discrete elements are taken as they stand.
    ///
    /// - `removed`: elements by body; `before`: number of discrete elements before
    pub(crate) fn release(
        &mut self,
        solid: &Solid,
        debris: &Debris,
        particles: &Particles,
        removed: &[(usize, u32)],
        before: usize,
    ) {
        let born = &debris.state().nodes[before..];
        for ground in &mut self.solids {
            ground.remove_facets(solid, removed);
            ground.admit(born, solid, debris);
        }
        self.nodes.edges.iter_mut().for_each(|edges| edges.remove(&self.solids));
        for (rigid_body, nodes) in self.rigid_bodies.iter().zip(&mut self.nodes.on_tools) {
            if let Some(nodes) = nodes {
                nodes.admit(born, &rigid_body.ground(), solid, debris);
            }
        }
        if let Some(among) = self.nodes.debris.as_mut().filter(|_| !born.is_empty()) {
            let made = Made { body: &self.body, materials: &self.materials };
            among.admit(before, solid, debris, particles, made);
        }
    }

    /// Takes what overlaps as it stands: it gives no force, and touches no nearer than now until it has parted.
    ///
    /// - `which`: the particles whose contacts with solids are taken; all contacts of others than solids are left alone
    pub fn take_up_on_solids(&mut self, solid: &Solid, particles: &Particles, which: impl Fn(u32) -> bool + Sync) {
        let Particles { position, velocity, spin, radius, .. } = particles;
        let spheres = Spheres { position, velocity, spin, radius };
        for ground in &mut self.solids {
            ground.accept_initial_overlap(solid, &spheres, &which);
        }
    }

    /// Takes everything of particles as it stands, as [`Contacts::take_up_on_solids`] does.
    pub(crate) fn accept_particle_overlaps(&mut self, solid: &Solid, particles: &Particles) {
        self.take_up_on_solids(solid, particles, |_| true);
        let Particles { position, velocity, spin, radius, .. } = particles;
        let spheres = Spheres { position, velocity, spin, radius };
        if let Some(mut among) = self.among.take() {
            among.search(&spheres, |i, j| self.law_among(radius, &particles.mass, i, j));
            among.accept_initial_overlap(&spheres, |_, _| true);
            self.among = Some(among);
        }
        self.accept_on_rigid_bodies(particles, false);
    }

    /// Takes all contacts of nodes as they stand, and tells them: node, depth [m] and what the node is in.
    pub(crate) fn accept_node_overlaps(&mut self, solid: &Solid) -> Vec<(u32, f64, OverlapWith)> {
        let mut found = Vec::new();
        let mut tell = |nodes: &NodesOnSurface, other: OverlapWith| {
            found.extend(nodes.touches().map(|(touch, _, node)| (node, touch.overlap, other.clone())));
        };
        for (rigid_body, nodes) in self.rigid_bodies.iter().zip(&mut self.nodes.on_tools) {
            if let Some(nodes) = nodes {
                nodes.accept_initial_overlap(&rigid_body.ground(), solid);
                tell(nodes, OverlapWith::RigidBody(rigid_body.name.clone()));
            }
        }
        for ground in &mut self.solids {
            ground.accept_node_overlaps(solid);
            let name = &solid.body(ground.body()).name;
            ground.visitors().iter().for_each(|nodes| tell(nodes, OverlapWith::Solid(name.clone())));
        }
        if let Some(edges) = &mut self.nodes.edges {
            let name = |ground: usize| OverlapWith::Solid(solid.body(self.solids[ground].body()).name.clone());
            let crossed = edges.accept_initial_overlap(solid, &self.solids);
            found.extend(crossed.into_iter().map(|(node, depth, ground)| (node, depth, name(ground))));
        }
        found
    }

    /// Contacts of nodes at the last step.
    pub(super) fn node_contacts(&self) -> usize {
        let on = |nodes: &NodesOnSurface| nodes.contacts().touches().count();
        let rigid_bodies = self.nodes.on_tools.iter().flatten().map(on).sum::<usize>();
        let solids = self.solids.iter().filter_map(|ground| ground.visitors()).map(on).sum::<usize>();
        let edges = self.nodes.edges.as_ref().map_or(0, |edges| edges.touches().len());
        rigid_bodies + solids + edges + self.nodes.debris.as_ref().map_or(0, DebrisAmong::touching)
    }
}

/// Tells plane surfaces how the nodes that may touch them are corners of their own bodies.
fn find_corners(solids: &mut [SolidSurface], debris: &Debris) {
    let mut beside = BTreeMap::<u32, [Option<u32>; 2]>::new();
    for ground in solids.iter().filter(|ground| ground.visitors().is_some()) {
        for [a, b] in ground.lines() {
            for (node, side, other) in [(a, 1, b), (b, 0, a)] {
                if debris.body(node) == ground.body() {
                    beside.entry(node).or_default()[side] = Some(other);
                }
            }
        }
    }
    let of = |node: u32| match *beside.get(&node)? {
        [Some(before), Some(after)] => Some([before, after]),
        _ => None,
    };
    solids.iter_mut().for_each(|ground| ground.has_corners(of));
}

/// Whether nodes meet a rigid body as facets or as a container; those of other shapes know it as
/// [`NodesOnShape`](crate::NodesOnShape).
fn has_walls(rigid_body: &RigidBody) -> bool {
    !matches!(rigid_body.form, Form::Shape { hollow: false, .. })
}

/// The piece that each solid body belongs to, by the first body of it: bodies that share nodes are one piece, whose bodies do
/// not touch each other.
///
/// - `joined`: bodies that interfaces join, which touch there alone
pub fn pieces(solid: &Solid, joined: &[[u32; 2]]) -> Vec<u32> {
    let mut owner = vec![u32::MAX; solid.reference.len()];
    let mut links = joined.to_vec();
    for body in 0..solid.body_count() {
        for node in neighbours::nodes_of(solid, body) {
            let first = &mut owner[node as usize];
            if *first == u32::MAX {
                *first = body as u32;
            } else if *first != body as u32 {
                links.push([*first, body as u32]);
            }
        }
    }
    connected(solid.body_count(), links)
}
