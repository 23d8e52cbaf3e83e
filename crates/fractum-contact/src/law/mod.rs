//! What a touching pair feels.

mod linear;

pub use linear::{ContactForce, Linear, PairMotion};
