//! Supports and loads of particles, and the work both do; the twin of the nodes' in `boundary.rs`.

use std::fmt;

use fractum_dem::Particles;
use fractum_math::{HalfSteps, Vec3};

use crate::boundary::{Motion, TimeFunction};
use crate::error::SceneError;

/// One axis of a set of particles, prescribed.
#[derive(Clone)]
pub struct ParticleSupport {
    /// The user's name for it.
    pub name: String,
    /// Particles of the scene.
    pub particles: Vec<u32>,
    /// Axis 0, 1 or 2.
    pub axis: usize,
    /// How it moves.
    pub motion: Motion,
}

/// A force along an axis on particles: the whole of it, or an acceleration of all.
#[derive(Clone)]
pub enum ParticleLoad {
    /// Value times weight [N].
    Force {
        /// Particles and their shares of the force.
        particles: Vec<(u32, f64)>,
        /// Axis 0, 1 or 2.
        axis: usize,
        /// Force [N].
        value: TimeFunction,
    },
    /// Acceleration of every particle [m/s²].
    Gravity {
        /// Axis 0, 1 or 2.
        axis: usize,
        /// Acceleration, taken at the origin.
        value: TimeFunction,
    },
}

impl fmt::Debug for ParticleLoad {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ParticleLoad::Force { particles, axis, .. } => write!(f, "Force({} particles, {axis})", particles.len()),
            ParticleLoad::Gravity { axis, .. } => write!(f, "Gravity({axis})"),
        }
    }
}

/// All supports of the bonded bodies.
#[derive(Clone, Default)]
pub(super) struct Holds {
    sets: Vec<Held>,
}

#[derive(Clone)]
struct Held {
    support: ParticleSupport,
    /// Force of the support on each particle at tⁿ [N].
    reaction: Vec<f64>,
}

impl fmt::Debug for Holds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.sets.iter().map(|set| &set.support.name)).finish()
    }
}

impl Holds {
    /// Collects supports and marks what they prescribe in `held`; particles that two fixed supports share are kept
    /// once.
    pub(super) fn new(sets: Vec<ParticleSupport>, reference: &[Vec3], held: &mut [u8]) -> Result<Self, SceneError> {
        let mut owner: Vec<[u32; 3]> = vec![[u32::MAX; 3]; if sets.is_empty() { 0 } else { reference.len() }];
        let mut kept: Vec<Held> = Vec::new();
        for (index, mut support) in sets.into_iter().enumerate() {
            let axis = support.axis;
            let mut own = Vec::with_capacity(support.particles.len());
            for &particle in &support.particles {
                let place = &mut owner[particle as usize][axis];
                if *place == u32::MAX {
                    *place = index as u32;
                    held[particle as usize] |= 1 << axis;
                    own.push(particle);
                    continue;
                }
                let first = &kept[*place as usize].support;
                if !(matches!(first.motion, Motion::Fixed) && matches!(support.motion, Motion::Fixed)) {
                    let p = reference[particle as usize];
                    return Err(SceneError::ContradictorySupports {
                        first: first.name.clone(),
                        second: support.name,
                        axis: ['x', 'y', 'z'][axis],
                        x: p.x,
                        y: p.y,
                        z: p.z,
                    });
                }
            }
            support.particles = own;
            kept.push(Held { reaction: vec![0.0; support.particles.len()], support });
        }
        Ok(Holds { sets: kept })
    }

    /// Places (set, entry, axis) of the prescribed degrees of freedom of these particles, which are ascending.
    pub(super) fn places(&self, particles: &[u32]) -> Vec<(u32, u32, u32)> {
        let mut places = Vec::new();
        for (set, Held { support, .. }) in self.sets.iter().enumerate() {
            for (entry, particle) in support.particles.iter().enumerate() {
                if particles.binary_search(particle).is_ok() {
                    places.push((set as u32, entry as u32, support.axis as u32));
                }
            }
        }
        places
    }

    /// Force of the supports on these places along `direction` at the last step [N].
    pub(super) fn reaction(&self, places: &[(u32, u32, u32)], direction: &Vec3) -> f64 {
        places.iter().map(|&(s, e, a)| self.sets[s as usize].reaction[e as usize] * direction[a as usize]).sum()
    }

    /// Particle, axis and displacement at the time `end` of everything prescribed, which must move in proportion to time.
    ///
    /// # Errors
    /// [`SceneError::NotProportional`].
    pub(super) fn displacements(&self, reference: &[Vec3], end: f64) -> Result<Vec<(u32, usize, f64)>, SceneError> {
        let mut found = Vec::new();
        for Held { support, .. } in &self.sets {
            for &particle in &support.particles {
                let x = &reference[particle as usize];
                let at = |share: f64| match &support.motion {
                    Motion::Fixed => 0.0,
                    // A velocity is proportional if it is constant.
                    Motion::Velocity(v) => v(share * end, x) * share * end,
                    Motion::Displacement(u) => u(share * end, x),
                };
                let whole = at(1.0);
                let proportional = |share: f64| (at(share) - share * whole).abs() <= 1e-9 * whole.abs();
                if ![0.0, 0.1, 0.25, 0.5, 0.7].into_iter().all(proportional) {
                    let name = support.name.clone();
                    return Err(SceneError::NotProportional { name, axis: ['x', 'y', 'z'][support.axis] });
                }
                found.push((particle, support.axis, whole));
            }
        }
        Ok(found)
    }

