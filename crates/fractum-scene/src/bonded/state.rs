//! What changes in bonded bodies during a run.

use fractum_dem::{BondMemory, ClumpMotion, FractureState, Particles, PastForces};
use fractum_math::{Rotation, Vec3};
use serde::{Deserialize, Serialize};

use super::{Bonded, BondedBody, Closest};

/// Everything that changes in bonded bodies during a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BondedState {
    position: Vec<Vec3>,
    orientation: Vec<Rotation>,
    velocity: Vec<Vec3>,
    spin: Vec<Vec3>,
    /// Broken bonds and crack faces of each body, with how close it came to breaking.
    fracture: Vec<(BondsState, Option<Closest>)>,
    past: PastForces,
    clumps: ClumpMotion,
}

/// What changes in the bonds of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
enum BondsState {
    /// Nothing.
    Constant,
    /// They break by a criterion and remember nothing.
    Breaking(FractureState),
    /// They separate by their law.
    Separating(FractureState, BondMemory),
    /// They remember.
    Remembering(BondMemory),
}

impl BondsState {
    fn of(body: &BondedBody) -> Self {
        match (&body.fracture, body.bonds.beam()) {
            (None, Some(_)) => BondsState::Constant,
            (Some(fracture), Some(_)) => BondsState::Breaking(fracture.state()),
            (None, None) => BondsState::Remembering(body.bonds.memory()),
            (Some(fracture), None) => BondsState::Separating(fracture.state(), body.bonds.memory()),
        }
    }

    fn restore(self, body: &mut BondedBody) {
        let (state, memory) = match self {
            BondsState::Constant => (None, None),
            BondsState::Breaking(state) => (Some(state), None),
            BondsState::Separating(state, memory) => (Some(state), Some(memory)),
            BondsState::Remembering(memory) => (None, Some(memory)),
        };
        if let (Some(fracture), Some(state)) = (&mut body.fracture, state) {
            fracture.restore(state, &mut body.bonds);
        }
        if let Some(memory) = memory {
            body.bonds.restore_memory(&memory);
        }
    }
}

impl Bonded {
    /// Everything that changes, for a checkpoint.
    pub fn state(&self) -> BondedState {
        let Particles { position, orientation, velocity, spin, .. } = self.particles.clone();
        let fracture = self.bodies.iter().map(|body| (BondsState::of(body), body.closest));
        let (fracture, past, clumps) = (fracture.collect(), self.past.clone(), self.clumps.motion.clone());
        BondedState { position, orientation, velocity, spin, fracture, past, clumps }
    }

    /// Puts a saved state back into bodies built from the same case.
    pub fn restore(&mut self, state: BondedState) {
        let BondedState { position, orientation, velocity, spin, fracture, past, clumps } = state;
        for (body, (broken, closest)) in self.bodies.iter_mut().zip(fracture) {
            broken.restore(body);
            body.closest = closest;
        }
        self.particles = Particles { position, orientation, velocity, spin, ..std::mem::take(&mut self.particles) };
        self.past = past;
        self.clumps.motion = clumps;
    }
}
