use fractum_math::Vec3;

use super::closest::area_vector;
use super::{FacetMesh, Feature};

impl FacetMesh {
    /// Shares of the points of a feature in a force at `place` on it: `add(point, weight)` for each.
    ///
    /// Weights add up to 1 and reproduce the place, Σ w p = place: force and moment pass exactly. Linear along an edge
    /// and in a triangle; Wachspress' coordinates in a polygon (Meyer et al. 2002), which are linear on its border.
    pub fn share(&self, feature: u32, place: &Vec3, points: &[Vec3], mut add: impl FnMut(u32, f64)) {
        // Share of the way from a to b.
        let along = |[a, b]: [u32; 2]| {
            let way = points[b as usize] - points[a as usize];
            (place - points[a as usize]).dot(&way) / way.norm_squared()
        };
        match self.feature(feature) {
            Feature::Point(point) => add(point, 1.0),
            Feature::Edge(edge) => {
                let [a, b] = self.edge(edge);
                let t = if a == b { 0.0 } else { along([a, b]) };
                add(a, 1.0 - t);
                add(b, t);
            }
            Feature::Facet(facet) => {
                let corners = self.corners(facet);
                if let &[a, b] = corners {
                    let t = along([a, b]);
                    add(a, 1.0 - t);
                    add(b, t);
                    return;
                }
                let count = corners.len();
                let p = |k: usize| points[corners[k % count] as usize];
                let normal = area_vector(corners, points);
                let twice = |a: Vec3, b: Vec3, c: Vec3| normal.dot(&(b - a).cross(&(c - a)));
                // Area from the place to each side.
                let side = |k: usize| twice(*place, p(k), p(k + 1));
                let weight = |k: usize| {
                    let own = twice(p(k + count - 1), p(k), p(k + 1));
                    let others = (0..count).filter(|&j| j != k && (j + 1) % count != k);
                    own * others.map(side).product::<f64>()
                };
                let sum: f64 = (0..count).map(weight).sum();
                (0..count).for_each(|k| add(corners[k], weight(k) / sum));
            }
        }
    }

    /// Value at a place on a feature of a vector given at the points (velocity, say), by the weights of
    /// [`FacetMesh::share`].
    pub fn interpolate(&self, feature: u32, place: &Vec3, points: &[Vec3], values: &[Vec3]) -> Vec3 {
        let mut sum = Vec3::zeros();
        self.share(feature, place, points, |point, weight| sum += values[point as usize] * weight);
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_reproduce_the_place_in_every_polygon() {
        let ring = |count: usize| -> Vec<Vec3> {
            let at = |k: usize| std::f64::consts::TAU * k as f64 / count as f64;
            (0..count).map(|k| Vec3::new(at(k).cos() * 1.3, at(k).sin(), 0.4)).collect()
        };
        let line = [Vec3::new(0.2, 0.1, 0.0), Vec3::new(-0.4, 0.9, 0.0)];
        let surface = FacetMesh::new(&line, &[[0, 1]]).unwrap();
        let values = surface.interpolate(0, &(line[0] * 0.3 + line[1] * 0.7), &line, &line);
        assert!((values - (line[0] * 0.3 + line[1] * 0.7)).norm() < 1e-15);
        assert_eq!(surface.interpolate(surface.edge_feature(1), &line[1], &line, &line), line[1]);
        for count in 3..8u32 {
            let points = ring(count as usize);
            let surface = FacetMesh::new(&points, &[(0..count).collect::<Vec<_>>()]).unwrap();
            for place in [Vec3::new(0.1, -0.2, 0.4), Vec3::new(-0.2, 0.3, 0.4), (points[0] + points[1]) * 0.5] {
                let (mut sum, mut mean) = (0.0, Vec3::zeros());
                surface.share(0, &place, &points, |point, weight| {
                    assert!(weight > -1e-15);
                    sum += weight;
                    mean += points[point as usize] * weight;
                });
                assert!((sum - 1.0).abs() < 1e-14 && (mean - place).norm() < 1e-14, "{count} corners");
            }
        }
    }
}
