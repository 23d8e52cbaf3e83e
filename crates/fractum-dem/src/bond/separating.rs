//! Bonds that separate beside the mean strain of their particles, and the work that they do last.

use fractum_kernels::bond::{BondForces, BondLaw};
use fractum_kernels::lanes::Lanes;
use fractum_math::{Sym3, Vec3};

use super::mean_strain::{BondChange, MeanStrain, Separating};
use super::network::BondNetwork;
use crate::particles::Particles;

impl<L: BondLaw> BondNetwork<L> {
    /// Separates the bonds that were found to fail, and finds by how much this changes the forces of this instant.
    pub(super) fn separate_overloaded(&mut self, particles: &Particles) {
        let mut separating = std::mem::take(&mut self.separating);
        separating.failed.clear();
        self.blocks.iter_mut().for_each(|block| separating.failed.append(&mut block.failing));
        if !separating.failed.is_empty() {
            self.find_neighbourhood(&mut separating);
            self.sum_changes(particles, &mut separating, -1.0);
            self.separate_failing(particles, &mut separating);
            self.sum_changes(particles, &mut separating, 1.0);
            self.find_stress_changes(&mut separating);
        }
        self.separating = separating;
    }

    /// Finds what loses its mean strain when bonds fail, and the bonds whose forces this changes.
    fn find_neighbourhood(&self, separating: &mut Separating) {
        let Some(mean) = &self.mean else { return };
        let Separating { failed, particles, bonds, changes, about, .. } = separating;
        particles.clear();
        for &bond in failed.iter() {
            mean.spanning(self.pairs[bond as usize], about);
            particles.append(about);
        }
        particles.sort_unstable();
        particles.dedup();
        bonds.clear();
        bonds.extend(&*failed);
        particles.iter().for_each(|&i| bonds.extend(mean.graph.every(i as usize).map(|half| half.bond)));
        bonds.sort_unstable();
        bonds.dedup();
        changes.clear();
        let none = BondChange { force: Vec3::zeros(), moment: [Vec3::zeros(); 2], share: Sym3::ZERO };
        changes.resize(bonds.len(), none);
    }

    /// Adds the forces of the bonds, as they are now, times a sign to their changes.
    fn sum_changes(&self, particles: &Particles, separating: &mut Separating, sign: f64) {
        let Some(mean) = &self.mean else { return };
        for (bond, change) in separating.bonds.iter().map(|&bond| bond as usize).zip(&mut separating.changes) {
            if !self.is_live(bond) {
                continue;
            }
            let (mut recent, mut memory) = (L::Recent::default(), [L::Memory::default()]);
            L::remember(self.memory_of(bond), 0, &mut recent, &mut memory);
            let lanes = self.pair(bond, particles).lanes();
            let strain = mean.between(self.pairs[bond]).0.map(|e| Lanes([e]));
            let found = self.law.deviating_forces(&lanes, strain, &[self.own[bond]], &mut recent, &mut memory);
            let forces: BondForces = found.forces.into();
            change.force += forces.force * sign;
            (0..2).for_each(|end| change.moment[end] += forces.moment[end] * sign);
            change.share += Sym3(found.share.map(|share| share.0[0])) * sign;
        }
    }

    /// Finds the particles whose stresses other forces of bonds or the loss of a mean strain change.
    fn find_stress_changes(&self, separating: &mut Separating) {
        let Some(mean) = &self.mean else { return };
        let Separating { particles, bonds, changes, stressed, near, .. } = separating;
        near.clear();
        near.extend(&*particles);
        near.extend(bonds.iter().flat_map(|&bond| self.pairs[bond as usize]));
        near.sort_unstable();
        near.dedup();
        stressed.clear();
        for &i in near.iter() {
            let halves = mean.graph.every(i as usize).filter_map(|half| bonds.binary_search(&half.bond).ok());
            let added = halves.fold(Sym3::ZERO, |sum, k| sum + changes[k].share);
            stressed.push((i, mean.stress_change(i, added)));
        }
    }

    /// Separates the interfaces that fail, and takes the mean strains away that go with them; the energy that this takes is dissipated by the
    /// interface.
    fn separate_failing(&mut self, particles: &Particles, separating: &mut Separating) {
        let Separating { failed, about, near: bonds, .. } = separating;
        for bond in failed.iter().map(|&bond| bond as usize) {
            let Some(mean) = self.mean.as_mut() else { return };
            let ends = self.pairs[bond];
            mean.spanning(ends, about);
            bonds.clear();
            bonds.push(bond as u32);
            about.iter().for_each(|&i| bonds.extend(mean.graph.every(i as usize).map(|half| half.bond)));
            bonds.sort_unstable();
            bonds.dedup();
            let before = self.energy_about(about, bonds, particles);
            let Some(mean) = self.mean.as_mut() else { return };
            let strain = mean.between(ends);
            mean.release(about);
            let own = self.own[bond];
            let memory = self.law.failed(&self.pair(bond, particles), strain, &own);
            self.put_memory(bond, memory);
            let released = before - self.energy_about(about, bonds, particles);
            self.put_memory(bond, self.law.with_dissipated(memory, released, self.length[bond], &own));
            let [block, group, lane] = self.index[bond];
            self.blocks[block as usize].separated.push(group * fractum_kernels::lanes::WIDTH as u32 + lane);
        }
    }

    /// Energy of some mean strains and bonds [J].
    fn energy_about(&self, about: &[u32], bonds: &[u32], particles: &Particles) -> f64 {
        let Some(mean) = &self.mean else { return 0.0 };
        let own: f64 = about.iter().map(|&i| mean.energy_of(i as usize)).sum();
        bonds.iter().fold(own, |sum, &bond| sum + self.energy_of(bond as usize, particles).total())
    }

    /// Takes the work that what separated at tⁿ still did in the step after it off what it dissipated, in equal parts; one call after each kick.
    ///
    /// - `particles`: with the velocities and spins vⁿ⁺½ of that step
    /// - `dt` [s]: the step
    pub fn book_last_work(&mut self, particles: &Particles, dt: f64) {
        if self.separating.failed.is_empty() {
            return;
        }
        let mut separating = std::mem::take(&mut self.separating);
        let Separating { failed, bonds, changes, stressed, .. } = &mut separating;
        let Particles { velocity, spin, .. } = particles;
        let of_bond = |(&bond, change): (&u32, &BondChange)| {
            let [i, j] = self.pairs[bond as usize].map(|i| i as usize);
            let turning = change.moment[0].dot(&spin[i]) + change.moment[1].dot(&spin[j]);
            change.force.dot(&(velocity[j] - velocity[i])) + turning
        };
        let of_bonds: f64 = bonds.iter().zip(&*changes).map(of_bond).sum();
        let of_stress =
            |mean: &MeanStrain| stressed.iter().fold(0.0, |sum, (i, stress)| sum + mean.power_of(*i, stress, velocity));
        let power = of_bonds + self.mean.as_ref().map_or(0.0, of_stress);
        let share = 0.5 * dt * power / failed.len() as f64;
        for bond in failed.drain(..).map(|bond| bond as usize) {
            let memory = self.memory_of(bond);
            self.put_memory(bond, self.law.with_dissipated(memory, share, self.length[bond], &self.own[bond]));
        }
        self.separating = separating;
    }
}
