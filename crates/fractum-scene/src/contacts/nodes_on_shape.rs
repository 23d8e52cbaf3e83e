//! Rigid shapes that the nodes and discrete elements of solids touch.

use fractum_contact::law::{ContactForce, ContactLaw, ContactMemory, ContactParameters, Linear, PairMotion};
use fractum_contact::{Frame, Outside, Shape};
use fractum_fem::Solid;
use fractum_math::{Vec3, Work, rotation_between};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::contacts::RigidBody;
use crate::coupling::Debris;

/// Overlap at the start, over the radius at the node, up to which a node is on the surface: what is left of a mesh file.
const ON_SURFACE: f64 = 1e-4;
/// Part of its velocity at the start with which a node that moves along a surface may come nearer to it: rounding.
const TOWARDS: f64 = 1e-9;

/// A rigid shape, seen from outside; solids stay out of it.
///
/// It feels the nodes on the surface of the solids at the start (as points) and every particle (as a sphere). A node
/// that turns into a particle while it lies nearer than its radius keeps touching as a point until it has left.
/// A shape that stands still or is driven [holds](super::held_nodes) points on its surface; springs push spheres, what is within a shape at
/// the start, and what touches a body that moves freely.
#[derive(Clone, Debug)]
pub struct NodesOnShape {
    pub(crate) shape: Shape,
    /// Where it is if it belongs to no rigid body of the scene.
    pub(crate) frame: Frame,
    /// The rigid body that it is the shape of, which moves it.
    pub(crate) rigid_body: Option<usize>,
    /// Friction and damping of its contacts, together with those of the other surface.
    surface: ContactParameters,
    /// Whether forces do not move it, so that it holds points.
    pub(super) holds: bool,
    pub(crate) candidates: Vec<Candidate>,
}

/// A node that may touch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Candidate {
    pub(crate) node: u32,
    pub(crate) law: Linear,
    pub(crate) radius: f64,
    pub(crate) memory: ContactMemory,
    pub(crate) force: Vec3,
    pub(crate) couple: Vec3,
    /// From the node to the contact [m].
    pub(crate) arm: Vec3,
    pub(crate) stored: f64,
    pub(crate) friction: f64,
    pub(crate) damping: f64,
    /// Whether the shape holds it instead of a spring; not at rest.
    pub(crate) is_held: bool,
    /// Whether it has been within the shape since the start: a spring pushes it out.
    pub(crate) is_pushed: bool,
    /// From the reference point of the shape to where the last force acted, where it is held [m].
    pub(super) lever: Vec3,
    /// At rest: stretch of the tangential spring that stands for the way it gave since the last equilibrium [m].
    #[serde(skip)]
    pub(crate) brought_back: Vec3,
    /// Forces that are tried, before and after a sweep [N].
    #[serde(skip)]
    pub(super) trial: [Vec3; 2],
}

impl Candidate {
    /// Whether it touched at the last step.
    pub(crate) fn is_loaded(&self) -> bool {
        self.force != Vec3::zeros() || self.memory != ContactMemory::default()
    }
}

impl NodesOnShape {
    /// A fixed half space behind the plane through `point` with unit `normal`.
    pub fn plane(point: Vec3, normal: Vec3, surface: ContactParameters) -> Self {
        let frame = Frame { rotation: rotation_between(&Vec3::z(), &normal), ..Frame::at(point) };
        NodesOnShape { shape: Shape::HalfSpace, frame, rigid_body: None, surface, holds: false, candidates: Vec::new() }
    }

    /// The shape of a rigid body of the scene, by its number there.
    pub fn of_body(rigid_body: usize, shape: Shape, surface: ContactParameters) -> Self {
        let (frame, candidates) = (Frame::at_rest(), Vec::new());
        NodesOnShape { shape, frame, rigid_body: Some(rigid_body), surface, holds: false, candidates }
    }

    /// The rigid body that it is the shape of.
    pub(crate) fn rigid_body(&self) -> Option<usize> {
        self.rigid_body
    }

