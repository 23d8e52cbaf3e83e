//! Contacts of discrete elements of solids with each other.

use fractum_contact::close_pairs;
use fractum_contact::law::{ContactForce, ContactMemory, Linear, PairMotion};
use fractum_fem::Solid;
use fractum_math::{Vec3, Work};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Debris, DebrisState};

/// Two particles that may touch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    /// Nodes, ascending.
    pub nodes: [u32; 2],
    /// Distance of the centres at which the pair touches [m].
    pub closing: f64,
    /// Nodes of one mesh edge, all of whose elements have been removed: they touch at their undeformed distance, until
    /// they have parted by more than that.
    pub neighbours: bool,
    pub(super) law: Linear,
    pub(super) memory: ContactMemory,
    /// Force on the second particle [N].
    pub(super) force: Vec3,
    /// Couple on the second particle beside the moment of the force [N m].
    pub(super) couple: Vec3,
    pub(super) stored: f64,
    pub(super) friction: f64,
    pub(super) damping: f64,
}

impl Debris {
    /// Adds those of these pairs, ascending, that are not in the list, in one pass over it.
    pub(super) fn add_pairs(&mut self, solid: &Solid, mut nodes: Vec<[u32; 2]>, neighbours: bool) {
        nodes.retain(|nodes| self.state.pairs.binary_search_by_key(nodes, |p| p.nodes).is_err());
        let added: Vec<Pair> = nodes.into_iter().map(|nodes| self.new_pair(solid, nodes, neighbours)).collect();
        self.state.pairs.extend(added);
        // Two ascending runs: the sort merges them.
        self.state.pairs.sort_by_key(|pair| pair.nodes);
    }

    /// A pair that touches no nearer than now, so that it brings no energy.
    fn new_pair(&self, solid: &Solid, nodes: [u32; 2], neighbours: bool) -> Pair {
        let [i, j] = nodes.map(|n| n as usize);
        let now = (solid.position(j) - solid.position(i)).norm();
        let rest =
            if neighbours { (solid.reference[j] - solid.reference[i]).norm() } else { self.radius[i] + self.radius[j] };
        let ((e1, nu1), (e2, nu2)) = (self.elasticity[i], self.elasticity[j]);
        let (e, nu) = (2.0 * e1 * e2 / (e1 + e2), 0.5 * (nu1 + nu2));
        let (radii, masses) = ([self.radius[i], self.radius[j]], [solid.mass[i], solid.mass[j]]);
        let thickness = self.thickness[i].min(self.thickness[j]);
        let surface = self.surface(nodes[0]).against(self.surface(nodes[1]));
        let law = if thickness > 0.0 {
            Linear::between_discs(e, nu, radii, thickness, masses, surface)
        } else {
            Linear::between_spheres(e, nu, radii, masses, surface)
        };
        Pair {
            nodes,
            closing: rest.min(now),
            neighbours,
            law,
            memory: ContactMemory::default(),
            force: Vec3::zeros(),
            couple: Vec3::zeros(),
            stored: 0.0,
            friction: 0.0,
            damping: 0.0,
        }
    }

    /// Renews the list of pairs if particles came or the skin is used up; true if it did.
    pub(crate) fn search(&mut self, solid: &Solid) -> bool {
        if self.is_empty() {
            return false;
        }
        let state = &self.state;
        let moved = |(&node, at): (&u32, &Vec3)| (solid.position(node as usize) - at).norm_squared();
        let limit = 0.25 * state.skin * state.skin;
        let used_up = || state.nodes.iter().zip(&state.searched_at).any(|pair| moved(pair) > limit);
        if !state.stale && !used_up() {
            return false;
        }
        let centres: Vec<Vec3> = state.nodes.iter().map(|&n| solid.position(n as usize)).collect();
        let radii = state.nodes.iter().map(|&n| self.radius[n as usize]);
        let skin = 0.5 * radii.sum::<f64>() / state.nodes.len() as f64;
        let strangers = self.near(&centres, skin);
        let mut pairs = Vec::with_capacity(strangers.len());
        let mut old = state.pairs.iter().peekable();
        for nodes in strangers {
            while let Some(pair) = old.next_if(|p| p.nodes < nodes) {
                pairs.extend(Some(*pair).filter(|p| p.neighbours));
            }
            match old.next_if(|p| p.nodes == nodes) {
                Some(pair) => pairs.push(*pair),
                // Neighbours that an element still joins are held by it.
                None if solid.is_live_edge(nodes) => {}
                None => pairs.push(self.new_pair(solid, nodes, false)),
            }
        }
        pairs.extend(old.filter(|p| p.neighbours));
        self.state.pairs = pairs;
        self.state.searched_at = centres;
        self.state.skin = skin;
        self.state.stale = false;
        true
    }

    /// Pairs of nodes whose particles, centred at `centres`, are no farther apart than the skin [m], ascending.
    pub(super) fn near(&self, centres: &[Vec3], skin: f64) -> Vec<[u32; 2]> {
        let nodes = &self.state.nodes;
        let radii: Vec<f64> = nodes.iter().map(|&n| self.radius[n as usize]).collect();
        let ascending = |pair: [u32; 2]| {
            let [i, j] = pair.map(|p| nodes[p as usize]);
            [i.min(j), i.max(j)]
        };
        let mut pairs: Vec<[u32; 2]> = close_pairs(centres, &radii, skin).into_iter().map(ascending).collect();
        pairs.sort_unstable();
        pairs
    }

