//! A body that breaks where several ranks share it: crack faces belong to the ranks of both particles, alike; what the others need is
//! sent by the rank of the first.

use fractum_parallel::{gather, gather_by_owner, rank_of};

use super::faces::{Face, FaceWork};
use super::moving::{Fracture, power_of};
use crate::bond::{BondForces, Bonds};
use crate::particles::{ParticleSubdomain, Particles, SHARED};

impl Fracture {
    /// Leaves search and faces to ranks. Every rank must have the same body in the same state; from then on each finds what fails of its
    /// own, and all break it.
    pub fn distribute(&mut self, part: &ParticleSubdomain, bonds: &Bonds) {
        self.search.iter_mut().for_each(|search| search.distribute(part, bonds, &self.graph));
    }

    /// Brings all faces up to date on every rank. All ranks must call it.
    pub fn gather_faces(&mut self, part: &ParticleSubdomain) {
        if self.pairs.is_empty() {
            return;
        }
        let own = part.own();
        let is_own = |face: &Face| own.contains(&(face.pair[0] as usize));
        let mine: Vec<(u32, Face)> =
            (0..).zip(&self.pairs).filter(|(_, face)| is_own(face)).map(|(k, f)| (k, *f)).collect();
        for (k, face) in gather(&**part.exchange(), &mine).into_iter().flatten() {
            self.pairs[k as usize] = face;
        }
    }

    /// Gives every rank the energies of all faces.
    pub(super) fn gather_works(&mut self, part: &ParticleSubdomain) {
        let numbers = |work: &FaceWork| {
            let FaceWork { contact, kinks } = work;
            [contact.stored, contact.friction, contact.damping, *kinks]
        };
        let mut all: Vec<[f64; 4]> = self.works.iter().map(numbers).collect();
        part.gather_blocks(SHARED, &mut all);
        for (work, [stored, friction, damping, kinks]) in self.works.iter_mut().zip(all) {
            (work.contact.stored, work.contact.friction, work.contact.damping) = (stored, friction, damping);
            work.kinks = kinks;
        }
    }

    /// The powers of bonds that broke last, each by the rank that has the first particle [W].
    pub(super) fn gather_powers(
        &self,
        part: &ParticleSubdomain,
        acting: &[(usize, BondForces)],
        particles: &Particles,
    ) -> Vec<f64> {
        let first = |of: &(usize, BondForces)| self.cracks[of.0].pair[0] as usize;
        let power = |of: &(usize, BondForces)| [power_of(&of.1, self.cracks[of.0].pair, particles)];
        let mut powers: Vec<[f64; 1]> = acting.iter().map(power).collect();
        if !powers.is_empty() {
            gather_by_owner(&**part.exchange(), |k| rank_of(part.first(), first(&acting[k])), &mut powers);
        }
        powers.into_iter().flatten().collect()
    }
}
