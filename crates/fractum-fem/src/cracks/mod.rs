//! Cracks: what damage has cut through, how it lies, which surface removal has opened, and what separates.

pub(crate) mod cost;
pub(crate) mod crack;
pub(crate) mod crack_network;
pub(crate) mod crack_surface;
pub(crate) mod separation;

pub use cost::{CrackCost, cost_of_cracks};
pub use crack::{
    CrackEdge, CrackPlane, Fracture, cost_of_bands, crack_edges, fracture, lost_to_bands, removed_count,
    share_at_borders, size_along_cracks,
};
pub use crack_network::{
    CrackCell, CrackMouth, CrackNetwork, CrackNetworkState, CrackSide, area_at, characteristic_length, present_volume,
};
pub use crack_surface::{CrackFacet, CrackSurface};
pub use separation::{SeparatedElement, SeparatedFacet, Separation, separate_cracks};
