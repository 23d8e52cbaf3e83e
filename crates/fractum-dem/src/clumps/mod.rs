//! Clumps: rigid grains of spheres. The spheres are particles that touch others; the clump gathers their forces and moves them.

mod motion;
mod shape;

use std::borrow::Cow;
use std::ops::Range;

use fractum_math::{HalfSteps, Mat3, Rotation, Vec3, sphere_volume};
use serde::{Deserialize, Serialize};

pub use shape::{CLUMP_SPHERES, ClumpShape};

use crate::{DemError, Particles};

/// Clump of a particle that belongs to none.
pub const NO_CLUMP: u32 = u32::MAX;

/// What changes in clumps during a run; one entry per clump.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ClumpMotion {
    /// Centre of mass [m].
    pub position: Vec<Vec3>,
    /// Rotation since the start.
    pub orientation: Vec<Rotation>,
    /// Velocity of the centre of mass [m/s].
    pub velocity: Vec<Vec3>,
    /// Angular velocity in space [rad/s].
    pub spin: Vec<Vec3>,
    /// Angular momentum about the centre of mass, in space [kg m²/s].
    pub momentum: Vec<Vec3>,
}

/// Rigid grains made of particles that may overlap. Their spheres are held particles, and take places, velocities and spins from
/// their clump.
#[derive(Clone, Debug, Default)]
pub struct Clumps {
    /// What changes; velocities and angular momenta are those of the half step before tⁿ.
    pub motion: ClumpMotion,
    /// Force that acts on the clump as a whole, such as its weight [N].
    force: Vec<Vec3>,
    /// Mass [kg].
    mass: Vec<f64>,
    /// Moments of inertia about the centre of mass, in the axes of space at the start [kg m²].
    inertia: Vec<Mat3>,
    inverse: Vec<Mat3>,
    /// Orientation in the middle of the last step.
    middle: Vec<Rotation>,
    /// First particle of each clump, and the number of its spheres.
    spheres: Vec<[u32; 2]>,
    /// Runs of particles that are spheres of clumps, with the first of their entries below.
    runs: Vec<(Range<usize>, usize)>,
    /// Of each sphere its clump, and its centre from the centre of mass, in the axes of space at the start [m].
    owner: Vec<u32>,
    arm: Vec<Vec3>,
    partial: Vec<HalfSteps>,
}

impl Clumps {
    /// Clumps of a shape at rest, with their particles, which are held.
    ///
    /// - `places`: centre of mass [m], radius of the sphere around it [m] and orientation of each
    /// - `density` [kg/m³]: that of the union of the spheres of a clump
    ///
    /// The mass of a particle is the one that damping of its contacts counts with: its share of the clump's by volumes of spheres, or a
    /// third of the clump's if that is more. Where two or three equal spheres hit at once the shares give the restitution of the
    /// material; small ones bear more than their share, as a grain of many rests on few.
    ///
    /// # Errors
    /// Radii or a density that are not positive.
    pub fn at_rest(
        shape: &ClumpShape,
        places: &[(Vec3, f64, Rotation)],
        density: f64,
    ) -> Result<(Particles, Self), DemError> {
        let cubes: f64 = shape.spheres().iter().map(|(_, r)| r.powi(3)).sum();
        let (mut position, mut radius, mut mass) = (Vec::new(), Vec::new(), Vec::new());
        let mut all = Clumps::default();
        for (clump, (centre, size, turn)) in (0..).zip(places) {
            let scale = size / shape.radius();
            let own = density * shape.volume() * scale.powi(3);
            let rotation = turn.to_rotation_matrix();
            let moments = shape.inertia() * (density * scale.powi(5));
            let inertia = rotation.matrix() * moments * rotation.matrix().transpose();
            all.spheres.push([position.len() as u32, shape.spheres().len() as u32]);
            for (at, r) in shape.spheres() {
                let arm = rotation.matrix() * at * scale;
                position.push(centre + arm);
                radius.push(r * scale);
                mass.push(own * (r.powi(3) / cubes).max(LEAST_SHARE));
                all.owner.push(clump);
                all.arm.push(arm);
            }
            all.mass.push(own);
            all.inertia.push(inertia);
            all.inverse.push(inertia.try_inverse().unwrap_or_else(Mat3::zeros));
            all.motion.position.push(*centre);
        }
        let (count, zero) = (places.len(), vec![Vec3::zeros(); places.len()]);
        all.motion.orientation = vec![Rotation::identity(); count];
        all.middle.clone_from(&all.motion.orientation);
        (all.motion.velocity, all.motion.spin, all.motion.momentum) = (zero.clone(), zero.clone(), zero.clone());
        all.force = zero;
        all.runs = vec![(0..position.len(), 0)];
        all.make_room();
        let mut particles = Particles::at_rest(position, radius, mass.iter().sum())?;
        particles.inertia = mass.iter().zip(&particles.radius).map(|(m, r)| 0.4 * m * r * r).collect();
        particles.mass = mass;
        particles.held.fill(0b11_1111);
        Ok((particles, all))
    }

