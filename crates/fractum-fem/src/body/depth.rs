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

    /// Shares of the ends of a line in what is spread evenly over its area, or of the corners of a triangle over its volume.
    pub fn shares<const N: usize>(self, corners: [&Vec3; N]) -> [f64; N] {
        let sum: f64 = corners.iter().map(|corner| corner.x).sum();
        match self {
            Depth::Turn if sum > 0.0 => corners.map(|corner| (sum + corner.x) / ((N + 1) as f64 * sum)),
            _ => [1.0 / N as f64; N],
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A load that is even over the volume has the resultant moment of the volume: the mean radius over a ring of a line and of a triangle.
    #[test]
    fn shares_of_a_ring_have_its_mean_radius() {
        for [a, b, c] in [[0.0, 1.0, 0.0], [0.5, 0.7, 2.0], [3.0, 3.0, 3.1]] {
            let [x, y, z] = [a, b, c].map(|r| Vec3::new(r, 0.3 * r, 0.0));
            let line = Depth::Turn.shares([&x, &y]);
            assert!((line.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let mean = (a * a + a * b + b * b) / (1.5 * (a + b));
            assert!((line[0] * a + line[1] * b - mean).abs() < 1e-14, "{line:?}");
            let triangle = Depth::Turn.shares([&x, &y, &z]);
            assert!((triangle.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let mean = (a * a + b * b + c * c + a * b + b * c + c * a) / (2.0 * (a + b + c));
            assert!((triangle[0] * a + triangle[1] * b + triangle[2] * c - mean).abs() < 1e-14, "{triangle:?}");
        }
        assert_eq!(Depth::Thickness(0.1).shares([&Vec3::x(), &Vec3::y(), &Vec3::z()]), [1.0 / 3.0; 3]);
    }
}
