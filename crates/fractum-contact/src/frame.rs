use fractum_math::{Rotation, Vec3, rotation_by};
use serde::{Deserialize, Serialize};

/// Where a rigid body is and how it moves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    /// Reference point of the body [m].
    pub origin: Vec3,
    /// Rotation from the body's axes to space.
    pub rotation: Rotation,
    /// Velocity of the reference point [m/s].
    pub velocity: Vec3,
    /// Angular velocity in space [rad/s].
    pub spin: Vec3,
}

impl Frame {
    /// At rest at the origin, axes along those of space.
    pub fn at_rest() -> Self {
        Frame::at(Vec3::zeros())
    }

    /// At rest at a point, axes along those of space.
    pub fn at(origin: Vec3) -> Self {
        Frame { origin, rotation: Rotation::identity(), velocity: Vec3::zeros(), spin: Vec3::zeros() }
    }

    /// A point of space in the body's axes.
    #[inline]
    pub fn to_body(&self, x: &Vec3) -> Vec3 {
        let from = x - self.origin;
        // A body that never turned keeps every bit.
        if self.is_unturned() { from } else { self.rotation.inverse_transform_vector(&from) }
    }

    /// A direction of the body in space.
    #[inline]
    pub fn to_space(&self, direction: &Vec3) -> Vec3 {
        if self.is_unturned() { *direction } else { self.rotation.transform_vector(direction) }
    }

    /// Velocity of a point of the body [m/s]; `x` in space.
    #[inline]
    pub fn velocity_at(&self, x: &Vec3) -> Vec3 {
        self.velocity + self.spin.cross(&(x - self.origin))
    }

    /// Where it is after a duration [s], at the velocities that it has.
    #[must_use]
    pub fn moved(&self, dt: f64) -> Self {
        let turns = self.spin != Vec3::zeros();
        let rotation = if turns { rotation_by(self.spin * dt) * self.rotation } else { self.rotation };
        Frame { origin: self.origin + self.velocity * dt, rotation, ..*self }
    }

    fn is_unturned(&self) -> bool {
        self.rotation.coords.xyz() == Vec3::zeros()
    }
}
