//! The motion of clumps: central differences as for single particles, with moments of inertia that turn with the clump.
//!
//! The angular momentum Lⁿ⁺½ = Lⁿ⁻½ + Δt Mⁿ is kept in space. The spin of the step follows from it by the orientation in the middle
//! of the step, ω = I(exp(½ Δt ω) qⁿ)⁻¹ Lⁿ⁺½, which is found by iteration, and qⁿ⁺¹ = exp(Δt ω) qⁿ. This is the implicit leapfrog of
//! Fincham (1992) with the exponential map: of second order, symmetric in time, and exact for the angular momentum.

use std::ops::Range;

use fractum_math::{HalfSteps, Mat3, Rotation, Vec3};
use rayon::prelude::*;

use super::{ClumpMotion, Clumps};
use crate::particles::{ParticleDamping, Particles, TimeStep, turned};

/// Clumps that are moved as one piece of parallel work.
const BLOCK: usize = 256;
/// Most iterations for a spin; each brings it nearer by the angle of half a step.
const ITERATIONS: usize = 50;
/// Relative change of a spin that is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A clump while it moves.
struct Moving<'a> {
    position: &'a mut Vec3,
    orientation: &'a mut Rotation,
    middle: &'a mut Rotation,
    velocity: &'a mut Vec3,
    spin: &'a mut Vec3,
    momentum: &'a mut Vec3,
    mass: f64,
    inverse: &'a Mat3,
}

impl Clumps {
    /// Scratch for the sums of a step.
    pub(super) fn make_room(&mut self) {
        self.partial = vec![HalfSteps::default(); self.len().div_ceil(BLOCK)];
    }

    /// Sets forces on clumps as a whole to zero.
    pub fn clear_forces(&mut self) {
        self.force.fill(Vec3::zeros());
    }

    /// Adds the weight of the clumps.
    ///
    /// - `gravity` [m/s²]
    pub fn add_weight(&mut self, gravity: &Vec3) {
        self.force.iter_mut().zip(&self.mass).for_each(|(force, mass)| *force += gravity * *mass);
    }

    /// Force on a clump [N] and moment about its centre of mass [N m], by the forces of tⁿ on its spheres and on it as a whole.
    pub fn load(&self, clump: usize, particles: &Particles) -> [Vec3; 2] {
        gathered(&self.motion.position[clump], &self.force[clump], self.particles_of(clump), particles)
    }

    /// Velocities and spins given at t = 0 become those of half a step before it, with the forces of t = 0.
    pub fn start_half_a_step_early(&mut self, particles: &mut Particles, dt: f64) {
        for clump in 0..self.len() {
            let [force, moment] = self.load(clump, particles);
            let ClumpMotion { velocity, momentum, orientation, spin, .. } = &mut self.motion;
            velocity[clump] -= force * (0.5 * dt / self.mass[clump]);
            momentum[clump] -= moment * (0.5 * dt);
            (spin[clump], self.middle[clump]) =
                spin_in_middle(&momentum[clump], &orientation[clump], &self.inverse[clump], -dt);
        }
        self.move_spheres(particles, false);
    }

