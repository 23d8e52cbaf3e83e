use fractum_dem::crack_shape::Axis;
use fractum_math::Vec3;

use super::{Points, Supports};

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

/// What is measured on a set of points, ascending: nodes of solids, or particles.
#[derive(Clone, Debug, PartialEq)]
pub enum PointProbe {
    /// Force of the supports [N]; directions about an axis are those of the places without load.
    Reaction {
        /// Prescribed degrees of freedom; see [`Supports::places`].
        places: Vec<(u32, u32, u32)>,
        /// Which component.
        along: Along,
    },
    /// Moment of the forces of the supports about an axis [N m]; levers are those without load.
    Moment {
        /// Prescribed degrees of freedom; see [`Supports::places`].
        places: Vec<(u32, u32, u32)>,
        /// The axis.
        about: Axis,
    },
    /// Mean displacement at the instant of the last step, as its reactions are [m], of the points that have not left the run;
    /// directions about an axis are those of the places without load.
    Displacement {
        /// The points.
        points: Vec<u32>,
        /// Which component.
        along: Along,
    },
    /// Mean velocity [m/s] of the points that have not left the run; directions about an axis are those of the present places.
    Velocity {
        /// The points.
        points: Vec<u32>,
        /// Which component.
        along: Along,
    },
    /// Rotation of the set as a whole about an axis through its centre, for small angles [rad]; not a number once a point has
    /// left the run.
    Rotation {
        /// The points.
        points: Vec<u32>,
        /// Unit direction of the axis.
        axis: Vec3,
    },
}

impl PointProbe {
    /// The points that it looks at.
    pub(crate) fn points(&self, supports: &Supports) -> Vec<u32> {
        match self {
            PointProbe::Reaction { places, .. } | PointProbe::Moment { places, .. } => {
                supports.points_at(places).collect()
            }
            PointProbe::Displacement { points, .. }
            | PointProbe::Velocity { points, .. }
            | PointProbe::Rotation { points, .. } => points.clone(),
        }
    }

    /// Whether it looks at what supports have done.
    pub(crate) fn is_of_supports(&self) -> bool {
        matches!(self, PointProbe::Reaction { .. } | PointProbe::Moment { .. })
    }

    /// Value at the last step; `dt` is the step that followed it [s]. Not a number once all points have left the run.
    pub(crate) fn value(
        &self,
        population: &impl Points,
        supports: &Supports,
        dt: f64,
        has_left: impl Fn(u32) -> bool,
    ) -> f64 {
        let present = |point: &u32| !has_left(*point);
        let displacement = |i: usize| population.displacement_before(i, dt);
        match self {
            PointProbe::Reaction { places, along: Along::Direction(direction) } => supports.reaction(places, direction),
            PointProbe::Reaction { places, along } => {
                supports.reaction_by(places, |point| along.at(population.reference(point)))
            }
            PointProbe::Moment { places, about } => {
                let lever = |point| population.reference(point) - about.point;
                supports.reaction_by(places, |point| about.direction.cross(&lever(point)))
            }
            PointProbe::Displacement { points, along } => component(
                points.iter().filter(|point| present(point)),
                along,
                |i| *population.reference(i),
                displacement,
            ),
            PointProbe::Velocity { points, along } => component(
                points.iter().filter(|point| present(point)),
                along,
                |i| population.position(i),
                |i| *population.velocity(i),
            ),
            PointProbe::Rotation { points, .. } if points.iter().any(|&point| has_left(point)) => f64::NAN,
            PointProbe::Rotation { points, axis } => {
                let centre = mean(points, |i| *population.reference(i));
                let shift = mean(points, displacement);
                let (mut moment, mut weight) = (0.0, 0.0);
                for &i in points {
                    let path = axis.cross(&(population.reference(i as usize) - centre));
                    moment += path.dot(&(displacement(i as usize) - shift));
                    weight += path.norm_squared();
                }
                moment / weight
            }
        }
    }
}

/// Mean component of a vector over points at these places; not a number of no points.
fn component<'a>(
    points: impl Iterator<Item = &'a u32>,
    along: &Along,
    place: impl Fn(usize) -> Vec3,
    of: impl Fn(usize) -> Vec3,
) -> f64 {
    if let Along::Direction(direction) = along {
        return mean(points, of).dot(direction);
    }
    let (mut sum, mut count) = (0.0, 0);
    for &point in points {
        sum += of(point as usize).dot(&along.at(&place(point as usize)));
        count += 1;
    }
    sum / f64::from(count)
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