    /// Whether it holds points in motion.
    pub(crate) fn holds_points(&self) -> bool {
        self.holds
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
            let law = debris.wall_law(node, solid.mass[node as usize], self.rigid_body, self.surface);
            let candidate = Candidate {
                node,
                law,
                radius: 0.0,
                memory: ContactMemory::default(),
                force: Vec3::zeros(),
                couple: Vec3::zeros(),
                arm: Vec3::zeros(),
                stored: 0.0,
                friction: 0.0,
                damping: 0.0,
                is_held: false,
                is_pushed: false,
                lever: Vec3::zeros(),
                brought_back: Vec3::zeros(),
                trial: [Vec3::zeros(); 2],
            };
            self.candidates.insert(place, candidate);
        }
    }

    /// Finds, before the first step, whether it holds points, and which of them a spring must push out.
    pub(crate) fn prepare(&mut self, rigid_bodies: &[RigidBody], solid: &Solid, debris: &Debris) {
        let body = self.rigid_body.map(|index| rigid_bodies.get(index));
        let is_driven = body.is_none_or(|body| body.is_some_and(RigidBody::is_driven));
        let frame = body.flatten().map_or(self.frame, |body| body.frame);
        // A row of nodes that is stopped at once loses energy: where solids are thrown at the shape springs send them back.
        let is_thrown = self.candidates.iter().any(|c| {
            let (place, velocity) = (solid.position(c.node as usize), solid.velocity[c.node as usize]);
            let outward = -frame.to_space(&self.shape.outside(&frame.to_body(&place)).normal);
            velocity.dot(&outward) < -TOWARDS * velocity.norm()
        });
        // The nodes of short steps are kicked more often than what holds them.
        self.holds = is_driven && !solid.is_subcycled() && !is_thrown;
        for c in &mut self.candidates {
            let depth = -self.shape.outside(&frame.to_body(&solid.position(c.node as usize))).distance;
            c.is_pushed = depth > ON_SURFACE * debris.radius(c.node);
        }
    }

    /// Takes all contacts as they stand: they give no force, and touch no nearer than now until they have parted. Tells
    /// them: node and depth [m].
    pub(crate) fn accept_initial_overlap(&mut self, rigid_bodies: &[RigidBody], solid: &Solid) -> Vec<(u32, f64)> {
        let frame =
            self.rigid_body.and_then(|index| rigid_bodies.get(index)).map_or(self.frame, |rigid_body| rigid_body.frame);
        let mut found = Vec::new();
        for c in &mut self.candidates {
            let depth = -self.shape.outside(&frame.to_body(&solid.position(c.node as usize))).distance;
            c.is_pushed = false;
            if depth > 0.0 {
                Linear::add_overlap_offset(&mut c.memory, depth);
                found.push((c.node, depth));
            }
        }
        found
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
        self.candidates.iter().filter(|c| c.force != Vec3::zeros()).count()
    }

    /// Largest squared frequency that the springs of these contacts add to a node [1/s²].
    pub(crate) fn frequency_square(&self, solid: &Solid, debris: &Debris) -> f64 {
        let of = |c: &Candidate| (c.law.normal_stiffness + c.law.tangential_stiffness) / solid.mass[c.node as usize];
        let has_spring = |c: &&Candidate| !self.holds || c.is_pushed || debris.radius_if_particle(c.node) > 0.0;
        self.candidates.iter().filter(has_spring).map(of).fold(0.0, f64::max)
    }

    /// Adds the forces of the springs to the nodes, the torques to free particles, and the opposite to the rigid body.
    pub(crate) fn add_forces(
        &mut self,
        rigid_bodies: &mut [RigidBody],
        solid: &mut Solid,
        debris: &mut Debris,
        dt: f64,
    ) -> Work {
        let NodesOnShape { shape, frame, rigid_body, candidates, holds, .. } = self;
        let holds = *holds;
        let mut rigid_body = rigid_body.and_then(|index| rigid_bodies.get_mut(index));
        if let Some(rigid_body) = &rigid_body {
            *frame = rigid_body.frame;
        }
        let (shape, frame) = (*shape, *frame);
        {
            let (solid, debris) = (&*solid, &*debris);
            candidates.par_iter_mut().with_min_len(1024).for_each(|c| {
                let i = c.node as usize;
                let place = solid.position(i);
                let Outside { normal, distance, .. } = shape.outside(&frame.to_body(&place));
                let normal = -frame.to_space(&normal);
                if holds && c.is_point(debris) {
                    c.hold(&normal, distance);
                    return;
                }
                let let_go = c.let_go(solid, &frame, dt);
                let full = debris.radius_if_particle(c.node);
                if c.radius == 0.0 && full > 0.0 && distance > full {
                    c.radius = full;
                }
                c.arm = -normal * distance;
                let spin = debris.spin(solid, c.node);
                let velocity = solid.velocity[i] + spin.cross(&c.arm) - frame.velocity_at(&(place + c.arm));
                // A node without a particle is a point: it neither rolls nor feels a couple.
                let spin = if full > 0.0 { spin - frame.spin } else { Vec3::zeros() };
                let motion = PairMotion { normal, overlap: c.radius - distance, velocity, spin, dt };
                let ContactForce { on_second, couple_on_second, stored, friction, damping } =
                    c.law.force(&motion, &mut c.memory);
                (c.force, c.couple) = (on_second, couple_on_second);
                (c.stored, c.friction, c.damping) = (stored, friction, damping + let_go);
                c.is_pushed &= distance < 0.0;
            });
        }
        let mut work = Work::default();
        let has_spring = |c: &&Candidate| !c.is_held && (c.stored > 0.0 || c.damping != 0.0 || c.friction != 0.0);
        for c in candidates.iter().filter(has_spring) {
            let i = c.node as usize;
            solid.force[i] += c.force;
            debris.add_torque(c.node, c.arm.cross(&c.force) + c.couple);
            if let Some(rigid_body) = &mut rigid_body {
                rigid_body.push(&-c.force, &-c.couple, &(solid.position(i) + c.arm), solid.mass[i]);
            }
            work += Work::contact(c.stored, c.friction, c.damping);
        }
        work
    }
}
