//! Numbers that the particles of bonded bodies yield at every instant.

use fractum_math::Vec3;

use super::Bonded;

/// What is measured on a set of particles, ascending.
#[derive(Clone, Debug, PartialEq)]
pub enum ParticleProbe {
    /// Force of the supports along a direction [N].
    Reaction {
        /// Prescribed degrees of freedom; see [`Bonded::support_places`].
        places: Vec<(u32, u32, u32)>,
        /// Unit direction.
        direction: Vec3,
    },
    /// Mean displacement along a direction at the instant of the last step, as its reactions are [m].
    Displacement {
        /// Particles.
        particles: Vec<u32>,
        /// Unit direction.
        direction: Vec3,
    },
    /// Mean velocity along a direction [m/s].
    Velocity {
        /// Particles.
        particles: Vec<u32>,
        /// Unit direction.
        direction: Vec3,
    },
    /// Rotation of the set as a whole about an axis through its centre, for small angles [rad].
    Rotation {
        /// Particles.
        particles: Vec<u32>,
        /// Unit direction of the axis.
        axis: Vec3,
    },
}

impl ParticleProbe {
    /// Value at the last step; `dt` is the step that followed it [s].
    pub(crate) fn value(&self, bonded: &Bonded, dt: f64) -> f64 {
        let all = &bonded.particles;
        let displacement = |i: usize| all.position[i] - all.velocity[i] * dt - bonded.reference[i];
        match self {
            ParticleProbe::Reaction { places, direction } => bonded.holds.reaction(places, direction),
            ParticleProbe::Displacement { particles, direction } => mean(particles, displacement).dot(direction),
            ParticleProbe::Velocity { particles, direction } => mean(particles, |i| all.velocity[i]).dot(direction),
            ParticleProbe::Rotation { particles, axis } => {
                let centre = mean(particles, |i| bonded.reference[i]);
                let shift = mean(particles, displacement);
                let (mut moment, mut weight) = (0.0, 0.0);
                for &i in particles {
                    let path = axis.cross(&(bonded.reference[i as usize] - centre));
                    moment += path.dot(&(displacement(i as usize) - shift));
                    weight += path.norm_squared();
                }
                moment / weight
            }
        }
    }
}

fn mean(particles: &[u32], of: impl Fn(usize) -> Vec3) -> Vec3 {
    particles.iter().map(|&i| of(i as usize)).sum::<Vec3>() / particles.len().max(1) as f64
}

impl Bonded {
    /// Prescribed degrees of freedom of these particles, which are ascending: (set, entry, axis).
    pub fn support_places(&self, particles: &[u32]) -> Vec<(u32, u32, u32)> {
        self.holds.places(particles)
    }

    /// Linear momentum of all particles [kg m/s].
    pub(crate) fn momentum(&self) -> Vec3 {
        let all = &self.particles;
        (0..all.len()).map(|i| all.velocity[i] * self.own_mass(i)).sum()
    }

    /// Angular momentum of all particles about the origin, their spin included [kg m²/s].
    pub(crate) fn angular_momentum(&self) -> Vec3 {
        let all = &self.particles;
        let of = |i: usize| match self.own_mass(i) {
            0.0 => Vec3::zeros(),
            mass => all.position[i].cross(&all.velocity[i]) * mass + all.spin[i] * all.inertia[i],
        };
        (0..all.len()).map(of).sum()
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
