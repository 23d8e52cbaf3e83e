//! Momentum and energy of the particles of bonded bodies, and the fastest of them.

use fractum_dem::Particles;
use fractum_math::{Vec3, sum_chunks};

use super::Bonded;

impl Bonded {
    /// Linear momentum of all particles [kg m/s].
    pub(crate) fn momentum(&self) -> Vec3 {
        let all = &self.particles;
        (0..all.len()).map(|i| all.velocity[i] * self.own_mass(i)).sum::<Vec3>() + self.clumps.momentum()
    }

    /// Angular momentum of all particles about the origin, their spin included [kg m²/s].
    pub(crate) fn angular_momentum(&self) -> Vec3 {
        let all = &self.particles;
        let of = |i: usize| match self.own_mass(i) {
            0.0 => Vec3::zeros(),
            mass => all.position[i].cross(&all.velocity[i]) * mass + all.spin[i] * all.inertia[i],
        };
        (0..all.len()).map(of).sum::<Vec3>() + self.clumps.angular_momentum()
    }

    /// The particle with the largest kinetic energy, or with a value that is not a number: its energy, body and place.
    pub(crate) fn fastest(&self) -> Option<(f64, String)> {
        let all = &self.particles;
        let energy = |i: usize| {
            let energy = all.mass[i] * all.velocity[i].norm_squared() + all.inertia[i] * all.spin[i].norm_squared();
            if energy.is_finite() { energy } else { f64::INFINITY }
        };
        let worst = (0..all.len()).reduce(|worst, i| if energy(i) > energy(worst) { i } else { worst })?;
        let body = self.bodies.iter().find(|body| body.range.contains(&worst))?;
        let place = self.reference[worst];
        let text = format!(
            "particle {} of body {} at ({:.4e}, {:.4e}, {:.4e}) m",
            worst - body.range.start,
            body.name,
            place.x,
            place.y,
            place.z
        );
        Some((energy(worst), text))
    }
}

/// Power of the viscous forces of bonds [W], which is never positive.
pub(super) fn viscous_power(particles: &Particles, viscous: &[Vec3]) -> f64 {
    sum_chunks(viscous.len(), |i| viscous[i].dot(&particles.velocity[i]))
}

/// Kinetic energy that the step sums for particles at constant velocity [J].
pub(super) fn energy_of(particles: &Particles, of: &[u32]) -> f64 {
    let energy = |i: usize| {
        particles.mass[i] * particles.velocity[i].norm_squared()
            + particles.inertia[i] * particles.spin[i].norm_squared()
    };
    of.iter().map(|&i| 0.5 * energy(i as usize)).sum()
}
