//! Facets and how they hang together.

mod closest;
mod weights;

use fractum_math::{Ragged, Vec3, numbered_parts};

use crate::SurfaceError;
use closest::area_vector;
pub(crate) use closest::closest_on_segment;
use closest::{Place, closest_on_line, closest_on_polygon, closest_on_triangle};

/// Area of a facet below which it is degenerate, over the square of its longest edge.
const DEGENERATE: f64 = 1e-10;
/// Distance of a corner from the plane of its facet that still counts as planar, over the longest edge.
const PLANAR: f64 = 1e-6;

/// The facets of one body - triangles, quads, planar convex polygons - with their edges; or the lines around a plane body, which meet at points: a line is
/// a facet then, and each of its ends an edge from a point to itself.
///
/// It knows how facets share edges and points, not where the points are: those may move. A *feature* is a facet, an
/// edge or a point; features are numbered in this order: first all facets, then all edges, then all points.
#[derive(Clone, Debug, PartialEq)]
pub struct FacetMesh {
    facets: Ragged,
    /// Edge from each corner of each facet to the next.
    facet_edges: Vec<u32>,
    edges: Vec<[u32; 2]>,
    /// Facets at each edge; the second is that of an open edge again.
    edge_facets: Vec<[u32; 2]>,
    points: u32,
    /// Connected part of each facet.
    part: Vec<u32>,
    parts: u32,
    triangles: bool,
    /// Whether each facet has gone; empty as long as all are there.
    gone: Vec<bool>,
}

/// What a feature number stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// A facet.
    Facet(u32),
    /// An edge.
    Edge(u32),
    /// A point.
    Point(u32),
}

impl FacetMesh {
    /// Checks facets and finds their edges.
    ///
    /// - `points` [m]: coordinates at the start
    /// - `facets`: corners of each in order; triangles, quads or planar convex polygons, or both ends of lines
    ///
    /// # Errors
    /// Missing or non-finite points, degenerate, warped or concave facets, edges with more than two facets.
    pub fn new<F: AsRef<[u32]>>(points: &[Vec3], facets: &[F]) -> Result<Self, SurfaceError> {
        if facets.is_empty() {
            return Err(SurfaceError::Empty);
        }
        for (facet, corners) in facets.iter().enumerate() {
            check_facet(points, facet, corners.as_ref())?;
        }
        // (edge, facet, place of its first corner), sorted by edge: those of one edge lie side by side.
        let mut sides: Vec<([u32; 2], u32, u32)> = Vec::new();
        let mut place = 0;
        for (facet, corners) in facets.iter().enumerate() {
            let corners = corners.as_ref();
            for k in 0..corners.len() {
                let next = if corners.len() == 2 { k } else { (k + 1) % corners.len() };
                let (a, b) = (corners[k], corners[next]);
                sides.push(([a.min(b), a.max(b)], facet as u32, place));
                place += 1;
            }
        }
        sides.sort_unstable();
        let mut facet_edges = vec![0; sides.len()];
        let (mut edges, mut edge_facets): (Vec<[u32; 2]>, Vec<[u32; 2]>) = (Vec::new(), Vec::new());
        for same in sides.chunk_by(|a, b| a.0 == b.0) {
            if same.len() > 2 {
                let at = points[same[0].0[0] as usize].into();
                return Err(SurfaceError::NonManifold { facets: same.len(), at });
            }
            for side in same {
                facet_edges[side.2 as usize] = edges.len() as u32;
            }
            edges.push(same[0].0);
            edge_facets.push([same[0].1, same[same.len() - 1].1]);
        }
        let (part, parts) = numbered_parts(facets.len(), edge_facets.iter().copied());
        Ok(FacetMesh {
            triangles: facets.iter().all(|f| f.as_ref().len() == 3),
            facets: Ragged::from_rows(facets),
            facet_edges,
            edges,
            edge_facets,
            points: points.len() as u32,
            part,
            parts,
            gone: Vec::new(),
        })
    }

