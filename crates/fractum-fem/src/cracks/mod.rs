//! Cracks: what damage has cut through, how it lies, which elements are removed, and what separates.

pub(crate) mod crack;
pub(crate) mod crack_network;
pub(crate) mod crack_surface;
pub(crate) mod removal;
pub(crate) mod separation;