    /// Adds the clumps of another body, whose particles come behind `first` others.
    pub fn append(&mut self, mut other: Clumps, first: usize) {
        let (clumps, spheres) = (self.len() as u32, self.owner.len());
        self.motion.position.append(&mut other.motion.position);
        self.motion.orientation.append(&mut other.motion.orientation);
        self.motion.velocity.append(&mut other.motion.velocity);
        self.motion.spin.append(&mut other.motion.spin);
        self.motion.momentum.append(&mut other.motion.momentum);
        self.force.append(&mut other.force);
        self.mass.append(&mut other.mass);
        self.inertia.append(&mut other.inertia);
        self.inverse.append(&mut other.inverse);
        self.middle.append(&mut other.middle);
        self.spheres.extend(other.spheres.iter().map(|[start, count]| [start + first as u32, *count]));
        let moved = |(run, start): &(Range<usize>, usize)| (run.start + first..run.end + first, start + spheres);
        self.runs.extend(other.runs.iter().map(moved));
        self.owner.extend(other.owner.iter().map(|clump| clump + clumps));
        self.arm.append(&mut other.arm);
        self.make_room();
    }

    /// Number of clumps.
    pub fn len(&self) -> usize {
        self.mass.len()
    }

    /// Whether there are no clumps.
    pub fn is_empty(&self) -> bool {
        self.mass.is_empty()
    }

    /// The particles of a clump.
    pub fn particles_of(&self, clump: usize) -> Range<usize> {
        let [first, count] = self.spheres[clump].map(|number| number as usize);
        first..first + count
    }

