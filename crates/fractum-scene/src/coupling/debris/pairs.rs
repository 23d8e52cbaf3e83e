//! Contacts of discrete elements of solids with each other.

use fractum_contact::law::{ContactForce, ContactMemory, Linear, PairMotion};
use fractum_fem::Solid;
use fractum_math::{Vec3, Work};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Debris, DebrisState};
use crate::contact_pairs::ContactBody;

/// Gap over the distance of the centres below which a pair is about to touch.
const NEAR: f64 = 0.05;

/// Two particles that touch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Nodes, ascending.
    pub nodes: [u32; 2],
    /// Distance of the centres at which the pair touches [m].
    pub closing: f64,
    pub(super) law: Linear,
    pub(super) memory: ContactMemory,
    /// Force on the second particle [N].
    pub(super) force: Vec3,
    /// Moments of force and couple about the centres, to be taken from the first particle and given to the second [N m].
    #[serde(skip)]
    pub(super) moments: [Vec3; 2],
    pub(super) stored: f64,
    pub(super) friction: f64,
    pub(super) damping: f64,
}

impl Debris {
    /// A contact that begins; its closing distance is left to the caller.
    pub(super) fn new_pair(&self, solid: &Solid, nodes: [u32; 2]) -> Pair {
        Pair {
            nodes,
            closing: 0.0,
            law: self.pair_law(solid, nodes),
            memory: ContactMemory::default(),
            force: Vec3::zeros(),
            moments: [Vec3::zeros(); 2],
            stored: 0.0,
            friction: 0.0,
            damping: 0.0,
        }
    }

    /// The law of the particles of two nodes.
    pub(super) fn pair_law(&self, solid: &Solid, nodes: [u32; 2]) -> Linear {
        let [i, j] = nodes.map(|n| n as usize);
        let ((e1, nu1), (e2, nu2)) = (self.elasticity[i], self.elasticity[j]);
        let (e, nu) = (2.0 * e1 * e2 / (e1 + e2), 0.5 * (nu1 + nu2));
        let (radii, masses) = ([self.radius[i], self.radius[j]], [solid.mass[i], solid.mass[j]]);
        let thickness = self.thickness[i].min(self.thickness[j]);
        let surface = self.surface_with(nodes[1], ContactBody::Solid(self.body(nodes[0])), self.surface(nodes[0]));
        if thickness > 0.0 {
            Linear::between_discs(e, nu, radii, thickness, masses, surface)
        } else {
            Linear::between_spheres(e, nu, radii, masses, surface)
        }
    }

    /// Adds the contact forces of all pairs to the nodes.
    pub(crate) fn add_forces(&mut self, solid: &mut Solid, dt: f64) -> Work {
        let beyond = self.update_turning(solid, dt);
        let Debris { state, particle_of, radius, torque, turned, place_in_turned, .. } = self;
        let DebrisState { contacts, .. } = state;
        torque.fill(Vec3::zeros());
        {
            let solid = &*solid;
            let spin = |node: usize| turned[place_in_turned[particle_of[node] as usize] as usize].spin;
            contacts.par_iter_mut().with_min_len(512).for_each(|pair| {
                let [i, j] = pair.nodes.map(|n| n as usize);
                let apart = solid.position(j) - solid.position(i);
                let distance = apart.norm();
                let normal = if distance > 0.0 { apart / distance } else { Vec3::x() };
                let (arm_i, arm_j) = arms(normal, distance, radius[i], radius[j]);
                let velocity = solid.velocity[j] + spin(j).cross(&arm_j) - solid.velocity[i] - spin(i).cross(&arm_i);
                let motion =
                    PairMotion { normal, overlap: pair.closing - distance, velocity, spin: spin(j) - spin(i), dt };
                let ContactForce { on_second, couple_on_second, stored, friction, damping } =
                    pair.law.force(&motion, &mut pair.memory);
                pair.force = on_second;
                pair.moments = [arm_i, arm_j].map(|arm| arm.cross(&on_second) + couple_on_second);
                (pair.stored, pair.friction, pair.damping) = (stored, friction, damping);
            });
        }
        // In the order of the pairs: contacts are few beside elements, and the sum has one order.
        // What torques do more than their contacts know is not left to friction.
        let mut work = Work::contact(0.0, -beyond, 0.0);
        for pair in contacts.iter().filter(|p| p.stored > 0.0 || p.damping != 0.0 || p.friction != 0.0) {
            let [i, j] = pair.nodes.map(|n| n as usize);
            solid.force[i] -= pair.force;
            solid.force[j] += pair.force;
            torque[particle_of[i] as usize] -= pair.moments[0];
            torque[particle_of[j] as usize] += pair.moments[1];
            work += Work::contact(pair.stored, pair.friction, pair.damping);
        }
        work
    }

    /// Pairs of nodes with the force on the second [N].
    pub(crate) fn loads(&self) -> impl Iterator<Item = ([u32; 2], Vec3)> {
        self.state.contacts.iter().map(|pair| (pair.nodes, pair.force))
    }

    /// Largest squared frequency that contacts can add to a node, by Gershgorin's rows [1/s²].
    ///
    /// - `near`: also by pairs that are about to touch, whose gap is a small part of their distance
    pub(crate) fn frequency_square(&mut self, solid: &Solid, near: bool) -> f64 {
        let mut rates = std::mem::take(&mut self.rates);
        rates.resize(self.len(), 0.0);
        if near {
            for (node, entry) in self.near_pairs() {
                let nodes = [node, entry.partner];
                let apart = (solid.position(nodes[1] as usize) - solid.position(nodes[0] as usize)).norm();
                if apart <= entry.closing * (1.0 + NEAR) {
                    self.add_rates(solid, nodes, &self.pair_law(solid, nodes), &mut rates);
                }
            }
        } else {
            self.state.contacts.iter().for_each(|pair| self.add_rates(solid, pair.nodes, &pair.law, &mut rates));
        }
        let largest = rates.iter().copied().fold(0.0, f64::max);
        rates.fill(0.0);
        self.rates = rates;
        largest
    }

    /// Adds the rows of a contact: stiffness over mass.
    fn add_rates(&self, solid: &Solid, nodes: [u32; 2], law: &Linear, rates: &mut [f64]) {
        let [i, j] = nodes.map(|n| n as usize);
        let [p, q] = [i, j].map(|n| self.particle_of[n] as usize);
        // A turning sphere answers 1 + m r²/I = 3.5 times as fast to the tangential spring, a disc 3 times; a particle on an
        // element 1.25 times if all nodes of the element weigh the same.
        let free = !self.state.attached[p] || !self.state.attached[q];
        let turning = match (free, self.planar) {
            (false, _) => 2.0,
            (true, true) => 3.0,
            (true, false) => 3.5,
        };
        let rolling = law.rolling.frequency_factor(self.radius[i].min(self.radius[j]));
        let (k_n, k_t) = (law.normal_stiffness, law.tangential_stiffness);
        let stiffness = k_n.max(turning * k_t + rolling * k_n);
        let coupling = stiffness / (solid.mass[i] * solid.mass[j]).sqrt();
        rates[p] += stiffness / solid.mass[i] + coupling;
        rates[q] += stiffness / solid.mass[j] + coupling;
    }
}

/// Vectors from both centres to the point of contact, which divides the distance in the ratio of the radii.
fn arms(normal: Vec3, distance: f64, radius_i: f64, radius_j: f64) -> (Vec3, Vec3) {
    let share = radius_i / (radius_i + radius_j);
    (normal * (share * distance), normal * ((share - 1.0) * distance))
}
