use fractum_math::elementary::sin;
use std::f64::consts::PI;

use fractum_dem::{Bonds, CentralDifference, LatticeSupports, ParticleDamping, Particles, Tolerance};
use fractum_math::{Vec3, rotation_by};
use fractum_pack::Domain;
use serde::Serialize;

use super::bending::{bending, torsion};
use super::{STRAIN, translation};
use crate::{CalibrateError, Sample};

/// How a cylinder held at `x-` vibrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum VibrationMode {
    /// Along its axis.
    Tension,
    /// Across its axis.
    Bending,
    /// About its axis.
    Torsion,
}

/// Result of a free vibration.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Vibration {
    /// Period, mean of the cycles followed [s].
    pub period: f64,
    /// Period of the clamped-free bar with the measured length and radius [s].
    pub theory: f64,
    /// Time steps taken.
    pub steps: usize,
    /// Time step [s].
    pub dt: f64,
}

/// Result of an impact.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Impact {
    /// Measured length over the time that a pulse takes to the far face [m/s].
    pub wave_speed: f64,
    /// √(E/ρ) [m/s].
    pub theory: f64,
    /// Time steps taken.
    pub steps: usize,
}

/// Cycles followed.
const CYCLES: usize = 2;
/// Share of the stable step.
pub(super) const SAFETY: f64 = 0.7;

/// A cylinder sample in motion: particles with the mass of the measured cylinder, and bonds.
struct Body {
    particles: Particles,
    bonds: Bonds,
    motion: CentralDifference,
    length: f64,
    radius: f64,
    axis: Vec3,
}

fn body(sample: &Sample, density: f64, test: &'static str) -> Result<Body, CalibrateError> {
    let shape = CalibrateError::Shape { test, shape: "a cylinder" };
    let (Domain::Cylinder { start, .. }, Some((length, radius))) = (&sample.packing.domain, sample.cylinder_extents())
    else {
        return Err(shape);
    };
    let mass = density * PI * radius * radius * length;
    let particles = Particles::at_rest(sample.packing.position.clone(), sample.packing.radius.clone(), mass)?;
    let bonds = Bonds::with_shares(&particles, &sample.network.pairs, &sample.shares, sample.lattice.section())?;
    let dt = bonds.stable_step(&particles, SAFETY);
    let motion = CentralDifference::new(&particles, dt, ParticleDamping::default());
    Ok(Body { particles, bonds, motion, length, radius, axis: *start })
}

impl Body {
    fn step(&mut self) {
        self.motion.kick_and_drift(&mut self.particles);
        self.particles.clear_forces();
        self.bonds.add_forces(&mut self.particles);
    }
}

/// Deflects a cylinder held at `x-` statically in a mode, lets it go, and measures the period of the face `x+`
/// (Jebahi et al. 2015, 2.4.3.2, with the clamped-free bending period 1.787 L² √(ρS/EI)).
///
/// - `density` of the continuum [kg/m³]; `young_modulus` [Pa] and `poisson_ratio` for the theory
///
/// # Errors
/// Another shape; a static solve that does not converge.
pub fn vibration(
    sample: &Sample,
    mode: VibrationMode,
    density: f64,
    young_modulus: f64,
    poisson_ratio: f64,
) -> Result<Vibration, CalibrateError> {
    let mut body = body(sample, density, "free vibration")?;
    let (Some(held), Some(face)) = (sample.packing.wall("x-"), sample.packing.wall("x+")) else {
        return Err(CalibrateError::Shape { test: "free vibration", shape: "a cylinder" });
    };
    let tolerance = Tolerance::default();
    let rest = match mode {
        VibrationMode::Bending => bending(sample, tolerance)?.1,
        VibrationMode::Torsion => torsion(sample, tolerance)?.1,
        VibrationMode::Tension => {
            let mut supports = LatticeSupports::none(sample.packing.len());
            held.iter().for_each(|&i| (0..6).for_each(|d| supports.set(i, d, 0.0)));
            face.iter().for_each(|&i| supports.set(i, 0, STRAIN * body.length));
            let stretch = |x: &Vec3| translation(Vec3::x() * (STRAIN * (x.x - body.axis.x)));
            let guess: Vec<_> = sample.packing.position.iter().map(stretch).collect();
            sample.lattice.solve(&supports, None, &guess, tolerance)?
        }
    };
    for (i, u) in rest.state.iter().enumerate() {
        body.particles.position[i] += Vec3::new(u[0], u[1], u[2]);
        body.particles.orientation[i] = rotation_by(Vec3::new(u[3], u[4], u[5]));
    }
    held.iter().for_each(|&i| body.particles.held[i as usize] = 0b11_1111);
    body.bonds.add_forces(&mut body.particles);
    let dt = body.motion.dt();
    body.particles.start_half_a_step_early(dt);
    let start: Vec<Vec3> = face.iter().map(|&i| sample.packing.position[i as usize]).collect();
    let axis = body.axis;
    let signal = |particles: &Particles| -> f64 {
        let of = |(&i, x0): (&u32, &Vec3)| {
            let u = particles.position[i as usize] - x0;
            match mode {
                VibrationMode::Tension => u.x,
                VibrationMode::Bending => u.y,
                VibrationMode::Torsion => (x0.y - axis.y) * u.z - (x0.z - axis.z) * u.y,
            }
        };
        face.iter().zip(&start).map(of).sum()
    };
    let wave = (density / young_modulus).sqrt();
    let theory = match mode {
        VibrationMode::Tension => 4.0 * body.length * wave,
        // 2π/1.8751² = 1.787; √(S/I) = 2/R.
        VibrationMode::Bending => 2.0 * PI / 1.875_104_f64.powi(2) * body.length.powi(2) * wave * 2.0 / body.radius,
        VibrationMode::Torsion => 4.0 * body.length * wave * (2.0 * (1.0 + poisson_ratio)).sqrt(),
    };
    let first = signal(&body.particles);
    let (period, steps) = follow(dt, theory, first, || {
        body.step();
        signal(&body.particles)
    });
    Ok(Vibration { period, theory, steps, dt })
}

