//! Surfaces in space.

use fractum_math::Vec3;

/// Triangles in space.
#[derive(Clone, Debug, Default)]
pub struct Triangles {
    /// Corners [m].
    pub points: Vec<[f64; 3]>,
    /// Points of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Triangles {
    /// The mean of the values of the corners, triangle by triangle; values that are not there count as 0.
    pub fn means(&self, of_points: &[f64]) -> Vec<f64> {
        let value = |&point: &u32| of_points.get(point as usize).copied().unwrap_or(0.0);
        self.triangles.iter().map(|corners| corners.iter().map(value).sum::<f64>() / 3.0).collect()
    }
}

/// Lowest and highest coordinates.
pub fn corners<'a>(points: impl Iterator<Item = &'a Vec3>) -> [Vec3; 2] {
    let nothing = [Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)];
    points.fold(nothing, |[low, high], x| [low.inf(x), high.sup(x)])
}

/// Sizes along the axes.
pub fn extent<'a>(points: impl Iterator<Item = &'a Vec3>) -> Vec3 {
    let [low, high] = corners(points);
    high - low
}
