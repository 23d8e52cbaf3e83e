use fractum_dem::{
    Bonds, CentralDifference, CrackFaces, CriticalLoad, Dof6, Fracture, LatticeSupports, LoadPoint, Occasion,
    ParticleDamping, Particles, Piece, StaticBody, Tolerance, pieces,
};
use fractum_math::{Vec3, rotation_by};
use serde::Serialize;

use super::setup::Setup;
use super::{Failure, FailureOptions};
use crate::{CalibrateError, Sample};

/// How to break in motion.
#[derive(Clone, Copy, Debug)]
pub struct MotionOptions {
    /// Density of the continuum [kg/m³].
    pub density: f64,
    /// Time in which the load would rise from zero to the first break, in times that a wave takes along the sample.
    pub transits: f64,
    /// Nominal stress [Pa] that is reached in this time instead of that of the first break. The sample has lost its strength as
    /// soon as the load falls, since bonds may go on breaking.
    pub of: Option<f64>,
    /// Pressure on the sides of a box before and while its ends move [Pa]; only forces of the supports count as load.
    pub pressure: f64,
    /// Load at which motion starts, over that of the first break: below it, the body is as at rest.
    pub start: f64,
    /// The faces of cracks.
    pub faces: CrackFaces,
    /// Share of the stable step.
    pub safety: f64,
}

/// A sample that was broken in motion.
#[derive(Clone, Debug, Serialize)]
pub struct BrokenInMotion {
    /// Nominal stress when the first bond broke [Pa].
    pub first_break: Option<f64>,
    /// Largest nominal stress [Pa].
    pub strength: f64,
    /// The largest load.
    pub peak: CriticalLoad,
    /// Broken bonds.
    pub broken: usize,
    /// Whether the sample came apart or lost its strength.
    pub separated: bool,
    /// Time steps, and their size [s].
    pub steps: usize,
    /// Time step [s].
    pub dt: f64,
    /// Energies at the end [J].
    pub energy: MotionEnergy,
    /// Load curve.
    #[serde(skip)]
    pub curve: Vec<LoadPoint>,
    /// The pieces at the end.
    #[serde(skip)]
    pub pieces: Vec<Piece>,
}

/// Where the energy is [J].
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct MotionEnergy {
    /// Work of the supports, with the elastic and kinetic energy at the start.
    pub external: f64,
    /// Kinetic energy.
    pub kinetic: f64,
    /// In bonds.
    pub elastic: f64,
    /// In bonds when they broke.
    pub broken_bonds: f64,
    /// In crack faces that touch.
    pub contact: f64,
    /// Taken by friction and damping of crack faces.
    pub friction: f64,
    /// Taken by the finite step where crack faces meet or part within it.
    pub kinks: f64,
    /// Largest difference of both sides over the external work.
    pub residual_max_relative: f64,
}

/// Steps between two points of the load curve.
const EVERY: usize = 20;
/// Load over that which [`MotionOptions::transits`] are of at which a sample that holds is given up.
const BEYOND: f64 = 2.0;

