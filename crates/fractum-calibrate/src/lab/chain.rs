use fractum_math::elementary::{cos, cosh, sin, sinh};
use std::f64::consts::PI;

use fractum_dem::{BeamSection, Bonds, CentralDifference, ParticleDamping, Particles};
use fractum_math::Vec3;

use super::vibration::{SAFETY, follow};
use super::{Vibration, VibrationMode};
use crate::CalibrateError;

/// Length of the chain from its first to its last particle [m].
const LENGTH: f64 = 2.0;
/// Radius of its beams and particles [m].
const RADIUS: f64 = 0.05;
/// Its material, E [Pa], ν and ρ [kg/m³]: periods over those of theory do not depend on it.
const MATERIAL: (f64, f64, f64) = (1e9, 0.25, 1000.0);
/// Largest speed over that of waves.
const SMALL: f64 = 1e-7;
/// First root of cosh β cos β = −1, and what its mode takes of the sines.
const CLAMPED_FREE: (f64, f64) = (1.875_104_068_7, 0.734_095_514);

/// Vibration of a row of `particles` particles after a clamped one, joined by beams of the bar that it stands for, against
/// the clamped-free bar (Jebahi et al. 2015, 2.4.3.1): tension 4 L √(ρ/E), bending 1.787 L² √(ρS/EI), and torsion
/// √0.8 · 4 L √(ρ/G), as spheres of the bar's mass have 2/5 m R² where it has 1/2 m R² (eq. 2.32).
///
/// The bar ends half a spacing after the last particle. Its mass is that of the chain; the rotary inertia of the spheres,
/// which theory leaves out, makes bending slower by some thousandths.
///
/// # Errors
/// Fewer than two particles.
pub fn chain(mode: VibrationMode, particles: usize) -> Result<Vibration, CalibrateError> {
    if !(2..=100_000).contains(&particles) {
        return Err(CalibrateError::Shape { test: "chain", shape: "a row of 2 to 100,000 particles" });
    }
    let (young, poisson, density) = MATERIAL;
    let spacing = LENGTH / particles as f64;
    let length = LENGTH + 0.5 * spacing;
    let position: Vec<Vec3> = (0..=particles).map(|i| Vec3::x() * (spacing * i as f64)).collect();
    let pairs: Vec<[u32; 2]> = (0..particles as u32).map(|i| [i, i + 1]).collect();
    let section = BeamSection { young_modulus: young, poisson_ratio: poisson, radius: RADIUS };
    let mass = density * PI * RADIUS * RADIUS * spacing * (particles + 1) as f64;
    let mut body = Particles::at_rest(position, vec![RADIUS; particles + 1], mass)?;
    body.held[0] = 0b11_1111;
    let mut bonds = Bonds::new(&body, &pairs, section)?;

    let wave = (density / young).sqrt();
    let speed = SMALL / wave;
    for i in 1..=particles {
        let place = body.position[i].x / length;
        let quarter = sin(0.5 * PI * place);
        match mode {
            VibrationMode::Tension => body.velocity[i].x = speed * quarter,
            VibrationMode::Torsion => body.spin[i].x = speed / length * quarter,
            VibrationMode::Bending => {
                let (beta, sigma) = CLAMPED_FREE;
                let b = beta * place;
                body.velocity[i].y = 0.5 * speed * (cosh(b) - cos(b) - sigma * (sinh(b) - sin(b)));
                let slope = sinh(b) + sin(b) - sigma * (cosh(b) - cos(b));
                body.spin[i].z = 0.5 * speed * beta / length * slope;
            }
        }
    }
    let signal = |body: &Particles| match mode {
        VibrationMode::Tension => body.position[particles].x - LENGTH,
        VibrationMode::Bending => body.position[particles].y,
        VibrationMode::Torsion => body.orientation[particles].i,
    };
    let theory = match mode {
        VibrationMode::Tension => 4.0 * length * wave,
        // √(S/I) = 2/R.
        VibrationMode::Bending => 2.0 * PI / CLAMPED_FREE.0.powi(2) * length * length * wave * 2.0 / RADIUS,
        VibrationMode::Torsion => 0.8f64.sqrt() * 4.0 * length * wave * (2.0 * (1.0 + poisson)).sqrt(),
    };
    let dt = bonds.stable_step(&body, SAFETY);
    // Bonds give no force yet: velocities half a step early are the given ones.
    let mut motion = CentralDifference::new(&body, dt, ParticleDamping::default());
    let (period, steps) = follow(dt, theory, 0.0, || {
        motion.kick_and_drift(&mut body);
        body.clear_forces();
        bonds.add_forces(&mut body);
        signal(&body)
    });
    Ok(Vibration { period, theory, steps, dt })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chains_vibrate_with_the_periods_of_a_clamped_bar() {
        for (mode, allowed) in
            [(VibrationMode::Tension, 2e-3), (VibrationMode::Bending, 1e-2), (VibrationMode::Torsion, 2e-3)]
        {
            let found = chain(mode, 40).unwrap();
            let difference = found.period / found.theory - 1.0;
            assert!(difference.abs() < allowed, "{mode:?}: {difference}");
        }
        assert!(chain(VibrationMode::Tension, 1).is_err());
    }
}
