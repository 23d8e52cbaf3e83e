//! Bonded bodies: particles of their own beside the solids, joined by bonds of a law.

mod distributed;
mod fields;
mod frequency;
mod leave;
mod momentum;
mod piece;
mod plan;
mod points;
mod state;
mod through_box;

use std::ops::Range;

use fractum_contact::PeriodicCell;
use fractum_dem::{
    AnyBondLaw, BondEnergy, BondGraph, Bonds, Clumps, Crack, Fracture, Occasion, ParticleDamping, ParticleSubdomain,
    Particles, PastForces, TimeStep,
};
use fractum_fem::LocalDamping;
use fractum_math::{HalfSteps, Vec3, Work};
use serde::{Deserialize, Serialize};

use crate::clock::Clock;
use crate::conditions::{Kick, Load, Loads, Support, Supports};
use crate::error::SceneError;
use momentum::{energy_of, viscous_power};
pub use plan::BondFracture;
use points::ParticlePoints;
pub use state::BondedState;
pub use through_box::narrowest_box;
pub(crate) use through_box::{set_cell, set_cell_velocity, sums_through_box, touching_faces};

/// Steps between two searches for particles of a broken body that meet others of it.
const STEPS_BETWEEN_SEARCHES: u64 = 20;

/// A bonded body before it joins a scene.
#[derive(Clone, Debug)]
pub struct BondedPart {
    /// The user's name for it.
    pub name: String,
    /// Its particles, as they start.
    pub particles: Particles,
    /// The particles of each bond.
    pub pairs: Vec<[u32; 2]>,
    /// The law of its bonds.
    pub law: AnyBondLaw,
    /// Factors on the areas of the bonds; 1 where there are none.
    pub shares: Vec<f64>,
    /// Density of the continuum that it stands for [kg/m³].
    pub density: f64,
    /// Volume fraction of the interior of the packing.
    pub fraction: f64,
    /// When its bonds break; never where there is nothing.
    pub fracture: Option<BondFracture>,
    /// Rigid grains that its particles are spheres of; none of bonded bodies.
    pub clumps: Clumps,
}

/// How close a body came to its first or next broken bond.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Closest {
    /// What it bore over what it can bear.
    pub ratio: f64,
    /// Where, in the undeformed body [m].
    pub place: Vec3,
    /// When [s].
    pub time: f64,
}

/// A bonded body in a scene.
#[derive(Clone, Debug)]
pub struct BondedBody {
    /// The user's name for it.
    pub name: String,
    /// Its particles among those of the scene.
    pub range: Range<usize>,
    /// Its bonds; they name particles of the scene.
    pub bonds: Bonds,
    /// Density of the continuum that it stands for [kg/m³].
    pub density: f64,
    /// Volume fraction of the interior of the packing.
    pub fraction: f64,
    pub(crate) plan: Option<BondFracture>,
    pub(crate) fracture: Option<Fracture>,
    pub(crate) closest: Option<Closest>,
    /// All bonds, where they resist the change of their length.
    viscous: Option<BondGraph>,
    /// Largest viscous resistance over stiffness of its bonds as they were made [s].
    viscous_time: f64,
    /// Bound on the highest frequency [rad/s]: 2/ω is the step that is stable without a safety factor.
    bound: f64,
}

impl BondedBody {
    /// Bonds that have broken.
    pub fn broken(&self) -> usize {
        self.cracks().len()
    }

    /// What broke, in order.
    pub fn cracks(&self) -> &[Crack] {
        self.fracture.as_ref().map_or(&[], Fracture::cracks)
    }

    /// Whether a bond holds: one that has separated by its law is live as a contact, but joins nothing.
    pub fn is_joined(&self, bond: usize) -> bool {
        let of_graph = |fracture: &Fracture| fracture.graph().is_live(bond as u32);
        self.fracture.as_ref().map_or_else(|| self.bonds.is_live(bond), of_graph)
    }

    /// Whether its bonds can break.
    pub fn can_break(&self) -> bool {
        self.fracture.is_some()
    }

