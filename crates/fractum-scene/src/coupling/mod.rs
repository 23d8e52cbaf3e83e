//! The transition of damaged elements to discrete elements.

mod debris;
mod holder;
mod radius;

pub use debris::{Debris, DebrisState, Pair};
pub use radius::largest_radii;
