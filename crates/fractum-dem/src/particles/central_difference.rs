//! The time integrator: central differences with velocities at half steps, which is velocity Verlet seen from the middle
//! of its steps, for steps that may differ in size and energies that balance to round-off.

use std::ops::Range;

use fractum_math::{HalfSteps, Vec3};
use rayon::prelude::*;

use super::kernel::{self, Moving};
use super::step::{ParticleDamping, TimeStep};
use super::{BLOCK, ParticleSubdomain, Particles, PastForces, free};

impl Particles {
    /// Number of entries that [`Particles::kick_and_drift`] needs for its partial sums.
    pub fn block_count(&self) -> usize {
        self.len().div_ceil(BLOCK)
    }

    /// Advances vⁿ⁻½ → vⁿ⁺½ and xⁿ → xⁿ⁺¹, spin and orientation alike, with the forces and moments of tⁿ. Held degrees
    /// of freedom keep their velocity.
    ///
    /// - `before`: forces of the step before, one per particle where [`ParticleDamping::dissipation`] is not 0 (else not
    ///   looked at); those of this step afterwards
    /// - `partial`: scratch, [`Particles::block_count`] entries
    /// - returns what damping takes, and the kinetic energy at tⁿ as ½ Σ m vⁿ⁻½ · (vⁿ⁻½ + Δt aⁿ) and the same for the
    ///   rotation: the product that the scheme conserves exactly in a linear body; as the step after sees it, it is
    ///   ½ Σ m vⁿ⁺½ · (vⁿ⁺½ - Δt aⁿ), another one where the step changes
    pub fn kick_and_drift(&mut self, step: &TimeStep, before: &mut PastForces, partial: &mut [HalfSteps]) -> HalfSteps {
        self.advance(0..self.len(), step, before, partial);
        partial.iter().fold(HalfSteps::default(), |sum, &part| sum + part)
    }

    /// [`Particles::kick_and_drift`] of what a rank moves. All ranks must call it.
    pub fn kick_and_drift_part(
        &mut self,
        part: &ParticleSubdomain,
        step: &TimeStep,
        before: &mut PastForces,
        partial: &mut [HalfSteps],
    ) -> HalfSteps {
        let own = part.own();
        let blocks = own.start / BLOCK..own.end.div_ceil(BLOCK);
        self.advance(own, step, before, &mut partial[blocks]);
        part.of_others().iter().for_each(|run| self.advance_run(run.clone(), step, before));
        if step.measure || !step.damping.is_off() {
            part.gather_work(partial);
        }
        partial.iter().fold(HalfSteps::default(), |sum, &part| sum + part)
    }

    /// Advances a range of particles.
    ///
    /// - `partial`: what each [`BLOCK`] of them has done
    fn advance(&mut self, range: Range<usize>, step: &TimeStep, before: &mut PastForces, partial: &mut [HalfSteps]) {
        let all = &mut *self;
        let motion = all.position[range.clone()].par_chunks_mut(BLOCK);
        let motion = motion.zip(all.orientation[range.clone()].par_chunks_mut(BLOCK));
        let rates = all.velocity[range.clone()].par_chunks_mut(BLOCK);
        let rates = rates.zip(all.spin[range.clone()].par_chunks_mut(BLOCK));
        let loads = all.force[range.clone()].par_chunks(BLOCK).zip(all.moment[range.clone()].par_chunks(BLOCK));
        let weights = all.mass[range.clone()].par_chunks(BLOCK).zip(all.inertia[range.clone()].par_chunks(BLOCK));
        let constants = weights.zip(all.held[range.clone()].par_chunks(BLOCK));
        let damps = step.damping.dissipation != 0.0;
        let past = damps.then(|| [&before.force[range.clone()], &before.moment[range.clone()]]);
        motion.zip(rates).zip(loads.zip(constants)).zip(partial.par_iter_mut()).enumerate().for_each(
            |(
                block,
                ((((position, orientation), (velocity, spin)), ((force, moment), ((mass, inertia), held))), work),
            )| {
                let own = block * BLOCK..block * BLOCK + position.len();
                let past = past.map(|past| past.map(|of| &of[own.clone()]));
                let particles =
                    Moving { position, orientation, velocity, spin, force, moment, mass, inertia, held, past };
                *work = kernel::advance(particles, step);
            },
        );
        if damps {
            let past = before.force[range.clone()].par_chunks_mut(BLOCK);
            let past = past.zip(before.moment[range.clone()].par_chunks_mut(BLOCK));
            let loads = self.force[range.clone()].par_chunks(BLOCK).zip(self.moment[range.clone()].par_chunks(BLOCK));
            let held = self.held[range].par_chunks(BLOCK);
            past.zip(loads).zip(held).for_each(|((past, loads), held)| note(past, loads, held));
        }
    }