    /// Advances vⁿ⁻½ → vⁿ⁺½ and xⁿ → xⁿ⁺¹, spin and orientation alike, with the forces of tⁿ on the particles, which
    /// [`Clumps::carry`] takes along; what it returns is that of [`Particles::kick_and_drift`]. Damping acts on each clump as a whole;
    /// the scheme of Tchamwa and Wielgosz does not.
    pub fn kick_and_drift(&mut self, particles: &Particles, step: &TimeStep) -> HalfSteps {
        if self.is_empty() {
            return HalfSteps::default();
        }
        let all = particles;
        let ClumpMotion { position, orientation, velocity, spin, momentum } = &mut self.motion;
        let places = position.par_chunks_mut(BLOCK).zip(orientation.par_chunks_mut(BLOCK));
        let rates = velocity.par_chunks_mut(BLOCK).zip(spin.par_chunks_mut(BLOCK)).zip(momentum.par_chunks_mut(BLOCK));
        let sums = self.middle.par_chunks_mut(BLOCK).zip(self.partial.par_iter_mut());
        let (forces, spheres, masses, inverses) = (&self.force, &self.spheres, &self.mass, &self.inverse);
        places.zip(rates).zip(sums).enumerate().for_each(
            |(block, (((position, orientation), ((velocity, spin), momentum)), (middle, work)))| {
                *work = HalfSteps::default();
                for k in 0..position.len() {
                    let clump = block * BLOCK + k;
                    let [first, count] = spheres[clump].map(|number| number as usize);
                    if all.is_out(first) {
                        continue;
                    }
                    let load = gathered(&position[k], &forces[clump], first..first + count, all);
                    let one = Moving {
                        position: &mut position[k],
                        orientation: &mut orientation[k],
                        middle: &mut middle[k],
                        velocity: &mut velocity[k],
                        spin: &mut spin[k],
                        momentum: &mut momentum[k],
                        mass: masses[clump],
                        inverse: &inverses[clump],
                    };
                    advance(one, load, step, work);
                }
            },
        );
        self.partial.iter().fold(HalfSteps::default(), |sum, &part| sum + part)
    }

    /// Takes the particles that are in the run to the places of their clumps at the end of the last step, with velocities and spins in
    /// its middle.
    pub fn carry(&self, particles: &mut Particles) {
        self.move_spheres(particles, true);
    }

    /// Gives the particles the velocities and spins of their clumps before the first step.
    pub fn start(&self, particles: &mut Particles) {
        self.move_spheres(particles, false);
    }

    /// - `places`: whether they have moved
    fn move_spheres(&self, particles: &mut Particles, places: bool) {
        let (motion, middle) = (&self.motion, &self.middle);
        let Particles { position, orientation, velocity, spin, radius, .. } = particles;
        for (run, start) in &self.runs {
            let moving = position[run.clone()].par_iter_mut().zip(&mut orientation[run.clone()]);
            let rates = velocity[run.clone()].par_iter_mut().zip(&mut spin[run.clone()]);
            let own = self.owner[*start..*start + run.len()].par_iter().zip(&self.arm[*start..*start + run.len()]);
            let own = own.zip(&radius[run.clone()]);
            moving.zip(rates).zip(own).with_min_len(BLOCK).for_each(
                |(((position, orientation), (velocity, spin)), ((&clump, arm), radius))| {
                    if *radius < 0.0 {
                        return;
                    }
                    let clump = clump as usize;
                    *spin = motion.spin[clump];
                    *velocity = motion.velocity[clump] + spin.cross(&(middle[clump] * arm));
                    if places {
                        *orientation = motion.orientation[clump];
                        *position = motion.position[clump] + *orientation * arm;
                    }
                },
            );
        }
    }
}

/// Sum of forces on particles and on their clump [N], and moment about its centre of mass [N m].
fn gathered(centre: &Vec3, whole: &Vec3, own: Range<usize>, particles: &Particles) -> [Vec3; 2] {
    let (mut force, mut moment) = (*whole, Vec3::zeros());
    for i in own {
        force += particles.force[i];
        moment += particles.moment[i] + (particles.position[i] - centre).cross(&particles.force[i]);
    }
    [force, moment]
}

