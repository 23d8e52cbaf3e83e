//! Particles that several ranks share, see [`ParticleSubdomain`].

use std::sync::Arc;

use fractum_dem::{NearPairs, ParticleSubdomain, ParticleSubdomainSize, Particles};
use fractum_parallel::Exchange;

use super::{Bonded, BondedBody};

impl Bonded {
    /// Why ranks cannot share particles and bonds, in words; none where they can.
    pub(crate) fn cannot_be_distributed(&self) -> Option<&'static str> {
        let any = |is: fn(&BondedBody) -> bool| self.bodies.iter().any(is);
        let breaks_by_criterion = |body: &BondedBody| body.fracture.as_ref().is_some_and(|f| !f.is_by_law());
        if any(|body| !body.bonds.can_be_shared()) {
            Some("bonds beside the mean strain of their particles")
        } else if any(|body| body.viscous.is_some()) {
            Some("bonds that resist the change of their length")
        } else if self.bodies.iter().any(|body| breaks_by_criterion(body) && body.bonds.has_memory()) {
            Some("bonds with a memory that break by a criterion")
        } else {
            None
        }
    }

    /// Whether there are so many particles that some can have them and others not.
    pub(crate) fn has_blocks(&self) -> bool {
        self.particles.len() > ParticleSubdomain::BLOCK
    }

    /// Leaves a share of particles and bonds to each rank of an exchange. Every rank must have the same ones in the same state.
    ///
    /// - `everywhere`: particles that every rank shall move
    pub(crate) fn distribute(&mut self, exchange: Arc<dyn Exchange>, everywhere: impl Iterator<Item = u32>) {
        let pairs = self.bodies.iter().flat_map(|body| body.bonds.pairs()).copied();
        let part = ParticleSubdomain::new(exchange, self.particles.len(), pairs);
        for BondedBody { bonds, fracture, .. } in &mut self.bodies {
            bonds.distribute(&part);
            fracture.iter_mut().for_each(|fracture| fracture.distribute(&part, bonds));
        }
        self.part = Some(Box::new(part));
        self.set_strangers();
        let moved = self.supports.driven().chain(self.held_in_motion()).chain(self.loads.points());
        let everywhere: Vec<u32> = everywhere.chain(moved).chain(self.carried.iter().copied()).collect();
        self.follow(&everywhere);
    }

    /// Held particles that move as yet: their supports do work in the first step.
    fn held_in_motion(&self) -> impl Iterator<Item = u32> {
        let is_moving = |(i, held): &(u32, &u8)| **held != 0 && self.particles.velocity[*i as usize].amax() > 0.0;
        (0..).zip(self.supports.held()).filter(is_moving).map(|(i, _)| i)
    }

    /// What this process does of the work; none where it does all.
    pub fn share(&self) -> Option<ParticleSubdomainSize> {
        Some(self.part.as_ref()?.share())
    }

    /// Whether several ranks share the particles.
    pub(crate) fn is_distributed(&self) -> bool {
        self.part.is_some()
    }

    /// The share of this process, where several share the particles, with all particles.
    pub(crate) fn with_part<T>(&mut self, work: impl FnOnce(Option<&ParticleSubdomain>, &mut Particles) -> T) -> T {
        work(self.part.as_deref(), &mut self.particles)
    }

    /// Has every rank move these particles, from where they are now. All ranks must name the same ones.
    pub(crate) fn follow(&mut self, particles: &[u32]) {
        let Bonded { part, particles: all, past, .. } = self;
        part.iter_mut().for_each(|part| part.follow(particles, all, past));
    }

    /// Tells all ranks the forces on the particles that all of them move.
    pub(crate) fn exchange_forces(&mut self) {
        let Bonded { part, particles, .. } = self;
        part.iter_mut().for_each(|part| part.exchange_forces(particles));
    }

    /// See [`Particles::start_half_a_step_early`]; each rank knows the forces on what it moves.
    pub(crate) fn start_half_a_step_early(&mut self, dt: f64) {
        self.particles.start_half_a_step_early(dt);
        self.clumps.start_half_a_step_early(&mut self.particles, dt);
        self.part.iter_mut().for_each(|part| part.forget_others());
    }

    /// Brings the motion of all particles up to date on every rank. All ranks must call it.
    pub(crate) fn gather_motion(&mut self) {
        let Bonded { part, particles, past, .. } = self;
        part.iter_mut().for_each(|part| part.gather(particles, past));
    }

    /// Brings the forces on all particles up to date on every rank. All ranks must call it.
    pub(crate) fn gather_forces(&mut self) {
        let Bonded { part, particles, .. } = self;
        part.iter_mut().for_each(|part| part.gather_forces(particles));
    }

    /// Brings particles and the memory of bonds up to date on every rank. All ranks must call it.
    pub(crate) fn gather(&mut self) {
        self.gather_motion();
        let Bonded { part: Some(part), bodies, .. } = self else { return };
        for BondedBody { bonds, fracture, .. } in bodies {
            bonds.gather_memory(0..bonds.len() as u32);
            fracture.iter_mut().for_each(|fracture| fracture.gather_faces(part));
        }
    }

    /// Brings the memory of some bonds (body, bond) up to date on every rank. All ranks must name the same ones.
    pub(crate) fn gather_bonds(&mut self, bonds: &[(u32, u32)]) {
        for (index, body) in (0..).zip(&mut self.bodies) {
            body.bonds.gather_memory(bonds.iter().filter(|(body, _)| *body == index).map(|(_, bond)| *bond));
        }
    }

    /// Tells the motion of particles that may touch from now on, see [`ParticleSubdomain::set_near`].
    pub(crate) fn set_near(&mut self, pairs: &[[u32; 2]]) {
        self.part.iter_mut().for_each(|part| part.set_near(NearPairs::Contacts, pairs.iter().copied()));
    }

    /// The same of particles of broken bodies that may touch others of them.
    pub(super) fn set_strangers(&mut self) {
        let Bonded { part: Some(part), bodies, .. } = self else { return };
        let fractures = bodies.iter().filter_map(|body| body.fracture.as_ref());
        part.set_near(NearPairs::Strangers, fractures.flat_map(|fracture| fracture.strangers()));
    }
}