    /// The largest ratio of load to strength at the steps that were measured; none where bonds cannot break.
    pub fn closest(&self) -> Option<Closest> {
        self.closest
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
    pub(crate) reference: Vec<Vec3>,
    pub(crate) bodies: Vec<BondedBody>,
    pub(crate) supports: Supports,
    /// Particles that supports keep from turning, ascending, with the axes (bits) about which they do.
    pub(crate) still: Vec<(u32, u8)>,
    pub(crate) loads: Loads,
    /// Rigid grains of particles.
    pub(crate) clumps: Clumps,
    /// Particles that follow the facets of a solid or a clump, ascending; their mass is that of the nodes or the clump.
    carried: Vec<u32>,
    /// Elastic energy of the bonds when last measured.
    pub(crate) energy: BondEnergy,
    /// Elastic energy that bonds which broke before tⁿ held [J].
    released: f64,
    /// Energy that the laws of bonds have dissipated, when last measured [J].
    dissipated: f64,
    /// Viscous forces of bonds, one per particle where there are any [N].
    viscous: Vec<Vec3>,
    /// Highest natural frequency, or a bound on it [rad/s].
    frequency: f64,
    partial: Vec<HalfSteps>,
    /// φ − 1 of the scheme of Tchamwa and Wielgosz.
    dissipation: f64,
    /// Forces of the step before, where that scheme is used.
    past: PastForces,
    /// What this process moves, where several share the particles.
    part: Option<Box<ParticleSubdomain>>,
}

impl Bonded {
    /// Joins bodies to one population and makes their bonds at the present distances.
    ///
    /// # Errors
    /// A beam that is none, or a bond that joins nothing.
    pub fn new(parts: Vec<BondedPart>) -> Result<Self, SceneError> {
        Self::within(parts, None)
    }

    /// [`Bonded::new`] in a box that repeats: bonds join the nearest images.
    ///
    /// # Errors
    /// As [`Bonded::new`].
    pub fn within(parts: Vec<BondedPart>, cell: Option<&PeriodicCell>) -> Result<Self, SceneError> {
        let mut all = Bonded::default();
        let mut plans = Vec::new();
        for part in parts {
            let start = all.particles.len();
            let BondedPart { name, mut particles, pairs, law, shares, density, fraction, fracture, clumps } = part;
            all.clumps.append(clumps, start);
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
            own.thickness = particles.thickness.or(own.thickness);
            let pairs: Vec<[u32; 2]> = pairs.iter().map(|pair| pair.map(|i| i + start as u32)).collect();
            plans.push((name, range, (pairs, shares, law), [density, fraction], fracture));
        }
        all.reference = all.particles.position.clone();
        all.carried = all.clumps.all_particles().map(|i| i as u32).collect();
        for (name, range, (pairs, shares, law), [density, fraction], mut plan) in plans {
            let bonds = Bonds::within(&all.particles, &pairs, &shares, law, cell)?;
            if let Some(plan) = &mut plan {
                plan.take_place(range.clone(), all.particles.len());
            }
            let fracture = match &plan {
                Some(BondFracture { criterion: Some(criterion), faces, volume, strength_factors, to_wall }) => {
                    let fracture = Fracture::new(&bonds, &all.particles, *criterion, *faces, fraction, *volume)?;
                    Some(fracture.with_strength_factors(strength_factors).reading_at_walls(to_wall))
                }
                Some(plan) => Some(Fracture::of_law(&bonds, &all.particles, plan.faces, plan.volume)),
                None => None,
            };
            let viscous_time = bonds.viscous_time(&all.particles);
            let resists = viscous_time > 0.0;
            let viscous = resists.then(|| BondGraph::new(all.particles.len(), bonds.pairs()));
            if resists {
                all.viscous.resize(all.particles.len(), Vec3::zeros());
            }
            let bound = 2.0 / bonds.stable_step(&all.particles, 1.0);
            all.bodies.push(BondedBody {
                name,
                range,
                bonds,
                density,
                fraction,
                plan,
                fracture,
                closest: None,
                viscous,
                viscous_time,
                bound,
            });
        }
        all.frequency = all.bodies.iter().map(|body| body.bound).fold(0.0, f64::max);
        all.partial = vec![HalfSteps::default(); all.particles.block_count()];
        Ok(all)
    }

    /// Sets what holds and moves particles, which have their initial velocities and spins by now.
    ///
    /// - `turning`: particles and the axes (bits) about which they do not turn
    ///
    /// # Errors
    /// [`SceneError::ContradictorySupports`] if a degree of freedom is prescribed in two ways.
    pub fn set_supports(&mut self, sets: Vec<Support>, turning: &[(u32, u8)]) -> Result<(), SceneError> {
        self.supports = Supports::new(sets, &self.reference)?;
        self.particles.held.iter_mut().zip(self.supports.held()).for_each(|(held, bits)| *held |= bits);
        for &(particle, axes) in turning {
            let i = particle as usize;
            self.particles.held[i] |= axes << 3;
            (0..3).filter(|axis| axes >> axis & 1 == 1).for_each(|axis| self.particles.spin[i][axis] = 0.0);
        }
        self.still = turning.to_vec();
        self.still.sort_unstable();
        self.still.dedup_by(|next, own| {
            let same = next.0 == own.0;
            own.1 |= if same { next.1 } else { 0 };
            same
        });
        Ok(())
    }

