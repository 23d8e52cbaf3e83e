//! Particles in a box that repeats: how the box deforms, what its sides do, and its stress.
//!
//! A particle is one of its images and never leaps. Images differ by edges n of the box H in place, H n, and in velocity, Ḣ n. What the
//! forces do on a particle and on its image differs by f · Ḣ n: that is the work of the box. Where Ḣ changes, the mean flow
//! Ḣ H⁻¹ (x - x_c) about the centre of mass changes with it, so that all images of a particle feel the same; no momentum comes in.
//!
//! In the ledger kinetic energy is that of the motion against the mean flow. The work of the box is then V σ : L per time, with the stress
//! of contacts, bonds and this motion, whatever images stand for the particles.

use fractum_contact::PeriodicCell;
use fractum_dem::Particles;
use fractum_math::{Mat3, Vec3};
use serde::{Deserialize, Serialize};

use crate::bonded::{Bonded, set_cell_velocity, sums_through_box};
use crate::clock::ThisStep;
use crate::contacts::Contacts;
use crate::time_function::TimeFunction;

/// How a box that repeats deforms.
#[derive(Clone, Default)]
pub struct BoxStrain {
    /// Rates of the components of the velocity gradient ∂v_i/∂x_j with i ≤ j [1/s].
    pub rates: Vec<([usize; 2], TimeFunction)>,
    /// Stress that the box holds by its rates along axes.
    pub servos: Vec<BoxServo>,
}

/// A normal stress that a box holds by its rate along this axis.
#[derive(Clone)]
pub struct BoxServo {
    /// Axis.
    pub axis: usize,
    /// Stress that is asked for, tension positive [Pa].
    pub stress: TimeFunction,
    /// Largest rate [1/s].
    pub rate: f64,
    /// Share of the stress that is missing where it begins to slow down.
    pub slows_at: f64,
}

/// A box that repeats, with what it does.
#[derive(Clone)]
pub struct PeriodicBox {
    pub(crate) strain: BoxStrain,
    pub(crate) state: PeriodicState,
    /// Least distance of opposite sides that bonded bodies need [m].
    pub(crate) bonded_needs: f64,
}

/// What changes in a box that repeats.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PeriodicState {
    /// The box at tⁿ; the velocity of its edges is that of the half step before.
    pub(crate) cell: PeriodicCell,
    /// Its edges at the start [m].
    pub(crate) start: Mat3,
    /// Work on the particles as they stand, and that of the half step that has begun [J].
    pub(crate) work: [f64; 2],
    /// Kinetic energy that the mean flow adds to that of the particles as they stand, when last measured [J].
    pub(crate) streaming: f64,
    /// Kinetic energy of the mean flow in the box, when last measured [J].
    pub(crate) flow: f64,
    /// Stress when last measured, tension positive [Pa].
    pub(crate) stress: Mat3,
    /// The part of it that motion against the mean flow has [Pa].
    pub(crate) kinetic_stress: Mat3,
}

/// A box at rest with edges along the axes.
///
/// - `corner`, `size` [m]; `repeats`: along which axes
pub fn periodic_cell(corner: Vec3, size: &Vec3, repeats: [bool; 3]) -> PeriodicCell {
    PeriodicCell { corner, edges: Mat3::from_diagonal(size), velocity: Mat3::zeros(), repeats }
}

/// Mean motion of the particles.
pub(crate) struct MeanMotion {
    mass: f64,
    /// Centre of mass [m].
    pub(crate) centre: Vec3,
    /// Its velocity [m/s].
    velocity: Vec3,
}

impl MeanMotion {
    pub(crate) fn of(particles: &Particles) -> Self {
        let Particles { position, velocity, mass, .. } = particles;
        let (mut sum, mut places, mut momentum) = (0.0, Vec3::zeros(), Vec3::zeros());
        for ((x, v), m) in position.iter().zip(velocity).zip(mass) {
            sum += m;
            places += x * *m;
            momentum += v * *m;
        }
        MeanMotion { mass: sum, centre: places / sum, velocity: momentum / sum }
    }
}

/// Velocity gradient that is asked for at a time, of the axes without a servo [1/s].
pub(crate) fn gradient(strain: &BoxStrain, time: f64) -> Mat3 {
    let mut gradient = Mat3::zeros();
    for ([i, j], rate) in &strain.rates {
        gradient[(*i, *j)] = rate(time, &Vec3::zeros());
    }
    gradient
}

/// Work of the box; the kinetic energy that the particles as they stand have beyond that against the mean flow; and that of the mean flow in
/// the box, ∫ ½ ρ |L x|² dV about its middle [J].
pub(crate) fn box_energies(own: Option<&PeriodicBox>) -> [f64; 3] {
    let of = |PeriodicState { work, streaming, flow, .. }: &PeriodicState| [work[0] - streaming, *streaming, *flow];
    own.map_or([0.0; 3], |own| of(&own.state))
}

impl std::fmt::Debug for PeriodicBox {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("PeriodicBox").field("state", &self.state).finish_non_exhaustive()
    }
}

