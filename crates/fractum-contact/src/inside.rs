//! Centres that are within a body whose facets look outward.

use fractum_math::{Vec3, angle_between};

use crate::foot::Foot;
use crate::surface::{FacetMesh, Feature};

/// Distance over the longest edge below which the direction to the closest place is lost in rounding.
const ON_THE_SURFACE: f64 = 1e-9;

/// Cosine of the angle between the normals of two lines that face each other, up to which both may have turned beside what bodies that do not
/// deform allow.
const FACES: f64 = 0.7;
/// How far beside the end of a line a point still meets it, over the depth to which points are pushed out.
const BESIDE: f64 = 0.1;

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
    let (foot, is_within) = closest_foot(surface, points, candidates, centre, depth)?;
    is_within.then_some(foot)
}

/// The same for a point of a plane body, which meets lines that one of its own faces.
///
/// The last point of a body that ends flush with another one lies on a side of it, and would be pushed out there. Its own lines do not face
/// that side: it meets the line that they face, also a little beside its end.
///
/// - `own`: unit normals out of the lines before and after the point, counter-clockwise around its body
/// - returns also whether the body is within `depth` of the point, on either side
pub(crate) fn foot_of_corner(
    surface: &FacetMesh,
    points: &[Vec3],
    candidates: &[u32],
    centre: &Vec3,
    depth: f64,
    own: &[Vec3; 2],
) -> (Option<Foot>, bool) {
    let beside = BESIDE * depth;
    let Some((foot, is_within)) = closest_foot(surface, points, candidates, centre, depth) else {
        return (None, false);
    };
    if faces(own, &foot.normal) {
        return (is_within.then_some(foot), true);
    }
    if foot.distance > beside {
        return (None, true);
    }
    let mut nearest: Option<Foot> = None;
    for &facet in candidates {
        let &[a, b] = surface.corners(facet) else { continue };
        let [a, b] = [a, b].map(|end| points[end as usize]);
        let (way, normal) = (b - a, -surface.normal(facet, points));
        let (length, along) = (way.norm(), (centre - a).dot(&way) / way.norm());
        let below = (centre - a).dot(&normal);
        let meets = below >= 0.0 && below < depth && along >= -beside && along <= length + beside;
        if meets && nearest.is_none_or(|known| below < -known.distance) && faces(own, &normal) {
            nearest = Some(Foot::contact(facet, facet, -normal * below, normal, -below));
        }
    }
    (nearest, true)
}

/// Whether one of the lines at a corner faces the ground, whose inward normal this is, or the corner itself does, between both.
fn faces([before, after]: &[Vec3; 2], normal: &Vec3) -> bool {
    let turn = |a: &Vec3, b: &Vec3| a.x * b.y - a.y * b.x;
    let between =
        turn(before, normal) >= 0.0 && turn(normal, after) >= 0.0 && normal.dot(before) + normal.dot(after) > 0.0;
    between || normal.dot(before) > FACES || normal.dot(after) > FACES
}

/// The closest place within `depth` [m] as a foot, whose distance is negative within the body, and whether it is within; none on an open border.
fn closest_foot(
    surface: &FacetMesh,
    points: &[Vec3],
    candidates: &[u32],
    centre: &Vec3,
    depth: f64,
) -> Option<(Foot, bool)> {
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
    let is_within = offset.dot(&outward) >= 0.0;
    let distance = if is_within { -square.sqrt() } else { square.sqrt() };
    let corners = surface.corners(facet);
    let edge = (points[corners[1] as usize] - points[corners[0] as usize]).norm();
    let normal = if distance.abs() > ON_THE_SURFACE * edge { offset / distance } else { -outward.normalize() };
    Some((Foot::contact(feature, facet, offset, normal, distance), is_within))
}

/// Direction out of the body at a feature.
fn outward(surface: &FacetMesh, points: &[Vec3], candidates: &[u32], feature: u32) -> Vec3 {
    let around = candidates.iter().copied().filter(|&facet| surface.touches(facet, feature));
    let mut sum = Vec3::zeros();
    for facet in around {
        let (corners, normal) = (surface.corners(facet), surface.normal(facet, points));
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

    #[test]
    fn a_corner_meets_the_line_that_it_faces_also_a_little_beside_its_end() {
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0));
        let square = FacetMesh::new(&points, &[[0, 1], [1, 2], [2, 3], [3, 0]]).unwrap();
        let all = [0, 1, 2, 3];
        // The upper right corner of a body on the left.
        let flush = |x: f64, y: f64| {
            foot_of_corner(&square, &points, &all, &Vec3::new(x, y, 0.0), 0.5, &[Vec3::x(), Vec3::y()]).0
        };
        for y in [0.999, 1.0, 1.04] {
            let foot = flush(0.02, y).unwrap();
            assert_eq!((foot.facet, foot.feature, foot.normal), (3, 3, Vec3::x()));
            assert!((foot.distance + 0.02).abs() < 1e-15 && (foot.offset + Vec3::x() * 0.02).norm() < 1e-15);
        }
        assert!(flush(0.02, 1.06).is_none() && flush(-0.02, 1.0).is_none());
        // One that comes from below meets the lower side, and a tip that comes along the diagonal the nearer one of both.
        let meets = |x: f64, y: f64, own: [Vec3; 2]| {
            foot_of_corner(&square, &points, &all, &Vec3::new(x, y, 0.0), 0.5, &own).0.map(|foot| foot.facet)
        };
        assert_eq!(meets(0.02, 0.03, [Vec3::y(), -Vec3::x()]), Some(0));
        assert_eq!(meets(0.02, 0.03, [Vec3::x(), Vec3::y()]), Some(3));
        assert_eq!(meets(0.03, 0.02, [Vec3::x(), Vec3::y()]), Some(0));
        assert_eq!(meets(-0.01, -0.01, [Vec3::x(), Vec3::y()]), None);
    }
}
