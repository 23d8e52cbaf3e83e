//! A node that stands twice, and its copy.

use fractum_math::{HalfSteps, Vec3};

use crate::motion::central_difference::{WholeStep, damping_force, free_axes};
use crate::solid::Solid;

/// A node that stands twice, or its copy, in the kick.
pub(super) struct LinkedNode {
    node: usize,
    velocity: Vec3,
    force: Vec3,
    /// Force of damping [N].
    resist: Vec3,
    inverse_mass: f64,
    dt: [f64; 2],
}

impl LinkedNode {
    /// - `acceleration`: of both halves together at tⁿ [m/s²]
    pub(super) fn new(solid: &Solid, node: usize, acceleration: Vec3, dt: [f64; 2], step: &WholeStep) -> Self {
        let (velocity, force, inverse_mass) = (solid.velocity[node], solid.force[node], solid.inverse_mass[node]);
        let resist = if step.damping.is_off() {
            Vec3::zeros()
        } else {
            let free = free_axes(step.held.get(node).copied().unwrap_or(0));
            // Each half by itself is not balanced: the other half and the link balance it.
            let unbalanced = acceleration / inverse_mass;
            damping_force(step.damping, unbalanced.component_mul(&free), velocity.component_mul(&free), inverse_mass)
        };
        LinkedNode { node, velocity, force, resist, inverse_mass, dt }
    }

    /// Velocity at the instant of the kick, without the link [m/s].
    pub(super) fn velocity_at(&self) -> Vec3 {
        self.velocity + (self.force + self.resist) * (0.5 * self.dt[0] * self.inverse_mass)
    }

    /// What a force of the link changes in that [s/kg].
    pub(super) fn yield_per_force(&self) -> f64 {
        0.5 * self.dt[0] * self.inverse_mass
    }

    /// Gives it its next velocity and displacement; what damping and the link take, and the kinetic energy where asked for.
    pub(super) fn kick(&mut self, solid: &mut Solid, link: Vec3, measure: bool) -> HalfSteps {
        let LinkedNode { node, velocity: before, force, resist, inverse_mass, dt: [dt_before, dt_after] } = *self;
        let total = force + resist + link;
        let after = before + total * (inverse_mass * 0.5 * (dt_before + dt_after));
        solid.velocity[node] = after;
        solid.displacement[node] += after * dt_after;
        let mut work = HalfSteps::default();
        for (work, velocity, dt, sign) in
            [(&mut work.before, before, dt_before, 1.0), (&mut work.after, after, dt_after, -1.0)]
        {
            work.damping = -0.5 * dt * resist.dot(&velocity);
            work.linked = -0.5 * dt * link.dot(&velocity);
            if measure {
                let mirrored = velocity + total * (sign * inverse_mass * dt);
                work.kinetic = 0.5 / inverse_mass * velocity.dot(&mirrored);
            }
        }
        work
    }
}
