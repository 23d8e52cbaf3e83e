//! Contacts of particles that several ranks share.
//!
//! Pairs of particles belong to the ranks of both; contacts with rigid bodies and solids are found by all ranks alike.

use std::ops::Range;

use fractum_contact::law::HertzMemory;
use fractum_contact::{SUMMED_SPHERES, Spheres};
use fractum_dem::{ParticleSubdomain, Particles};
use fractum_fem::Solid;
use fractum_math::Work;
use fractum_parallel::gather;

use super::Contacts;
use super::debris_among::{DebrisAmong, Made};
use super::flat_faces::Poses;
use crate::coupling::Debris;

impl Contacts {
    /// Which searches are due by the way of some particles: of pairs, then on rigid bodies, on solids, and among discrete elements.
    fn due(&mut self, solid: &Solid, debris: &Debris, particles: &Particles, range: Range<usize>) -> Vec<bool> {
        let poses = Poses::of(particles);
        self.flat.locate(&poses, range.clone());
        let Contacts { among, rigid_bodies, on_tools, solids, flat, nodes, .. } = self;
        let spheres = spheres(particles);
        let of_pairs = among.iter().map(|among| among.is_used_up(&spheres, range.clone()));
        let grounds = rigid_bodies.iter().zip(&*on_tools);
        let on_bodies = grounds.map(|(body, (contacts, _))| {
            flat.locate_for(&poses, body);
            contacts.is_used_up(&body.ground(), &flat.felt(spheres), range.clone())
        });
        let on_solids = solids.iter_mut().map(|ground| ground.is_used_up(solid, &spheres, range.clone()));
        let near_debris = nodes.debris.iter_mut().filter(|_| !debris.is_empty());
        let of_debris = near_debris.map(|among| among.is_used_up(solid, debris, particles, range.clone()));
        of_pairs.chain(on_bodies).chain(on_solids).chain(of_debris).collect()
    }

    /// The same by the way of all particles, of which each rank looks at its own. All ranks must call it.
    pub(crate) fn due_on_any(
        &mut self,
        part: &ParticleSubdomain,
        solid: &Solid,
        debris: &Debris,
        particles: &Particles,
    ) -> Vec<bool> {
        let mut due = self.due(solid, debris, particles, part.own());
        for due in due.chunks_mut(u64::BITS as usize) {
            let bits = (0..).zip(&*due).fold(0u64, |bits, (k, due)| bits | u64::from(*due) << k);
            let bits = part.exchange().any(bits);
            (0..).zip(due).for_each(|(k, due)| *due = bits >> k & 1 == 1);
        }
        due
    }

    /// Does the searches that are due, once all particles are where they are.
    pub(crate) fn search(&mut self, due: &[bool], solid: &Solid, debris: &Debris, particles: &Particles) {
        let poses = Poses::of(particles);
        self.flat.locate(&poses, 0..particles.len());
        let spheres = spheres(particles);
        let mut due = due.iter().copied();
        if let Some(mut among) = self.among.take() {
            if due.next() == Some(true) {
                among.renew(&spheres, |i, j| self.law_among(&particles.radius, &particles.mass, i, j));
            }
            self.among = Some(among);
        }
        let Contacts { rigid_bodies, on_tools, solids, flat, .. } = self;
        for (rigid_body, (contacts, _)) in rigid_bodies.iter().zip(on_tools) {
            if due.next() == Some(true) {
                flat.locate_for(&poses, rigid_body);
                contacts.renew(&rigid_body.ground(), &flat.felt(spheres));
            }
        }
        for ground in solids {
            if due.next() == Some(true) {
                ground.renew(solid, &spheres);
            }
        }
        if let Some(among) = self.nodes.debris.as_mut().filter(|_| due.next() == Some(true)) {
            let made = Made { body: &self.body, materials: &self.materials };
            among.renew(solid, debris, particles, made);
        }
    }

    /// Particles that rigid bodies, solids and discrete elements may touch before the next search, some of them more than once.
    pub(crate) fn near(&self) -> impl Iterator<Item = u32> {
        let grounds = self.on_tools.iter().map(|(contacts, _)| contacts);
        let on_grounds = grounds.chain(self.solids.iter().map(|ground| ground.contacts()));
        on_grounds.flat_map(|contacts| contacts.near()).chain(self.nodes.debris.iter().flat_map(DebrisAmong::near))
    }

    /// Pairs of particles that may touch before the next search.
    pub(crate) fn near_pairs(&self) -> &[[u32; 2]] {
        self.among.as_ref().map_or(&[], |among| among.pairs())
    }

    /// Adds the forces of pairs to the particles of a rank; the energies of all.
    pub(super) fn add_forces_among(&mut self, part: &ParticleSubdomain, particles: &mut Particles, dt: f64) -> Work {
        let Some(among) = &mut self.among else { return Work::default() };
        let Particles { position, velocity, spin, radius, force, moment, .. } = particles;
        let spheres = Spheres { position, velocity, spin, radius };
        among.add_forces_on(part.own(), &spheres, force, moment, dt);
        let numbers = |work: &Work| [work.stored, work.friction, work.damping];
        let mut all: Vec<[f64; 3]> = among.works().iter().map(numbers).collect();
        part.gather_blocks(SUMMED_SPHERES, &mut all);
        for (work, [stored, friction, damping]) in among.works().iter_mut().zip(all) {
            *work = Work::contact(stored, friction, damping);
        }
        among.work()
    }

    /// Whether forces of pairs are asked for.
    pub(crate) fn watches_pairs(&self) -> bool {
        self.among.is_some() && !self.watched.is_empty()
    }

    /// Brings the forces of all pairs up to date on every rank. All ranks must call it.
    pub(crate) fn gather_loads(&mut self, part: &ParticleSubdomain) {
        if let Some(among) = &mut self.among {
            let own: Vec<[f64; 3]> = among.forces(part.own()).map(Into::into).collect();
            among.put_forces(gather(&**part.exchange(), &own).into_iter().flatten().map(Into::into));
        }
    }

    /// Brings the memory of all pairs up to date on every rank. All ranks must call it.
    pub(crate) fn gather_memories(&mut self, part: &ParticleSubdomain) {
        if let Some(among) = &mut self.among {
            let own: Vec<(bool, HertzMemory)> = among.memories(part.own());
            among.put_memories(gather(&**part.exchange(), &own).into_iter().flatten());
        }
    }
}

fn spheres(particles: &Particles) -> Spheres<'_> {
    let Particles { position, velocity, spin, radius, .. } = particles;
    Spheres { position, velocity, spin, radius }
}
