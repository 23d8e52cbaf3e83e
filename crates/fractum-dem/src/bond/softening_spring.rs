//! A toy law with memory, for tests: a spring along the bond that softens in tension.

use fractum_kernels::bond::{BadLaw, BondLanes, BondLaw, BondStiffness, EnergyLanes, ForceLanes};
use fractum_kernels::lanes::{Lanes, dot, scale};

/// F = k δ up to δ₀, then on a line to zero at δ₁; unloading goes to the origin, and compression is elastic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SofteningSpring {
    /// k [N/m].
    pub(crate) stiffness: f64,
    /// δ₀ [m].
    pub(crate) onset: f64,
    /// δ₁ [m].
    pub(crate) end: f64,
}

impl SofteningSpring {
    /// Force over k δ once the largest elongation is `most`.
    fn integrity(&self, most: f64) -> f64 {
        if most <= self.onset {
            1.0
        } else {
            (self.onset * (self.end - most) / ((self.end - self.onset) * most)).max(0.0)
        }
    }
}

impl BondLaw for SofteningSpring {
    type Parameters = ();
    /// Largest elongation so far [m].
    type Memory = f64;
    type Recent<const W: usize> = ();

    fn check(&self) -> Result<(), BadLaw> {
        let fine = self.stiffness > 0.0 && self.onset > 0.0 && self.end > self.onset;
        let bad = BadLaw::Number { what: "softening", value: self.end, expected: "an end beyond the onset" };
        if fine { Ok(()) } else { Err(bad) }
    }

    fn parameters(&self, _: f64, _: [f64; 2], _: f64) {}

    fn forces<const W: usize>(
        &self,
        bonds: &BondLanes<W>,
        _: &[(); W],
        _: &mut (),
        memory: &mut [f64; W],
    ) -> ForceLanes<W> {
        let length = dot(bonds.gap, bonds.gap).sqrt();
        let elongation = length - bonds.inverse.recip();
        let pull = Lanes(std::array::from_fn(|k| {
            let (now, live) = (elongation.0[k], bonds.live.0[k]);
            memory[k] = if live > 0.0 { memory[k].max(now) } else { memory[k] };
            let integrity = if now > 0.0 { self.integrity(memory[k]) } else { 1.0 };
            -live * integrity * self.stiffness * now / length.0[k]
        }));
        let none = [Lanes::splat(0.0); 3];
        ForceLanes { force: scale(bonds.gap, pull), moment: [none; 2] }
    }

    fn energies<const W: usize>(&self, bonds: &BondLanes<W>, _: &[(); W], _: &(), memory: &[f64; W]) -> EnergyLanes<W> {
        let elongation = dot(bonds.gap, bonds.gap).sqrt() - bonds.inverse.recip();
        let tension = Lanes::of(|k| {
            let integrity = if elongation.0[k] > 0.0 { self.integrity(memory[k]) } else { 1.0 };
            0.5 * integrity * self.stiffness * elongation.0[k].powi(2)
        });
        EnergyLanes { tension, bending: Lanes::splat(0.0), torsion: Lanes::splat(0.0) }
    }

    fn dissipated(&self, _: f64, _: &(), memory: &f64) -> f64 {
        // Work up to the largest elongation less what is given back from there.
        let most = memory.clamp(self.onset, self.end);
        let peak = self.stiffness * self.onset;
        let force = self.integrity(most) * self.stiffness * most;
        0.5 * peak * self.onset + 0.5 * (peak + force) * (most - self.onset) - 0.5 * force * most
    }

    fn stiffness(&self, _: f64, _: &()) -> BondStiffness {
        BondStiffness { axial: self.stiffness, bending: 0.0, carry_over: 0.0, twist: 0.0 }
    }

    fn face_stiffness(&self, _: f64) -> [f64; 2] {
        [self.stiffness, 0.0]
    }

