//! Damage of an edge: what it sees, how its history advances, the stress that is left, and the energy that a step takes.

mod beds;
mod edge;
mod friction;
mod rate;
mod restraint;
mod taken;

pub use beds::{Band, Beds};
pub use edge::{ABOVE_ALL, EdgeDamage, Softens};
pub use friction::{CrackFriction, Rubbed, RubbingStep};
pub use rate::{EdgeRate, RateLaw, Waiting, rate_factor};
pub use restraint::{Restraint, Seen};
pub use taken::Taken;
