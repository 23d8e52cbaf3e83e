//! Size and shape of simplices.

use fractum_math::elementary::atan2;
use fractum_math::{CHUNK, Vec3};
use rayon::prelude::*;

use crate::topology::{TETRAHEDRON_EDGES, TETRAHEDRON_FACETS};

/// Signed volume of a tetrahedron, (b − a) · ((c − a) × (d − a)) / 6. Positive where a, b, c turn counter-clockwise
/// seen from d, as origin, x, y, z do.
#[inline]
pub fn signed_volume([a, b, c, d]: [Vec3; 4]) -> f64 {
    (b - a).dot(&(c - a).cross(&(d - a))) / 6.0
}

/// Area of a triangle times its unit normal, (b − a) × (c − a) / 2; its z is the signed area in the xy-plane.
#[inline]
pub fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    0.5 * (b - a).cross(&(c - a))
}

/// Area vectors of the facets of a tetrahedron, facet k opposite node k, outward for positive volume.
#[inline]
fn facet_areas(corners: [Vec3; 4]) -> [Vec3; 4] {
    TETRAHEDRON_FACETS.map(|facet| area_vector(facet.map(|i| corners[i])))
}

/// Size and shape of one triangle or tetrahedron.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Signed area (in the xy-plane; without sign out of it) or signed volume.
    pub size: f64,
    /// Shortest altitude: distance of a node from the side or facet opposite.
    pub shortest_altitude: f64,
    /// Radius of the inscribed over that of the circumscribed circle or sphere, times 2 or 3: 1 for the regular
    /// shape, 0 for a flat one.
    pub radius_ratio: f64,
    /// Smallest angle at a corner, or dihedral angle at an edge, in radians.
    pub smallest_angle: f64,
    /// Largest such angle, in radians.
    pub largest_angle: f64,
}

/// Size and shape of a tetrahedron.
///
/// Altitude 3 V / A; radius ratio 108 V² / (ΣA · |a²(b×c) + b²(c×a) + c²(a×b)|) with the edges a, b, c of one corner.
pub fn tetrahedron(corners: [Vec3; 4]) -> Shape {
    let size = signed_volume(corners);
    let volume = size.abs();
    let areas = facet_areas(corners);
    let norms = areas.map(|area| area.norm());
    let [a, b, c] = [1, 2, 3].map(|i| corners[i] - corners[0]);
    let circum = a.norm_squared() * b.cross(&c) + b.norm_squared() * c.cross(&a) + c.norm_squared() * a.cross(&b);
    // the edge between two nodes lies between the facets opposite the other two
    let cosines = TETRAHEDRON_EDGES.map(|[i, j]| -areas[i].dot(&areas[j]) / (norms[i] * norms[j]));
    let angle = |extreme: f64| {
        let edge = cosines.iter().position(|&cosine| cosine == extreme).unwrap_or(0);
        let [i, j] = TETRAHEDRON_EDGES[edge];
        atan2(areas[i].cross(&areas[j]).norm(), -areas[i].dot(&areas[j])) // accurate near 0 and π too
    };
    Shape {
        size,
        shortest_altitude: ratio(3.0 * volume, norms.into_iter().fold(0.0, f64::max)),
        radius_ratio: ratio(108.0 * volume * volume, norms.iter().sum::<f64>() * circum.norm()),
        smallest_angle: angle(cosines.into_iter().fold(-1.0, f64::max)),
        largest_angle: angle(cosines.into_iter().fold(1.0, f64::min)),
    }
}

/// Size and shape of a triangle.
///
/// Altitude 2 A / l; radius ratio 16 A² / (Σl · l₁ l₂ l₃).
pub fn triangle(corners: [Vec3; 3]) -> Shape {
    let vector = area_vector(corners);
    let area = vector.norm();
    let sides = [[1, 2], [2, 0], [0, 1]].map(|[i, j]: [usize; 2]| corners[j] - corners[i]);
    let lengths = sides.map(|side| side.norm());
    let angles = [[1, 2], [2, 0], [0, 1]].map(|[i, j]: [usize; 2]| atan2(2.0 * area, -sides[i].dot(&sides[j])));
    Shape {
        size: if vector.x == 0.0 && vector.y == 0.0 { vector.z } else { area },
        shortest_altitude: ratio(2.0 * area, lengths.into_iter().fold(0.0, f64::max)),
        radius_ratio: ratio(16.0 * area * area, lengths.iter().sum::<f64>() * lengths.iter().product::<f64>()),
        smallest_angle: angles.into_iter().fold(f64::INFINITY, f64::min),
        largest_angle: angles.into_iter().fold(0.0, f64::max),
    }
}

/// Zero where the denominator is: a flat element has no altitude.
fn ratio(numerator: f64, denominator: f64) -> f64 {
    if denominator > 0.0 { numerator / denominator } else { 0.0 }
}

/// A value and the element that has it; of equals, the first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// Index of the element.
    pub element: u32,
}

