use std::fmt;

use fractum_math::Vec3;

use crate::conditions::Points;
use crate::time_function::TimeFunction;

/// Force along an axis on points with weights: value times weight [N].
#[derive(Clone)]
pub struct NodalForce {
    /// Points and weights: shares of a total force [-], or areas under a traction [m²].
    pub points: Vec<(u32, f64)>,
    /// Axis 0, 1 or 2.
    pub axis: usize,
    /// Force [N] or traction [Pa].
    pub value: TimeFunction,
}

impl NodalForce {
    pub(super) fn apply(&self, points: &impl Points, time: f64, forces: &mut Vec<(u32, Vec3)>) {
        for &(point, weight) in &self.points {
            let mut force = Vec3::zeros();
            force[self.axis] = weight * (self.value)(time, points.reference(point as usize));
            forces.push((point, force));
        }
    }
}

impl fmt::Debug for NodalForce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "NodalForce({} points along {})", self.points.len(), self.axis)
    }
}
