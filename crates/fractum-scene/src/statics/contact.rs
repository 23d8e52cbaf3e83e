//! Contact at equilibrium, with rigid shapes and of discrete elements with each other: penalty springs, on where a node overlaps and off where it does not.
//!
//! The springs are those of motion: the tangential one remembers its stretch at the last equilibrium and slips where Coulomb's
//! law lets it. The iteration takes them linear about its last iterate, what slips by its secant.

use fractum_contact::law::slip_to_cone;
use fractum_contact::{Frame, Outside};
use fractum_math::{Mat3, Vec3};

use crate::conditions::integral;
use crate::contacts::{Candidate, NodesOnShape};
use crate::contacts::{Drive, RigidBody};
use crate::coupling::Push;
use crate::error::SceneError;
use crate::ledger::EnergyKind;
use crate::scene::Scene;
use crate::statics::check_supports;

/// Gap over the size of the solid up to which a node counts as touching: what rounding leaves of a body that lies on a shape.
const TOUCHING: f64 = 1e-9;

/// A node that a shape or another node pushes: its force, linear about the state it was found at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spring {
    /// Node.
    pub(super) node: u32,
    /// The node that pushes it and feels the opposite.
    pub(super) partner: Option<u32>,
    /// Unit normal towards the node.
    normal: Vec3,
    /// Force on the node [N].
    pub(super) force: Vec3,
    /// How it falls with the displacement of the node, against that of its partner [N/m].
    pub(super) stiffness: Mat3,
    /// How it changes as the shape moves on [N/s].
    pub(super) rate: Vec3,
}

impl Spring {
    /// A displacement field at its node, against that of its partner.
    pub(super) fn of(&self, field: &[Vec3]) -> Vec3 {
        let own = field[self.node as usize];
        self.partner.map_or(own, |partner| own - field[partner as usize])
    }

    /// Adds a force on its node, and the opposite on its partner.
    pub(super) fn push(&self, force: Vec3, forces: &mut [Vec3]) {
        forces[self.node as usize] += force;
        if let Some(partner) = self.partner {
            forces[partner as usize] -= force;
        }
    }

    /// The two nodes that it couples.
    pub(super) fn pair(&self) -> Option<[u32; 2]> {
        self.partner.map(|partner| [self.node, partner])
    }
}

/// A tangential spring at one instant.
struct Tangential {
    slip: Vec3,
    /// Way against friction since the last equilibrium [m].
    slid: Vec3,
}

/// Normal out of the shape and overlap of a node at a place.
fn sense(ground: &NodesOnShape, frame: &Frame, c: &Candidate, place: &Vec3) -> (Vec3, f64) {
    let Outside { normal, distance, .. } = ground.shape.outside(&frame.to_body(place));
    (-frame.to_space(&normal), c.radius - distance)
}

/// The tangential spring of a contact with the normal force `pressure` after a relative motion.
fn tangential(c: &Candidate, normal: &Vec3, pressure: f64, moved: Vec3) -> Tangential {
    let across = |v: Vec3| v - normal * v.dot(normal);
    let trial = across(c.memory.slip + moved);
    let slip = slip_to_cone(trial, c.law.tangential_stiffness * trial.norm(), c.law.friction * pressure);
    Tangential { slip, slid: trial - slip }
}

impl RigidBody {
    /// Way that its drive takes it between two times [m].
    fn way(&self, from: f64, to: f64) -> Vec3 {
        Vec3::from_fn(|axis, _| match &self.along[axis] {
            Drive::Velocity(velocity) => integral(|t| velocity(t, &self.frame.origin), from, to),
            _ => 0.0,
        })
    }
}

impl Scene {
    /// Fails if some connected piece of the solids can move as a rigid body against neither supports nor the shapes it lies on.
    ///
    /// # Errors
    /// [`SceneError::FreeBody`] with the body and the motion.
    pub fn check_supports(&self) -> Result<(), SceneError> {
        let springs = self.springs(&self.solid.displacement, [0.0, 0.0], 1.0, true);
        let touched: Vec<(u32, Vec3)> = springs.iter().map(|spring| (spring.node, spring.normal)).collect();
        check_supports(&self.solid, self.supports.held(), &touched)
    }

    /// Springs of the nodes that touch shapes or each other under a displacement field.
    ///
    /// - `times`: load parameters of the last equilibrium and of the field
    /// - `ahead`: duration from which the pace of the shapes is taken [s]
    /// - `near`: also those that just do not touch, with no force
    pub(super) fn springs(&self, field: &[Vec3], times: [f64; 2], ahead: f64, near: bool) -> Vec<Spring> {
        let pushed = |push: Push| {
            let stiffness = push.normal * push.normal.transpose() * push.stiffness;
            let force = push.normal * (push.stiffness * push.overlap);
            let [partner, node] = push.nodes;
            Spring { node, partner: Some(partner), normal: push.normal, force, stiffness, rate: Vec3::zeros() }
        };
        let mut springs: Vec<Spring> = self.debris.pushes(&self.solid, field).map(pushed).collect();
        if self.shape_contacts.is_empty() {
            return springs;
        }
        let size = self.solid.reference.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let gap = if near { TOUCHING * size } else { 0.0 };
        for ground in &self.shape_contacts {
            let (mut frame, way, pace) = self.motion_of(ground, times, ahead);
            frame.origin += way;
            for c in &ground.candidates {
                let i = c.node as usize;
                let (normal, overlap) = sense(ground, &frame, c, &(self.solid.reference[i] + field[i]));
                if overlap <= -gap {
                    continue;
                }
                let pressure = c.law.normal_stiffness * overlap.max(0.0);
                let moved = field[i] - self.solid.displacement[i] - way;
                let Tangential { slip, slid } = tangential(c, &normal, pressure, moved);
                // What slips is held by the secant of its friction: iterates that go from sticking to slipping and back settle.
                let (held, went) = (slip.norm(), slid.norm());
                let holds = if held > 0.0 {
                    c.law.tangential_stiffness * held / (held + went)
                } else if went == 0.0 && pressure > 0.0 && c.law.friction > 0.0 {
                    c.law.tangential_stiffness
                } else {
                    0.0
                };
                let along = normal * normal.transpose();
                let stiffness = along * c.law.normal_stiffness + (Mat3::identity() - along) * holds;
                let force = normal * pressure - slip * c.law.tangential_stiffness;
                let rate = stiffness * pace;
                springs.push(Spring { node: c.node, partner: None, normal, force, stiffness, rate });
            }
        }
        springs
    }

