//! What joins elements and particles: the transition of damaged elements, and ties.

mod debris;
mod holder;
mod layer;
mod radius;
mod tie;

pub(crate) use debris::{Apart, Push};
pub use debris::{Debris, DebrisState, Pair};
pub use layer::{Attachment, Layer};
pub use radius::largest_radii;
pub use tie::Ties;
