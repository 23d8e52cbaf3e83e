//! Boundary conditions, written once over [`Points`]: supports, loads and probes of nodes and of particles alike.

mod load;
mod points;
mod probe;
mod state;
mod support;
mod surface_support;

pub use load::*;
pub use points::Population;
pub(crate) use points::{DrivenPoints, Points};
pub(crate) use probe::mean;
pub use probe::{Along, PointProbe};
pub(crate) use state::ConditionsState;
pub(crate) use support::{Kick, integral};
pub use support::{Motion, Support, Supports};
pub use surface_support::{SupportedFacet, SurfaceSupports};