    /// Particles that are spheres of clumps, ascending.
    pub fn all_particles(&self) -> impl Iterator<Item = usize> + '_ {
        self.runs.iter().flat_map(|(run, _)| run.clone())
    }

    /// The clump of each of so many particles; [`NO_CLUMP`] for those of none. Nothing where there is no clump.
    pub fn of_particles(&self, count: usize) -> Vec<u32> {
        if self.is_empty() {
            return Vec::new();
        }
        let mut of = vec![NO_CLUMP; count];
        for (run, start) in &self.runs {
            of[run.clone()].copy_from_slice(&self.owner[*start..*start + run.len()]);
        }
        of
    }

    /// Mass of every particle [kg]; of a sphere of a clump its share by volumes of spheres, so that all of them add up.
    pub fn masses<'p>(&self, particles: &'p Particles) -> Cow<'p, [f64]> {
        if self.is_empty() {
            return Cow::Borrowed(&particles.mass);
        }
        let mut masses = particles.mass.clone();
        for clump in 0..self.len() {
            let own = self.particles_of(clump);
            let cube = |i: usize| particles.radius[i].abs().powi(3);
            let cubes: f64 = own.clone().map(cube).sum();
            own.for_each(|i| masses[i] = self.mass[clump] * cube(i) / cubes);
        }
        Cow::Owned(masses)
    }

    /// Mass of a clump [kg].
    pub fn mass(&self, clump: usize) -> f64 {
        self.mass[clump]
    }

    /// Radius of the sphere around the centre of mass that just holds a clump [m].
    pub fn radius(&self, clump: usize, particles: &Particles) -> f64 {
        let own = self.particles_of(clump);
        let arms = &self.arm[self.sphere_of(own.start)..];
        own.zip(arms).map(|(i, arm)| arm.norm() + particles.radius[i].abs()).fold(0.0, f64::max)
    }

    /// Gives a clump at the start a velocity [m/s] and an angular velocity [rad/s].
    pub fn set_motion(&mut self, clump: usize, velocity: Vec3, spin: Vec3) {
        self.motion.velocity[clump] = velocity;
        self.motion.spin[clump] = spin;
        let turn = self.motion.orientation[clump].to_rotation_matrix();
        self.motion.momentum[clump] = turn.matrix() * (self.inertia[clump] * (turn.matrix().transpose() * spin));
    }

    /// Square of the frequency that contacts ask of a clump [1/s²], on the side of safety where all its spheres touch at once: the
    /// sum of those of its spheres by themselves, each by how much easier a force at its centre moves the clump.
    ///
    /// - `alone`: squared frequency of a particle by itself [1/s²]
    /// - `density` [kg/m³]: that of a sphere by itself
    pub fn frequency_square(
        &self,
        clump: usize,
        particles: &Particles,
        alone: impl Fn(usize) -> f64,
        density: f64,
    ) -> f64 {
        let own = self.particles_of(clump);
        let start = self.sphere_of(own.start);
        let of = |(particle, arm): (usize, &Vec3)| {
            let across = arm.cross_matrix();
            let turning = (across.transpose() * self.inverse[clump] * across).symmetric_eigenvalues().max();
            let mass = density * sphere_volume(particles.radius[particle].abs());
            alone(particle) * mass * (1.0 / self.mass[clump] + turning.max(0.0))
        };
        own.clone().zip(&self.arm[start..]).map(of).sum()
    }

    /// Number of a particle among the spheres of clumps.
    fn sphere_of(&self, particle: usize) -> usize {
        let run = self.runs.partition_point(|(run, _)| run.end <= particle);
        particle - self.runs[run].0.start + self.runs[run].1
    }

    /// Linear momentum of all clumps [kg m/s].
    pub fn momentum(&self) -> Vec3 {
        (0..self.len()).map(|clump| self.motion.velocity[clump] * self.mass[clump]).sum()
    }

    /// Angular momentum of all clumps about the origin [kg m²/s].
    pub fn angular_momentum(&self) -> Vec3 {
        let ClumpMotion { position, velocity, momentum, .. } = &self.motion;
        (0..self.len()).map(|clump| position[clump].cross(&velocity[clump]) * self.mass[clump] + momentum[clump]).sum()
    }

    /// Kinetic energy of a clump [J].
    pub fn kinetic_energy_of(&self, clump: usize) -> f64 {
        let ClumpMotion { velocity, spin, momentum, .. } = &self.motion;
        0.5 * (self.mass[clump] * velocity[clump].norm_squared() + spin[clump].dot(&momentum[clump]))
    }

    /// Kinetic energy of all clumps [J].
    pub fn kinetic_energy(&self) -> f64 {
        (0..self.len()).map(|clump| self.kinetic_energy_of(clump)).sum()
    }

    /// Takes a clump out of the run, whose particles [are taken out](Particles::take_out) too.
    pub fn take_out(&mut self, clump: usize) {
        for of in [&mut self.motion.velocity, &mut self.motion.spin, &mut self.motion.momentum] {
            of[clump] = Vec3::zeros();
        }
    }
}

/// Least part of the mass of a clump that a sphere of it counts with in contact: it rests on three places.
const LEAST_SHARE: f64 = 1.0 / 3.0;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_count_in_contact_with_their_share_or_a_third_of_the_clump() {
        let shares = |spheres: &[(Vec3, f64)]| {
            let shape = ClumpShape::new(spheres).unwrap();
            let place = (Vec3::zeros(), shape.radius(), Rotation::identity());
            let (particles, clumps) = Clumps::at_rest(&shape, &[place], 1.0).unwrap();
            let whole: f64 = clumps.masses(&particles).iter().sum();
            assert!((whole / clumps.mass(0) - 1.0).abs() < 1e-12);
            particles.mass.iter().map(|mass| mass / clumps.mass(0)).collect::<Vec<f64>>()
        };
        let close = |found: Vec<f64>, expected: [f64; 2]| {
            assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12), "{found:?}");
        };
        close(shares(&[(Vec3::zeros(), 1.0), (Vec3::x() * 2.0, 1.0)]), [0.5, 0.5]);
        close(shares(&[(Vec3::zeros(), 1.0), (Vec3::x(), 0.5)]), [8.0 / 9.0, 1.0 / 3.0]);
    }
}
