//! The closest place of a surface to points.

use fractum_math::Vec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use rayon::prelude::*;

use crate::FacetMesh;
use crate::sphere_facet::tree_of;

/// The closest place of a surface to a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// Facet; the first one where several share the place.
    pub facet: u32,
    /// Feature on which the place lies, see [`FacetMesh::feature`].
    pub feature: u32,
    /// Vector from the point to the place [m].
    pub offset: Vec3,
}

/// The closest place of a surface to each of `centres`, none where it is further away than the point's `reach` [m].
///
/// - `points` [m]: of the surface
pub fn nearest_facets(
    surface: &FacetMesh,
    points: &[Vec3],
    centres: &[Vec3],
    reach: impl Fn(usize) -> f64 + Sync,
) -> Vec<Option<Nearest>> {
    let tree = tree_of(surface, points);
    let find = |(i, x): (usize, &Vec3)| {
        let reach = reach(i);
        let around = Aabb::from_half_extents(Vector::new(x.x, x.y, x.z), Vector::new(reach, reach, reach));
        let mut best: Option<(f64, Nearest)> = None;
        for facet in tree.intersect_aabb(&around) {
            let (feature, offset) = surface.closest(facet, points, x);
            let distance = offset.norm();
            let better = |(d, b): &(f64, Nearest)| distance < *d || (distance == *d && facet < b.facet);
            if distance <= reach && best.as_ref().is_none_or(better) {
                best = Some((distance, Nearest { facet, feature, offset }));
            }
        }
        best.map(|(_, nearest)| nearest)
    };
    centres.par_iter().enumerate().map(find).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nearest_facet_is_found_within_reach_only() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let surface = FacetMesh::new(&points, &[[0, 1, 2], [0, 2, 3]]).unwrap();
        let centres = [Vec3::new(0.7, 0.2, 0.3), Vec3::new(0.2, 0.7, -0.3), Vec3::new(0.5, 0.5, 0.1), Vec3::z()];
        let found = nearest_facets(&surface, &points, &centres, |_| 0.4);
        assert_eq!(found[0].unwrap().facet, 0);
        assert_eq!(found[1].unwrap().offset, Vec3::z() * 0.3);
        // On the common edge the first facet counts.
        assert_eq!(found[2].unwrap().facet, 0);
        assert_eq!(found[3], None);
    }
}