    /// Asks that the surface encloses a volume.
    ///
    /// # Errors
    /// [`SurfaceError::Open`] if an edge belongs to one facet only.
    pub fn require_closed(&self, points: &[Vec3]) -> Result<(), SurfaceError> {
        let mut open = self.edges.iter().zip(&self.edge_facets).filter(|(_, f)| f[0] == f[1]);
        match open.next() {
            None => Ok(()),
            Some((edge, _)) => Err(SurfaceError::Open { open: 1 + open.count(), at: points[edge[0] as usize].into() }),
        }
    }

    /// Number of edges that belong to one facet only.
    pub fn open_edges(&self) -> usize {
        self.edge_facets.iter().filter(|[a, b]| a == b).count()
    }

    /// An edge along which both of its facets run the same way, so that they look to opposite sides; and how many there are.
    pub fn turned_over(&self) -> Option<(u32, usize)> {
        let runs = |facet: u32, [a, b]: [u32; 2]| {
            let corners = self.corners(facet);
            (0..corners.len()).any(|k| corners[k] == a && corners[(k + 1) % corners.len()] == b)
        };
        let sides = self.edges.iter().zip(&self.edge_facets).zip(0..);
        let is_turned = |(&ends, &[a, b]): (&[u32; 2], &[u32; 2])| a != b && runs(a, ends) == runs(b, ends);
        let mut turned = sides.filter(|(side, _)| is_turned(*side)).map(|(_, edge)| edge);
        turned.next().map(|first| (first, 1 + turned.count()))
    }

    /// Number of facets.
    pub fn len(&self) -> usize {
        self.facets.len()
    }

    /// Whether there are no facets; never true.
    pub fn is_empty(&self) -> bool {
        self.facets.is_empty()
    }

    /// Takes a facet out: nothing touches it any more. Those around it stay, with an open edge.
    pub fn remove(&mut self, facet: u32) {
        if self.gone.is_empty() {
            self.gone.resize(self.facets.len(), false);
        }
        self.gone[facet as usize] = true;
    }

    /// Whether a facet has been taken out.
    #[inline]
    pub fn is_gone(&self, facet: u32) -> bool {
        !self.gone.is_empty() && self.gone[facet as usize]
    }

    /// Number of parts that share no edge.
    pub fn part_count(&self) -> usize {
        self.parts as usize
    }

    /// Connected part of a facet.
    pub fn part(&self, facet: u32) -> u32 {
        self.part[facet as usize]
    }

    /// Corners of a facet in order.
    #[inline]
    pub fn corners(&self, facet: u32) -> &[u32] {
        self.facets.row(facet as usize)
    }

    /// Ends of an edge.
    pub fn edge(&self, edge: u32) -> [u32; 2] {
        self.edges[edge as usize]
    }

    /// Number of edges.
    pub fn edge_count(&self) -> usize {
        self.edges.len()
    }

    /// Facets at an edge; the second is the first again at an open one.
    pub fn sides(&self, edge: u32) -> [u32; 2] {
        self.edge_facets[edge as usize]
    }

    /// What a feature number stands for.
    pub fn feature(&self, number: u32) -> Feature {
        let (facets, edges) = (self.facets.len() as u32, self.edges.len() as u32);
        if number < facets {
            Feature::Facet(number)
        } else if number < facets + edges {
            Feature::Edge(number - facets)
        } else {
            Feature::Point(number - facets - edges)
        }
    }

    /// Feature number of an edge.
    pub(crate) fn edge_feature(&self, edge: u32) -> u32 {
        self.facets.len() as u32 + edge
    }

    /// Feature number of a point.
    pub(crate) fn point_feature(&self, point: u32) -> u32 {
        (self.facets.len() + self.edges.len()) as u32 + point
    }

    /// Unit normal of a facet: outward where its corners run counter-clockwise seen from outside, to the right of the way along a line.
    pub(crate) fn normal(&self, facet: u32, points: &[Vec3]) -> Vec3 {
        let corners = self.corners(facet);
        if let &[a, b] = corners {
            let way = points[b as usize] - points[a as usize];
            return Vec3::new(way.y, -way.x, 0.0).normalize();
        }
        area_vector(corners, points).normalize()
    }

