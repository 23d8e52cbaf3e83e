//! Discrete elements at equilibrium: the normal springs of motion, without friction.
//!
//! A tangential spring would need the torques on the elements that hold the particles to leave the moment of the pair in balance.
//! Particles that no element holds have no equilibrium of their own, and touch nothing here.

use fractum_contact::law::ContactMemory;
use fractum_fem::Solid;
use fractum_math::Vec3;

use super::{Debris, Pair};

/// Part of the closing distance by which rounding may bring nodes nearer.
const ROUNDING: f64 = 1e-9;

/// Two nodes that push each other apart.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Push {
    /// Nodes, ascending.
    pub(crate) nodes: [u32; 2],
    /// Unit normal from the first to the second.
    pub(crate) normal: Vec3,
    /// Overlap [m], above 0.
    pub(crate) overlap: f64,
    /// Normal stiffness [N/m].
    pub(crate) stiffness: f64,
}

/// Unit normal from the first to the second node of a pair, and their overlap [m].
fn sense(pair: &Pair, solid: &Solid, field: &[Vec3]) -> (Vec3, f64) {
    let [i, j] = pair.nodes.map(|n| n as usize);
    let apart = solid.reference[j] + field[j] - solid.reference[i] - field[i];
    let distance = apart.norm();
    (if distance > 0.0 { apart / distance } else { Vec3::x() }, pair.closing * (1.0 - ROUNDING) - distance)
}

impl Debris {
    /// Adds the pairs that may touch under a displacement field to those near the last equilibrium. Where they overlapped there
    /// they touch no nearer than that.
    pub(crate) fn meet(&mut self, solid: &Solid, field: &[Vec3]) {
        let place = |node: u32| solid.reference[node as usize] + field[node as usize];
        let state = &self.state;
        let moved = |(&node, at): (&u32, &Vec3)| (place(node) - at).norm_squared();
        let limit = 0.25 * state.skin * state.skin;
        if state.nodes.iter().zip(&state.searched_at).all(|pair| moved(pair) <= limit) {
            return;
        }
        let centres: Vec<Vec3> = state.nodes.iter().map(|&n| place(n)).collect();
        let mut near = self.near(&centres, state.skin);
        near.retain(|&nodes| !solid.is_live_edge(nodes));
        self.add_pairs(solid, near, false);
    }

    /// Whether an element holds both particles of a pair.
    fn rests(&self, pair: &Pair) -> bool {
        pair.nodes.iter().all(|&node| self.state.attached[self.particle_of[node as usize] as usize])
    }

    /// Pairs that touch under a displacement field.
    pub(crate) fn pushes(&self, solid: &Solid, field: &[Vec3]) -> impl Iterator<Item = Push> {
        self.state.pairs.iter().filter(|pair| self.rests(pair)).filter_map(|pair| {
            let (normal, overlap) = sense(pair, solid, field);
            let push = Push { nodes: pair.nodes, normal, overlap, stiffness: pair.law.normal_stiffness };
            (overlap > 0.0).then_some(push)
        })
    }

    /// Takes over the contacts of a state of equilibrium. Returns the work that the mean of the forces at both ends of the step
    /// does on the way to a contact or from it, where there is none [J].
    ///
    /// - `before`: displacements at the last equilibrium; those of the solid are the new ones
    pub(crate) fn accept_at_rest(&mut self, solid: &Solid, before: &[Vec3]) -> f64 {
        let mut pairs = std::mem::take(&mut self.state.pairs);
        let mut idle = 0.0;
        for pair in &mut pairs {
            let rests = self.rests(pair);
            let (_, was) = sense(pair, solid, before);
            let (normal, overlap) = sense(pair, solid, &solid.displacement);
            let pressed = if rests { overlap.max(0.0) } else { 0.0 };
            let half = 0.5 * pair.law.normal_stiffness;
            if rests {
                let (now, then) = (pressed, was.max(0.0));
                idle += half * ((now + then) * (overlap - was) - (now * now - then * then));
            }
            pair.memory = ContactMemory::default();
            (pair.force, pair.couple) = (normal * (2.0 * half * pressed), Vec3::zeros());
            (pair.stored, pair.friction, pair.damping) = (half * pressed * pressed, 0.0, 0.0);
            let [i, j] = pair.nodes.map(|n| n as usize);
            pair.update_closing(pair.closing * (1.0 - ROUNDING) - overlap, self.radius[i] + self.radius[j], solid);
        }
        self.state.pairs = pairs;
        idle
    }

    /// Energy in the springs of all pairs [J].
    pub(crate) fn stored(&self) -> f64 {
        self.state.pairs.iter().map(|pair| pair.stored).sum::<f64>() + 0.0
    }

    /// Adds the forces of the last equilibrium to the nodes.
    pub(crate) fn add_forces_at_rest(&self, solid: &mut Solid) {
        for pair in self.touching() {
            let [i, j] = pair.nodes.map(|n| n as usize);
            solid.force[i] -= pair.force;
            solid.force[j] += pair.force;
        }
    }
}
