//! Particles of bonded bodies as boundary conditions see them.

use fractum_dem::Particles;
use fractum_math::Vec3;

use super::Bonded;
use crate::conditions::{DrivenPoints, Points};

/// Particles with their reference; those that are tied weigh on nodes.
pub(super) struct ParticlePoints<'a> {
    pub(super) particles: &'a mut Particles,
    pub(super) reference: &'a [Vec3],
    pub(super) tied: &'a [u32],
}

macro_rules! points {
    ($type:ty) => {
        impl Points for $type {
            fn reference(&self, point: usize) -> &Vec3 {
                &self.reference[point]
            }

            fn position(&self, point: usize) -> Vec3 {
                self.particles.position[point]
            }

            fn displacement(&self, point: usize) -> Vec3 {
                self.particles.position[point] - self.reference[point]
            }

            fn displacement_before(&self, point: usize, dt: f64) -> Vec3 {
                self.particles.position[point] - self.particles.velocity[point] * dt - self.reference[point]
            }

            fn velocity(&self, point: usize) -> &Vec3 {
                &self.particles.velocity[point]
            }
        }
    };
}

points!(ParticlePoints<'_>);
points!(Bonded);

impl DrivenPoints for ParticlePoints<'_> {
    fn mass(&self, point: usize) -> f64 {
        self.particles.mass[point]
    }

    fn forces(&mut self) -> &mut [Vec3] {
        &mut self.particles.force
    }

    fn set_motion(&mut self, point: usize, axis: usize, velocity: f64, path: f64) {
        self.particles.velocity[point][axis] = velocity;
        self.particles.position[point][axis] += path;
    }

    /// The leap leaves out all force on what is held.
    fn force_left_out(&self, point: usize, axis: usize) -> f64 {
        self.particles.force[point][axis]
    }

    fn add_weight(&mut self, gravity: &Vec3) {
        let Particles { force, mass, .. } = &mut *self.particles;
        force.iter_mut().zip(&*mass).for_each(|(force, mass)| *force += *gravity * *mass);
        self.tied.iter().for_each(|&i| force[i as usize] -= *gravity * mass[i as usize]);
    }

    fn momentum(&self, _: &mut [Vec3]) -> Vec3 {
        let Particles { velocity, mass, .. } = &*self.particles;
        let all: Vec3 = velocity.iter().zip(mass).map(|(v, m)| v * *m).sum();
        let tied: Vec3 = self.tied.iter().map(|&i| velocity[i as usize] * mass[i as usize]).sum();
        all - tied
    }
}
