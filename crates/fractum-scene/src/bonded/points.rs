//! Particles of bonded bodies as boundary conditions see them.

use std::ops::Range;

use fractum_dem::{Clumps, ParticleSubdomain, Particles};
use fractum_math::{CHUNK, Vec3};
use rayon::prelude::*;

use super::Bonded;
use crate::conditions::{DrivenPoints, Points};

/// Particles with their reference; the weight of those that are carried is that of nodes or clumps.
pub(super) struct ParticlePoints<'a> {
    pub(super) particles: &'a mut Particles,
    pub(super) reference: &'a [Vec3],
    pub(super) carried: &'a [u32],
    pub(super) clumps: &'a mut Clumps,
    pub(super) part: Option<&'a ParticleSubdomain>,
}

/// Particles whose momentum is summed before that of others.
const BLOCK: usize = ParticleSubdomain::BLOCK;

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

            fn moment(&self, point: usize) -> Vec3 {
                self.particles.moment[point]
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
        let mut add = |run: Range<usize>| {
            let forces = force[run.clone()].iter_mut().zip(&mass[run]);
            forces.for_each(|(force, mass)| *force += *gravity * *mass);
        };
        match self.part {
            Some(part) => part.moved().for_each(add),
            None => add(0..mass.len()),
        }
        self.carried.iter().for_each(|&i| force[i as usize] -= *gravity * mass[i as usize]);
        self.clumps.add_weight(gravity);
    }

    fn momentum(&self, partial: &mut [Vec3]) -> Vec3 {
        let Particles { velocity, mass, .. } = &*self.particles;
        let of_block = |(v, m): (&[Vec3], &[f64])| v.iter().zip(m).map(|(v, m)| v * *m).sum::<Vec3>();
        let blocks = velocity.par_chunks(BLOCK).zip(mass.par_chunks(BLOCK));
        let all = match self.part {
            None => {
                let chunks = partial.par_iter_mut().zip(velocity.par_chunks(CHUNK).zip(mass.par_chunks(CHUNK)));
                chunks.for_each(|(sum, (v, m))| *sum = v.chunks(BLOCK).zip(m.chunks(BLOCK)).map(of_block).sum());
                partial.iter().sum::<Vec3>()
            }
            Some(part) => {
                let mut sums: Vec<[f64; 3]> = blocks.map(|block| of_block(block).into()).collect();
                part.gather_blocks(BLOCK, &mut sums);
                let of_chunk = |blocks: &[[f64; 3]]| blocks.iter().map(|&sum| Vec3::from(sum)).sum::<Vec3>();
                sums.chunks(CHUNK / BLOCK).map(of_chunk).sum()
            }
        };
        let carried: Vec3 = self.carried.iter().map(|&i| velocity[i as usize] * mass[i as usize]).sum();
        all - carried + self.clumps.momentum()
    }
}
