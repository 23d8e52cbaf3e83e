//! Discrete elements and their motion.

mod central_difference;
mod kernel;
mod past_forces;
mod step;
mod subdomain;

pub use central_difference::CentralDifference;
pub(crate) use kernel::turned;
pub use past_forces::PastForces;
pub use step::{ParticleDamping, TimeStep};
pub use subdomain::{NearPairs, ParticleSubdomain, ParticleSubdomainSize};

use fractum_math::{Rotation, Vec3};
use rayon::prelude::*;

use crate::DemError;

/// Number of particles handled as one block by the parallel loops.
pub(crate) const BLOCK: usize = 1024;

/// Particles that one process has as a whole, where several share them, and whose bonds are computed together.
pub(crate) const SHARED: usize = 2 * BLOCK;

/// Degrees of freedom that plane discs do not have: motion along z, rotation about x and y.
const OUT_OF_PLANE: u8 = 0b01_1100;

/// Discrete elements: spheres that move and turn, or discs in the xy-plane. One entry per particle in every array.
#[derive(Clone, Debug, Default)]
pub struct Particles {
    /// Centre [m].
    pub position: Vec<Vec3>,
    /// Rotation since the start.
    pub orientation: Vec<Rotation>,
    /// Velocity [m/s].
    pub velocity: Vec<Vec3>,
    /// Angular velocity in space [rad/s].
    pub spin: Vec<Vec3>,
    /// Force [N].
    pub force: Vec<Vec3>,
    /// Moment about the centre [N m].
    pub moment: Vec<Vec3>,
    /// Mass [kg].
    pub mass: Vec<f64>,
    /// Moment of inertia about any axis, of discs about z [kg m²].
    pub inertia: Vec<f64>,
    /// Radius [m]; negative while the particle [is not in the run](Particles::take_out).
    pub radius: Vec<f64>,
    /// Bit d set: degree of freedom d (0–2 translation, 3–5 rotation) keeps its velocity whatever the forces.
    pub held: Vec<u8>,
    /// Thickness [m] where all of them are plane discs; none of spheres.
    pub thickness: Option<f64>,
}

impl Particles {
    /// Solid spheres at rest, with masses that add up to `total_mass` [kg] (equal densities: the mass of the continuum
    /// is kept, Jebahi et al. 2015, eq. 2.26).
    ///
    /// # Errors
    /// Array lengths; radii or a mass that are not positive.
    pub fn at_rest(position: Vec<Vec3>, radius: Vec<f64>, total_mass: f64) -> Result<Self, DemError> {
        let n = position.len();
        if radius.len() != n {
            return Err(DemError::Length { what: "radius", found: radius.len(), expected: n });
        }
        let bad = |v: &f64| !(v.is_finite() && *v > 0.0);
        if let Some(particle) = radius.iter().position(bad) {
            return Err(DemError::BadParticle { particle, what: "radius", value: radius[particle] });
        }
        if bad(&total_mass) {
            return Err(DemError::BadParticle { particle: 0, what: "total mass", value: total_mass });
        }
        let cubes: f64 = radius.iter().map(|r| r.powi(3)).sum();
        let mass: Vec<f64> = radius.iter().map(|r| total_mass * r.powi(3) / cubes).collect();
        let inertia = mass.iter().zip(&radius).map(|(m, r)| 0.4 * m * r * r).collect();
        let zero = || vec![Vec3::zeros(); n];
        Ok(Particles {
            position,
            orientation: vec![Rotation::identity(); n],
            velocity: zero(),
            spin: zero(),
            force: zero(),
            moment: zero(),
            mass,
            inertia,
            radius,
            held: vec![0; n],
            thickness: None,
        })
    }

    /// Plane discs at rest, of one density [kg/m³] and thickness [m]: they keep to the xy-plane.
    ///
    /// # Errors
    /// Those of [`Particles::at_rest`].
    pub fn discs_at_rest(
        position: Vec<Vec3>,
        radius: Vec<f64>,
        density: f64,
        thickness: f64,
    ) -> Result<Self, DemError> {
        let mut discs = Particles::at_rest(position, radius, density)?;
        for (i, r) in discs.radius.iter().enumerate() {
            discs.mass[i] = density * std::f64::consts::PI * r * r * thickness;
            discs.inertia[i] = 0.5 * discs.mass[i] * r * r;
        }
        discs.held.fill(OUT_OF_PLANE);
        discs.thickness = Some(thickness);
        Ok(discs)
    }

