//! How many there are of everything in a scene.

use crate::contacts::NodesOnShape;
use crate::enter::{entered_of, inlets_of};
use crate::scene::Scene;
use fractum_fem::{cracks, neighbours};

/// What a probe counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // the names say it
pub enum CountKind {
    RemovedElements,
    BrokenEdges,
    DamagedEdges,
    Particles,
    Fragments,
    Contacts,
    Bonds,
    BrokenBonds,
    EnteredParticles,
    WaitingParticles,
    LeftPieces,
}

/// What there is of everything.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs)] // the names say it
pub struct Counts {
    pub nodes: usize,
    pub elements: usize,
    pub removed_elements: usize,
    /// Those of them that were turned inside out.
    pub crushed_elements: usize,
    pub particles: usize,
    pub contacts: usize,
    pub bonds: usize,
    pub broken_bonds: usize,
    /// Those that have come in through inlets.
    pub entered_particles: usize,
    /// Those that are due and have no free place in their inlet.
    pub waiting_particles: usize,
    /// Free pieces that have left the domain.
    pub left_pieces: usize,
}

impl Counts {
    /// One of them; edges and fragments are not among them.
    pub(crate) fn of(&self, kind: CountKind) -> usize {
        match kind {
            CountKind::RemovedElements => self.removed_elements,
            CountKind::Particles => self.particles,
            CountKind::Contacts => self.contacts,
            CountKind::Bonds => self.bonds,
            CountKind::BrokenBonds => self.broken_bonds,
            CountKind::EnteredParticles => self.entered_particles,
            CountKind::WaitingParticles => self.waiting_particles,
            CountKind::LeftPieces => self.left_pieces,
            CountKind::Fragments | CountKind::BrokenEdges | CountKind::DamagedEdges => 0,
        }
    }
}

impl Scene {
    /// Counts of everything but fragments and edges, of which [`fractum_fem::cracks::fracture`] tells.
    pub fn counts(&self) -> Counts {
        Counts {
            nodes: self.solid.reference.len(),
            elements: (0..self.solid.body_count()).map(|b| neighbours::element_count(&self.solid, b)).sum(),
            removed_elements: cracks::removed_count(&self.solid) - self.removals.left.elements,
            crushed_elements: self.removals.tally.crushed,
            particles: self.debris.len() + self.bonded.particles.len()
                - self.removals.left.particles(self.solid.reference.len()).count()
                - inlets_of(self).iter().map(|inlet| inlet.outside().len()).sum::<usize>(),
            entered_particles: entered_of(self).particles,
            waiting_particles: entered_of(self).waiting,
            left_pieces: self.removals.left.pieces,
            bonds: self.bonded.bond_counts().0,
            broken_bonds: self.bonded.bond_counts().1,
            contacts: self.debris.touching().count()
                + self.shape_contacts.iter().map(NodesOnShape::touching).sum::<usize>()
                + self.contacts.touching(),
        }
    }

    /// One count.
    pub fn count(&self, kind: CountKind) -> usize {
        match kind {
            CountKind::Fragments => self.fragments().len(),
            CountKind::BrokenEdges => cracks::fracture(&self.solid).broken_edges,
            CountKind::DamagedEdges => cracks::fracture(&self.solid).damaged_edges,
            kind => self.counts().of(kind),
        }
    }
}
