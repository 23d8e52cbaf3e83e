//! Rigid planes that nodes and particles rest on.

use fractum_contact::ContactWork;
use fractum_contact::law::{ContactForce, ContactMemory, Linear, PairMotion, Surface};
use fractum_fem::Solid;
use fractum_math::Vec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::coupling::Debris;

/// A fixed rigid half space; solids stay on the side that its normal points to.
///
/// It feels the nodes on the surface of the solids at the start (as points) and every particle (as a sphere). A node
/// that turns into a particle while it lies nearer than its radius keeps touching as a point until it has left.
#[derive(Clone, Debug)]
pub struct RigidPlane {
    /// A point of the plane [m].
    pub point: Vec3,
    /// Unit normal, out of the rigid side.
    pub normal: Vec3,
    /// Friction and damping of its contacts, together with those of the other surface.
    pub surface: Surface,
    candidates: Vec<Candidate>,
}

/// A node that may touch a plane.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Candidate {
    node: u32,
    law: Linear,
    radius: f64,
    memory: ContactMemory,
    force: Vec3,
    couple: Vec3,
    stored: f64,
    friction: f64,
    damping: f64,
}

impl RigidPlane {
    /// A plane through `point` with unit `normal`.
    pub fn new(point: Vec3, normal: Vec3, surface: Surface) -> Self {
        RigidPlane { point, normal, surface, candidates: Vec::new() }
    }

    /// Sets the nodes that may touch: the surface of the solids.
    pub(crate) fn watch(&mut self, nodes: &[u32], solid: &Solid, debris: &Debris) {
        for &node in nodes {
            self.watch_node(node, solid, debris);
        }
    }

    /// Adds a node unless it is watched already.
    pub(crate) fn watch_node(&mut self, node: u32, solid: &Solid, debris: &Debris) {
        if let Err(place) = self.candidates.binary_search_by_key(&node, |c| c.node) {
            let law = debris.wall_law(node, solid.mass[node as usize], self.surface);
            let candidate = Candidate {
                node,
                law,
                radius: 0.0,
                memory: ContactMemory::default(),
                force: Vec3::zeros(),
                couple: Vec3::zeros(),
                stored: 0.0,
                friction: 0.0,
                damping: 0.0,
            };
            self.candidates.insert(place, candidate);
        }
    }

    /// Contacts for a checkpoint.
    pub(crate) fn state(&self) -> Vec<Candidate> {
        self.candidates.clone()
    }

    pub(crate) fn restore(&mut self, candidates: Vec<Candidate>) {
        self.candidates = candidates;
    }

    /// Nodes in contact at the last step.
    pub(crate) fn touching(&self) -> usize {
        self.candidates.iter().filter(|c| c.stored > 0.0).count()
    }

    /// Largest squared frequency that these contacts add to a node [1/s²].
    pub(crate) fn frequency_square(&self, solid: &Solid) -> f64 {
        let of = |c: &Candidate| (c.law.normal_stiffness + c.law.tangential_stiffness) / solid.mass[c.node as usize];
        self.candidates.iter().map(of).fold(0.0, f64::max)
    }

    /// Adds the contact forces to the nodes, and the torques to free particles.
    pub(crate) fn add_forces(&mut self, solid: &mut Solid, debris: &mut Debris, dt: f64) -> ContactWork {
        let RigidPlane { point, normal, candidates, .. } = self;
        let (point, normal) = (*point, *normal);
        {
            let (solid, debris) = (&*solid, &*debris);
            candidates.par_iter_mut().with_min_len(1024).for_each(|c| {
                let i = c.node as usize;
                let height = (solid.reference[i] + solid.displacement[i] - point).dot(&normal);
                let full = debris.radius_if_particle(c.node);
                if c.radius == 0.0 && full > 0.0 && height > full {
                    c.radius = full;
                }
                let arm = -normal * height;
                let spin = debris.spin(c.node);
                let velocity = solid.velocity[i] + spin.cross(&arm);
                let motion = PairMotion { normal, overlap: c.radius - height, velocity, spin, dt };
                let ContactForce { on_second, couple_on_second, stored, friction, damping } =
                    c.law.force(&motion, &mut c.memory);
                (c.force, c.couple) = (on_second, couple_on_second);
                (c.stored, c.friction, c.damping) = (stored, friction, damping);
            });
        }
        let mut work = ContactWork::default();
        for c in candidates.iter().filter(|c| c.stored > 0.0 || c.damping != 0.0) {
            let i = c.node as usize;
            let arm = -normal * (solid.reference[i] + solid.displacement[i] - point).dot(&normal);
            solid.force[i] += c.force;
            debris.add_torque(c.node, arm.cross(&c.force) + c.couple);
            work.stored += c.stored;
            work.friction += c.friction;
            work.damping += c.damping;
        }
        work
    }
}
