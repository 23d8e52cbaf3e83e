//! Boundary conditions, written once over [`Points`]: supports, loads and probes of nodes and of particles alike.

mod load;
mod points;
mod probe;
mod support;
mod surface_support;

use std::sync::Arc;

use fractum_math::Vec3;

pub use load::*;
pub(crate) use points::{DrivenPoints, Points};
pub use probe::{Along, PointProbe};
pub(crate) use support::integral;
pub use support::{Motion, Support, Supports};
pub use surface_support::{SupportedFacet, SurfaceSupports};

/// A value over time [s] and reference position [m], in SI units.
pub type TimeFunction = Arc<dyn Fn(f64, &Vec3) -> f64 + Send + Sync>;
