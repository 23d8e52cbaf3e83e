//! Bonds that join particles: their laws, the network that computes them, the graph of those that hold.

mod block;
mod graph;
mod kept_loads;
mod kinds;
mod law;
mod loads;
mod mean_strain;
mod network;
mod network_part;
mod nonlocal;
mod separating;
mod share;
mod space_cells;

pub(crate) use graph::check_pairs;
pub use graph::{BondGraph, HalfEdge, Parts};
pub use kinds::{AnyBondLaw, BondMemory, Bonds};
pub use law::*;
pub use loads::{LoadLanes, LoadSizes};
pub use network::BondNetwork;