    /// Where a shape was at the last equilibrium, the way it has gone since, and its pace.
    fn motion_of(&self, ground: &NodesOnShape, [present, time]: [f64; 2], ahead: f64) -> (Frame, Vec3, Vec3) {
        match ground.rigid_body.and_then(|index| self.contacts.rigid_bodies().get(index)) {
            Some(rigid_body) => {
                (rigid_body.frame, rigid_body.way(present, time), rigid_body.way(time, time + ahead) / ahead)
            }
            None => (ground.frame, Vec3::zeros(), Vec3::zeros()),
        }
    }

    /// Takes over the contacts of a state of equilibrium: memories, forces on the rigid bodies, their places, and the ledger.
    ///
    /// - `before`: displacements at the last equilibrium; those of the scene are the new ones
    pub(super) fn accept_contacts(&mut self, before: &[Vec3], present: f64, time: f64) {
        if !self.has_contacts() {
            return;
        }
        self.books.external -= self.debris.accept_at_rest(&self.solid, before);
        if !self.shape_contacts.is_empty() {
            self.accept_grounds(before, present, time);
        }
        let on_grounds: f64 = self.shape_contacts.iter().flat_map(|ground| &ground.candidates).map(|c| c.stored).sum();
        self.ledger[EnergyKind::Contact] = on_grounds + self.debris.stored();
        self.sum_watched_contacts();
    }

    /// Whether anything can touch at equilibrium.
    pub(crate) fn has_contacts(&self) -> bool {
        !(self.shape_contacts.is_empty() && self.debris.is_empty())
    }

    fn accept_grounds(&mut self, before: &[Vec3], present: f64, time: f64) {
        self.contacts.rigid_bodies_mut().iter_mut().for_each(RigidBody::clear_forces);
        let (mut friction, mut external) = (0.0, 0.0);
        for index in 0..self.shape_contacts.len() {
            let (old, way, _) = self.motion_of(&self.shape_contacts[index], [present, time], 1.0);
            let new = Frame { origin: old.origin + way, ..old };
            let Scene { shape_contacts, contacts, solid, debris, .. } = self;
            let mut candidates = std::mem::take(&mut shape_contacts[index].candidates);
            let ground = &shape_contacts[index];
            for c in &mut candidates {
                let i = c.node as usize;
                let place = solid.position(i);
                let (_, was) = sense(ground, &old, c, &(solid.reference[i] + before[i]));
                let (normal, overlap) = sense(ground, &new, c, &place);
                let pressure = c.law.normal_stiffness * overlap.max(0.0);
                let full = debris.radius_if_particle(c.node);
                if c.radius == 0.0 && full > 0.0 && -overlap > full {
                    c.radius = full;
                }
                let Tangential { slip, slid } =
                    tangential(c, &normal, pressure, solid.displacement[i] - before[i] - way);
                friction += 0.5 * c.law.tangential_stiffness * (c.memory.slip + slip).dot(&slid);
                let half = 0.5 * c.law.normal_stiffness;
                // The way to a contact is without force, and so is that from it.
                let idle = half
                    * ((overlap.max(0.0) + was.max(0.0)) * (overlap - was)
                        - (overlap.max(0.0).powi(2) - was.max(0.0).powi(2)));
                let force = normal * pressure - slip * c.law.tangential_stiffness;
                external += 0.5 * (c.force + force).dot(&way) - idle;
                c.memory.slip = slip;
                (c.force, c.couple, c.arm) = (force, Vec3::zeros(), normal * (overlap - c.radius));
                c.stored = half * overlap.max(0.0).powi(2) + 0.5 * c.law.tangential_stiffness * slip.norm_squared();
                (c.friction, c.damping, c.is_held) = (0.0, 0.0, false);
                if let Some(rigid_body) =
                    ground.rigid_body.and_then(|rigid_body| contacts.rigid_bodies_mut().get_mut(rigid_body))
                {
                    rigid_body.push(&-force, &Vec3::zeros(), &(place + c.arm));
                }
            }
            shape_contacts[index].candidates = candidates;
        }
        for rigid_body in self.contacts.rigid_bodies_mut() {
            rigid_body.frame.origin += rigid_body.way(present, time);
            rigid_body.frame.velocity = Vec3::zeros();
        }
        self.books.friction += friction;
        self.books.external += external;
    }
}