    /// Those of some particles, ascending, that supports keep from turning, with the axes (bits) about which they do.
    pub fn still(&self, particles: &[u32]) -> Vec<(u32, u8)> {
        self.still.iter().copied().filter(|(particle, _)| particles.binary_search(particle).is_ok()).collect()
    }

    /// Whether all supports and loads grow in proportion to time until `end` [s], but for loads that hold from the start.
    ///
    /// # Errors
    /// [`SceneError::NotProportional`], [`SceneError::LoadNotProportional`] with the first that does not.
    pub fn check_proportional(&self, end: f64) -> Result<(), SceneError> {
        self.supports.proportional(&self.reference, end)?;
        self.loads.proportional(self, &self.particles.mass, end).map(|_| ())
    }

    /// Damps the highest frequencies by the scheme of Tchamwa and Wielgosz.
    ///
    /// - `phi`: φ ≥ 1; 1 is velocity Verlet without dissipation
    pub fn set_dissipation(&mut self, phi: f64) {
        self.dissipation = phi - 1.0;
        self.past = if phi > 1.0 { PastForces::none(self.particles.len()) } else { PastForces::default() };
    }

    /// Sets what pushes particles.
    pub fn set_loads(&mut self, loads: Vec<Load>) {
        self.loads = Loads::new(loads, self.particles.len());
    }

    /// Hands particles over to the solids that move them from now on.
    pub(crate) fn set_tied(&mut self, tied: Vec<u32>) {
        // Held in all degrees of freedom, they take no part in the step.
        tied.iter().for_each(|&i| self.particles.held[i as usize] = 0b11_1111);
        self.carried.extend(tied);
        self.carried.sort_unstable();
    }

    /// Whether something else moves a particle.
    fn is_carried(&self, particle: usize) -> bool {
        self.carried.binary_search(&(particle as u32)).is_ok()
    }

    /// Mass of a particle that moves by itself, 0 of one that is carried [kg].
    fn own_mass(&self, particle: usize) -> f64 {
        if self.is_carried(particle) { 0.0 } else { self.particles.mass[particle] }
    }

    /// Rigid grains that particles are spheres of.
    pub fn clumps(&self) -> &Clumps {
        &self.clumps
    }

    /// Whether there is no bonded body.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// The bodies in the order of the case.
    pub fn bodies(&self) -> &[BondedBody] {
        &self.bodies
    }

    /// Supports of the particles, with the reactions of the last step.
    pub fn supports(&self) -> &Supports {
        &self.supports
    }

    /// Centres without load [m].
    pub fn reference(&self) -> &[Vec3] {
        &self.reference
    }

    /// Degrees of freedom that are prescribed, or follow a solid.
    pub fn held_count(&self) -> usize {
        let all: usize = self.particles.held.iter().map(|bits| bits.count_ones() as usize).sum();
        all - 6 * self.clumps.all_particles().count()
    }

    /// Bonds at the start, and those of them that have broken.
    pub fn bond_counts(&self) -> (usize, usize) {
        self.bodies.iter().fold((0, 0), |(all, broken), body| (all + body.bonds.len(), broken + body.broken()))
    }

    /// Energy that is nothing [J]: a million steps in each of which places move by a rounding bring a thousandth of it.
    pub(crate) fn round_off_energy(&self, dt: f64) -> f64 {
        let farthest = self.reference.iter().map(|x| x.amax()).fold(0.0, f64::max);
        1e9 * self.particles.mass.iter().sum::<f64>() * (f64::EPSILON * farthest / dt).powi(2)
    }

    /// Elastic energy of the bonds when last measured, by parts [J].
    pub fn energy(&self) -> BondEnergy {
        self.energy
    }

    /// Elastic energy that bonds held when they broke [J].
    pub fn released_energy(&self) -> f64 {
        self.released
    }

    /// Energy that the laws of bonds have dissipated, when last measured [J].
    pub(crate) fn dissipated_energy(&self) -> f64 {
        self.dissipated
    }

    /// Replaces forces and moments by those of the bonds and of crack faces at the present positions.
    ///
    /// - `dt` [s]: the step that led here
    /// - `measure`: whether to sum the elastic energy, see [`Bonded::energy`]
    pub(crate) fn update_bond_forces(&mut self, dt: f64, measure: bool) -> Work {
        let Bonded { particles, bodies, energy, released, dissipated, viscous, part, clumps, .. } = self;
        clumps.clear_forces();
        match part {
            Some(part) => particles.clear_forces_of_part(part),
            None => particles.clear_forces(),
        }
        let mut work = Work::default();
        *released = 0.0;
        viscous.fill(Vec3::zeros());
        for BondedBody { bonds, fracture, viscous: graph, .. } in bodies.iter_mut() {
            if let Some(graph) = graph {
                bonds.add_viscous_forces(particles, graph, viscous);
            }
            let Some(fracture) = fracture else {
                bonds.add_forces(particles);
                continue;
            };
            fracture.add_bond_forces(bonds, particles);
            let faces = fracture.add_contact_forces(particles, part.as_deref(), dt);
            work += faces.contact;
            *released += fracture.released();
        }
        particles.force.iter_mut().zip(viscous).for_each(|(force, viscous)| *force += *viscous);
        if measure {
            *dissipated = bodies.iter().map(|body| body.bonds.dissipated()).sum();
            *energy = bodies.iter().fold(BondEnergy::default(), |sum, body| sum + body.bonds.energy(particles));
        }
        work
    }

