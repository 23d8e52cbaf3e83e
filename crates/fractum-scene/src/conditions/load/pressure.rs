use std::fmt;

use fractum_math::Vec3;

use crate::conditions::Points;
use crate::time_function::TimeFunction;

/// Pressure on facets, along their present normals [Pa]; positive pushes into the body.
#[derive(Clone)]
pub struct Pressure {
    /// Points of outward facets; an edge in the plane repeats its second one.
    pub facets: Vec<[u32; 3]>,
    /// Thickness for edges in the plane [m]; 0 for triangles.
    pub thickness: f64,
    /// Pressure over time and the reference centre of the facet.
    pub value: TimeFunction,
}

impl Pressure {
    pub(super) fn apply(&self, points: &impl Points, time: f64, forces: &mut Vec<(u32, Vec3)>) {
        for facet in &self.facets {
            push_facet(points, facet, self.thickness, |centre| (self.value)(time, centre), forces);
        }
    }
}

/// A third of p times the area vector of a facet on each of its corners, half on each end of a plane edge.
///
/// - `pressure`: at the reference centre of the facet [Pa]
pub(super) fn push_facet(
    points: &impl Points,
    facet: &[u32; 3],
    thickness: f64,
    pressure: impl Fn(&Vec3) -> f64,
    forces: &mut Vec<(u32, Vec3)>,
) {
    let [a, b, c] = facet.map(|n| n as usize);
    let p = [a, b, c].map(|n| points.position(n));
    if thickness > 0.0 {
        let centre = (points.reference(a) + points.reference(b)) * 0.5;
        let along = p[1] - p[0];
        let area = Vec3::new(along.y, -along.x, 0.0) * thickness;
        let force = area * (-0.5 * pressure(&centre));
        forces.extend([(facet[0], force), (facet[1], force)]);
    } else {
        let centre = (points.reference(a) + points.reference(b) + points.reference(c)) / 3.0;
        let area = (p[1] - p[0]).cross(&(p[2] - p[0])) * 0.5;
        let force = area * (-pressure(&centre) / 3.0);
        forces.extend(facet.map(|n| (n, force)));
    }
}

impl fmt::Debug for Pressure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Pressure({} facets)", self.facets.len())
    }
}
