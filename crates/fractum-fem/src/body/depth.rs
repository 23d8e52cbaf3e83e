//! How far plane bodies extend across their plane.

use std::f64::consts::PI;

use fractum_math::Vec3;

/// How far a plane body extends across its plane: what makes areas of lines and volumes of areas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Depth {
    /// A thickness [m].
    Thickness(f64),
    /// A whole turn about the y axis.
    Turn,
}

impl Depth {
    /// The depth at a place [m]: the circumference of a whole turn.
    #[inline]
    pub fn at(self, place: &Vec3) -> f64 {
        match self {
            Depth::Thickness(thickness) => thickness,
            Depth::Turn => 2.0 * PI * place.x,
        }
    }

    /// Shares of the two ends of a line in what is spread evenly over its area.
    pub fn shares(self, [a, b]: [&Vec3; 2]) -> [f64; 2] {
        match self {
            Depth::Turn if a.x + b.x > 0.0 => [2.0 * a.x + b.x, a.x + 2.0 * b.x].map(|r| r / (3.0 * (a.x + b.x))),
            _ => [0.5; 2],
        }
    }
}

/// Area of a facet times its normal [m²]: of a triangle, or with a depth of the side in the plane between its first two corners,
/// outward where the solid lies to the left.
pub fn facet_area([a, b, c]: [Vec3; 3], depth: Option<Depth>) -> Vec3 {
    match depth {
        Some(depth) => Vec3::new(b.y - a.y, a.x - b.x, 0.0) * depth.at(&((a + b) * 0.5)),
        None => (b - a).cross(&(c - a)) * 0.5,
    }
}
