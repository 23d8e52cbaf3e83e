use std::fmt;

use fractum_math::Vec3;

use crate::time_function::TimeFunction;

/// Acceleration of every point along an axis [m/s²].
#[derive(Clone)]
pub struct Gravity {
    /// Axis 0, 1 or 2.
    pub axis: usize,
    /// Acceleration, taken at the origin.
    pub value: TimeFunction,
}

impl Gravity {
    pub(super) fn apply(&self, time: f64, acceleration: &mut Vec3) {
        acceleration[self.axis] += (self.value)(time, &Vec3::zeros());
    }
}

impl fmt::Debug for Gravity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Gravity(along {})", self.axis)
    }
}