/// The elements of a mesh in a few numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Sum of the signed areas or volumes.
    pub total_size: f64,
    /// Smallest signed area or volume.
    pub smallest: Extreme,
    /// Largest signed area or volume.
    pub largest: Extreme,
    /// Shortest altitude of all; it governs the stable time step.
    pub shortest_altitude: Extreme,
    /// Mean of the radius ratios.
    pub mean_radius_ratio: f64,
    /// Lowest radius ratio.
    pub worst_radius_ratio: Extreme,
    /// Smallest angle, in radians.
    pub smallest_angle: Extreme,
    /// Largest angle, in radians.
    pub largest_angle: Extreme,
}

/// Lengths of edges, in the unit of the nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lengths {
    /// The shortest.
    pub shortest: f64,
    /// The mean.
    pub mean: f64,
    /// The longest.
    pub longest: f64,
}

/// Lengths of edges between pairs of nodes; none for an empty set.
///
/// # Panics
/// If an edge names a node that is not there.
pub fn lengths(nodes: &[Vec3], edges: &[[u32; 2]]) -> Option<Lengths> {
    let length = |[a, b]: &[u32; 2]| (nodes[*b as usize] - nodes[*a as usize]).norm();
    let extreme = |of: fn(f64, f64) -> f64| edges.iter().map(length).reduce(of);
    let mean = edges.iter().map(length).sum::<f64>() / edges.len() as f64;
    Some(Lengths { shortest: extreme(f64::min)?, mean, longest: extreme(f64::max)? })
}

/// Summarizes tetrahedra; none for an empty set. The same bits for any number of threads.
///
/// # Panics
/// If an element names a node that is not there.
pub fn summarize_tetrahedra(nodes: &[Vec3], elements: &[[u32; 4]]) -> Option<Summary> {
    summarize(elements, |element| tetrahedron(element.map(|node| nodes[node as usize])))
}

/// Summarizes triangles; none for an empty set. The same bits for any number of threads.
///
/// # Panics
/// If an element names a node that is not there.
pub fn summarize_triangles(nodes: &[Vec3], elements: &[[u32; 3]]) -> Option<Summary> {
    summarize(elements, |element| triangle(element.map(|node| nodes[node as usize])))
}

fn summarize<const N: usize>(elements: &[[u32; N]], shape: impl Fn([u32; N]) -> Shape + Sync) -> Option<Summary> {
    let chunks: Vec<Summary> = elements
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(chunk, elements)| {
            let shapes = elements.iter().zip((chunk * CHUNK) as u32..).map(|(&e, index)| Summary::of(shape(e), index));
            shapes.reduce(Summary::merge).expect("chunks are not empty")
        })
        .collect();
    let mut summary = chunks.into_iter().reduce(Summary::merge)?;
    summary.mean_radius_ratio /= elements.len() as f64;
    Some(summary)
}

impl Summary {
    /// One element; the mean is a sum until the last step.
    fn of(shape: Shape, element: u32) -> Self {
        let extreme = |value| Extreme { value, element };
        Summary {
            total_size: shape.size,
            smallest: extreme(shape.size),
            largest: extreme(shape.size),
            shortest_altitude: extreme(shape.shortest_altitude),
            mean_radius_ratio: shape.radius_ratio,
            worst_radius_ratio: extreme(shape.radius_ratio),
            smallest_angle: extreme(shape.smallest_angle),
            largest_angle: extreme(shape.largest_angle),
        }
    }

    fn merge(self, later: Self) -> Self {
        let low = |a: Extreme, b: Extreme| if b.value < a.value { b } else { a };
        let high = |a: Extreme, b: Extreme| if b.value > a.value { b } else { a };
        Summary {
            total_size: self.total_size + later.total_size,
            smallest: low(self.smallest, later.smallest),
            largest: high(self.largest, later.largest),
            shortest_altitude: low(self.shortest_altitude, later.shortest_altitude),
            mean_radius_ratio: self.mean_radius_ratio + later.mean_radius_ratio,
            worst_radius_ratio: low(self.worst_radius_ratio, later.worst_radius_ratio),
            smallest_angle: low(self.smallest_angle, later.smallest_angle),
            largest_angle: high(self.largest_angle, later.largest_angle),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{structured_box, structured_rectangle};
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_3, FRAC_PI_4, PI, SQRT_2};

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-14 * (1.0 + b.abs())
    }

