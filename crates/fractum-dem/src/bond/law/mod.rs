//! Laws of bonds, each in its file.

mod cohesive_beam;

pub(super) use cohesive_beam::beam;
pub use cohesive_beam::{BeamEnergy, BeamForces, BeamSection, BondedPair, cohesive_beam, cohesive_beam_energy};
