//! Bonds that join particles: the network that computes them, the graph of those that hold.

mod block;
mod distributed;
mod graph;
mod images;
mod kept_loads;
mod kinds;
mod loads;
mod mean_strain;
mod network;
mod nonlocal;
mod separating;
#[cfg(test)]
mod softening_spring;
mod space_cells;
mod subdomain;
mod through_box;

pub use fractum_kernels::bond::{
    BadLaw, BeamSection, BondEnergy, BondForces, BondLanes, BondLaw, BondStiffness, BondedPair, Crushing,
    DeviatingForces, EnergyLanes, ForceLanes, Interface, InterfaceFailure, InterfaceMemory, LocalBond, MeanElasticity,
    RecentStrains, Separation, Turn,
};
pub use graph::{BondGraph, HalfEdge, Parts};
pub(crate) use graph::{check_pairs, check_shares};
pub use kinds::{AnyBondLaw, BondMemory, Bonds};
pub use loads::{LoadLanes, LoadSizes};
pub use network::BondNetwork;