    #[test]
    fn regular_shapes_have_radius_ratio_one() {
        let corners = [[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0], [1.0, -1.0, -1.0], [-1.0, -1.0, 1.0]].map(Vec3::from);
        let shape = tetrahedron(corners); // edge √8: V = a³/(6√2), h = a√(2/3), cos θ = 1/3
        assert!(close(shape.size.abs(), 8.0 / 3.0) && close(shape.radius_ratio, 1.0));
        assert!(close(shape.shortest_altitude, 4.0 / 3f64.sqrt()));
        assert!(close(shape.smallest_angle, (1.0 / 3f64).acos()) && close(shape.largest_angle, shape.smallest_angle));

        let shape = triangle([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.75f64.sqrt(), 0.0]].map(Vec3::from));
        assert!(close(shape.size, 0.75f64.sqrt() / 2.0) && close(shape.radius_ratio, 1.0));
        assert!(close(shape.shortest_altitude, 0.75f64.sqrt()));
        assert!(close(shape.smallest_angle, FRAC_PI_3) && close(shape.largest_angle, FRAC_PI_3));
    }

    #[test]
    fn corner_of_the_unit_cube_has_its_textbook_values() {
        let corners = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()];
        let shape = tetrahedron(corners); // r = 1/(3 + √3), R = √3/2
        assert!(close(shape.size, 1.0 / 6.0));
        assert!(close(shape.shortest_altitude, 1.0 / 3f64.sqrt()));
        assert!(close(shape.radius_ratio, 3.0 / (3.0 + 3f64.sqrt()) / (3f64.sqrt() / 2.0)));
        assert!(close(shape.largest_angle, FRAC_PI_2) && close(shape.smallest_angle, (1.0 / 3f64.sqrt()).acos()));
        assert!(close(tetrahedron([corners[1], corners[0], corners[2], corners[3]]).size, -1.0 / 6.0));
    }

    #[test]
    fn flat_shapes_have_no_altitude_and_straight_angles() {
        let shape = triangle([Vec3::zeros(), Vec3::x(), 3.0 * Vec3::x()]);
        assert_eq!((shape.size, shape.shortest_altitude, shape.radius_ratio), (0.0, 0.0, 0.0));
        assert!(close(shape.largest_angle, PI));
        let shape = tetrahedron([Vec3::zeros(); 4]);
        assert_eq!((shape.size, shape.shortest_altitude, shape.radius_ratio), (0.0, 0.0, 0.0));
    }

    #[test]
    fn summaries_of_structured_meshes_have_known_values() {
        let mesh = structured_box([20, 15, 17], Vec3::new(20.0, 15.0, 17.0), None);
        let summary = summarize_tetrahedra(&mesh.nodes, &mesh.tetrahedra).unwrap();
        assert!((summary.total_size - 5100.0).abs() < 1e-9);
        assert!(close(summary.smallest.value, 1.0 / 6.0) && close(summary.largest.value, 1.0 / 6.0));
        assert!(close(summary.shortest_altitude.value, 1.0 / SQRT_2));
        assert!(close(summary.largest_angle.value, FRAC_PI_2) && close(summary.smallest_angle.value, FRAC_PI_4));
        assert!((summary.mean_radius_ratio - summary.worst_radius_ratio.value).abs() < 1e-12);

        let mesh = structured_rectangle([3, 4], [3.0, 4.0], None);
        let summary = summarize_triangles(&mesh.nodes, &mesh.triangles).unwrap();
        assert!(close(summary.total_size, 12.0) && close(summary.shortest_altitude.value, 1.0 / SQRT_2));
        assert_eq!(summary.smallest.element, 0);
        assert!(summarize_triangles(&mesh.nodes, &[]).is_none());
    }

    #[test]
    fn lengths_of_a_structured_mesh_are_those_of_sides_and_diagonals() {
        let mesh = structured_rectangle([2, 1], [2.0, 1.0], None);
        let found = lengths(&mesh.nodes, &crate::topology::edges_of_triangles(&mesh.triangles).nodes).unwrap();
        // Seven sides and two diagonals.
        assert!(close(found.shortest, 1.0) && close(found.longest, SQRT_2), "{found:?}");
        assert!(close(found.mean, (7.0 + 2.0 * SQRT_2) / 9.0), "{found:?}");
        assert_eq!(lengths(&mesh.nodes, &[]), None);
    }

    #[test]
    fn summary_names_the_worst_element() {
        let mut mesh = structured_box([3, 3, 3], Vec3::new(1.0, 1.0, 1.0), None);
        let moved = mesh.tetrahedra[77][0] as usize;
        let target = mesh.tetrahedra[77][1..].iter().map(|&node| mesh.nodes[node as usize]).sum::<Vec3>() / 3.0;
        mesh.nodes[moved] = 0.999 * target + 0.001 * mesh.nodes[moved];
        let summary = summarize_tetrahedra(&mesh.nodes, &mesh.tetrahedra[77..78]).unwrap();
        let all = summarize_tetrahedra(&mesh.nodes, &mesh.tetrahedra).unwrap();
        assert!(all.shortest_altitude.value <= summary.shortest_altitude.value);
        let element = mesh.tetrahedra[all.shortest_altitude.element as usize];
        let shape = tetrahedron(element.map(|node| mesh.nodes[node as usize]));
        assert_eq!(shape.shortest_altitude, all.shortest_altitude.value);
    }
}