    /// Advances a run of particles that another rank counts.
    fn advance_run(&mut self, run: Range<usize>, step: &TimeStep, before: &mut PastForces) {
        let Particles { position, orientation, velocity, spin, force, moment, mass, inertia, held, .. } = self;
        let (force, moment, held) = (&force[run.clone()], &moment[run.clone()], &held[run.clone()]);
        let damps = step.damping.dissipation != 0.0;
        let particles = Moving {
            position: &mut position[run.clone()],
            orientation: &mut orientation[run.clone()],
            velocity: &mut velocity[run.clone()],
            spin: &mut spin[run.clone()],
            force,
            moment,
            mass: &mass[run.clone()],
            inertia: &inertia[run.clone()],
            held,
            past: damps.then(|| [&before.force[run.clone()], &before.moment[run.clone()]]),
        };
        kernel::advance(particles, step);
        if damps {
            note((&mut before.force[run.clone()], &mut before.moment[run]), (force, moment), held);
        }
    }

    /// Velocities and spins given at t = 0 become those of half a step before it.
    pub fn start_half_a_step_early(&mut self, dt: f64) {
        for i in 0..self.len() {
            let held = self.held[i];
            self.velocity[i] -= free(self.force[i], held) * (0.5 * dt / self.mass[i]);
            self.spin[i] -= free(self.moment[i], held >> 3) * (0.5 * dt / self.inertia[i]);
        }
    }
}

/// Keeps the forces and moments on free degrees of freedom.
fn note(past: (&mut [Vec3], &mut [Vec3]), loads: (&[Vec3], &[Vec3]), held: &[u8]) {
    for k in 0..held.len() {
        past.0[k] = free(loads.0[k], held[k]);
        past.1[k] = free(loads.1[k], held[k] >> 3);
    }
}

/// Central differences at one step size, with what they keep from step to step: for particles without supports that move.
///
/// Velocities given at t = 0 need [`Particles::start_half_a_step_early`] first, with the forces of t = 0.
#[derive(Clone, Debug)]
pub struct CentralDifference {
    step: TimeStep,
    past: PastForces,
    partial: Vec<HalfSteps>,
}

impl CentralDifference {
    /// Steps of `dt` [s] for these particles.
    pub fn new(particles: &Particles, dt: f64, damping: ParticleDamping) -> Self {
        let past = if damping.dissipation == 0.0 { PastForces::default() } else { PastForces::none(particles.len()) };
        let step = TimeStep { dt_before: dt, dt_after: dt, damping, measure: false };
        CentralDifference { step, past, partial: vec![HalfSteps::default(); particles.block_count()] }
    }

    /// The step [s].
    pub fn dt(&self) -> f64 {
        self.step.dt_after
    }

    /// One step with the forces of tⁿ; see [`Particles::kick_and_drift`].
    pub fn kick_and_drift(&mut self, particles: &mut Particles) {
        particles.kick_and_drift(&self.step, &mut self.past, &mut self.partial);
    }

    /// One step that also gives the energies of tⁿ.
    pub fn kick_drift_and_measure(&mut self, particles: &mut Particles) -> HalfSteps {
        let step = TimeStep { measure: true, ..self.step };
        particles.kick_and_drift(&step, &mut self.past, &mut self.partial)
    }
}

#[cfg(test)]
mod tests {
    use super::super::turned;
    use super::*;
    use crate::{BeamSection, Bonds};

    fn pair() -> (Particles, Bonds) {
        let position = vec![Vec3::zeros(), Vec3::new(1.0, 0.2, -0.1)];
        let mut particles = Particles::at_rest(position, vec![0.4, 0.5], 2.0).unwrap();
        let bonds = Bonds::new(&particles, &[[0, 1]], BeamSection::new(1e3, 0.3).unwrap()).unwrap();
        particles.velocity = vec![Vec3::new(0.3, -0.2, 0.1), Vec3::new(-0.1, 0.4, 0.2)];
        particles.spin = vec![Vec3::new(0.5, 0.1, -0.3), Vec3::new(-0.2, 0.3, 0.6)];
        (particles, bonds)
    }

