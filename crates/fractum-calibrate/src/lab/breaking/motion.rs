use fractum_dem::{
    BeamNetwork, CrackFaces, CriticalLoad, Fracture, Integrator, LoadPoint, Occasion, Particles, Piece, StaticBody,
    pieces,
};
use fractum_math::{Rotation, Vec3};
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
/// Load over that of the first break at which a sample that holds is given up.
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
    let Setup { supports, guess, displacement, stress_per_load, ends, middle, .. } = Setup::of(sample, test)?;
    let first = super::break_sample(sample, test, &FailureOptions { limit: f64::INFINITY, ..*options })?.outcome;
    let Some(point) = first.first else {
        return Err(CalibrateError::Material {
            what: "load of the first break",
            value: f64::INFINITY,
            expected: "a test in which something breaks",
        });
    };
    let first_factor = point.displacement / displacement;
    let rest = StaticBody::new(sample.lattice.clone(), supports.clone(), &guess, options.tolerance)?;
    let state = rest.state();
    let mass = motion.density * sample.measured_volume();
    let mut particles = Particles::at_rest(sample.packing.position.clone(), sample.packing.radius.clone(), mass)?;
    let mut bonds = BeamNetwork::new(&particles.position, &sample.network.pairs, sample.lattice.section())?;
    let volume = sample.measured_volume();
    let mut fracture = Fracture::new(&bonds, &particles, options.criterion, motion.faces, sample.fraction, volume)?;
    // Wave speed from the stiffness that the sample shows: c² = E/ρ with E = stress per strain.
    let strain = point.displacement / displacement * super::STRAIN;
    let speed = (point.load * stress_per_load / strain / motion.density).sqrt();
    let (lower, upper) = sample.packing.domain.bounds();
    let period = motion.transits * (upper - lower).max() / speed;
    let rate = first_factor / period;
    let mut factor = motion.start * first_factor;
    for (i, u) in state.iter().enumerate() {
        let (shift, turn) = (Vec3::new(u[0], u[1], u[2]), Vec3::new(u[3], u[4], u[5]));
        particles.position[i] += shift * factor;
        particles.orientation[i] = Rotation::from_scaled_axis(turn * factor);
        particles.velocity[i] = shift * rate;
        particles.spin[i] = turn * rate;
        particles.held[i] = (0..6).filter(|&d| supports.is_fixed(i as u32, d)).fold(0, |bits, d| bits | 1 << d);
    }
    let held: Vec<(usize, usize)> = (0..particles.len())
        .flat_map(|i| (0..3).map(move |d| (i, d)))
        .filter(|&(i, d)| supports.is_fixed(i as u32, d))
        .collect();
    // What supports do per unit of the load factor, against the forces of bonds and contacts.
    let push = |p: &Particles| -held.iter().map(|&(i, d)| p.force[i][d] * state[i][d]).sum::<f64>();
    let dt = bonds.stable_step(&particles, motion.safety);
    fracture.add_bond_forces(&mut bonds, &mut particles);
    let mut energy =
        MotionEnergy { external: particles.kinetic_energy() + bonds.energy(&particles).total(), ..Default::default() };
    let (mut peak, mut first_break) = (CriticalLoad { displacement: 0.0, load: 0.0, broken: 0 }, None);
    let (mut curve, mut separated, mut steps) = (Vec::new(), false, 0);
    let mut last_broken = 0;
    while factor < BEYOND * first_factor {
        let before = push(&particles);
        particles.kick_and_drift(dt, Integrator::VelocityVerlet);
        fracture.book_last_work(&particles, dt);
        particles.clear_forces();
        fracture.add_bond_forces(&mut bonds, &mut particles);
        let faces = fracture.add_contact_forces(&mut particles, dt);
        let after = push(&particles);
        energy.external += 0.5 * (before + after) * rate * dt;
        energy.friction += faces.contact.friction + faces.contact.damping;
        energy.kinks += faces.kinks;
        energy.contact = faces.contact.stored;
        particles.kick(dt, Integrator::VelocityVerlet);
        let kinetic = if (steps + 1) % EVERY == 0 { conserved_kinetic(&particles, dt) } else { 0.0 };
        factor += rate * dt;
        steps += 1;
        let load = after / displacement;
        let broken = fracture.cracks().len();
        if load > peak.load {
            peak = CriticalLoad { displacement: factor * displacement, load, broken };
        }
        let occasion = Occasion { time: steps as f64 * dt, event: steps, load };
        if fracture.break_overloaded(&mut bonds, &particles, occasion) > 0 {
            first_break.get_or_insert(load * stress_per_load);
            last_broken = steps;
        }
        if steps % EVERY == 0 {
            energy.kinetic = kinetic;
            energy.elastic = bonds.energy(&particles).total();
            energy.broken_bonds = fracture.released();
            let sum =
                energy.kinetic + energy.elastic + energy.broken_bonds + energy.contact + energy.friction + energy.kinks;
            let residual = ((energy.external - sum) / energy.external).abs();
            energy.residual_max_relative = energy.residual_max_relative.max(residual);
            let point = LoadPoint {
                displacement: factor * displacement,
                load,
                elastic: energy.elastic,
                work: energy.external,
                broken: fracture.cracks().len(),
            };
            curve.push(point);
            let graph = fracture.graph();
            separated = graph.broken() > 0
                && match &middle {
                    None => graph.parts().separate(&ends[0], &ends[1]),
                    Some(inside) => graph.parts_among(|i| inside[i]).separate(&ends[0], &ends[1]),
                };
            // Half a transit without a break: the crack has come to rest.
            let rested = (steps - last_broken) as f64 * dt > 0.5 * period / motion.transits;
            if separated || (rested && load < options.stop * peak.load) {
                separated = true;
                break;
            }
        }
    }
    let strength = peak.load * stress_per_load;
    let broken = fracture.cracks().len();
    let pieces = pieces(&particles, fracture.graph().live_pairs(), |i| particles.mass[i]);
    Ok(BrokenInMotion { first_break, strength, peak, broken, separated, steps, dt, energy, curve, pieces })
}

/// The kinetic energy that velocity Verlet conserves exactly in a linear body, with those half a step before and after:
/// ½ Σ m v⁻·v⁺ = ½ Σ m (v² − (Δt a/2)²), the same for the rotation.
fn conserved_kinetic(particles: &Particles, dt: f64) -> f64 {
    let square =
        |force: &Vec3, held: u8| (0..3).filter(|d| held >> d & 1 == 0).map(|d| force[d] * force[d]).sum::<f64>();
    let excess = |i: usize| {
        let (held, force, moment) = (particles.held[i], &particles.force[i], &particles.moment[i]);
        square(force, held) / particles.mass[i] + square(moment, held >> 3) / particles.inertia[i]
    };
    particles.kinetic_energy() - 0.125 * dt * dt * (0..particles.len()).map(excess).sum::<f64>()
}
