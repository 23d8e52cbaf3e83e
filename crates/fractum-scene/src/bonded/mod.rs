//! Bonded bodies: particles of their own beside the solids, joined by cohesive beams.

mod boundary;
mod piece;
mod probe;

use std::ops::Range;

use fractum_dem::{BeamEnergy, BeamNetwork, BeamSection, Leap, LeapWork, ParticleDamping, Particles};
use fractum_fem::LocalDamping;
use fractum_math::{Rotation, Vec3};
use serde::{Deserialize, Serialize};

pub use boundary::{ParticleLoad, ParticleSupport};
pub use probe::ParticleProbe;

use crate::error::SceneError;
use boundary::{Forces, Holds};

/// A bonded body before it joins a scene.
#[derive(Clone, Debug)]
pub struct BondedPart {
    /// The user's name for it.
    pub name: String,
    /// Its particles, as they start.
    pub particles: Particles,
    /// The particles of each bond.
    pub pairs: Vec<[u32; 2]>,
    /// The beam of its bonds.
    pub section: BeamSection,
    /// Density of the continuum that it stands for [kg/m³].
    pub density: f64,
}

/// A bonded body in a scene.
#[derive(Clone, Debug)]
pub struct BondedBody {
    /// The user's name for it.
    pub name: String,
    /// Its particles among those of the scene.
    pub range: Range<usize>,
    /// Its bonds; they name particles of the scene.
    pub bonds: BeamNetwork,
    /// Density of the continuum that it stands for [kg/m³].
    pub density: f64,
    broken: usize,
}

impl BondedBody {
    /// Bonds that have broken.
    pub fn broken(&self) -> usize {
        self.broken
    }
}

/// All bonded bodies of a scene: one population of particles, and the bonds of each body.
///
/// Velocities are those of the half step before tⁿ, as everywhere in a scene; forces are those of tⁿ.
#[derive(Clone, Debug, Default)]
pub struct Bonded {
    /// The particles of all bodies.
    pub particles: Particles,
    /// Centres without load [m].
    reference: Vec<Vec3>,
    bodies: Vec<BondedBody>,
    holds: Holds,
    forces: Forces,
    /// Elastic energy of the bonds when last measured.
    energy: BeamEnergy,
    /// Elastic energy that broken bonds held [J].
    released: f64,
    /// Bound on the highest natural frequency [rad/s].
    frequency: f64,
    partial: Vec<LeapWork>,
}

/// Everything that changes in bonded bodies during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BondedState {
    position: Vec<Vec3>,
    orientation: Vec<Rotation>,
    velocity: Vec<Vec3>,
    spin: Vec<Vec3>,
    /// Broken bonds of each body, ascending.
    broken: Vec<Vec<u32>>,
    released: f64,
}

/// Energies of one step [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct BondedWork {
    pub(crate) kinetic: f64,
    pub(crate) external_before: f64,
    pub(crate) external_after: f64,
    pub(crate) damped_before: f64,
    pub(crate) damped_after: f64,
}

impl Bonded {
    /// Joins bodies to one population and makes their bonds at the present distances.
    ///
    /// # Errors
    /// A beam that is none, or a bond that joins nothing.
    pub fn new(parts: Vec<BondedPart>) -> Result<Self, SceneError> {
        let mut all = Bonded::default();
        let mut plans = Vec::new();
        for part in parts {
            let start = all.particles.len();
            let BondedPart { name, mut particles, pairs, section, density } = part;
            let range = start..start + particles.len();
            let own = &mut all.particles;
            own.position.append(&mut particles.position);
            own.orientation.append(&mut particles.orientation);
            own.velocity.append(&mut particles.velocity);
            own.spin.append(&mut particles.spin);
            own.force.append(&mut particles.force);
            own.moment.append(&mut particles.moment);
            own.mass.append(&mut particles.mass);
            own.inertia.append(&mut particles.inertia);
            own.radius.append(&mut particles.radius);
            own.held.append(&mut particles.held);
            let pairs: Vec<[u32; 2]> = pairs.iter().map(|pair| pair.map(|i| i + start as u32)).collect();
            plans.push((name, range, pairs, section, density));
        }
        all.reference = all.particles.position.clone();
        for (name, range, pairs, section, density) in plans {
            let bonds = BeamNetwork::new(&all.reference, &pairs, section)?;
            all.bodies.push(BondedBody { name, range, bonds, density, broken: 0 });
        }
        // 2/ω is the step that is stable without a safety factor.
        let highest = |body: &BondedBody| 2.0 / body.bonds.stable_step(&all.particles, 1.0);
        all.frequency = all.bodies.iter().map(highest).fold(0.0, f64::max);
        all.partial = vec![LeapWork::default(); all.particles.block_count()];
        Ok(all)
    }