    /// Breaks what the forces of tⁿ overload; they still act on the kick that follows.
    ///
    /// - `measure`: whether to see how close every body is to breaking, too
    pub(crate) fn break_overloaded(&mut self, step: u64, time: f64, measure: bool) {
        let Bonded { particles, reference, bodies, part, past, .. } = self;
        let occasion = Occasion { time, event: step as usize, load: 0.0 };
        let mut finds_new = false;
        for BondedBody { bonds, fracture, closest, range, .. } in bodies {
            let Some(fracture) = fracture else { continue };
            if step.is_multiple_of(STEPS_BETWEEN_SEARCHES) && fracture.may_have_new_pairs() {
                part.iter_mut().for_each(|part| part.gather(particles, past));
                fracture.find_new_pairs(bonds, particles, range.clone());
                finds_new |= part.is_some();
            }
            if measure && let Some(site) = fracture.closest(bonds, particles) {
                let place = fracture.position_of(&site, reference);
                if closest.is_none_or(|known| site.ratio > known.ratio) {
                    *closest = Some(Closest { ratio: site.ratio, place, time });
                }
            }
            fracture.break_overloaded(bonds, particles, occasion);
        }
        if finds_new {
            self.set_strangers();
        }
    }

    /// Kinetic energy of the particles that no solid carries, and of clumps [J].
    pub(crate) fn kinetic_energy(&self) -> f64 {
        self.particles.kinetic_energy() - energy_of(&self.particles, &self.carried) + self.clumps.kinetic_energy()
    }

    /// Adds the loads of `time`; returns their work in the half step before [J].
    pub(crate) fn add_loads(&mut self, time: f64, dt_before: f64) -> f64 {
        let Bonded { particles, reference, loads, carried, clumps, part, .. } = self;
        let part = part.as_deref();
        loads.add_forces(&mut ParticlePoints { particles, reference, carried, clumps, part }, time, dt_before)
    }

    /// Advances velocities and positions, then puts prescribed motion in the place of free motion.
    ///
    /// - `follow`: takes tied particles to their places
    pub(crate) fn advance(
        &mut self,
        clock: Clock,
        damping: LocalDamping,
        measure: bool,
        follow: impl FnOnce(&mut Particles),
    ) -> HalfSteps {
        let (Clock { time, dt_before, dt_after, .. }, begins) = (clock, clock.begins_motion());
        let Bonded {
            particles,
            reference,
            bodies,
            supports,
            loads,
            partial,
            past,
            dissipation,
            carried,
            clumps,
            viscous,
            part,
            ..
        } = self;
        let resistance = viscous_power(particles, viscous);
        let damping = ParticleDamping { local: damping.local, mass_rate: damping.mass_rate, dissipation: *dissipation };
        let counted_twice = if measure { energy_of(particles, carried) } else { 0.0 };
        let mut points = ParticlePoints { particles, reference, carried, clumps, part: part.as_deref() };
        supports.remember(&points, None);
        let step = TimeStep { dt_before, dt_after, damping, measure };
        let of_clumps = points.clumps.kick_and_drift(points.particles, &step);
        let mut work = match points.part {
            Some(part) => points.particles.kick_and_drift_part(part, &step, past, partial),
            None => points.particles.kick_and_drift(&step, past, partial),
        };
        work +=
            supports.impose(&mut points, &Kick { time, dt_before, dt_after, is_fine: None, is_first: true, begins });
        work.before.damping -= 0.5 * dt_before * resistance;
        work.before.kinetic -= counted_twice;
        work.after.kinetic -= counted_twice;
        work += of_clumps;
        points.clumps.carry(points.particles);
        follow(points.particles);
        work.after.external += 0.5 * dt_after * loads.power(&points);
        part.iter_mut().for_each(|part| part.exchange_ghosts(particles));
        for body in bodies.iter_mut() {
            body.bonds.book_last_work(particles, dt_after);
            let fracture = body.fracture.iter_mut();
            fracture.for_each(|fracture| fracture.book_last_work(particles, part.as_deref(), dt_after));
        }
        work.after.damping -= 0.5 * dt_after * viscous_power(particles, viscous);
        work
    }
}
