//! Bonds that join particles: their laws, the network that computes them, the graph of those that hold.

mod block;
mod graph;
mod kinds;
pub mod lanes;
mod law;
mod network;

pub use graph::{BondGraph, HalfEdge, Parts};
pub use kinds::{AnyBondLaw, BondMemory, Bonds};
pub use law::{
    BeamSection, BondEnergy, BondForces, BondLanes, BondLaw, BondStiffness, BondedPair, ForceLanes, Turn,
    cohesive_beam, cohesive_beam_energy,
};
pub use network::BondNetwork;
