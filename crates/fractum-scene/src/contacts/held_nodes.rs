//! Nodes of solids that a rigid shape holds on its surface.
//!
//! A node that would be within the shape at tⁿ⁺¹ gets the force at tⁿ that leaves it on the surface: the multiplier of a constraint
//! (Carpenter, Taylor and Katona 1991), along the normal of tⁿ as in the scheme RATTLE. No spring gives way beside the body, and the step is
//! that of the elements. Along the surface the node sticks as long as Coulomb's cone lets it. What meets the shape is stopped at once: the
//! energy of the relative motion of the node is lost. The forces of both ends of a step work along the relative way of that step.

use fractum_contact::Frame;
use fractum_contact::law::{ContactLaw, ContactMemory, Linear};
use fractum_fem::{LocalDamping, Solid};
use fractum_math::{Vec3, Work};
use rayon::prelude::*;

use crate::contacts::RigidBody;
use crate::contacts::nodes_on_shape::{Candidate, NodesOnShape};
use crate::coupling::Debris;

/// Most sweeps over shapes that may hold the same node, and most looks at the local damping of a node, which depends on its force.
const SWEEPS: usize = 30;
/// Most corrections on a curved surface.
const CORRECTIONS: usize = 5;
/// Change of a force, and rest of a gap, that is rounding.
const ROUNDING: f64 = 1e-12;

/// A step of the nodes that shapes may hold.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HoldStep<'a> {
    /// tⁿ [s].
    pub(crate) time: f64,
    /// Step that led here; 0 where nothing has moved before [s].
    pub(crate) elapsed: f64,
    /// Duration that the forces of tⁿ change the velocity for [s].
    pub(crate) dt_kick: f64,
    /// Step that follows [s].
    pub(crate) dt_after: f64,
    pub(crate) damping: LocalDamping,
    /// Bit a of a node is set where its axis a is prescribed; empty without supports.
    pub(crate) held: &'a [u8],
}

impl HoldStep<'_> {
    fn held(&self, node: usize) -> u8 {
        self.held.get(node).copied().unwrap_or(0)
    }
}

/// Adds the forces on the nodes that shapes hold, once all others are there, and the opposite to the rigid bodies.
pub(crate) fn hold_nodes(
    shapes: &mut [NodesOnShape],
    rigid_bodies: &mut [RigidBody],
    solid: &mut Solid,
    step: &HoldStep,
) -> Work {
    for c in shapes.iter().flat_map(|shape| &shape.candidates).filter(|c| c.is_held) {
        solid.force[c.node as usize] += c.force;
    }
    for _ in 0..SWEEPS {
        let (mut change, mut largest) = (0.0, 0.0);
        for shape in &mut *shapes {
            let [most, size] = shape.sweep(rigid_bodies, solid, step);
            (change, largest) = (f64::max(change, most), f64::max(largest, size));
        }
        if shapes.len() == 1 || change <= ROUNDING * largest {
            break;
        }
    }
    let mut work = Work::default();
    shapes.iter_mut().for_each(|shape| work += shape.book(rigid_bodies, solid, step));
    work
}

impl Candidate {
    /// Whether it is a point that a driven shape holds.
    pub(super) fn is_point(&self, debris: &Debris) -> bool {
        !self.is_pushed && self.radius == 0.0 && !debris.is_loose(self.node)
    }

    /// Takes the place of a point at tⁿ.
    ///
    /// - `normal` out of the shape, `distance` from its surface [m]
    pub(super) fn hold(&mut self, normal: &Vec3, distance: f64) {
        let (overlap, offset) = ((-distance).max(0.0), Linear::overlap_offset(&self.memory));
        // What did not come here by motion is taken as it stands.
        let left = if self.is_held { offset.min(overlap) } else { overlap };
        self.memory = ContactMemory::default();
        Linear::add_overlap_offset(&mut self.memory, left);
        self.arm = -normal * distance;
        // Springs at rest are no more.
        (self.damping, self.friction, self.stored) = (self.stored, 0.0, 0.0);
        (self.couple, self.is_held, self.trial) = (Vec3::zeros(), true, [self.force; 2]);
    }

    /// Lets a spring take over; what the last force of the shape still does in the step `dt` to here [J].
    pub(super) fn let_go(&mut self, solid: &Solid, frame: &Frame, dt: f64) -> f64 {
        if !std::mem::take(&mut self.is_held) {
            return 0.0;
        }
        let velocity = solid.velocity[self.node as usize] - frame.velocity - frame.spin.cross(&self.lever);
        -0.5 * dt * self.force.dot(&velocity)
    }
}

/// What a shape stops at the first instant, along its force [J]: the motion has begun half a step earlier, at twice the velocity.
fn stopped_at_start(node: usize, force: Vec3, solid: &Solid, step: &HoldStep) -> f64 {
    let Some(along) = force.try_normalize(0.0) else { return 0.0 };
    let impulse = step.dt_kick * solid.force[node].dot(&along);
    0.5 * impulse * impulse * along.dot(&solid.mobility(node, step.held(node)).component_mul(&along))
}

/// A shape that holds a node: where it is at tⁿ and at tⁿ⁺¹.
struct Holding<'a> {
    ground: &'a NodesOnShape,
    now: Frame,
    next: Frame,
}