/// Breaks a sample by explicit steps with the supports at constant speed.
///
/// All particles start with the velocities of the quasi-static motion, so that no wave runs before bonds break.
///
/// # Errors
/// Another shape; an impossible criterion or density; a static solve that does not converge.
pub fn break_in_motion(
    sample: &Sample,
    test: Failure,
    options: &FailureOptions,
    motion: &MotionOptions,
) -> Result<BrokenInMotion, CalibrateError> {
    let setup = Setup::of(sample, test)?;
    let first = super::first_break(sample, test, &FailureOptions { limit: f64::INFINITY, ..*options })?;
    let Some(point) = first else {
        return Err(CalibrateError::Material {
            what: "load of the first break",
            value: f64::INFINITY,
            expected: "a test in which something breaks",
        });
    };
    let mut moving = MovingSample::new(sample, &setup, &point, options, motion)?;
    let last_factor = BEYOND * moving.rate * motion.transits * moving.transit;
    let separated = |graph: &fractum_dem::BondGraph| {
        graph.broken() > 0
            && match &setup.middle {
                None => graph.parts().separate(&setup.ends[0], &setup.ends[1]),
                Some(inside) => graph.parts_among(|i| inside[i]).separate(&setup.ends[0], &setup.ends[1]),
            }
    };
    let (mut curve, mut apart) = (Vec::new(), false);
    while moving.factor < last_factor && !apart {
        if !moving.steps.is_multiple_of(EVERY) {
            moving.step(false);
            continue;
        }
        let point = moving.measured_step();
        if moving.steps > EVERY {
            curve.push(point);
            // Half a transit without a break: the crack has come to rest.
            let rested = motion.of.is_some()
                || (moving.steps - moving.last_broken) as f64 * moving.motion.dt() > 0.5 * moving.transit;
            apart = separated(moving.fracture.graph()) || (rested && point.load < options.stop * moving.peak.load);
        }
    }
    let MovingSample { particles, fracture, motion, energy, peak, first_load, steps, .. } = moving;
    Ok(BrokenInMotion {
        first_break: first_load.map(|load| load * setup.stress_per_load),
        strength: peak.load * setup.stress_per_load,
        peak,
        broken: fracture.cracks().len(),
        separated: apart,
        steps,
        dt: motion.dt(),
        energy,
        curve,
        pieces: pieces(&particles, fracture.graph().live_pairs(), |i| particles.mass[i]),
    })
}

/// A sample between supports that move at constant speed.
struct MovingSample {
    particles: Particles,
    bonds: Bonds,
    fracture: Fracture,
    motion: CentralDifference,
    driven: Driven,
    /// Displacement (or rotation) of the supports at load factor one.
    displacement: f64,
    factor: f64,
    /// Load factor per time [1/s].
    rate: f64,
    /// Time of a wave along the sample [s].
    transit: f64,
    energy: MotionEnergy,
    load: f64,
    peak: CriticalLoad,
    first_load: Option<f64>,
    steps: usize,
    last_broken: usize,
}

/// What acts on a sample from outside.
struct Driven {
    /// Prescribed displacements (particle, axis) at load factor one.
    prescribed: Vec<(usize, usize, f64)>,
    /// Forces of the pressure on the sides.
    pressed: Vec<(usize, Vec3)>,
}

impl Driven {
    /// Work of the supports per unit of the load factor, against the forces of bonds and contacts [J].
    fn push(&self, particles: &Particles) -> f64 {
        -self.prescribed.iter().map(|&(i, d, u)| particles.force[i][d] * u).sum::<f64>()
    }

    /// Work of the pressure, from wherever it is counted [J].
    fn work_of_pressure(&self, particles: &Particles) -> f64 {
        self.pressed.iter().map(|(i, force)| force.dot(&particles.position[*i])).sum()
    }
}