/// Period of a signal about zero, mean of some cycles (not a number where there are none), and the steps taken.
///
/// - `theory`: about the period; `first`: the signal before the first step; `step` makes one and gives the signal
pub(super) fn follow(dt: f64, theory: f64, first: f64, mut step: impl FnMut() -> f64) -> (f64, usize) {
    // Downward zero crossings, which a high mode on top of the slow one could double near zero: each must be half a
    // theoretical period after the last.
    let (mut last, mut steps, mut crossings) = (first, 0usize, Vec::<f64>::new());
    let limit = (10.0 * theory / dt) as usize;
    while crossings.len() <= CYCLES && steps < limit {
        let value = step();
        steps += 1;
        let time = (steps as f64 - value / (value - last)) * dt;
        if last > 0.0 && value <= 0.0 && crossings.last().is_none_or(|t| time - t > 0.5 * theory) {
            crossings.push(time);
        }
        last = value;
    }
    let period = match crossings[..] {
        [first, .., end] => (end - first) / (crossings.len() - 1) as f64,
        _ => f64::NAN,
    };
    (period, steps)
}

/// Length of the pulse of an impact, and of the time over which its arrival is watched, in times of a wave through the
/// cylinder: the pulse has arrived, and its reflection has not come back a second time.
const PULSE: f64 = 1.2;
const WATCH: f64 = 2.6;

/// Sends a smooth pulse of velocity, sin², into the face `x-` of a cylinder and measures when it comes to the far face: the
/// mean time there, weighted with the velocity, less that of the pulse (Jebahi et al. 2015, 2.4.3.3). Dispersion widens a
/// pulse but leaves this mean, while the height of a step arrives late.
///
/// # Errors
/// Another shape.
pub fn impact(sample: &Sample, density: f64, young_modulus: f64) -> Result<Impact, CalibrateError> {
    let mut body = body(sample, density, "impact")?;
    let (Some(near), Some(far)) = (sample.packing.wall("x-"), sample.packing.wall("x+")) else {
        return Err(CalibrateError::Shape { test: "impact", shape: "a cylinder" });
    };
    let theory = (young_modulus / density).sqrt();
    let (speed, transit) = (1e-5 * theory, body.length / theory);
    near.iter().for_each(|&i| body.particles.held[i as usize] = 1);
    let mean = |p: &Particles| far.iter().map(|&i| p.velocity[i as usize].x).sum::<f64>() / far.len() as f64;
    let dt = body.motion.dt();
    let steps = (WATCH * transit / dt) as usize;
    let (mut sum, mut moment) = (0.0, 0.0);
    for step in 0..steps {
        // Velocities are those of the middle of the step.
        let time = (step as f64 + 0.5) * dt;
        let phase = time / (PULSE * transit);
        let pulse = if phase < 1.0 { speed * sin(PI * phase).powi(2) } else { 0.0 };
        near.iter().for_each(|&i| body.particles.velocity[i as usize].x = pulse);
        body.step();
        let value = mean(&body.particles);
        sum += value;
        moment += value * time;
    }
    let time = moment / sum - 0.5 * PULSE * transit;
    Ok(Impact { wave_speed: body.length / time, theory, steps })
}
