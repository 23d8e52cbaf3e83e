//! What a touching pair feels.

mod linear;
mod surface;

pub use linear::{ContactForce, ContactMemory, Linear, PairMotion};
pub use surface::Surface;
