//! Motion of the nodes: central differences with the velocity at half steps.

use std::ops::Range;

use fractum_math::{CHUNK, HalfSteps, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::solid::Solid;
use crate::solid::neighbours::Neighbours;

/// Damping that acts on the nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LocalDamping {
    /// Fraction a of the unbalanced force that opposes the motion, -a |F| v/|v|; for quasi-static runs.
    pub local: f64,
    /// Mass-proportional rate α [1/s].
    pub mass_rate: f64,
}

impl LocalDamping {
    /// Whether nothing is damped.
    pub fn is_off(&self) -> bool {
        self.local == 0.0 && self.mass_rate == 0.0
    }
}

/// A step of all nodes.
#[derive(Clone, Copy, Debug)]
pub struct WholeStep<'a> {
    /// Step before tⁿ [s].
    pub dt_before: f64,
    /// Step after tⁿ [s].
    pub dt_after: f64,
    /// Damping.
    pub damping: LocalDamping,
    /// Bit a is set where axis a of a node is prescribed; empty if none is.
    pub held: &'a [u8],
    /// Whether to sum the kinetic energy.
    pub measure: bool,
}

impl Solid {
    /// Advances vⁿ⁻½ → vⁿ⁺½ and uⁿ → uⁿ⁺¹ with the forces of tⁿ.
    ///
    /// - `dt_before`, `dt_after`: the steps on both sides of tⁿ [s]
    /// - `held`: bit a is set where axis a of a node is prescribed (it feels no damping); empty if none is
    /// - `measure`: whether to sum the kinetic energy
    /// - returns what damping takes, and the kinetic energy at tⁿ as ½ Σ m vⁿ⁻½ · (vⁿ⁻½ + Δt aⁿ), which is
    ///   ½ Σ m vⁿ⁻½ · vⁿ⁺½ for equal steps: with this product central differences conserve the energy of a linear body
    ///   exactly; as the step after sees it, it is ½ Σ m vⁿ⁺½ · (vⁿ⁺½ - Δt aⁿ), another one where the step changes
    pub fn kick_and_drift(
        &mut self,
        dt_before: f64,
        dt_after: f64,
        damping: LocalDamping,
        held: &[u8],
        measure: bool,
    ) -> HalfSteps {
        let step = WholeStep { dt_before, dt_after, damping, held, measure };
        self.with_neighbours(|neighbours, solid| {
            let moving: &dyn Neighbours = neighbours;
            kick_runs(solid, &step, |chunk| moving.moved(chunk));
            neighbours.end_step(&mut solid.chunk_work);
        });
        work_of_chunks(self)
    }

    /// Velocity of a node after a kick under a force, as [`Solid::kick_and_drift`] gives it [m/s]; held axes keep theirs.
    pub fn kicked(&self, node: usize, force: Vec3, dt_kick: f64, damping: LocalDamping, held: u8) -> Vec3 {
        let (before, free) = (self.velocity[node], free_axes(held));
        let (force, moving) = (force.component_mul(&free), before.component_mul(&free));
        let resist = damping_force(damping, force, moving, self.inverse_mass[node]);
        before + (force + resist) * (self.inverse_mass[node] * dt_kick)
    }

    /// Velocity that an impulse gives a node, by axis [1/kg]; none along held axes.
    pub fn mobility(&self, node: usize, held: u8) -> Vec3 {
        free_axes(held) * self.inverse_mass[node]
    }
}

/// What [`kick_runs`] has found, in sum.
pub(crate) fn work_of_chunks(solid: &Solid) -> HalfSteps {
    solid.chunk_work.iter().fold(HalfSteps::default(), |sum, &part| sum + part)
}

/// [`Solid::kick_and_drift`] of some nodes; see [`work_of_chunks`].
///
/// - `runs`: runs of nodes in a chunk, counted from its first; none where these are all nodes
pub(crate) fn kick_runs<'a>(
    solid: &mut Solid,
    step: &WholeStep,
    runs: impl Fn(usize) -> Option<&'a [Range<usize>]> + Sync,
) {
    let WholeStep { dt_before, dt_after, damping, held, measure } = *step;
    let dt_kick = 0.5 * (dt_before + dt_after);
    let Solid { displacement, velocity, force, inverse_mass, chunk_work, .. } = solid;
    let plain = damping.is_off() && !measure;
    displacement
        .par_chunks_mut(CHUNK)
        .zip(velocity.par_chunks_mut(CHUNK))
        .zip(chunk_work.par_iter_mut())
        .enumerate()
        .for_each(|(chunk, ((displacement, velocity), work))| {
            *work = HalfSteps::default();
            let all = 0..velocity.len();
            for run in runs(chunk).unwrap_or(std::slice::from_ref(&all)) {
                let first = chunk * CHUNK + run.start;
                let (displacement, velocity) = (&mut displacement[run.clone()], &mut velocity[run.clone()]);
                let (force, inverse_mass) = (&force[first..], &inverse_mass[first..]);
                if plain {
                    for i in 0..velocity.len() {
                        velocity[i] += force[i] * (inverse_mass[i] * dt_kick);
                        displacement[i] += velocity[i] * dt_after;
                    }
                    continue;
                }
                for i in 0..velocity.len() {
                    let before = velocity[i];
                    let mut total = force[i];
                    let mut resist = Vec3::zeros();
                    if !damping.is_off() {
                        let free = free_axes(held.get(first + i).copied().unwrap_or(0));
                        resist = damping_force(
                            damping,
                            total.component_mul(&free),
                            before.component_mul(&free),
                            inverse_mass[i],
                        );
                        total += resist;
                    }
                    let after = before + total * (inverse_mass[i] * dt_kick);
                    velocity[i] = after;
                    displacement[i] += after * dt_after;
                    if measure {
                        let mirrored = before + total * (inverse_mass[i] * dt_before);
                        work.before.kinetic += 0.5 / inverse_mass[i] * before.dot(&mirrored);
                        let mirrored = after - total * (inverse_mass[i] * dt_after);
                        work.after.kinetic += 0.5 / inverse_mass[i] * after.dot(&mirrored);
                    }
                    work.before.damping -= 0.5 * dt_before * resist.dot(&before);
                    work.after.damping -= 0.5 * dt_after * resist.dot(&after);
                }
            }
        });
}

pub(crate) fn free_axes(bits: u8) -> Vec3 {
    Vec3::from_fn(|axis, _| if bits & (1 << axis) == 0 { 1.0 } else { 0.0 })
}

/// -a |F| v/|v| - α m v, zero at rest.
pub(crate) fn damping_force(damping: LocalDamping, force: Vec3, velocity: Vec3, inverse_mass: f64) -> Vec3 {
    let speed = velocity.norm();
    let local = if speed > 0.0 { velocity * (-damping.local * force.norm() / speed) } else { Vec3::zeros() };
    local - velocity * (damping.mass_rate / inverse_mass)
}
