use fractum_dem::crack_shape::Axis;
use fractum_math::Vec3;

/// The direction of a component of a vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Along {
    /// The same everywhere: a unit vector.
    Direction(Vec3),
    /// Away from an axis.
    Radial(Axis),
    /// Around an axis, by the right hand.
    Tangential(Axis),
}

impl Along {
    /// Unit vector at a place; zero on the axis.
    pub fn at(&self, place: &Vec3) -> Vec3 {
        let away = |axis: &Axis| {
            let from = place - axis.point;
            (from - axis.direction * from.dot(&axis.direction)).try_normalize(0.0).unwrap_or_default()
        };
        match self {
            Along::Direction(direction) => *direction,
            Along::Radial(axis) => away(axis),
            Along::Tangential(axis) => axis.direction.cross(&away(axis)),
        }
    }
}

/// The mean of a vector over points.
pub(crate) fn mean<'a>(points: impl IntoIterator<Item = &'a u32>, of: impl Fn(usize) -> Vec3) -> Vec3 {
    let (mut sum, mut count) = (Vec3::zeros(), 0);
    for &point in points {
        sum += of(point as usize);
        count += 1;
    }
    sum / f64::from(count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_about_an_axis_are_unit_vectors_by_the_right_hand() {
        let axis = Axis { point: Vec3::new(1.0, 2.0, 3.0), direction: Vec3::z() };
        let place = Vec3::new(1.0, 4.0, -7.0);
        assert_eq!(Along::Radial(axis).at(&place), Vec3::y());
        assert_eq!(Along::Tangential(axis).at(&place), -Vec3::x());
        assert_eq!(Along::Direction(Vec3::x()).at(&place), Vec3::x());
        let on_axis = Vec3::new(1.0, 2.0, 9.0);
        assert_eq!(
            (Along::Radial(axis).at(&on_axis), Along::Tangential(axis).at(&on_axis)),
            (Vec3::zeros(), Vec3::zeros())
        );
    }
}