    /// Takes the forces of the supports from an equilibrium.
    pub(super) fn set_reactions(&mut self, of: impl Fn(u32) -> [f64; 6]) {
        for Held { support, reaction } in &mut self.sets {
            for (&particle, reaction) in support.particles.iter().zip(reaction) {
                *reaction = of(particle)[support.axis];
            }
        }
    }

    /// Gives held axes, which have kept their velocity so far, the prescribed one, and finds the reactions.
    pub(super) fn impose(
        &mut self,
        particles: &mut Particles,
        reference: &[Vec3],
        time: f64,
        dt_before: f64,
        dt_after: f64,
    ) -> HalfSteps {
        let mut work = HalfSteps::default();
        let dt_kick = 0.5 * (dt_before + dt_after);
        for Held { support, reaction } in &mut self.sets {
            let axis = support.axis;
            for (&particle, reaction) in support.particles.iter().zip(reaction) {
                let i = particle as usize;
                let before = particles.velocity[i][axis];
                let velocity = match &support.motion {
                    Motion::Fixed => 0.0,
                    Motion::Velocity(v) => v(time + 0.5 * dt_after, &reference[i]),
                    Motion::Displacement(u) => {
                        let present = particles.position[i][axis] - reference[i][axis] - before * dt_after;
                        (u(time + dt_after, &reference[i]) - present) / dt_after
                    }
                };
                // What moves a held particle: the support, and the forces that it balances.
                let total = particles.mass[i] * (velocity - before) / dt_kick;
                *reaction = total - particles.force[i][axis];
                particles.velocity[i][axis] = velocity;
                particles.position[i][axis] += (velocity - before) * dt_after;
                work.before.external += 0.5 * *reaction * before * dt_before;
                work.after.external += 0.5 * *reaction * velocity * dt_after;
                work.before.kinetic += 0.5 * total * before * dt_before;
            }
        }
        work
    }
}

/// All loads of the bonded bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Forces {
    loads: Vec<ParticleLoad>,
    /// Forces on single particles of the last step [N].
    applied: Vec<(u32, Vec3)>,
    /// Acceleration of all particles in the last step [m/s²].
    gravity: Vec3,
}

impl Forces {
    pub(super) fn new(loads: Vec<ParticleLoad>) -> Self {
        let entries = |load: &ParticleLoad| match load {
            ParticleLoad::Force { particles, .. } => particles.len(),
            ParticleLoad::Gravity { .. } => 0,
        };
        Forces { applied: Vec::with_capacity(loads.iter().map(entries).sum()), loads, gravity: Vec3::zeros() }
    }

    /// Adds the forces of `time`.
    ///
    /// - `tied`: particles whose weight acts on nodes
    pub(super) fn add(&mut self, particles: &mut Particles, tied: &[u32], reference: &[Vec3], time: f64) {
        let Forces { loads, applied, gravity } = self;
        applied.clear();
        *gravity = Vec3::zeros();
        for load in loads.iter() {
            match load {
                ParticleLoad::Force { particles, axis, value } => {
                    for &(particle, weight) in particles {
                        let mut force = Vec3::zeros();
                        force[*axis] = weight * value(time, &reference[particle as usize]);
                        applied.push((particle, force));
                    }
                }
                ParticleLoad::Gravity { axis, value } => gravity[*axis] += value(time, &Vec3::zeros()),
            }
        }
        for &(particle, force) in applied.iter() {
            particles.force[particle as usize] += force;
        }
        if *gravity != Vec3::zeros() {
            let Particles { force, mass, .. } = particles;
            force.iter_mut().zip(&*mass).for_each(|(force, mass)| *force += *gravity * *mass);
            tied.iter().for_each(|&i| force[i as usize] -= *gravity * mass[i as usize]);
        }
    }

    /// Power of the last forces at the present velocities [W].
    pub(super) fn power(&self, particles: &Particles, tied: &[u32]) -> f64 {
        let velocity = &particles.velocity;
        let mut power: f64 = self.applied.iter().map(|(i, force)| force.dot(&velocity[*i as usize])).sum();
        if self.gravity != Vec3::zeros() {
            let momentum: Vec3 = velocity.iter().zip(&particles.mass).map(|(v, m)| v * *m).sum();
            let others: Vec3 = tied.iter().map(|&i| velocity[i as usize] * particles.mass[i as usize]).sum();
            power += self.gravity.dot(&(momentum - others));
        }
        power
    }
}