impl PeriodicBox {
    /// Deforms until tⁿ⁺¹; returns the least distance of two sides and the one that contacts need, where that is larger [m].
    pub(crate) fn deform(
        &mut self,
        bonded: &mut Bonded,
        contacts: &mut Contacts,
        step: &ThisStep,
    ) -> Result<(), [f64; 2]> {
        let ThisStep { is_first, measure, dt_before, dt_after, .. } = *step;
        let PeriodicBox { strain, state, bonded_needs } = self;
        let deforms = !strain.rates.is_empty() || !strain.servos.is_empty();
        if !deforms && !measure {
            return Ok(());
        }
        let [of_bonds, virial_of_bonds] = sums_through_box(bonded);
        let [through, virial] = contacts.sums_through_box(&bonded.particles).unwrap_or_default();
        let (through, virial) = (through + of_bonds, virial + virial_of_bonds);
        let particles = &mut bonded.particles;
        if !is_first {
            state.work[0] -= 0.5 * dt_before * through.dot(&state.cell.velocity);
        }
        let mean = MeanMotion::of(particles);
        if measure || !strain.servos.is_empty() {
            let volume = state.cell.volume();
            state.kinetic_stress = kinetic(particles, &mean, &state.cell, dt_before) / -volume;
            state.stress = state.kinetic_stress - virial / volume;
        }
        let mut gradient = gradient(strain, step.time + 0.5 * dt_after);
        for servo in &strain.servos {
            gradient[(servo.axis, servo.axis)] = servo.rate(state, &mean, step);
        }
        let after = if is_first { state.cell.velocity } else { state.cell.velocity_under(&gradient, dt_after) };
        if after != state.cell.velocity {
            let change = PeriodicCell { velocity: after - state.cell.velocity, ..state.cell }.velocity_gradient();
            state.work[0] += change_flow(particles, &mean, &change, dt_before);
            state.cell.velocity = after;
        }
        if measure {
            state.streaming = streaming(particles, &mean, &state.cell.velocity_gradient(), dt_before);
            state.flow = mean.mass / 24.0 * state.cell.velocity.norm_squared();
            if is_first {
                state.work[0] = state.streaming;
            }
        }
        state.work[1] = -0.5 * dt_after * through.dot(&after);
        if after != Mat3::zeros() {
            state.cell.edges += after * dt_after;
        }
        contacts.set_cell(&state.cell);
        set_cell_velocity(bonded, &after);
        let (narrowest, needed) = (state.cell.narrowest(), contacts.narrowest_box().max(*bonded_needs));
        // A box that is no number is left to the balance.
        if narrowest < needed { Err([narrowest, needed]) } else { Ok(()) }
    }
}

impl BoxServo {
    /// Rate of the half step that follows [1/s]: that of a [`Servo`](crate::Servo) that presses on a side, with the mass of all particles.
    fn rate(&self, state: &PeriodicState, mean: &MeanMotion, step: &ThisStep) -> f64 {
        let (cell, k) = (&state.cell, self.axis);
        let length = cell.edges[(k, k)];
        let (area, fastest) = (cell.volume() / length, self.rate * length);
        let wanted = (self.stress)(step.time, &Vec3::zeros());
        let dt = 0.5 * (step.dt_before + step.dt_after);
        let pushed = mean.mass * cell.velocity[(k, k)] + dt * area * (wanted - state.stress[(k, k)]);
        let resistance = mean.mass + dt * self.slows_at * wanted.abs() * area / fastest;
        (pushed / resistance).clamp(-fastest, fastest) / length
    }
}

/// Velocity of a particle at tⁿ, of which it has that of the half step before [m/s].
fn velocity_now(particles: &Particles, i: usize, dt_before: f64) -> Vec3 {
    particles.velocity[i] + particles.force[i] * (0.5 * dt_before / particles.mass[i])
}

/// Σ m c ⊗ c of the velocities against the mean flow [J].
fn kinetic(particles: &Particles, mean: &MeanMotion, cell: &PeriodicCell, dt_before: f64) -> Mat3 {
    let gradient = cell.velocity_gradient();
    let mut sum = Mat3::zeros();
    for i in 0..particles.len() {
        let flow = mean.velocity + gradient * (particles.position[i] - mean.centre);
        let own = velocity_now(particles, i, dt_before) - flow;
        sum += own * own.transpose() * particles.mass[i];
    }
    sum
}

/// Changes the mean flow by a velocity gradient [1/s]; returns the energy that this brings [J]: as the scheme sees it, that of ½ m v · (v + Δt a).
fn change_flow(particles: &mut Particles, mean: &MeanMotion, change: &Mat3, dt_before: f64) -> f64 {
    let mut energy = 0.0;
    for i in 0..particles.len() {
        let kick = change * (particles.position[i] - mean.centre);
        energy += particles.mass[i] * kick.dot(&(velocity_now(particles, i, dt_before) + kick * 0.5));
        particles.velocity[i] += kick;
    }
    energy
}

/// Kinetic energy that the particles as they stand have beyond that against the mean flow [J].
fn streaming(particles: &Particles, mean: &MeanMotion, gradient: &Mat3, dt_before: f64) -> f64 {
    let of = |i: usize| {
        let flow = gradient * (particles.position[i] - mean.centre);
        particles.mass[i] * flow.dot(&(velocity_now(particles, i, dt_before) - flow * 0.5))
    };
    (0..particles.len()).map(of).sum()
}