impl MovingSample {
    /// The sample at its start: displacements and velocities of the quasi-static motion.
    ///
    /// - `first`: the load at which the sample at rest breaks
    fn new(
        sample: &Sample,
        setup: &Setup,
        first: &CriticalLoad,
        options: &FailureOptions,
        motion: &MotionOptions,
    ) -> Result<Self, CalibrateError> {
        let Setup { supports, guess, displacement, stress_per_load, .. } = setup;
        let state = StaticBody::new(sample.lattice.clone(), supports.clone(), guess, options.tolerance)?.state();
        let volume = sample.measured_volume();
        let (position, radius) = (sample.packing.position.clone(), sample.packing.radius.clone());
        let mut particles = Particles::at_rest(position, radius, motion.density * volume)?;
        let mut bonds =
            Bonds::with_shares(&particles, &sample.network.pairs, &sample.shares, sample.lattice.section())?;
        let fracture = Fracture::new(&bonds, &particles, options.criterion, motion.faces, sample.fraction, volume)?;
        let mut fracture = fracture.reading_at_walls(&sample.to_wall);
        // Wave speed from the stiffness that the sample shows: c² = E/ρ with E = stress per strain.
        let first_factor = first.displacement / displacement;
        let speed = (first.load * stress_per_load / (first_factor * super::STRAIN) / motion.density).sqrt();
        let (lower, upper) = sample.packing.domain.bounds();
        let transit = (upper - lower).max() / speed;
        let target = motion.of.map_or(1.0, |stress| stress / (first.load * stress_per_load)) * first_factor;
        let rate = target / (motion.transits * transit);
        let factor = motion.start * first_factor;
        let pressed = if motion.pressure > 0.0 { pressure_on_sides(sample, motion.pressure)? } else { Vec::new() };
        let squeezed = squeezed(sample, supports, &pressed, options.tolerance)?;
        set_in_motion(&mut particles, &squeezed, 1.0, 0.0);
        set_in_motion(&mut particles, &state, factor, rate);
        let mut prescribed = Vec::new();
        for (i, u) in state.iter().enumerate() {
            let held = |&d: &usize| supports.is_fixed(i as u32, d);
            particles.held[i] = (0..6).filter(held).fold(0, |bits, d| bits | 1 << d);
            prescribed.extend((0..3).filter(held).map(|d| (i, d, u[d])));
        }
        let dt = bonds.stable_step(&particles, motion.safety);
        fracture.add_bond_forces(&mut bonds, &mut particles);
        press(&mut particles, &pressed);
        particles.start_half_a_step_early(dt);
        Ok(MovingSample {
            motion: CentralDifference::new(&particles, dt, ParticleDamping::default()),
            particles,
            bonds,
            fracture,
            driven: Driven { prescribed, pressed },
            displacement: *displacement,
            factor,
            rate,
            transit,
            energy: MotionEnergy::default(),
            load: 0.0,
            peak: CriticalLoad { displacement: 0.0, load: 0.0, broken: 0 },
            first_load: None,
            steps: 0,
            last_broken: 0,
        })
    }

    /// One step. Returns the kinetic energy at its start, where it is measured [J].
    fn step(&mut self, measure: bool) -> f64 {
        let MovingSample { particles, bonds, fracture, motion, driven, .. } = self;
        let (before, potential) = (driven.push(particles), driven.work_of_pressure(particles));
        let kinetic = if measure {
            motion.kick_drift_and_measure(particles).before.kinetic
        } else {
            motion.kick_and_drift(particles);
            0.0
        };
        let dt = motion.dt();
        fracture.book_last_work(particles, None, dt);
        particles.clear_forces();
        fracture.add_bond_forces(bonds, particles);
        press(particles, &driven.pressed);
        let faces = fracture.add_contact_forces(particles, None, dt);
        self.energy.friction += faces.contact.friction + faces.contact.damping;
        self.energy.kinks += faces.kinks;
        self.energy.contact = faces.contact.stored;
        let after = driven.push(particles);
        let by_pressure = driven.work_of_pressure(particles) - potential;
        self.energy.external += 0.5 * (before + after) * self.rate * dt + by_pressure;
        self.factor += self.rate * dt;
        self.steps += 1;
        self.load = after / self.displacement;
        let broken = self.fracture.cracks().len();
        if self.load > self.peak.load {
            self.peak = CriticalLoad { displacement: self.factor * self.displacement, load: self.load, broken };
        }
        let occasion = Occasion { time: self.steps as f64 * dt, event: self.steps, load: self.load };
        if self.fracture.break_overloaded(&mut self.bonds, &self.particles, occasion) > 0 {
            self.first_load.get_or_insert(self.load);
            self.last_broken = self.steps;
        }
        kinetic
    }

