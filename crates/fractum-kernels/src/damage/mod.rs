//! Damage of an edge: what it sees, how its history advances, the stress that is left, and the energy that a step takes.

mod beds;
mod edge;
mod friction;
mod rate;
mod restraint;
mod seen;
mod taken;

pub use beds::Beds;
pub use edge::{ABOVE_ALL, EdgeDamage, Softens};
pub use friction::{CrackFriction, Rubbed, RubbingStep};
pub use rate::{EdgeRate, RateLaw, Waiting, rate_factor};
pub use restraint::Restraint;
pub use seen::{Band, Seen};
pub use taken::Taken;
