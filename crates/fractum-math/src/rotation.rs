//! Rotations from vectors and back, by [`elementary`](crate::elementary) functions only.

use nalgebra::Quaternion;

use crate::elementary::{acos, atan2, sin_cos};
use crate::{Rotation, Vec3};

/// The rotation about `theta` by its length [rad].
pub fn rotation_by(theta: Vec3) -> Rotation {
    let angle = theta.norm();
    if angle == 0.0 {
        return Rotation::identity();
    }
    let (sine, cosine) = sin_cos(0.5 * angle);
    let v = theta * (sine / angle);
    Rotation::new_normalize(Quaternion::new(cosine, v.x, v.y, v.z))
}

/// The vector about which a rotation turns, as long as its angle [rad], at most π.
pub fn rotation_vector(q: &Rotation) -> Vec3 {
    let (w, v) = if q.w < 0.0 { (-q.w, -q.imag()) } else { (q.w, q.imag()) };
    let sine = v.norm();
    if sine == 0.0 { Vec3::zeros() } else { v * (2.0 * atan2(sine, w) / sine) }
}

/// The shortest rotation that turns the direction of `from` to that of `to`; half a turn has no single axis: a turn about
/// some axis across `from` then. Vectors without length give no rotation.
pub fn rotation_between(from: &Vec3, to: &Vec3) -> Rotation {
    let (Some(a), Some(b)) = (from.try_normalize(0.0), to.try_normalize(0.0)) else { return Rotation::identity() };
    // (1 + cos, sin · axis) is twice the cosine of half the angle times the quaternion.
    let (w, v) = (1.0 + a.dot(&b), a.cross(&b));
    if w * w + v.norm_squared() < 1e-24 {
        let across = a.cross(&Vec3::ith(a.iamin(), 1.0)).normalize();
        return Rotation::new_unchecked(Quaternion::new(0.0, across.x, across.y, across.z));
    }
    Rotation::new_normalize(Quaternion::new(w, v.x, v.y, v.z))
}

/// Angle between two vectors [rad], in [0, π]; zero where one has no length.
pub fn angle_between(a: &Vec3, b: &Vec3) -> f64 {
    let lengths = a.norm() * b.norm();
    if lengths == 0.0 { 0.0 } else { acos((a.dot(b) / lengths).clamp(-1.0, 1.0)) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_rotation_by_a_vector_is_that_of_nalgebra(v in prop::array::uniform3(-2.0f64..2.0)) {
            let theta = Vec3::from(v);
            prop_assert!((rotation_by(theta).coords - Rotation::from_scaled_axis(theta).coords).norm() < 1e-15);
        }

        #[test]
        fn the_vector_of_a_rotation_gives_it_back(v in prop::array::uniform3(-1.8f64..1.8)) {
            let theta = Vec3::from(v);
            prop_assume!(theta.norm() < 3.1);
            prop_assert!((rotation_vector(&rotation_by(theta)) - theta).norm() < 1e-14);
        }

        #[test]
        fn the_shortest_rotation_turns_one_direction_to_the_other(
            a in prop::array::uniform3(-1.0f64..1.0), b in prop::array::uniform3(-1.0f64..1.0),
        ) {
            let (a, b) = (Vec3::from(a), Vec3::from(b));
            prop_assume!(a.norm() > 1e-3 && b.norm() > 1e-3 && angle_between(&a, &b) < 3.1);
            let rotation = rotation_between(&a, &b);
            prop_assert!((rotation * a.normalize() - b.normalize()).norm() < 1e-13);
            prop_assert!((rotation_vector(&rotation).norm() - angle_between(&a, &b)).abs() < 1e-7);
        }
    }

    #[test]
    fn opposite_directions_are_half_a_turn_apart() {
        for axis in [Vec3::x(), Vec3::y(), Vec3::z(), Vec3::new(1.0, -2.0, 0.5)] {
            assert!((rotation_between(&axis, &-axis) * axis + axis).norm() < 1e-14);
        }
    }

    #[test]
    fn no_rotation_has_no_vector() {
        assert_eq!(rotation_by(Vec3::zeros()), Rotation::identity());
        assert_eq!(rotation_vector(&Rotation::identity()), Vec3::zeros());
        assert_eq!(rotation_between(&Vec3::zeros(), &Vec3::x()), Rotation::identity());
    }
}
