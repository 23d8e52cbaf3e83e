use std::collections::BTreeMap;

use fractum_math::Vec3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::{TriMesh, TriMeshFlags};
use serde::{Deserialize, Serialize};

use crate::PackError;

/// Largest coordinate [m].
const FARTHEST: f64 = 1e15;

/// A closed triangulated surface with outward orientation, as a domain to be packed.
#[derive(Clone)]
pub struct ClosedSurface {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    mesh: Box<TriMesh>,
    volume: f64,
    area: f64,
}

/// The numbers of a surface, as stored in files.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfaceData {
    /// Vertices [m].
    pub points: Vec<[f64; 3]>,
    /// Vertex ids of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl std::fmt::Debug for ClosedSurface {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "ClosedSurface({} triangles, {} m³)", self.triangles.len(), self.volume)
    }
}

impl ClosedSurface {
    /// Checks that the triangles enclose a volume and orients them outward.
    ///
    /// # Errors
    /// [`PackError::OpenSurface`] with the number of open edges; [`PackError::BadSurface`] for missing points, coordinates
    /// that are no lengths of bodies, and for a surface without volume.
    pub fn new(points: &[Vec3], triangles: &[[u32; 3]]) -> Result<Self, PackError> {
        if let Some(point) = points.iter().find(|p| !p.iter().all(|c| c.abs() <= FARTHEST)) {
            return Err(PackError::BadSurface(format!("a point has coordinates {:?}", point.as_slice())));
        }
        if let Some(t) = triangles.iter().find(|t| t.iter().any(|&v| v as usize >= points.len())) {
            return Err(PackError::BadSurface(format!("triangle {t:?} names a point above {}", points.len())));
        }
        let mut edges: BTreeMap<(u32, u32), (i32, u32)> = BTreeMap::new();
        for t in triangles {
            for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
                let entry = edges.entry((a.min(b), a.max(b))).or_default();
                entry.0 += if a < b { 1 } else { -1 };
                entry.1 += 1;
            }
        }
        let mut bad = edges.iter().filter(|&(_, &(sum, count))| sum != 0 || count != 2);
        if let Some((&(a, _), _)) = bad.next() {
            return Err(PackError::OpenSurface { open: 1 + bad.count(), near: points[a as usize].into() });
        }
        let corner = |t: &[u32; 3]| t.map(|v| points[v as usize]);
        let signed: f64 = triangles.iter().map(corner).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum();
        let area: f64 = triangles.iter().map(corner).map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum();
        // Also where both are too small for a number.
        if !(area.is_finite() && signed.abs() > 1e-9 * area * area.sqrt()) {
            return Err(PackError::BadSurface(format!("it encloses {signed:.3e} m³")));
        }
        let mut triangles = triangles.to_vec();
        if signed < 0.0 {
            for t in &mut triangles {
                t.swap(1, 2);
            }
        }
        let vertices = points.iter().map(|p| Vector::new(p.x, p.y, p.z)).collect();
        let mesh = TriMesh::with_flags(vertices, triangles.clone(), TriMeshFlags::ORIENTED)
            .map_err(|error| PackError::BadSurface(error.to_string()))?;
        Ok(ClosedSurface { points: points.to_vec(), triangles, mesh: Box::new(mesh), volume: signed.abs(), area })
    }

    /// Enclosed volume [m³].
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Area [m²].
    pub fn area(&self) -> f64 {
        self.area
    }

    /// Visits the corners of its triangles [m], counter-clockwise from outside.
    pub(crate) fn visit_triangles(&self, mut visit: impl FnMut([Vec3; 3])) {
        self.triangles.iter().for_each(|corners| visit(corners.map(|corner| self.points[corner as usize])));
    }

    /// Lower and upper corner of the bounding box [m].
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let first = self.points[0];
        self.points.iter().fold((first, first), |(lower, upper), p| (lower.inf(p), upper.sup(p)))
    }

    /// Distance to the surface [m], positive inside.
    pub fn depth(&self, x: &Vec3) -> f64 {
        self.nearest(x).0
    }

    /// Distance to the surface [m], positive inside, and the unit vector that leads inward there; none on the surface itself.
    pub(crate) fn nearest(&self, x: &Vec3) -> (f64, Option<Vec3>) {
        let point = Vector::new(x.x, x.y, x.z);
        let projection = self.mesh.project_local_point(point, false);
        let d = projection.point - point;
        let out = Vec3::new(d.x, d.y, d.z);
        let depth = if projection.is_inside { out.norm() } else { -out.norm() };
        (depth, (depth != 0.0).then(|| -out / depth))
    }

    /// Triangles whose box comes within `reach` of `x`, in ascending order.
    pub(crate) fn near(&self, x: &Vec3, reach: f64, found: &mut Vec<u32>) {
        let centre = Vector::new(x.x, x.y, x.z);
        let half = Vector::new(reach, reach, reach);
        found.clear();
        found.extend(self.mesh.bvh().intersect_aabb(&Aabb::from_half_extents(centre, half)));
        found.sort_unstable();
    }

    /// Vector from the closest point of a triangle to `x`, and the triangle's outward normal.
    pub(crate) fn offset(&self, triangle: u32, x: &Vec3) -> (Vec3, Vec3) {
        let [a, b, c] = self.triangles[triangle as usize].map(|v| self.points[v as usize]);
        let normal = (b - a).cross(&(c - a)).normalize();
        (x - closest_on_triangle(x, &a, &b, &c), normal)
    }

    /// The numbers to store.
    pub fn data(&self) -> SurfaceData {
        SurfaceData { points: self.points.iter().map(|&p| p.into()).collect(), triangles: self.triangles.clone() }
    }

    /// Rebuilds a surface from stored numbers.
    ///
    /// # Errors
    /// As [`ClosedSurface::new`].
    pub fn from_data(data: &SurfaceData) -> Result<Self, PackError> {
        let points: Vec<Vec3> = data.points.iter().map(|&p| p.into()).collect();
        ClosedSurface::new(&points, &data.triangles)
    }
}

