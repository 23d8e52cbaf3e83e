mod at_rest;
mod leave;
mod near;
mod pairs;
mod rows;

pub(crate) use at_rest::Push;
pub use pairs::Pair;

use fractum_contact::law::{ContactParameters, ElasticMaterial, Linear};
use fractum_fem::{Solid, removal};
use fractum_math::{HalfSteps, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::holder::{Holder, Holders};
use super::radius::largest_radii;
use crate::contact_pairs::{ContactBody, ContactPairs};
pub(crate) use near::Apart;
use near::Near;

/// No particle at this node.
const NONE: u32 = u32::MAX;

/// Discrete elements at the nodes of removed elements, and their contacts.
///
/// A particle sits on its node and shares its mass and translation: forces of its contacts act on the node in the same
/// step. As long as an element holds the node the particle turns with it and hands it its torques; after that it is a free
/// sphere (a disc in the plane) with rotation of its own.
#[derive(Clone, Debug)]
pub struct Debris {
    /// Contact parameters of each body.
    surfaces: Vec<ContactParameters>,
    /// Pairs of bodies with parameters of their own.
    pairs: ContactPairs,
    /// Body of each node.
    body: Vec<u32>,
    /// All bodies are plane: particles are discs.
    planar: bool,
    /// Young's modulus and Poisson's ratio of the body of each node.
    elasticity: Vec<(f64, f64)>,
    /// Thickness of the body of each node [m]; 0 in space.
    thickness: Vec<f64>,
    /// Radius at each node [m].
    radius: Vec<f64>,
    state: DebrisState,
    /// Particle of each node, or [`NONE`].
    particle_of: Vec<u32>,
    torque: Vec<Vec3>,
    holders: Holders,
    /// How the particles turn that touch.
    turned: Vec<Turned>,
    /// Where each particle is in that list, or [`NONE`].
    place_in_turned: Vec<u32>,
    near: Near,
    /// Pairs of nodes that never touch.
    pub(crate) apart: Apart,
    /// Stiffness over mass of the contacts of each particle [1/s²]; zero but while it is summed.
    rates: Vec<f64>,
}

/// How a particle turns at the moment, as contact sees it.
#[derive(Clone, Debug)]
struct Turned {
    particle: u32,
    /// Its own angular velocity, or that of its holder [rad/s].
    spin: Vec3,
    /// The element that holds it.
    holder: Option<Holder>,
}

/// What changes in the debris during a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DebrisState {
    /// Nodes of the particles in the order of their birth.
    pub nodes: Vec<u32>,
    /// Whether some element still holds the particle.
    pub attached: Vec<bool>,
    /// Angular velocity of free particles at the half step, zero of attached ones [rad/s].
    pub spin: Vec<Vec3>,
    /// Pairs that touch, ascending, and those that have just parted.
    contacts: Vec<Pair>,
    /// Pairs that touch at another distance than free spheres, ascending; only in a checkpoint.
    special: Vec<SpecialPair>,
    /// Torques that elements got at the last step.
    handed: Vec<Handed>,
}

/// Two particles that touch at another distance than free spheres.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct SpecialPair {
    nodes: [u32; 2],
    closing: f64,
    neighbours: bool,
}

/// A torque that an element got from a particle that it holds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Handed {
    particle: u32,
    /// Number among the elements of all bodies.
    element: u32,
    /// [N m].
    torque: Vec3,
}

impl Debris {
    /// Debris of a solid without any particle yet.
    ///
    /// - `surfaces`: of each body of the solid, in their order
    pub fn new(solid: &Solid, surfaces: Vec<ContactParameters>) -> Self {
        let bodies = 0..solid.body_count();
        assert_eq!(surfaces.len(), bodies.len(), "one surface per body");
        Debris {
            surfaces,
            pairs: ContactPairs::default(),
            body: Vec::new(),
            planar: bodies.clone().all(|b| solid.body(b).shape == fractum_fem::ElementKind::T3),
            elasticity: Vec::new(),
            thickness: Vec::new(),
            radius: Vec::new(),
            state: DebrisState::default(),
            particle_of: vec![NONE; solid.reference.len()],
            torque: Vec::new(),
            holders: Holders::default(),
            turned: Vec::new(),
            place_in_turned: Vec::new(),
            near: Near::default(),
            apart: Apart::default(),
            rates: Vec::new(),
        }
    }

    /// The same with pairs of bodies that have contact parameters of their own.
    pub fn with_pairs(self, pairs: ContactPairs) -> Self {
        Debris { pairs, ..self }
    }

