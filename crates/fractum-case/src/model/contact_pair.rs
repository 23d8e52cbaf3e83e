//! Pairs of materials with coefficients of contact of their own.

use fractum_scene::PairContact;

use super::{Body, BodyKind, Case, ContactCoefficients};
use crate::Place;

/// Coefficients of contact of two materials, in place of those that follow from each of them.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPair {
    /// Indices into `Case::materials`, in the order of the file; one twice for bodies of the same material.
    pub materials: [usize; 2],
    /// Where it stands.
    pub place: Place,
    /// Its coefficients, one at least.
    pub coefficients: ContactCoefficients,
}

impl ContactPair {
    /// Whether it is that of two materials.
    pub fn is_of(&self, first: usize, second: usize) -> bool {
        self.materials == [first, second] || self.materials == [second, first]
    }
}

impl Case {
    /// What acts of a pair between two bodies: nothing of what a rigid body itself says, and no adhesion but of loose particles.
    pub fn acting(&self, pair: &ContactPair, bodies: [&Body; 2]) -> ContactCoefficients {
        let own = |coefficients: ContactCoefficients, body: &Body| match &body.kind {
            BodyKind::Rigid(rigid) => coefficients.without(&rigid.own_contact),
            _ => coefficients,
        };
        let coefficients = bodies.into_iter().fold(pair.coefficients, own);
        let loose = |body: &Body| matches!(body.kind, BodyKind::Particles(_));
        let may_stick = |body: &Body| matches!(body.kind, BodyKind::Particles(_) | BodyKind::Rigid(_));
        let sticks = bodies.into_iter().any(loose) && bodies.into_iter().all(may_stick);
        ContactCoefficients { work_of_adhesion: coefficients.work_of_adhesion.filter(|_| sticks), ..coefficients }
    }

    /// The pair of the materials of two bodies.
    pub fn pair_of(&self, bodies: [&Body; 2]) -> Option<&ContactPair> {
        let [first, second] = bodies.map(|body| body.kind.material());
        self.contact_pairs
            .iter()
            .find(|pair| first.zip(second).is_some_and(|(first, second)| pair.is_of(first, second)))
    }

    /// Coefficients of contact of two bodies, where a pair of materials gives some.
    pub fn contact_between(&self, bodies: [&Body; 2]) -> Option<PairContact> {
        let acting = self.acting(self.pair_of(bodies)?, bodies);
        let [first, second] = bodies.map(|body| body.kind.surface(&self.materials));
        Some(PairContact { surface: acting.over(first.against(second)), work_of_adhesion: acting.work_of_adhesion })
    }
}