    /// One step with the energies at its start, and the point of the load curve there.
    fn measured_step(&mut self) -> LoadPoint {
        let mut now = self.energy;
        now.elastic = self.bonds.energy(&self.particles).total();
        now.broken_bonds = self.fracture.released();
        let displacement = self.factor * self.displacement;
        let (load, broken) = (self.load, self.fracture.cracks().len());
        let first = self.steps == 0;
        now.kinetic = self.step(true);
        if first {
            now.external = now.kinetic + now.elastic;
            self.energy.external += now.external;
        }
        let sum = now.kinetic + now.elastic + now.broken_bonds + now.contact + now.friction + now.kinks;
        let residual = ((now.external - sum) / now.external).abs();
        let MotionEnergy { kinetic, elastic, broken_bonds, .. } = now;
        let residual_max_relative = now.residual_max_relative.max(residual);
        self.energy = MotionEnergy { kinetic, elastic, broken_bonds, residual_max_relative, ..self.energy };
        LoadPoint { displacement, load, elastic, work: now.external, broken }
    }
}

/// Forces of a pressure [Pa] on the four sides of a box, in equilibrium.
fn pressure_on_sides(sample: &Sample, pressure: f64) -> Result<Vec<(usize, Vec3)>, CalibrateError> {
    let size = sample.box_extents().ok_or(CalibrateError::Shape { test: "pressure on the sides", shape: "a box" })?;
    let mut forces = Vec::new();
    for (wall, inwards, area) in [
        ("y-", Vec3::y(), size.x * size.z),
        ("y+", -Vec3::y(), size.x * size.z),
        ("z-", Vec3::z(), size.x * size.y),
        ("z+", -Vec3::z(), size.x * size.y),
    ] {
        let set = sample.packing.wall(wall).unwrap_or_default();
        forces.extend(set.iter().map(|&i| (i as usize, inwards * (pressure * area / set.len() as f64))));
    }
    // Walls are not met at exactly opposite places: what would turn the box about its axis is taken off.
    let position = |i: usize| sample.packing.position[i];
    let centre = forces.iter().map(|(i, _)| position(*i)).sum::<Vec3>() / forces.len().max(1) as f64;
    let across = |i: usize| position(i) - centre - Vec3::x() * (position(i) - centre).x;
    let moment: f64 = forces.iter().map(|(i, force)| across(*i).cross(force).x).sum();
    let inertia: f64 = forces.iter().map(|(i, _)| across(*i).norm_squared()).sum();
    forces.iter_mut().for_each(|(i, force)| *force -= Vec3::x().cross(&across(*i)) * (moment / inertia));
    Ok(forces)
}

/// Displacements and rotations of the elastic sample under forces, its supports at rest.
fn squeezed(
    sample: &Sample,
    supports: &LatticeSupports,
    forces: &[(usize, Vec3)],
    tolerance: Tolerance,
) -> Result<Vec<Dof6>, CalibrateError> {
    let count = sample.packing.len();
    let rest = vec![[0.0; 6]; count];
    if forces.is_empty() {
        return Ok(rest);
    }
    let (mut held, mut loads) = (LatticeSupports::none(count), rest.clone());
    for i in 0..count {
        (0..6).filter(|&d| supports.is_fixed(i as u32, d)).for_each(|d| held.set(i as u32, d, 0.0));
    }
    forces.iter().for_each(|(i, force)| (0..3).for_each(|d| loads[*i][d] += force[d]));
    Ok(sample.lattice.solve(&held, Some(&loads), &rest, tolerance)?.state)
}

/// Adds forces to those of particles.
fn press(particles: &mut Particles, forces: &[(usize, Vec3)]) {
    forces.iter().for_each(|(i, force)| particles.force[*i] += force);
}

/// Adds displacements and rotations times a factor, and velocities and spins at its rate [1/s].
fn set_in_motion(particles: &mut Particles, state: &[Dof6], factor: f64, rate: f64) {
    for (i, u) in state.iter().enumerate() {
        let (shift, turn) = (Vec3::new(u[0], u[1], u[2]), Vec3::new(u[3], u[4], u[5]));
        particles.position[i] += shift * factor;
        particles.orientation[i] = rotation_by(turn * factor) * particles.orientation[i];
        particles.velocity[i] += shift * rate;
        particles.spin[i] += turn * rate;
    }
}
