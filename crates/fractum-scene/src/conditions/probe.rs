use fractum_math::Vec3;

use super::{Points, Supports};

/// What is measured on a set of points, ascending: nodes of solids, or particles.
#[derive(Clone, Debug, PartialEq)]
pub enum PointProbe {
    /// Force of the supports along a direction [N].
    Reaction {
        /// Prescribed degrees of freedom; see [`Supports::places`].
        places: Vec<(u32, u32, u32)>,
        /// Unit direction.
        direction: Vec3,
    },
    /// Mean displacement along a direction at the instant of the last step, as its reactions are [m].
    Displacement {
        /// The points.
        points: Vec<u32>,
        /// Unit direction.
        direction: Vec3,
    },
    /// Mean velocity along a direction [m/s].
    Velocity {
        /// The points.
        points: Vec<u32>,
        /// Unit direction.
        direction: Vec3,
    },
    /// Rotation of the set as a whole about an axis through its centre, for small angles [rad].
    Rotation {
        /// The points.
        points: Vec<u32>,
        /// Unit direction of the axis.
        axis: Vec3,
    },
}

impl PointProbe {
    /// Value at the last step; `dt` is the step that followed it [s].
    pub(crate) fn value(&self, population: &impl Points, supports: &Supports, dt: f64) -> f64 {
        let displacement = |i: usize| population.displacement_before(i, dt);
        match self {
            PointProbe::Reaction { places, direction } => supports.reaction(places, direction),
            PointProbe::Displacement { points, direction } => mean(points, displacement).dot(direction),
            PointProbe::Velocity { points, direction } => mean(points, |i| *population.velocity(i)).dot(direction),
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

fn mean(points: &[u32], of: impl Fn(usize) -> Vec3) -> Vec3 {
    points.iter().map(|&i| of(i as usize)).sum::<Vec3>() / points.len().max(1) as f64
}