    fn section_radius(&self) -> f64 {
        1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bond::BondNetwork;
    use crate::particles::Particles;
    use fractum_math::Vec3;
    use fractum_math::elementary::{cos, sin};

    const SPRING: SofteningSpring = SofteningSpring { stiffness: 100.0, onset: 0.01, end: 0.05 };

    /// Nine particles along a crooked line, and springs between neighbours.
    fn line() -> (Particles, BondNetwork<SofteningSpring>) {
        let place = |i: usize| Vec3::new(i as f64, 0.3 * sin(i as f64), 0.2 * cos(i as f64));
        let particles = Particles::at_rest((0..9).map(place).collect(), vec![0.4; 9], 9.0).unwrap();
        let pairs: Vec<[u32; 2]> = (0..8).map(|i| [i, i + 1]).collect();
        let springs = BondNetwork::new(&particles, &pairs, SPRING).unwrap();
        (particles, springs)
    }

    fn forces(particles: &mut Particles, springs: &mut BondNetwork<SofteningSpring>) -> Vec<Vec3> {
        particles.clear_forces();
        springs.add_forces(particles);
        particles.force.clone()
    }

    /// Pulls the line apart along x, the outer springs farther than the inner ones.
    fn stretch(start: &Particles, by: f64) -> Particles {
        let mut particles = start.clone();
        particles.position.iter_mut().enumerate().for_each(|(i, x)| x.x += by * (i * i) as f64);
        particles
    }

    #[test]
    fn forces_are_the_derivative_of_the_energy_at_fixed_memory_and_balance() {
        let (start, mut springs) = line();
        forces(&mut stretch(&start, 0.002), &mut springs);
        // Unloaded a little, so that memory stays.
        let mut particles = stretch(&start, 0.0017);
        let force = forces(&mut particles, &mut springs);
        assert!((0..8).any(|bond| springs.memory_of(bond) > SPRING.onset));
        assert!(force.iter().sum::<Vec3>().norm() < 1e-13 * force[8].norm());
        for (i, axis) in (0..9).flat_map(|i| (0..3).map(move |axis| (i, axis))) {
            let energy = |by: f64| {
                let mut moved = particles.clone();
                moved.position[i][axis] += by;
                springs.energy(&moved).total()
            };
            let slope = (energy(1e-6) - energy(-1e-6)) / 2e-6;
            assert!((slope + force[i][axis]).abs() < 1e-6 * force[8].norm(), "{i} {axis}: {slope}");
        }
    }

    #[test]
    fn work_is_stored_or_dissipated_and_nothing_dissipated_comes_back() {
        let (start, mut springs) = line();
        let mut before = forces(&mut start.clone(), &mut springs);
        let (mut work, mut lost, mut place) = (0.0, 0.0, start.clone());
        // Out, half back, and out until the last springs are torn.
        let path = (0..2000).chain((1000..2000).rev()).chain(1000..6000).map(|k| 1e-6 * f64::from(k));
        for by in path {
            let mut next = stretch(&start, by);
            let after = forces(&mut next, &mut springs);
            for i in 0..9 {
                work -= 0.5 * (before[i] + after[i]).dot(&(next.position[i] - place.position[i]));
            }
            let dissipated = springs.dissipated();
            assert!(dissipated >= lost);
            (lost, before, place) = (dissipated, after, next);
            let stored = springs.energy(&place).total();
            assert!((work - stored - lost).abs() < 1e-5 * (work + 1e-6), "{by}: {work} {stored} {lost}");
        }
        // A torn spring has dissipated all the work under its curve.
        assert_eq!(springs.forces_of(7, &place).force, Vec3::zeros());
        let area = 0.5 * SPRING.stiffness * SPRING.onset * SPRING.end;
        assert!((SPRING.dissipated(1.0, &(), &springs.memory_of(7)) / area - 1.0).abs() < 1e-12);
    }

    #[test]
    fn memory_survives_saving_and_a_second_look_at_the_same_state() {
        let (start, mut springs) = line();
        forces(&mut stretch(&start, 0.002), &mut springs);
        springs.break_bond(3);
        let mut particles = stretch(&start, 0.001);
        let expected = forces(&mut particles, &mut springs);
        let saved = springs.memory();
        springs.find_virials(&particles);
        assert_eq!((&springs.memory(), &forces(&mut particles, &mut springs)), (&saved, &expected));
        // Made again from the same start, as a run that goes on does.
        let (_, mut again) = line();
        again.break_bond(3);
        assert_ne!(forces(&mut particles, &mut again), expected);
        let (_, mut again) = line();
        again.break_bond(3);
        again.restore_memory(&saved);
        assert_eq!((forces(&mut particles, &mut again), again.memory()), (expected, saved));
        assert_eq!(again.dissipated(), springs.dissipated());
    }
}
