//! Boundary conditions, written once over [`Points`]: supports and loads of nodes and of particles alike.

mod along;
mod load;
mod points;
mod state;
mod support;
mod surface_support;

pub use along::Along;
pub(crate) use along::mean;
pub use load::*;
pub use points::Population;
pub(crate) use points::{DrivenPoints, Points};
pub(crate) use state::ConditionsState;
pub(crate) use support::{Kick, integral};
pub use support::{Motion, Support, Supports};
pub use surface_support::{SupportedFacet, SurfaceSupports};
