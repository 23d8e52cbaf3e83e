//! Discrete elements at equilibrium: the normal springs of motion, without friction.
//!
//! A tangential spring would need the torques on the elements that hold the particles to leave the moment of the pair in balance.
//! Particles that no element holds have no equilibrium of their own, and touch nothing here.

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
fn sense(nodes: [u32; 2], closing: f64, solid: &Solid, field: &[Vec3]) -> (Vec3, f64) {
    let [i, j] = nodes.map(|n| n as usize);
    let apart = solid.reference[j] + field[j] - solid.reference[i] - field[i];
    let distance = apart.norm();
    (if distance > 0.0 { apart / distance } else { Vec3::x() }, closing * (1.0 - ROUNDING) - distance)
}

impl Debris {
    /// Adds the pairs that may touch under a displacement field to those near the last equilibrium.
    pub(crate) fn meet(&mut self, solid: &Solid, field: &[Vec3]) {
        if !self.is_empty() {
            self.list_pairs(solid, |node| solid.reference[node] + field[node]);
        }
    }

    /// Pairs that touch under a displacement field, both of whose particles an element holds.
    pub(crate) fn pushes(&self, solid: &Solid, field: &[Vec3]) -> impl Iterator<Item = Push> {
        self.near_pairs().filter_map(|(node, entry)| {
            let nodes = [node, entry.partner];
            let (normal, overlap) = sense(nodes, entry.closing, solid, field);
            let push = || Push { nodes, normal, overlap, stiffness: self.pair_law(solid, nodes).normal_stiffness };
            (overlap > 0.0 && self.both_held(nodes)).then(push)
        })
    }

    /// Takes over the contacts of a state of equilibrium. Returns the work that the mean of the forces at both ends of the step
    /// does on the way to a contact or from it, where there is none [J].
    ///
    /// - `before`: displacements at the last equilibrium; those of the solid are the new ones
    pub(crate) fn accept_at_rest(&mut self, solid: &Solid, before: &[Vec3]) -> f64 {
        let mut contacts = std::mem::take(&mut self.state.contacts);
        contacts.clear();
        let mut idle = 0.0;
        let mut rows = std::mem::take(&mut self.near.rows);
        for node in 0..rows.len() as u32 {
            for entry in rows.row_mut(node) {
                let nodes = [node, entry.partner];
                let (_, was) = sense(nodes, entry.closing, solid, before);
                let (normal, overlap) = sense(nodes, entry.closing, solid, &solid.displacement);
                entry.touches = overlap > 0.0 && self.both_held(nodes);
                if (entry.touches || was > 0.0) && self.both_held(nodes) {
                    let mut pair = Pair { closing: entry.closing, ..self.new_pair(solid, nodes) };
                    let half = 0.5 * pair.law.normal_stiffness;
                    let (now, then) = (overlap.max(0.0), was.max(0.0));
                    idle += half * ((now + then) * (overlap - was) - (now * now - then * then));
                    pair.force = normal * (2.0 * half * now);
                    pair.stored = half * now * now;
                    contacts.extend(entry.touches.then_some(pair));
                }
                let distance = entry.closing * (1.0 - ROUNDING) - overlap;
                self.part(solid, node, entry, distance);
            }
        }
        self.near.rows = rows;
        self.state.contacts = contacts;
        idle
    }

    /// Energy in the springs of all pairs [J].
    pub(crate) fn stored(&self) -> f64 {
        self.state.contacts.iter().map(|pair| pair.stored).sum::<f64>() + 0.0
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