    /// Sets what holds and moves particles, which have their initial velocities and spins by now.
    ///
    /// - `turning`: particles and the axes (bits) about which they do not turn
    ///
    /// # Errors
    /// [`SceneError::ContradictorySupports`] if a degree of freedom is prescribed in two ways.
    pub fn set_supports(&mut self, sets: Vec<ParticleSupport>, turning: &[(u32, u8)]) -> Result<(), SceneError> {
        self.holds = Holds::new(sets, &self.reference, &mut self.particles.held)?;
        for &(particle, axes) in turning {
            let i = particle as usize;
            self.particles.held[i] |= axes << 3;
            (0..3).filter(|axis| axes >> axis & 1 == 1).for_each(|axis| self.particles.spin[i][axis] = 0.0);
        }
        Ok(())
    }

    /// Sets what pushes particles.
    pub fn set_loads(&mut self, loads: Vec<ParticleLoad>) {
        self.forces = Forces::new(loads);
    }

    /// Whether there is no bonded body.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The bodies in the order of the case.
    pub fn bodies(&self) -> &[BondedBody] {
        &self.bodies
    }

    /// Centres without load [m].
    pub fn reference(&self) -> &[Vec3] {
        &self.reference
    }

    /// Degrees of freedom that are prescribed.
    pub fn held_count(&self) -> usize {
        self.particles.held.iter().map(|bits| bits.count_ones() as usize).sum()
    }

    /// Bonds at the start, and those of them that have broken.
    pub fn bond_counts(&self) -> (usize, usize) {
        self.bodies.iter().fold((0, 0), |(all, broken), body| (all + body.bonds.len(), broken + body.broken))
    }

    /// Bound on the highest natural frequency [rad/s]; breaking only lowers it.
    pub(crate) fn frequency(&self) -> f64 {
        self.frequency
    }

    /// Elastic energy of the bonds when last measured, by parts [J].
    pub fn energy(&self) -> BeamEnergy {
        self.energy
    }

    /// Elastic energy that bonds held when they broke [J].
    pub fn released_energy(&self) -> f64 {
        self.released
    }

    /// Breaks a bond for ever; its elastic energy is booked as released. A broken bond stays as it is.
    pub fn break_bond(&mut self, body: usize, bond: usize) {
        let BondedBody { bonds, broken, .. } = &mut self.bodies[body];
        if bonds.is_live(bond) {
            self.released += bonds.energy_of(bond, &self.particles).total();
            bonds.break_bond(bond);
            *broken += 1;
        }
    }

    /// Replaces forces and moments by those of the bonds at the present positions.
    ///
    /// - `measure`: whether to sum the elastic energy, see [`Bonded::energy`]
    pub(crate) fn update_bond_forces(&mut self, measure: bool) {
        let Bonded { particles, bodies, energy, .. } = self;
        particles.clear_forces();
        bodies.iter_mut().for_each(|body| body.bonds.add_forces(particles));
        if measure {
            *energy = bodies.iter().fold(BeamEnergy::default(), |sum, body| sum + body.bonds.energy(particles));
        }
    }

    /// Adds the loads of `time`; returns their work in the half step before [J].
    pub(crate) fn add_loads(&mut self, time: f64, dt_before: f64) -> f64 {
        let Bonded { particles, reference, forces, .. } = self;
        forces.add(particles, reference, time);
        0.5 * dt_before * forces.power(particles)
    }

    /// Advances velocities and positions, then puts prescribed motion in the place of free motion.
    pub(crate) fn advance(
        &mut self,
        time: f64,
        dt_before: f64,
        dt_after: f64,
        damping: LocalDamping,
        measure: bool,
    ) -> BondedWork {
        let Bonded { particles, reference, holds, forces, partial, .. } = self;
        let damping = ParticleDamping { local: damping.local, mass_rate: damping.mass_rate };
        let motion = particles.leap(&Leap { dt_before, dt_after, damping, measure }, partial);
        let support = holds.impose(particles, reference, time, dt_before, dt_after);
        BondedWork {
            kinetic: motion.kinetic + support.kinetic,
            external_before: support.before,
            external_after: support.after + 0.5 * dt_after * forces.power(particles),
            damped_before: motion.damped_before,
            damped_after: motion.damped_after,
        }
    }

    /// Everything that changes, for a checkpoint.
    pub fn state(&self) -> BondedState {
        let Particles { position, orientation, velocity, spin, .. } = self.particles.clone();
        let dead = |body: &BondedBody| {
            (0..body.bonds.len() as u32).filter(|&bond| !body.bonds.is_live(bond as usize)).collect()
        };
        let broken = self.bodies.iter().map(dead).collect();
        BondedState { position, orientation, velocity, spin, broken, released: self.released }
    }

    /// Puts a saved state back into bodies built from the same case.
    pub fn restore(&mut self, state: BondedState) {
        let BondedState { position, orientation, velocity, spin, broken, released } = state;
        for (body, dead) in self.bodies.iter_mut().zip(broken) {
            body.broken = dead.len();
            dead.iter().for_each(|&bond| body.bonds.break_bond(bond as usize));
        }
        self.particles = Particles { position, orientation, velocity, spin, ..std::mem::take(&mut self.particles) };
        self.released = released;
    }
}