    /// Velocities and spins by the forces and moments of the moment.
    fn kick(particles: &mut Particles, dt: f64) {
        for i in 0..particles.len() {
            particles.velocity[i] += particles.force[i] * (dt / particles.mass[i]);
            particles.spin[i] += particles.moment[i] * (dt / particles.inertia[i]);
        }
    }

    /// Positions and orientations by velocities and φ − 1 times what a kick would add.
    fn drift(particles: &mut Particles, dt: f64, dissipation: f64) {
        for i in 0..particles.len() {
            let more = particles.force[i] * (dissipation * dt / particles.mass[i]);
            let turn = particles.moment[i] * (dissipation * dt / particles.inertia[i]);
            particles.position[i] += (particles.velocity[i] + more) * dt;
            particles.orientation[i] = turned(&particles.orientation[i], (particles.spin[i] + turn) * dt);
        }
    }

    #[test]
    fn central_differences_are_velocity_verlet() {
        let (mut verlet, mut bonds) = pair();
        let dt = bonds.stable_step(&verlet, 0.3);
        let (mut central, _) = pair();
        bonds.add_forces(&mut central);
        central.start_half_a_step_early(dt);
        let mut motion = CentralDifference::new(&central, dt, ParticleDamping::default());
        bonds.add_forces(&mut verlet);
        for _ in 0..200 {
            kick(&mut verlet, 0.5 * dt);
            drift(&mut verlet, dt, 0.0);
            verlet.clear_forces();
            bonds.add_forces(&mut verlet);
            kick(&mut verlet, 0.5 * dt);
            motion.kick_and_drift(&mut central);
            central.clear_forces();
            bonds.add_forces(&mut central);
        }
        for i in 0..2 {
            assert!((verlet.position[i] - central.position[i]).norm() < 1e-12);
            assert!(verlet.orientation[i].angle_to(&central.orientation[i]) < 1e-7);
        }
    }

    #[test]
    fn damping_takes_what_the_motion_loses() {
        let (mut particles, _) = pair();
        let damping = ParticleDamping { mass_rate: 2.0, ..ParticleDamping::default() };
        let mut motion = CentralDifference::new(&particles, 1e-4, damping);
        let start = particles.kinetic_energy();
        let mut taken = 0.0;
        for _ in 0..1000 {
            let step = motion.kick_drift_and_measure(&mut particles);
            taken += step.before.damping + step.after.damping;
        }
        assert!((taken + particles.kinetic_energy() - start).abs() < 1e-3 * start);
        assert!(taken > 0.3 * start);
    }

    #[test]
    fn dissipation_is_the_scheme_of_tchamwa_and_wielgosz_and_its_work_is_booked() {
        let phi = 1.2;
        let (mut scheme, mut bonds) = pair();
        // Slow, so that the beam hardly turns: the balance is exact for a linear body.
        scheme.velocity.iter_mut().chain(&mut scheme.spin).for_each(|v| *v *= 1e-5);
        let mut central = scheme.clone();
        let dt = bonds.stable_step(&scheme, 0.5);
        let damping = ParticleDamping { dissipation: phi - 1.0, ..ParticleDamping::default() };
        let mut motion = CentralDifference::new(&central, dt, damping);
        let (mut taken, mut start) = (0.0, f64::NAN);
        for step in 0..100 {
            // x⁺ = x + Δt v + φ Δt² a, v⁺ = v + Δt a.
            scheme.clear_forces();
            bonds.add_forces(&mut scheme);
            kick(&mut scheme, dt);
            drift(&mut scheme, dt, phi - 1.0);
            central.clear_forces();
            bonds.add_forces(&mut central);
            let elastic = bonds.energy(&central).total();
            let done = motion.kick_drift_and_measure(&mut central);
            // Energy at tⁿ and what damping took in the half steps since the first one.
            taken += if step == 0 { 0.0 } else { done.before.damping };
            let total = done.before.kinetic + elastic + taken;
            taken += done.after.damping;
            if step == 0 {
                start = total;
            }
            assert!((total / start - 1.0).abs() < 1e-4, "step {step}: {}", total / start - 1.0);
            for i in 0..2 {
                assert!((scheme.position[i] - central.position[i]).norm() < 1e-12, "step {step}");
                assert!(scheme.orientation[i].angle_to(&central.orientation[i]) < 1e-7, "step {step}");
            }
        }
        // Most of the motion is rigid and stays.
        assert!(taken > 1e-3 * start, "{taken} of {start}");
    }
}
