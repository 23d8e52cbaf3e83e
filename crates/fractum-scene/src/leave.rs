//! Free pieces that are wholly outside the domain of a run leave it.

use fractum_math::Vec3;

use crate::conditions::Population;
use crate::domain::{Domain, Left};
use crate::fragment::parts;
use crate::scene::Scene;
use fractum_fem::removal;

/// Steps between two looks for pieces that have left the domain.
const STEPS_BETWEEN_FAREWELLS: u64 = 100;

impl Scene {
    /// The same scene, in which free pieces outside a box leave the run.
    pub fn with_domain(mut self, domain: Domain) -> Self {
        self.removals.domain = Some(domain);
        self
    }

    /// The box outside of which free pieces leave the run.
    pub fn domain(&self) -> Option<Domain> {
        self.removals.domain
    }

    /// What has left the run.
    pub fn left(&self) -> &Left {
        &self.removals.left
    }

    /// Whether a point of a population has left the run.
    pub(crate) fn has_left(&self, population: Population) -> impl Fn(u32) -> bool + use<> {
        let nodes = self.solid.reference.len();
        let mut left: Vec<u32> = match population {
            Population::Nodes => self.left().nodes(nodes).collect(),
            Population::Particles => self.left().particles(nodes).collect(),
        };
        left.sort_unstable();
        move |point| left.binary_search(&point).is_ok()
    }

    /// Has nothing push what has left, which rests where it was then.
    pub(crate) fn let_left_rest(&mut self) {
        let Scene { removals, solid, .. } = self;
        for node in removals.left.nodes(solid.reference.len()) {
            solid.force[node as usize] = Vec3::zeros();
        }
    }

    /// The box, where it is time to look for what is outside of it.
    fn domain_to_look_at(&self) -> Option<Domain> {
        self.removals.domain.filter(|_| self.clock.step.is_multiple_of(STEPS_BETWEEN_FAREWELLS))
    }

    /// Lets pieces of bonded bodies and loose particles leave, between the forces of tⁿ and the kick.
    ///
    /// - `dt`: the step that led to tⁿ [s]
    pub(crate) fn let_particles_leave(&mut self, dt: f64) {
        let Some(domain) = self.domain_to_look_at() else { return };
        self.bonded.gather_motion();
        if !self.bonded.has_outside(&domain) {
            return;
        }
        self.bonded.gather();
        self.bonded.gather_forces();
        self.gather_contacts();
        let mut touching: Vec<u32> = Vec::new();
        self.contacts.each_touching_particle(|i| touching.push(i));
        let (energy, gone) = self.bonded.let_leave(&domain, &touching, dt, &mut self.removals.left);
        self.books.left += energy;
        if !gone.is_empty() {
            gone.iter().for_each(|&i| self.removals.left.push(self.solid.reference.len() as u32 + i));
            self.contacts.look_again(&self.bonded.particles.radius);
        }
    }

    /// Lets every piece of the solids leave that is wholly outside the domain, that no support holds, and that touches nothing.
    ///
    /// The energy that goes is that of the half step, ½ m v² of the nodes and ½ σ¹ : ε⁰ of the elements, which central differences
    /// conserve: the balance of free elastic pieces closes to rounding.
    ///
    /// - `dt`: time since the forces were last computed [s]
    pub(crate) fn let_pieces_leave(&mut self, dt: f64) {
        let Some(domain) = self.domain_to_look_at() else { return };
        self.gather_nodes();
        let (solid, planar) = (&self.solid, self.solid.is_plane());
        let mut gone = vec![false; solid.reference.len()];
        self.removals.left.nodes(gone.len()).for_each(|node| gone[node as usize] = true);
        let outside: Vec<bool> = (0..gone.len()).map(|node| domain.is_outside(&solid.position(node), planar)).collect();
        if !outside.iter().zip(&gone).any(|(outside, gone)| *outside && !gone) {
            return;
        }
        let piece = parts(solid);
        let mut stays = vec![false; gone.len()];
        outside.iter().zip(&piece).filter(|(outside, _)| !**outside).for_each(|(_, &p)| stays[p as usize] = true);
        self.each_bound_node(|node| stays[piece[node as usize] as usize] = true);
        let leaves: Vec<bool> = (0..gone.len()).map(|node| !gone[node] && !stays[piece[node] as usize]).collect();
        if leaves.contains(&true) {
            self.take_leave(&leaves, &piece, dt);
        }
    }

    /// Visits every node that a support holds or that touches something.
    fn each_bound_node(&self, mut visit: impl FnMut(u32)) {
        let held = (0..).zip(self.supports.held()).filter(|(_, held)| **held != 0).map(|(node, _)| node);
        held.for_each(&mut visit);
        self.optional.surface_supports.nodes().for_each(&mut visit);
        self.debris.bound_nodes().for_each(&mut visit);
        self.ties.nodes().for_each(&mut visit);
        self.contacts.each_touching_node(&self.debris, &self.bonded.particles, &mut visit);
        for candidate in self.shape_contacts.iter().flat_map(|ground| &ground.candidates) {
            if candidate.is_loaded() {
                visit(candidate.node);
            }
        }
    }

    fn take_leave(&mut self, leaves: &[bool], piece: &[u32], dt: f64) {
        let mut elements: Vec<(usize, u32)> = Vec::new();
        for body in 0..self.solid.body_count() {
            let of_body = (0..).zip(&*self.solid.body(body).elements).zip(self.solid.alive(body));
            let leaving = of_body.filter(|((_, nodes), alive)| **alive && leaves[nodes[0] as usize]);
            elements.extend(leaving.map(|((element, _), _)| (body, element)));
        }
        let mut energy =
            self.debris.spin_energy(&self.solid, leaves) + removal::take_out(&mut self.solid, dt, &elements);
        let Scene { solid, removals, .. } = self;
        for node in (0..leaves.len()).filter(|&node| leaves[node]) {
            let (mass, velocity) = (solid.mass[node], std::mem::take(&mut solid.velocity[node]));
            energy += 0.5 * mass * velocity.norm_squared();
            removals.left.mass += mass;
            removals.left.momentum += velocity * mass;
            removals.left.pieces += usize::from(piece[node] as usize == node);
            removals.left.push(node as u32);
        }
        self.removals.left.elements += elements.len();
        if !elements.is_empty() {
            self.heat_loses_elements();
        }
        self.books.left += energy;
        let born = self.debris.state().nodes.clone();
        self.debris.let_leave(&self.solid, leaves);
        let Scene { solid, debris, contacts, bonded, removals, .. } = self;
        let gone: Vec<u32> = removals.left.nodes(leaves.len()).collect();
        contacts.let_nodes_leave(solid, debris, bonded.particles.len(), &born, &gone, &elements);
        for ground in &mut self.shape_contacts {
            ground.candidates.retain(|candidate| !leaves[candidate.node as usize]);
        }
        self.update_wall_frequency();
        if !elements.is_empty() && !self.settings.time_step.element_bound {
            self.frequencies.stable = self.solid.stable_step();
        }
    }
}