/// Closest point of a triangle (Ericson, *Real-Time Collision Detection*, 5.1.5).
fn closest_on_triangle(p: &Vec3, a: &Vec3, b: &Vec3, c: &Vec3) -> Vec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return *a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return *b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return *c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// A unit cube of 12 outward triangles, scaled.
    pub(crate) fn cube(side: f64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let corner = |i: u32| Vec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64) * side;
        let points = (0..8).map(corner).collect();
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.iter().flat_map(|q: &[u32; 4]| [[q[0], q[1], q[2]], [q[0], q[2], q[3]]]).collect();
        (points, triangles)
    }

    #[test]
    fn cube_has_its_volume_area_and_depth() {
        let (points, triangles) = cube(2.0);
        let surface = ClosedSurface::new(&points, &triangles).unwrap();
        assert!((surface.volume() - 8.0).abs() < 1e-12 && (surface.area() - 24.0).abs() < 1e-12);
        assert!((surface.depth(&Vec3::new(1.0, 0.3, 1.0)) - 0.3).abs() < 1e-12);
        assert!((surface.depth(&Vec3::new(1.0, -0.3, 1.0)) + 0.3).abs() < 1e-12);
        assert!((surface.depth(&Vec3::new(-1.0, -1.0, -1.0)) + 3f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn inward_orientation_is_turned_round() {
        let (points, mut triangles) = cube(1.0);
        triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert!(ClosedSurface::new(&points, &triangles).unwrap().depth(&Vec3::new(0.5, 0.5, 0.5)) > 0.4);
    }

    #[test]
    fn open_and_broken_surfaces_are_refused() {
        let (points, mut triangles) = cube(1.0);
        triangles.pop();
        assert!(matches!(ClosedSurface::new(&points, &triangles), Err(PackError::OpenSurface { open: 3, .. })));
        assert!(matches!(ClosedSurface::new(&points, &[[0, 1, 9]]), Err(PackError::BadSurface(_))));
        assert!(matches!(ClosedSurface::new(&points, &[]), Err(PackError::BadSurface(_))));
        let mut broken = points.clone();
        broken[0].x = f64::NAN;
        assert!(matches!(ClosedSurface::new(&broken, &cube(1.0).1), Err(PackError::BadSurface(_))));
    }
}