/// Kicks and drifts a clump.
fn advance(one: Moving<'_>, [force, moment]: [Vec3; 2], step: &TimeStep, work: &mut HalfSteps) {
    let Moving { position, orientation, middle, velocity, spin, momentum, mass, inverse } = one;
    let TimeStep { dt_before, dt_after, damping, measure } = *step;
    let half = 0.5 * (dt_before + dt_after);
    let (before, spin_before, momentum_before) = (*velocity, *spin, *momentum);
    let resist = resistance(&damping, &force, &before, &(before * mass));
    let brake = resistance(&damping, &moment, &spin_before, &momentum_before);
    let (force, moment) = (force + resist, moment + brake);
    *velocity += force * (half / mass);
    *momentum += moment * half;
    (*spin, *middle) = spin_in_middle(momentum, orientation, inverse, dt_after);
    *position += *velocity * dt_after;
    *orientation = turned(orientation, *spin * dt_after);
    if measure || damping.local != 0.0 || damping.mass_rate != 0.0 {
        work.before.damping -= 0.5 * dt_before * (resist.dot(&before) + brake.dot(&spin_before));
        work.after.damping -= 0.5 * dt_after * (resist.dot(velocity) + brake.dot(spin));
        // The products that central differences conserve, as for single particles.
        work.before.kinetic += 0.5 * before.dot(&(before * mass + force * dt_before));
        work.before.kinetic += 0.5 * spin_before.dot(&(momentum_before + moment * dt_before));
        work.after.kinetic += 0.5 * velocity.dot(&(*velocity * mass - force * dt_after));
        work.after.kinetic += 0.5 * spin.dot(&(*momentum - moment * dt_after));
    }
}

/// Spin with an angular momentum and the orientation in the middle of a step that begins with another one, and that orientation.
fn spin_in_middle(momentum: &Vec3, orientation: &Rotation, inverse: &Mat3, dt: f64) -> (Vec3, Rotation) {
    let at = |orientation: &Rotation| {
        orientation.transform_vector(&(inverse * orientation.inverse_transform_vector(momentum)))
    };
    let mut middle = *orientation;
    let mut spin = at(&middle);
    for _ in 0..ITERATIONS {
        middle = turned(orientation, spin * (0.5 * dt));
        let next = at(&middle);
        let is_found = (next - spin).norm() <= ROUNDING * next.norm();
        spin = next;
        if is_found {
            break;
        }
    }
    (spin, middle)
}

/// -a |F| v/|v| - α p, zero at rest; with moment, spin and angular momentum for a rotation.
fn resistance(damping: &ParticleDamping, force: &Vec3, velocity: &Vec3, momentum: &Vec3) -> Vec3 {
    let speed = velocity.norm();
    let local = if speed > 0.0 { damping.local * force.norm() / speed } else { 0.0 };
    -velocity * local - momentum * damping.mass_rate
}

#[cfg(test)]
mod tests {
    use super::super::ClumpShape;
    use super::*;

    fn step(dt: f64) -> TimeStep {
        TimeStep { dt_before: dt, dt_after: dt, damping: ParticleDamping::default(), measure: true }
    }

    /// Three spheres of different sizes: three different moments of inertia.
    fn asymmetric() -> ClumpShape {
        let of = |x: f64, y: f64, r: f64| (Vec3::new(x, y, 0.0), r);
        ClumpShape::new(&[of(0.0, 0.0, 1.0), of(1.6, 0.0, 0.9), of(0.3, 1.2, 0.6)]).unwrap()
    }

