//! Size and shape of simplices.

use fractum_math::Vec3;

/// Signed volume of a tetrahedron, (b − a) · ((c − a) × (d − a)) / 6; positive when the triangle a b c is
/// counter-clockwise seen from outside opposite d reversed, that is for the unit corner 0, x, y, z.
#[inline]
pub fn signed_volume([a, b, c, d]: [Vec3; 4]) -> f64 {
    (b - a).dot(&(c - a).cross(&(d - a))) / 6.0
}

/// Area of a triangle times its unit normal, (b − a) × (c − a) / 2.
#[inline]
pub fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    0.5 * (b - a).cross(&(c - a))
}
