use std::sync::Arc;

use fractum_math::Vec3;

/// A value over time [s] and reference position [m], in SI units.
pub type TimeFunction = Arc<dyn Fn(f64, &Vec3) -> f64 + Send + Sync>;
