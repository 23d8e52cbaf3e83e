use fractum_math::Vec3;
use fractum_math::elementary::hypot;
use serde::{Deserialize, Serialize};

use crate::foot::Foot;

/// A rigid shape in its own axes, with its centre at the origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Shape {
    /// The half space z < 0.
    HalfSpace,
    /// A box of these half sides [m].
    Cuboid {
        /// Half sides [m].
        half: Vec3,
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius [m].
        radius: f64,
        /// Half of its length [m].
        half_length: f64,
    },
    /// A sphere.
    Ball {
        /// Radius [m].
        radius: f64,
    },
    /// The wall of a cylinder along z, without thickness and without lids; felt from both sides.
    Tube {
        /// Radius [m].
        radius: f64,
        /// Half of its length [m].
        half_length: f64,
    },
}

impl Shape {
    /// Where a sphere touches the shape from outside or, with `hollow`, the walls of the container from inside.
    ///
    /// - `centre` [m] in the axes of the shape, `radius` [m]
    ///
    /// From outside there is one contact at most, since the shapes are convex; from inside, one with each wall. A tube has one, on
    /// either side and on its rims alike: it counts as flat, so that a sphere keeps its energy from one side over the rim to the other.
    pub fn feet(&self, hollow: bool, centre: &Vec3, radius: f64, feet: &mut Vec<Foot>) {
        feet.clear();
        if !hollow || matches!(self, Shape::Tube { .. }) {
            let Outside { normal, distance, curvature } = self.outside(centre);
            if distance < radius {
                feet.push(foot(0, normal, distance, curvature));
            }
            return;
        }
        let mut add = |feature: u32, normal: Vec3, distance: f64, curvature: f64| {
            if distance < radius {
                feet.push(foot(feature, normal, distance, curvature));
            }
        };
        let axis = |k: usize| Vec3::ith(k, 1.0);
        match *self {
            Shape::HalfSpace => add(0, -axis(2), centre.z, 0.0),
            Shape::Cuboid { half } => {
                for k in 0..3 {
                    add(2 * k as u32, axis(k), half[k] - centre[k], 0.0);
                    add(2 * k as u32 + 1, -axis(k), half[k] + centre[k], 0.0);
                }
            }
            Shape::Cylinder { radius: wide, half_length } => {
                let (away, rho) = direction(Vec3::new(centre.x, centre.y, 0.0), Vec3::x());
                add(0, away, wide - rho, -0.5 / wide);
                add(1, axis(2), half_length - centre.z, 0.0);
                add(2, -axis(2), half_length + centre.z, 0.0);
            }
            Shape::Ball { radius: wide } => {
                let (away, from) = direction(*centre, Vec3::z());
                add(0, away, wide - from, -1.0 / wide);
            }
            Shape::Tube { .. } => {}
        }
    }

    /// The surface nearest to a point that is, or should be, outside.
    pub fn outside(&self, centre: &Vec3) -> Outside {
        let found = |normal: Vec3, distance: f64, curvature: f64| Outside { normal, distance, curvature };
        let axis = |k: usize| Vec3::ith(k, if centre[k] < 0.0 { -1.0 } else { 1.0 });
        match *self {
            Shape::HalfSpace => found(-Vec3::z(), centre.z, 0.0),
            Shape::Cuboid { half } => {
                let beyond = centre - centre.zip_map(&half, |c, h| c.clamp(-h, h));
                let distance = beyond.norm();
                if distance > 0.0 {
                    return found(-beyond / distance, distance, 0.0);
                }
                let depth = |k: usize| half[k] - centre[k].abs();
                let k = (1..3).fold(0, |least, k| if depth(k) < depth(least) { k } else { least });
                found(-axis(k), -depth(k), 0.0)
            }
            Shape::Cylinder { radius: wide, half_length } => {
                let (away, rho) = direction(Vec3::new(centre.x, centre.y, 0.0), Vec3::x());
                let (side, cap) = (rho - wide, centre.z.abs() - half_length);
                if side > 0.0 && cap > 0.0 {
                    let distance = hypot(side, cap);
                    found(-(away * side + axis(2) * cap) / distance, distance, 0.0)
                } else if side > cap {
                    found(-away, side, 0.5 / wide)
                } else {
                    found(-axis(2), cap, 0.0)
                }
            }
            Shape::Ball { radius: wide } => {
                let (away, from) = direction(*centre, Vec3::z());
                found(-away, from - wide, 1.0 / wide)
            }
            Shape::Tube { radius: wide, half_length } => {
                let (away, rho) = direction(Vec3::new(centre.x, centre.y, 0.0), Vec3::x());
                let beyond = centre.z - centre.z.clamp(-half_length, half_length);
                let to_wall = away * (wide - rho) - Vec3::z() * beyond;
                let (normal, distance) = direction(to_wall, -away);
                found(normal, distance, 0.0)
            }
        }
    }
}

