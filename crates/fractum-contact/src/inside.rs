//! Centres that are within a body whose facets look outward.

use fractum_math::{Vec3, angle_between};

use crate::foot::Foot;
use crate::surface::{FacetMesh, Feature, area_vector};

/// Distance over the longest edge below which the direction to the closest place is lost in rounding.
const ON_THE_SURFACE: f64 = 1e-9;

/// The foot of a centre that lies within the body, no deeper than `depth` [m]; none for one outside.
///
/// The closest place decides: a centre is within if it lies behind the normal there - on an edge the mean of both facets, at
/// a point that of all around it, weighted by their angles (Baerentzen and Aanaes 2005).
pub(crate) fn foot_from_inside(
    surface: &FacetMesh,
    points: &[Vec3],
    candidates: &[u32],
    centre: &Vec3,
    depth: f64,
) -> Option<Foot> {
    let mut nearest: Option<(f64, u32, u32, Vec3)> = None;
    for &facet in candidates {
        let (feature, offset) = surface.closest(facet, points, centre);
        let square = offset.norm_squared();
        if square < depth * depth && nearest.is_none_or(|(least, ..)| square < least) {
            nearest = Some((square, facet, feature, offset));
        }
    }
    let (square, facet, feature, offset) = nearest?;
    if surface.is_open_at(feature, candidates) {
        return None;
    }
    let outward = outward(surface, points, candidates, feature);
    if offset.dot(&outward) < 0.0 {
        return None;
    }
    let distance = square.sqrt();
    let corners = surface.corners(facet);
    let edge = (points[corners[1] as usize] - points[corners[0] as usize]).norm();
    let normal = if distance > ON_THE_SURFACE * edge { -offset / distance } else { -outward.normalize() };
    Some(Foot::contact(feature, facet, offset, normal, -distance))
}

/// Direction out of the body at a feature.
fn outward(surface: &FacetMesh, points: &[Vec3], candidates: &[u32], feature: u32) -> Vec3 {
    let around = candidates.iter().copied().filter(|&facet| surface.touches(facet, feature));
    let mut sum = Vec3::zeros();
    for facet in around {
        let corners = surface.corners(facet);
        let normal = area_vector(corners, points).normalize();
        let angle = match surface.feature(feature) {
            Feature::Point(point) => corners.iter().position(|&c| c == point).map_or(0.0, |k| {
                let count = corners.len();
                let at = points[point as usize];
                let next = points[corners[(k + 1) % count] as usize] - at;
                angle_between(&next, &(points[corners[(k + count - 1) % count] as usize] - at))
            }),
            _ => 1.0,
        };
        sum += normal * angle;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube of side 2 about the origin, cut into triangles.
    fn cube() -> (Vec<Vec3>, FacetMesh) {
        let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
        let points: Vec<Vec3> = (0..8).map(|k| Vec3::new(sign(k & 1), sign(k >> 1 & 1), sign(k >> 2 & 1))).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let facets: Vec<[u32; 3]> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        let mesh = FacetMesh::new(&points, &facets).unwrap();
        (points, mesh)
    }

    #[test]
    fn a_point_is_within_a_cube_where_it_is_and_nowhere_else() {
        let (points, mesh) = cube();
        let all: Vec<u32> = (0..mesh.len() as u32).collect();
        let steps = [-1.3, -0.95, -0.4, 0.0, 0.61, 0.9, 1.0, 1.2];
        for x in steps {
            for y in steps {
                for z in steps {
                    let centre = Vec3::new(x, y, z);
                    let found = foot_from_inside(&mesh, &points, &all, &centre, 3.0);
                    let size = centre.amax();
                    assert_eq!(found.is_some(), size <= 1.0, "{centre}");
                    if let Some(foot) = found {
                        assert!((foot.distance - (size - 1.0)).abs() < 1e-12, "{centre} {}", foot.distance);
                        assert!(
                            (centre + foot.offset).amax() - 1.0 < 1e-12 && (foot.normal.norm() - 1.0).abs() < 1e-12
                        );
                    }
                    assert!(foot_from_inside(&mesh, &points, &all, &centre, 0.04).is_none() || size > 0.95);
                }
            }
        }
    }

    #[test]
    fn behind_a_sheet_is_within_but_beside_it_is_not() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let sheet = FacetMesh::new(&points, &[[0, 1, 2], [0, 2, 3]]).unwrap();
        let within = |x: f64, z: f64| foot_from_inside(&sheet, &points, &[0, 1], &Vec3::new(x, 0.5, z), 0.5).is_some();
        assert!(within(0.5, -0.1) && within(0.4, -0.1) && !within(0.5, 0.1) && !within(1.1, -0.1));
    }
}