    /// Closest place of a facet to `x`: its feature and the vector from `x` to it.
    #[inline]
    pub(crate) fn closest(&self, facet: u32, points: &[Vec3], x: &Vec3) -> (u32, Vec3) {
        let corners = self.corners(facet);
        let (place, offset) = if let &[a, b] = corners {
            let [a, b] = [a, b].map(|end| &points[end as usize]);
            closest_on_line(x, a, b)
        } else if self.triangles {
            closest_on_triangle(x, [corners[0], corners[1], corners[2]].map(|c| &points[c as usize]))
        } else {
            closest_on_polygon(x, corners, points)
        };
        let number = match place {
            Place::Inside => facet,
            Place::Side(k) => self.edge_feature(self.facet_edges[self.facets.offset(facet as usize) + k]),
            Place::Corner(k) => self.point_feature(corners[k]),
        };
        (number, offset)
    }

    /// Edges of a facet with the facets beyond them; that beyond an open edge is the facet itself.
    pub(crate) fn neighbours(&self, facet: u32) -> impl Iterator<Item = (u32, u32)> {
        let first = self.facets.offset(facet as usize);
        self.facet_edges[first..first + self.corners(facet).len()].iter().map(move |&edge| {
            let [a, b] = self.edge_facets[edge as usize];
            (edge, if a == facet { b } else { a })
        })
    }

    /// Whether a feature lies on the border of what is left of the surface.
    ///
    /// - `candidates`: facets near the feature, all of those around it among them
    pub(crate) fn is_open_at(&self, feature: u32, candidates: &[u32]) -> bool {
        let open = |edge: u32| {
            let [a, b] = self.edge_facets[edge as usize];
            a == b || self.is_gone(a) || self.is_gone(b)
        };
        match self.feature(feature) {
            Feature::Facet(_) => false,
            Feature::Edge(edge) => open(edge),
            Feature::Point(point) => candidates
                .iter()
                .filter(|&&facet| self.corners(facet).contains(&point))
                .any(|&facet| self.neighbours(facet).any(|(edge, _)| self.edge(edge).contains(&point) && open(edge))),
        }
    }

    /// Whether a facet has an edge or a point (a feature number) on its border.
    pub(crate) fn touches(&self, facet: u32, feature: u32) -> bool {
        match self.feature(feature) {
            Feature::Facet(other) => other == facet,
            Feature::Edge(edge) => self.edge_facets[edge as usize].contains(&facet),
            Feature::Point(point) => self.corners(facet).contains(&point),
        }
    }
}