    /// Spins about the axis of the middle moment of inertia, a little off it, over a time; with energy and angular momentum at the end.
    fn tumbled(dt: f64, time: f64) -> (Rotation, [f64; 2], [Vec3; 2], f64) {
        let shape = asymmetric();
        let (mut particles, mut clumps) =
            Clumps::at_rest(&shape, &[(Vec3::new(1.0, 2.0, 3.0), shape.radius(), Rotation::identity())], 1.0).unwrap();
        let axes = shape.inertia().symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|a, b| axes.eigenvalues[*a].total_cmp(&axes.eigenvalues[*b]));
        let axis: Vec3 = axes.eigenvectors.column(order[1]).into();
        let off: Vec3 = axes.eigenvectors.column(order[0]).into();
        clumps.set_motion(0, Vec3::new(0.3, 0.0, 0.1), axis + off * 0.01);
        clumps.start(&mut particles);
        let (energy, momentum) = (clumps.kinetic_energy(), clumps.angular_momentum());
        clumps.start_half_a_step_early(&mut particles, dt);
        let mut least = f64::INFINITY;
        for _ in 0..(time / dt).round() as usize {
            clumps.kick_and_drift(&particles, &step(dt));
            clumps.carry(&mut particles);
            least = least.min((clumps.motion.orientation[0] * axis).dot(&axis));
        }
        let end = [clumps.kinetic_energy(), clumps.angular_momentum().norm()];
        (clumps.motion.orientation[0], [energy, end[0]], [momentum, clumps.angular_momentum()], least)
    }

    /// Dzhanibekov: it flips over and over, and loses nothing.
    #[test]
    fn free_flight_keeps_energy_and_angular_momentum_through_flips() {
        let (_, energy, momentum, least) = tumbled(0.02, 600.0);
        assert!(least < -0.9, "it turns over: {least}");
        assert!((energy[1] / energy[0] - 1.0).abs() < 1e-4, "{energy:?}");
        assert!((momentum[1] - momentum[0]).norm() < 1e-10 * momentum[0].norm(), "{momentum:?}");
    }

    #[test]
    fn the_step_is_of_second_order() {
        let fine = tumbled(0.000_625, 20.0).0;
        let error = |dt: f64| tumbled(dt, 20.0).0.angle_to(&fine);
        let (coarse, half) = (error(0.04), error(0.02));
        let order = (coarse / half).log2();
        assert!((1.9..2.1).contains(&order), "{coarse} and {half}: order {order}");
    }

    /// A torque about a principal axis turns a clump as I ω' = M, and a force at an end pushes its centre too.
    #[test]
    fn a_force_on_a_sphere_moves_and_turns_its_clump() {
        let shape = ClumpShape::new(&[(Vec3::zeros(), 1.0), (Vec3::x() * 2.0, 1.0)]).unwrap();
        let place = (Vec3::zeros(), shape.radius(), Rotation::identity());
        let (mut particles, mut clumps) = Clumps::at_rest(&shape, &[place], 1.0).unwrap();
        particles.force[1] = Vec3::new(0.0, 0.0, 1e-6);
        clumps.start_half_a_step_early(&mut particles, 1e-3);
        for _ in 0..100 {
            clumps.kick_and_drift(&particles, &step(1e-3));
            clumps.carry(&mut particles);
        }
        let mass = 2.0 * fractum_math::sphere_volume(1.0);
        let inertia = mass * (0.4 + 1.0);
        let time = 0.0995; // velocities are those of the last half step
        let ClumpMotion { velocity, spin, .. } = &clumps.motion;
        assert!((velocity[0].z / (1e-6 * time / mass) - 1.0).abs() < 1e-5);
        assert!((spin[0].y / (-1e-6 * time / inertia) - 1.0).abs() < 1e-4, "{}", spin[0].y);
        let expected = velocity[0].z - spin[0].y;
        assert!((particles.velocity[1].z / expected - 1.0).abs() < 1e-5);
    }

    #[test]
    fn damping_takes_what_a_clump_loses() {
        let shape = asymmetric();
        let place = (Vec3::zeros(), shape.radius(), Rotation::identity());
        let (mut particles, mut clumps) = Clumps::at_rest(&shape, &[place], 1.0).unwrap();
        clumps.set_motion(0, Vec3::x(), Vec3::new(0.1, 0.2, 0.3));
        clumps.start(&mut particles);
        let damping = ParticleDamping { mass_rate: 1.0, ..ParticleDamping::default() };
        let (start, mut taken) = (clumps.kinetic_energy(), 0.0);
        for _ in 0..1000 {
            let work = clumps.kick_and_drift(&particles, &TimeStep { damping, ..step(1e-3) });
            taken += work.before.damping + work.after.damping;
        }
        assert!(taken > 0.5 * start);
        assert!((taken + clumps.kinetic_energy() - start).abs() < 1e-3 * start, "{taken} of {start}");
    }
}