    /// Adds the contact forces of all pairs to the nodes.
    pub(crate) fn add_forces(&mut self, solid: &mut Solid, dt: f64) -> Work {
        let beyond = self.update_turning(solid, dt);
        let Debris { state, particle_of, radius, torque, turning, .. } = self;
        let DebrisState { pairs, .. } = state;
        torque.fill(Vec3::zeros());
        {
            let solid = &*solid;
            let spin = |node: usize| turning[particle_of[node] as usize];
            pairs.par_iter_mut().with_min_len(512).for_each(|pair| {
                let [i, j] = pair.nodes.map(|n| n as usize);
                let apart = solid.position(j) - solid.position(i);
                let distance = apart.norm();
                pair.update_closing(distance, radius[i] + radius[j], solid);
                let normal = if distance > 0.0 { apart / distance } else { Vec3::x() };
                let (arm_i, arm_j) = arms(normal, distance, radius[i], radius[j]);
                let velocity = solid.velocity[j] + spin(j).cross(&arm_j) - solid.velocity[i] - spin(i).cross(&arm_i);
                let motion =
                    PairMotion { normal, overlap: pair.closing - distance, velocity, spin: spin(j) - spin(i), dt };
                let ContactForce { on_second, couple_on_second, stored, friction, damping } =
                    pair.law.force(&motion, &mut pair.memory);
                (pair.force, pair.couple) = (on_second, couple_on_second);
                (pair.stored, pair.friction, pair.damping) = (stored, friction, damping);
            });
        }
        // In the order of the pairs: contacts are few beside elements, and the sum has one order.
        // What torques do more than their contacts know is not left to friction.
        let mut work = Work::contact(0.0, -beyond, 0.0);
        for pair in pairs.iter().filter(|p| p.stored > 0.0 || p.damping != 0.0 || p.friction != 0.0) {
            let [i, j] = pair.nodes.map(|n| n as usize);
            solid.force[i] -= pair.force;
            solid.force[j] += pair.force;
            let apart = solid.position(j) - solid.position(i);
            let distance = apart.norm();
            let (arm_i, arm_j) = arms(apart / distance, distance, radius[i], radius[j]);
            torque[particle_of[i] as usize] -= arm_i.cross(&pair.force) + pair.couple;
            torque[particle_of[j] as usize] += arm_j.cross(&pair.force) + pair.couple;
            work += Work::contact(pair.stored, pair.friction, pair.damping);
        }
        work
    }

    /// Pairs of nodes with the force on the second [N].
    pub(crate) fn loads(&self) -> impl Iterator<Item = ([u32; 2], Vec3)> {
        self.state.pairs.iter().map(|pair| (pair.nodes, pair.force))
    }

    /// Largest squared frequency that the contacts near closing can add to a node, by Gershgorin's rows [1/s²].
    pub(crate) fn frequency_square(&self, solid: &Solid) -> f64 {
        let mut rows = vec![0.0; self.len()];
        for pair in &self.state.pairs {
            let [i, j] = pair.nodes.map(|n| n as usize);
            let apart = (solid.position(j) - solid.position(i)).norm();
            if apart > pair.closing + self.state.skin {
                continue;
            }
            // A turning sphere answers 1 + m r²/I = 3.5 times as fast to the tangential spring; a particle on an element
            // 1.25 times if all nodes of the element weigh the same.
            let free = |n: usize| !self.state.attached[self.particle_of[n] as usize];
            let turning = if free(i) || free(j) { 3.5 } else { 2.0 };
            let rolling = pair.law.rolling.frequency_factor(self.radius[i].min(self.radius[j]));
            let (k_n, k_t) = (pair.law.normal_stiffness, pair.law.tangential_stiffness);
            let stiffness = k_n.max(turning * k_t + rolling * k_n);
            let coupling = stiffness / (solid.mass[i] * solid.mass[j]).sqrt();
            rows[self.particle_of[i] as usize] += stiffness / solid.mass[i] + coupling;
            rows[self.particle_of[j] as usize] += stiffness / solid.mass[j] + coupling;
        }
        rows.into_iter().fold(0.0, f64::max)
    }
}

impl Pair {
    /// Lets the closing distance grow back to that of free spheres once the pair has parted.
    pub(super) fn update_closing(&mut self, distance: f64, sum_of_radii: f64, solid: &Solid) {
        if self.neighbours {
            let [i, j] = self.nodes.map(|n| n as usize);
            let rest = (solid.reference[j] - solid.reference[i]).norm();
            if distance > 2.0 * rest {
                (self.neighbours, self.closing) = (false, sum_of_radii);
            } else if distance >= rest {
                self.closing = rest;
            }
        } else if distance >= sum_of_radii {
            self.closing = sum_of_radii;
        }
    }
}

/// Vectors from both centres to the point of contact, which divides the distance in the ratio of the radii.
fn arms(normal: Vec3, distance: f64, radius_i: f64, radius_j: f64) -> (Vec3, Vec3) {
    let share = radius_i / (radius_i + radius_j);
    (normal * (share * distance), normal * ((share - 1.0) * distance))
}
