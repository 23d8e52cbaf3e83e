//! What a touching pair feels.

mod linear;

pub use linear::{ContactForce, ContactMemory, Linear, PairMotion};