    /// Finds radii, bodies and materials of the nodes; needed before the first contact of any kind, and before anyone asks for them.
    ///
    /// Those of nodes around which a rank does not have all elements are not right; nothing ever touches them.
    pub fn prepare(&mut self, solid: &Solid) {
        if !self.radius.is_empty() {
            return;
        }
        self.radius = largest_radii(solid);
        let count = solid.reference.len();
        (self.body, self.elasticity, self.thickness) = (vec![0; count], vec![(0.0, 0.0); count], vec![0.0; count]);
        // The first body of a node counts.
        for index in (0..solid.body_count()).rev() {
            let body = solid.body(index);
            let pair = (body.elastic.young_modulus, body.elastic.poisson_ratio);
            for &node in body.elements.iter().flatten() {
                let i = node as usize;
                (self.elasticity[i], self.body[i]) = (pair, index as u32);
                // On an axis the ring about it counts.
                let place =
                    solid.reference[i].sup(&Vec3::new(0.5 * self.radius[i], f64::NEG_INFINITY, f64::NEG_INFINITY));
                self.thickness[i] = body.depth().map_or(0.0, |depth| depth.at(&place));
            }
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.state.nodes.len()
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.state.nodes.is_empty()
    }

    /// Particles in the order of their birth, with their nodes.
    pub fn state(&self) -> &DebrisState {
        &self.state
    }

    /// Radius at a node [m], particle or not.
    pub fn radius(&self, node: u32) -> f64 {
        self.radius[node as usize]
    }

    /// Thickness of the disc at a node [m]; 0 for spheres.
    pub fn thickness(&self, node: u32) -> f64 {
        self.thickness[node as usize]
    }

    /// Pairs that touch at the last step.
    pub fn touching(&self) -> impl Iterator<Item = &Pair> {
        self.state.contacts.iter().filter(|p| p.stored > 0.0)
    }

    /// Contact parameters of the body of a node.
    fn surface(&self, node: u32) -> ContactParameters {
        self.surfaces[self.body(node)]
    }

    /// Contact parameters of the body of a node with another body, which has the `surface`.
    pub(crate) fn surface_with(&self, node: u32, other: ContactBody, surface: ContactParameters) -> ContactParameters {
        self.pairs.surface([other, ContactBody::Solid(self.body(node))], [surface, self.surface(node)])
    }

    /// The law of a node on a rigid wall.
    ///
    /// - `rigid_body`: the one that the wall is part of; `wall`: its surface
    pub(crate) fn wall_law(&self, node: u32, mass: f64, rigid_body: Option<usize>, wall: ContactParameters) -> Linear {
        let i = node as usize;
        let ((e, nu), radius, thickness) = (self.elasticity[i], self.radius[i], self.thickness[i]);
        let surface = match rigid_body {
            Some(index) => self.surface_with(node, ContactBody::Rigid(index), wall),
            None => wall.against(self.surface(node)),
        };
        if thickness > 0.0 {
            Linear::disc_on_wall(e, nu, radius, thickness, mass, surface)
        } else {
            Linear::on_wall(e, nu, radius, mass, surface)
        }
    }

    /// Body of a node.
    pub(crate) fn body(&self, node: u32) -> usize {
        self.body[node as usize] as usize
    }

    /// Young's modulus [Pa] and Poisson's ratio of a node against another material, as between two nodes.
    pub(crate) fn mean_elasticity(&self, node: u32, other: &ElasticMaterial) -> (f64, f64) {
        let ((e1, nu1), (e2, nu2)) = (self.elasticity[node as usize], (other.young_modulus, other.poisson_ratio));
        (2.0 * e1 * e2 / (e1 + e2), 0.5 * (nu1 + nu2))
    }

    /// The law of a node of a solid on a facet of another body, or on a line of a plane one.
    ///
    /// - `other`, `thickness`, `body`, `surface`: the other body; its thickness [m] is 0 in space
    pub(crate) fn facet_law(
        &self,
        node: u32,
        mass: f64,
        (other, thickness): (&ElasticMaterial, f64),
        (body, surface): (usize, ContactParameters),
    ) -> Linear {
        let ((e, nu), radius) = (self.mean_elasticity(node, other), self.radius(node));
        let surface = self.surface_with(node, ContactBody::Solid(body), surface);
        if thickness > 0.0 {
            Linear::disc_on_wall(e, nu, radius, thickness.min(self.thickness(node)), mass, surface)
        } else {
            Linear::on_wall(e, nu, radius, mass, surface)
        }
    }

    /// Finds the elements that hold the nodes; needed before a node that is no particle yet touches facets.
    pub(crate) fn prepare_holders(&mut self, solid: &Solid) {
        self.prepare(solid);
        self.find_holders(solid);
    }

    fn find_holders(&mut self, solid: &Solid) {
        if self.holders.is_empty() {
            self.holders = Holders::new(solid);
        }
    }

    /// Angular velocity at a node: of its particle, or of an element that holds it [rad/s].
    pub(crate) fn turning_at(&self, solid: &Solid, node: u32) -> Vec3 {
        match self.particle_of[node as usize] {
            NONE => self.holder_of(solid, node).map_or_else(Vec3::zeros, |holder| holder.spin(solid)),
            particle => self.spin_of(solid, particle),
        }
    }

    /// Adds a torque at a node [N m]: on its particle, or as forces on an element that holds it.
    pub(crate) fn add_torque_at(&mut self, solid: &mut Solid, node: u32, torque: Vec3) {
        if self.particle_of[node as usize] != NONE {
            self.add_torque(node, torque);
        } else if let Some(holder) = self.holder_of(solid, node) {
            holder.add_torque(solid, torque);
        }
    }

    /// Radius of the particle at a node, 0 without one [m].
    pub(crate) fn radius_if_particle(&self, node: u32) -> f64 {
        if self.particle_of[node as usize] == NONE { 0.0 } else { self.radius[node as usize] }
    }

    /// Whether there is a particle at a node that no element holds any more.
    pub(crate) fn is_loose(&self, node: u32) -> bool {
        let particle = self.particle_of[node as usize];
        particle != NONE && !self.state.attached[particle as usize]
    }

    /// Angular velocity of the particle at a node, zero without one.
    pub(crate) fn spin(&self, solid: &Solid, node: u32) -> Vec3 {
        match self.particle_of[node as usize] {
            NONE => Vec3::zeros(),
            particle => self.spin_of(solid, particle),
        }
    }

    /// Angular velocity of a particle as contact sees it.
    fn spin_of(&self, solid: &Solid, particle: u32) -> Vec3 {
        if !self.state.attached[particle as usize] {
            return self.state.spin[particle as usize];
        }
        let holder = self.holder_of(solid, self.state.nodes[particle as usize]);
        holder.map_or_else(Vec3::zeros, |holder| holder.spin(solid))
    }

    /// Adds a torque on the particle at a node [N m].
    pub(crate) fn add_torque(&mut self, node: u32, torque: Vec3) {
        let particle = self.particle_of[node as usize];
        if particle != NONE {
            self.torque[particle as usize] += torque;
        }
    }

    /// Angular momentum of all spins [kg m²/s].
    pub fn spin_momentum(&self, solid: &Solid) -> Vec3 {
        let of =
            |(&node, spin): (&u32, &Vec3)| spin * self.inertia(solid.mass[node as usize], self.radius[node as usize]);
        self.state.nodes.iter().zip(&self.state.spin).map(of).sum()
    }

    /// Nodes that are looked at where discrete elements or contacts are at some nodes: these, and those of the elements around them,
    /// which hold them.
    pub(crate) fn nodes_near(&mut self, solid: &Solid, nodes: impl Iterator<Item = u32>) -> Vec<u32> {
        self.find_holders(solid);
        self.holders.nodes_near(solid, nodes)
    }

    /// Puts particles on the nodes of elements that were just removed, and opens the edges that lost their last
    /// element to contact.
    pub(crate) fn release(&mut self, solid: &Solid, removed: &[(usize, u32)]) {
        self.prepare_holders(solid);
        if self.near.is_empty() {
            self.near = Near::new(&self.radius, self.planar);
        }
        for &(body, element) in removed {
            let corners = solid.body(body).shape.node_count();
            for &node in &solid.body(body).elements[element as usize][..corners] {
                if self.particle_of[node as usize] == NONE {
                    self.particle_of[node as usize] = self.state.nodes.len() as u32;
                    self.state.nodes.push(node);
                    self.state.attached.push(true);
                    self.state.spin.push(Vec3::zeros());
                    self.torque.push(Vec3::zeros());
                    self.place_in_turned.push(NONE);
                }
                let particle = self.particle_of[node as usize] as usize;
                self.state.attached[particle] = self.holders.is_held(solid, node);
            }
        }
        self.open_edges(solid, removal::edges_without_elements(solid, removed));
    }

    fn holder_of(&self, solid: &Solid, node: u32) -> Option<Holder> {
        self.holders.of(solid, node, self.radius[node as usize])
    }

    /// Finds how the particles of contacts turn now, and those whose torques elements got. Contacts are about to book the torques of
    /// the step before with that; returns what those torques did on the elements that got them beyond it, over `dt` [J].
    ///
    /// Both differ where a particle has come free or its element has gone: it keeps no spin of the element.
    fn update_turning(&mut self, solid: &Solid, dt: f64) -> f64 {
        let mut turned = std::mem::take(&mut self.turned);
        turned.iter().for_each(|known| self.place_in_turned[known.particle as usize] = NONE);
        turned.clear();
        let of_contacts = self.state.contacts.iter().flat_map(|pair| pair.nodes);
        let handed = self.state.handed.iter().map(|handed| handed.particle);
        for particle in of_contacts.map(|node| self.particle_of[node as usize]).chain(handed) {
            let place = &mut self.place_in_turned[particle as usize];
            if *place == NONE {
                *place = turned.len() as u32;
                turned.push(Turned { particle, spin: self.state.spin[particle as usize], holder: None });
            }
        }
        turned.par_iter_mut().with_min_len(256).for_each(|Turned { particle, spin, holder }| {
            if self.state.attached[*particle as usize] {
                *holder = self.holder_of(solid, self.state.nodes[*particle as usize]);
                *spin = holder.as_ref().map_or_else(Vec3::zeros, |holder| holder.spin(solid));
            }
        });
        self.turned = turned;
        let beyond = |handed: &Handed| {
            let now = &self.turned[self.place_in_turned[handed.particle as usize] as usize];
            if now.holder.as_ref().is_some_and(|holder| holder.number == handed.element) {
                return 0.0;
            }
            let node = self.state.nodes[handed.particle as usize];
            let holder = self.holders.element(solid, handed.element, self.radius[node as usize]);
            let spin = holder.map_or_else(Vec3::zeros, |holder| holder.spin(solid));
            0.5 * dt * handed.torque.dot(&(spin - now.spin))
        };
        self.state.handed.iter().map(beyond).sum()
    }

    /// Hands the torques of all contacts on attached particles to the elements that hold them.
    pub(crate) fn pass_on_torques(&mut self, solid: &mut Solid) {
        self.state.handed.clear();
        for particle in 0..self.len() {
            let torque = self.torque[particle];
            if !self.state.attached[particle] || torque == Vec3::zeros() {
                continue;
            }
            let found = match self.place_in_turned[particle] {
                NONE => self.holder_of(solid, self.state.nodes[particle]),
                place => self.turned[place as usize].holder,
            };
            if let Some(holder) = found {
                holder.add_torque(solid, torque);
                self.state.handed.push(Handed { particle: particle as u32, element: holder.number, torque });
            }
        }
    }

    /// Turns the free particles; returns their rotational energy at tⁿ, measured as that of the nodes [J].
    ///
    /// - `measure`: whether the energy is wanted
    pub(crate) fn turn(&mut self, solid: &Solid, dt_before: f64, dt_after: f64, measure: bool) -> HalfSteps {
        let mut work = HalfSteps::default();
        for particle in 0..self.len() {
            if self.state.attached[particle] || (!measure && self.torque[particle] == Vec3::zeros()) {
                continue;
            }
            let node = self.state.nodes[particle] as usize;
            let inertia = self.inertia(solid.mass[node], self.radius[node]);
            let mut torque = self.torque[particle];
            if self.planar {
                (torque.x, torque.y) = (0.0, 0.0);
            }
            let before = self.state.spin[particle];
            let after = before + torque * (0.5 * (dt_before + dt_after) / inertia);
            self.state.spin[particle] = after;
            work.before.kinetic += 0.5 * before.dot(&(before * inertia + torque * dt_before));
            work.after.kinetic += 0.5 * after.dot(&(after * inertia - torque * dt_after));
        }
        work
    }

    /// Ends all turning.
    pub(crate) fn stop(&mut self) {
        self.state.spin.fill(Vec3::zeros());
    }

    fn inertia(&self, mass: f64, radius: f64) -> f64 {
        (if self.planar { 0.5 } else { 0.4 }) * mass * radius * radius
    }

    /// Puts a saved state back.
    pub(crate) fn restore(&mut self, solid: &Solid, state: DebrisState) {
        if !state.nodes.is_empty() {
            self.prepare_holders(solid);
        }
        self.particle_of.fill(NONE);
        for (particle, &node) in (0..).zip(&state.nodes) {
            self.particle_of[node as usize] = particle;
        }
        self.torque = vec![Vec3::zeros(); state.nodes.len()];
        self.turned.clear();
        self.place_in_turned = vec![NONE; state.nodes.len()];
        self.state = state;
        if !self.radius.is_empty() {
            self.list_anew(solid);
        }
    }

    /// What changes, for a checkpoint.
    pub(crate) fn saved(&self) -> DebrisState {
        let special = self.near_pairs().filter_map(|(node, entry)| {
            let nodes = [node, entry.partner];
            let sum = self.radius(nodes[0]) + self.radius(nodes[1]);
            let special = SpecialPair { nodes, closing: entry.closing, neighbours: entry.neighbours };
            (special.neighbours || special.closing != sum).then_some(special)
        });
        DebrisState { special: special.collect(), ..self.state.clone() }
    }

    /// Largest damping ratio of the contacts.
    pub(crate) fn damping_ratio(&self) -> f64 {
        self.surfaces.iter().map(|s| s.damping_ratio).fold(self.pairs.damping_ratio(), f64::max)
    }
}