/// The surface of a shape nearest to a point outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outside {
    /// Unit vector from the point into the shape.
    pub normal: Vec3,
    /// Distance of the surface along it [m]; negative within the shape.
    pub distance: f64,
    /// Mean curvature there [1/m].
    pub curvature: f64,
}

fn foot(feature: u32, normal: Vec3, distance: f64, curvature: f64) -> Foot {
    Foot { curvature, ..Foot::contact(feature, feature, normal * distance, normal, distance) }
}

/// Unit vector and length; `otherwise` where there is no length.
fn direction(vector: Vec3, otherwise: Vec3) -> (Vec3, f64) {
    let length = vector.norm();
    (if length > 0.0 { vector / length } else { otherwise }, length)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn every_wall_of_a_container_is_felt_in_its_corner() {
        let mut feet = Vec::new();
        let cube = Shape::Cuboid { half: Vec3::repeat(1.0) };
        cube.feet(true, &Vec3::repeat(0.95), 0.1, &mut feet);
        assert_eq!(feet.len(), 3);
        let drum = Shape::Cylinder { radius: 1.0, half_length: 1.0 };
        drum.feet(true, &Vec3::new(0.95, 0.0, -0.95), 0.1, &mut feet);
        assert_eq!(feet.len(), 2);
        assert!(feet.iter().all(|f| (f.distance - 0.05).abs() < 1e-12));
    }

    #[test]
    fn a_tube_is_felt_on_both_sides_and_its_rims() {
        let tube = Shape::Tube { radius: 1.0, half_length: 1.0 };
        let mut feet = Vec::new();
        let places =
            [([0.9, 0.0, 0.3], 0.1), ([0.0, -1.2, 0.3], 0.2), ([1.0, 0.0, 1.25], 0.25), ([1.3, 0.0, -1.4], 0.5)];
        for (place, distance) in places {
            tube.feet(true, &Vec3::from(place), 0.6, &mut feet);
            assert_eq!(feet.len(), 1);
            assert!((feet[0].distance - distance).abs() < 1e-12, "{place:?}: {}", feet[0].distance);
        }
        // No lids.
        tube.feet(true, &Vec3::new(0.0, 0.0, 1.0), 0.6, &mut feet);
        assert!(feet.is_empty());
    }

    proptest! {
        #[test]
        fn the_distance_falls_along_the_normal_one_to_one(
            x in prop::array::uniform3(-2f64..2.0), kind in 0usize..5, hollow in proptest::bool::ANY,
        ) {
            let shape = [
                Shape::HalfSpace,
                Shape::Cuboid { half: Vec3::new(1.0, 0.7, 0.5) },
                Shape::Cylinder { radius: 0.8, half_length: 0.6 },
                Shape::Ball { radius: 0.9 },
                Shape::Tube { radius: 0.8, half_length: 0.6 },
            ][kind];
            let (mut feet, mut moved) = (Vec::new(), Vec::new());
            let x = Vec3::from(x);
            shape.feet(hollow, &x, 10.0, &mut feet);
            for foot in &feet {
                prop_assert!((foot.normal.norm() - 1.0).abs() < 1e-12);
                let step = 1e-7;
                shape.feet(hollow, &(x + foot.normal * step), 10.0, &mut moved);
                let same = moved.iter().find(|m| m.feature == foot.feature).unwrap();
                // Not across the medial axis of a shape that holds the centre.
                if (same.normal - foot.normal).norm() < 1e-3 {
                    prop_assert!((foot.distance - same.distance - step).abs() < 1e-12);
                }
            }
        }
    }
}