    /// Whether a particle is held, but for what discs do not do anyway.
    pub fn is_held(&self, particle: usize) -> bool {
        self.held[particle] & !(if self.thickness.is_some() { OUT_OF_PLANE } else { 0 }) != 0
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are no particles.
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Takes a particle out of the run: it rests where it is and meets nothing.
    pub fn take_out(&mut self, particle: usize) {
        self.velocity[particle] = Vec3::zeros();
        self.spin[particle] = Vec3::zeros();
        self.held[particle] = 0b11_1111;
        self.radius[particle] = -self.radius[particle].abs();
    }

    /// Puts a particle that is out of the run into it: at rest at a place [m], free to move.
    pub fn put_in(&mut self, particle: usize, place: Vec3) {
        self.position[particle] = place;
        self.held[particle] = 0;
        self.radius[particle] = self.radius[particle].abs();
    }

    /// Whether a particle is out of the run: it has left, or has not come in yet.
    pub fn is_out(&self, particle: usize) -> bool {
        self.radius[particle] < 0.0
    }

    /// Sets all forces and moments to zero.
    pub fn clear_forces(&mut self) {
        let loads = self.force.par_chunks_mut(BLOCK).zip(self.moment.par_chunks_mut(BLOCK));
        loads.for_each(|(force, moment)| clear(force, moment));
    }

    /// [`Particles::clear_forces`] of what a rank moves.
    pub fn clear_forces_of_part(&mut self, part: &ParticleSubdomain) {
        for run in part.moved() {
            clear(&mut self.force[run.clone()], &mut self.moment[run]);
        }
    }

    /// Kinetic energy of translation and of rotation [J].
    pub fn kinetic_energy(&self) -> f64 {
        fractum_math::sum_chunks(self.len(), |i| {
            0.5 * (self.mass[i] * self.velocity[i].norm_squared() + self.inertia[i] * self.spin[i].norm_squared())
        })
    }
}

fn clear(force: &mut [Vec3], moment: &mut [Vec3]) {
    force.fill(Vec3::zeros());
    moment.fill(Vec3::zeros());
}

/// An acceleration without its held components.
#[inline]
pub(crate) fn free(a: Vec3, held: u8) -> Vec3 {
    if held & 7 == 0 {
        return a;
    }
    Vec3::from_fn(|d, _| if held >> d & 1 == 1 { 0.0 } else { a[d] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_exponential_map_is_the_rotation_by_the_vector(
            start in prop::array::uniform3(-2.0f64..2.0), theta in prop::array::uniform3(-1.0f64..1.0), size in 0.0f64..1.5,
        ) {
            let q = Rotation::from_scaled_axis(Vec3::from(start));
            let theta = Vec3::from(theta) * size * size;
            let expected = Rotation::from_scaled_axis(theta) * q;
            prop_assert!((turned(&q, theta).coords - expected.coords).norm() < 1e-15 * 4.0);
        }
    }

    #[test]
    fn a_held_particle_keeps_its_velocity_and_a_free_one_falls() {
        let mut particles = Particles::at_rest(vec![Vec3::zeros(), Vec3::x()], vec![0.1; 2], 2.0).unwrap();
        particles.held[0] = 0b111111;
        particles.velocity[0] = Vec3::new(0.0, 3.0, 0.0);
        particles.force.fill(Vec3::new(0.0, -10.0, 0.0));
        particles.start_half_a_step_early(0.01);
        let mut motion = CentralDifference::new(&particles, 0.01, ParticleDamping::default());
        (0..100).for_each(|_| motion.kick_and_drift(&mut particles));
        assert!((particles.position[0].y - 3.0).abs() < 1e-12);
        assert!((particles.position[1].y + 5.0).abs() < 1e-9, "{}", particles.position[1].y);
    }

    #[test]
    fn a_disc_keeps_to_its_plane() {
        let mut discs = Particles::discs_at_rest(vec![Vec3::zeros()], vec![0.1], 1000.0, 0.5).unwrap();
        let mass = 5.0 * std::f64::consts::PI;
        assert!((discs.mass[0] / mass - 1.0).abs() < 1e-15 && (discs.inertia[0] / (5e-3 * mass) - 1.0).abs() < 1e-15);
        (discs.force[0], discs.moment[0]) = (Vec3::repeat(mass), Vec3::repeat(5e-3 * mass));
        let mut motion = CentralDifference::new(&discs, 0.01, ParticleDamping::default());
        motion.kick_and_drift(&mut discs);
        let along = discs.velocity[0];
        assert!(along.z == 0.0 && discs.spin[0].xy().norm() == 0.0 && along.x > 0.0);
        assert!((discs.spin[0].z / along.x - 1.0).abs() < 1e-14 && !discs.is_held(0));
        assert_eq!(
            discs.kinetic_energy(),
            0.5 * (discs.mass[0] * along.norm_squared() + discs.inertia[0] * discs.spin[0].z.powi(2))
        );
    }

    #[test]
    fn impossible_particles_are_refused() {
        assert!(Particles::at_rest(vec![Vec3::zeros()], vec![0.0], 1.0).is_err());
        assert!(Particles::at_rest(vec![Vec3::zeros()], vec![1.0; 2], 1.0).is_err());
        assert!(Particles::at_rest(vec![Vec3::zeros()], vec![1.0], f64::NAN).is_err());
    }
}