impl NodesOnShape {
    fn body<'a>(&self, rigid_bodies: &'a [RigidBody]) -> Option<&'a RigidBody> {
        self.rigid_body.and_then(|index| rigid_bodies.get(index))
    }

    /// Finds the forces on its points under all other forces as they are tried; the largest change and the largest force [N].
    fn sweep(&mut self, rigid_bodies: &[RigidBody], solid: &mut Solid, step: &HoldStep) -> [f64; 2] {
        if !self.holds {
            return [0.0; 2];
        }
        let body = self.body(rigid_bodies);
        let now = body.map_or(self.frame, |body| body.frame);
        let next = body.map_or(self.frame, |body| body.driven_to(step.time, step.dt_after));
        let mut candidates = std::mem::take(&mut self.candidates);
        let holding = Holding { ground: self, now, next };
        let of_solid = &*solid;
        candidates.par_iter_mut().with_min_len(1024).filter(|c| c.is_held).for_each(|c| {
            let [_, mut force] = c.trial;
            let others = of_solid.force[c.node as usize] - force;
            for _ in 0..SWEEPS {
                let before = force;
                force = holding.force_on(c, others, before, of_solid, step);
                if step.damping.local == 0.0 || (force - before).norm() <= ROUNDING * force.norm() {
                    break;
                }
            }
            c.trial = [c.trial[1], force];
        });
        let mut most = [0.0f64; 2];
        for c in candidates.iter_mut().filter(|c| c.is_held) {
            let [before, force] = c.trial;
            if force != before {
                solid.force[c.node as usize] += force - before;
            }
            most = [most[0].max((force - before).norm()), most[1].max(force.norm())];
        }
        self.candidates = candidates;
        most
    }

    /// Books the step to here, and gives the rigid body the opposite of the forces that were found.
    fn book(&mut self, rigid_bodies: &mut [RigidBody], solid: &Solid, step: &HoldStep) -> Work {
        let elapsed = step.elapsed;
        let mut work = Work::default();
        if !self.holds {
            return work;
        }
        let mut body = self.rigid_body.and_then(|index| rigid_bodies.get_mut(index));
        let frame = body.as_ref().map_or(self.frame, |body| body.frame);
        for c in self.candidates.iter_mut().filter(|c| c.is_held) {
            let (before, [_, force]) = (std::mem::replace(&mut c.force, c.trial[1]), std::mem::take(&mut c.trial));
            if before != Vec3::zeros() || force != Vec3::zeros() {
                let place = solid.position(c.node as usize) + c.arm;
                let lever = place - frame.origin;
                let n = -frame.to_space(&self.shape.outside(&frame.to_body(&place)).normal);
                let half = |force: Vec3, lever: Vec3| {
                    let velocity = solid.velocity[c.node as usize] - frame.velocity - frame.spin.cross(&lever);
                    let taken = -0.5 * elapsed * force.dot(&velocity);
                    let stopped = -0.5 * elapsed * force.dot(&n) * velocity.dot(&n);
                    if c.law.friction > 0.0 { [stopped, taken - stopped] } else { [taken, 0.0] }
                };
                let ([stopped, slid], [stops, slides]) = (half(before, c.lever), half(force, lever));
                let stops = if elapsed > 0.0 { stops } else { stopped_at_start(c.node as usize, force, solid, step) };
                (c.damping, c.friction) = (c.damping + stopped + stops, slid + slides);
                c.lever = lever;
                if let Some(body) = &mut body {
                    body.push(&-force, &Vec3::zeros(), &place, 0.0);
                }
            }
            work += Work::contact(0.0, c.friction, c.damping);
        }
        work
    }
}

impl Holding<'_> {
    /// The force on a point that leaves it outside of the shape after the step [N].
    ///
    /// - `others`: all other forces; `tried`: the one that damping is to see
    fn force_on(&self, c: &Candidate, others: Vec3, tried: Vec3, solid: &Solid, step: &HoldStep) -> Vec3 {
        let (i, dt) = (c.node as usize, step.dt_after);
        let bits = step.held(i);
        let mobility = solid.mobility(i, bits);
        let kicked = solid.kicked(i, others + tried, step.dt_kick, step.damping, bits);
        let free = kicked - mobility.component_mul(&tried) * step.dt_kick;
        let offset = Linear::overlap_offset(&c.memory);
        let place = solid.position(i);
        let gap = |place: &Vec3| self.ground.shape.outside(&self.next.to_body(place)).distance + offset;
        let ahead = place + free * dt;
        let first = gap(&ahead);
        if first >= 0.0 {
            return Vec3::zeros();
        }
        let n = -self.now.to_space(&self.ground.shape.outside(&self.now.to_body(&place)).normal);
        let pushed = mobility.component_mul(&n);
        let along = n.dot(&pushed);
        if along <= 0.0 {
            return Vec3::zeros(); // supports prescribe this motion
        }
        let (mut impulse, mut missing) = (0.0, first);
        for _ in 0..CORRECTIONS {
            impulse -= missing / (dt * along);
            missing = gap(&(ahead + pushed * (impulse * dt)));
            if missing.abs() <= -ROUNDING * first {
                break;
            }
        }
        let impulse = impulse.max(0.0);
        let limit = c.law.friction * impulse;
        let mut push = n * impulse;
        if limit > 0.0 {
            let moved = free + pushed * impulse;
            let across = |v: Vec3| v - n * v.dot(&n);
            let slides = across(moved - self.next.velocity_at(&(place + moved * dt)));
            let stop = -across(slides.zip_map(&mobility, |v, w| if w > 0.0 { v / w } else { 0.0 }));
            let size = stop.norm();
            push += if size > limit { stop * (limit / size) } else { stop };
        }
        push / step.dt_kick
    }
}
