//! Bonds that join particles: their laws, the network that computes them, the graph of those that hold.

mod block;
mod distributed;
mod graph;
mod kept_loads;
mod kinds;
mod law;
mod loads;
mod mean_strain;
mod network;
mod nonlocal;
mod separating;
mod space_cells;
mod subdomain;

pub(crate) use graph::check_pairs;
pub use graph::{BondGraph, HalfEdge, Parts};
pub use kinds::{AnyBondLaw, BondMemory, Bonds};
pub use law::*;
pub use loads::{LoadLanes, LoadSizes};
pub use network::BondNetwork;