fn check_facet(points: &[Vec3], facet: usize, corners: &[u32]) -> Result<(), SurfaceError> {
    if let Some(&point) = corners.iter().find(|&&c| c as usize >= points.len()) {
        return Err(SurfaceError::MissingPoint { facet, point, points: points.len() });
    }
    let p = |k: usize| points[corners[k % corners.len()] as usize];
    if let Some(k) = (0..corners.len()).find(|&k| !p(k).iter().all(|c| c.is_finite())) {
        return Err(SurfaceError::NotFinite { point: corners[k], at: p(k).into() });
    }
    let at = corners.first().map_or([f64::NAN; 3], |_| p(0).into());
    let longest = (0..corners.len()).map(|k| (p(k + 1) - p(k)).norm()).fold(0.0, f64::max);
    let area_vector = (1..corners.len().max(2) - 1).map(|k| (p(k) - p(0)).cross(&(p(k + 1) - p(0))) * 0.5);
    let area_vector: Vec3 = area_vector.sum();
    let area = area_vector.norm();
    let repeated = (0..corners.len()).any(|k| corners[..k].contains(&corners[k]));
    if corners.len() == 2 && !repeated && longest > 0.0 {
        return Ok(());
    }
    if corners.len() < 3 || repeated || area <= DEGENERATE * longest * longest {
        return Err(SurfaceError::Degenerate { facet, at, area, longest });
    }
    if corners.len() > 3 {
        let normal = area_vector / area;
        let off = (1..corners.len()).map(|k| (p(k) - p(0)).dot(&normal).abs()).fold(0.0, f64::max);
        if off > PLANAR * longest {
            return Err(SurfaceError::NotPlanar { facet, at, off });
        }
        let turn = |k: usize| (p(k + 1) - p(k)).cross(&(p(k + 2) - p(k + 1))).dot(&normal);
        if (0..corners.len()).any(|k| turn(k) < -DEGENERATE * longest * longest) {
            return Err(SurfaceError::NotConvex { facet, at });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vec3> {
        [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec()
    }

    #[test]
    fn bad_facets_are_named() {
        let points = square();
        assert_eq!(FacetMesh::new::<[u32; 3]>(&points, &[]), Err(SurfaceError::Empty));
        assert!(matches!(
            FacetMesh::new(&points, &[[0, 1, 9]]),
            Err(SurfaceError::MissingPoint { facet: 0, point: 9, points: 4 })
        ));
        assert!(matches!(FacetMesh::new(&points, &[[0, 1, 1]]), Err(SurfaceError::Degenerate { .. })));
        assert!(matches!(FacetMesh::new(&points, &[[0, 0]]), Err(SurfaceError::Degenerate { .. })));
        let line = [Vec3::zeros(), Vec3::x(), Vec3::x() * 2.0];
        assert!(matches!(FacetMesh::new(&line, &[[0, 1, 2]]), Err(SurfaceError::Degenerate { .. })));
        let mut warped = points.clone();
        warped[2].z = 0.1;
        assert!(matches!(FacetMesh::new(&warped, &[[0, 1, 2, 3]]), Err(SurfaceError::NotPlanar { .. })));
        let mut dart = points.clone();
        dart[2] = Vec3::new(0.2, 0.2, 0.0);
        assert!(matches!(FacetMesh::new(&dart, &[[0, 1, 2, 3]]), Err(SurfaceError::NotConvex { .. })));
        let mut broken = points.clone();
        broken[1].y = f64::NAN;
        assert!(matches!(FacetMesh::new(&broken, &[[0, 1, 2]]), Err(SurfaceError::NotFinite { point: 1, .. })));
    }

    #[test]
    fn fins_and_holes_are_found() {
        let mut points = square();
        points.push(Vec3::new(0.5, 0.5, 1.0));
        let fin = FacetMesh::new(&points, &[[0, 1, 2], [0, 2, 3], [0, 2, 4]]);
        assert!(matches!(fin, Err(SurfaceError::NonManifold { facets: 3, .. })));
        let roof = FacetMesh::new(&points, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]).unwrap();
        assert!(matches!(roof.require_closed(&points), Err(SurfaceError::Open { open: 4, .. })));
        assert_eq!((roof.open_edges(), roof.turned_over()), (4, None));
        let turned = FacetMesh::new(&points, &[[0, 1, 4], [2, 1, 4], [2, 3, 4], [3, 0, 4]]).unwrap();
        assert_eq!(turned.turned_over().map(|(edge, count)| (turned.edge(edge), count)), Some(([1, 4], 2)));
        let closed: [&[u32]; 5] = [&[0, 1, 4], &[1, 2, 4], &[2, 3, 4], &[3, 0, 4], &[3, 2, 1, 0]];
        let pyramid = FacetMesh::new(&points, &closed).unwrap();
        assert_eq!(pyramid.require_closed(&points), Ok(()));
        assert_eq!(pyramid.part_count(), 1);
    }

    #[test]
    fn parts_that_share_no_edge_are_told_apart() {
        let points: Vec<Vec3> = (0..6).map(|i| Vec3::new(i as f64, (i % 2) as f64, 0.0)).collect();
        let surface = FacetMesh::new(&points, &[[0, 1, 2], [3, 4, 5]]).unwrap();
        assert_eq!((surface.part_count(), surface.part(0), surface.part(1)), (2, 0, 1));
    }
}
