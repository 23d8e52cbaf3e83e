//! Bonds that join particles: their laws, the network that computes them, the graph of those that hold.

mod graph;
mod lanes;
mod law;
mod network;

pub use graph::{BondGraph, HalfEdge, Parts};
pub use law::{BeamEnergy, BeamForces, BeamSection, BondedPair, cohesive_beam, cohesive_beam_energy};
pub use network::BeamNetwork;
