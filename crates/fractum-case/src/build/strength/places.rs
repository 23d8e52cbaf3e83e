//! Where flaws lie: in the elements of a body, or on its free surface.

use fractum_fem::{ElementKind, Plane};
use fractum_math::Vec3;
use fractum_mesh::topology::TETRAHEDRON_FACETS;
use rayon::prelude::*;

use super::Edges;
use super::flaws::{Bounds, Flaw, FlawField};
use crate::model::Reference;

/// Of two axes that lie nearly as far from a facet, the earlier is taken: no plane that engineers draw is a limit.
const PREFERENCE: [f64; 3] = [1.0, 0.97, 0.94];

/// Thickness of the layer in which surface flaws are drawn, over the root of the reference area: thinner than the gap between two
/// surfaces that face the same way, whose flaws would else be the same.
const LAYER: f64 = 1.0 / 64.0;

/// Processes of flaws that weaken a body, each in elements or on facets.
pub(super) struct Places {
    /// Thickness of the layers [m].
    depth: f64,
    /// In the volume, or over the faces of a sheet.
    within: Option<FlawField>,
    /// In a layer on the outside of facets, by the axis that is nearest to their normal and its sense; flaws are moved along it.
    on_facets: Option<[FlawField; 6]>,
    /// Free facets (sides in the plane) by their nodes, ascending; empty without surface flaws.
    free: Vec<[u32; 3]>,
    /// What a measure in mesh coordinates (area in the plane, length of sides) is of the body's volume or surface.
    per_element: f64,
    per_side: f64,
}

/// A free facet or side of an element.
struct Side<'a> {
    corners: &'a [Vec3],
    /// Axis nearest to the normal, and whether the normal points along it.
    axis: usize,
    along: bool,
    /// Cosine between both.
    cosine: f64,
    /// Area of a facet, length of a side.
    measure: f64,
}

impl Places {
    pub(super) fn new(edges: &Edges<'_>, reference: Reference, boundary: &[[u32; 3]], seed: u64) -> Self {
        let body = edges.body;
        let flat = body.shape == ElementKind::T3;
        let (axes, thickness) = if flat { (2, body.thickness) } else { (3, 1.0) };
        let per_measure = 1.0 / reference.measure();
        let field =
            |salt: u64, density| FlawField::new(seed.wrapping_mul(8).wrapping_add(salt), axes, density * per_measure);
        let depth = LAYER * reference.measure().sqrt();
        match reference {
            Reference::Volume(_) => Places {
                depth,
                within: Some(field(0, thickness)),
                on_facets: None,
                free: Vec::new(),
                per_element: thickness,
                per_side: 0.0,
            },
            Reference::Area(_) => {
                // The faces of a sheet are free; in plane strain there are none.
                let faces = if flat && body.plane == Plane::Stress { 2.0 } else { 0.0 };
                let mut free: Vec<[u32; 3]> = boundary.iter().map(|nodes| sorted(*nodes)).collect();
                free.sort_unstable();
                Places {
                    depth,
                    within: (faces > 0.0).then(|| field(0, faces)),
                    on_facets: Some(std::array::from_fn(|salt| field(1 + salt as u64, thickness / depth))),
                    free,
                    per_element: faces,
                    per_side: thickness,
                }
            }
        }
    }

    /// Volume or area in which flaws can reach a point [m³], [m²].
    ///
    /// - `radius`: within which they do [m]
    pub(super) fn spot(&self, edges: &Edges<'_>, radius: f64) -> f64 {
        let disc = std::f64::consts::PI * radius * radius;
        match (edges.body.shape, &self.on_facets) {
            (ElementKind::T4, None) => 4.0 / 3.0 * disc * radius,
            (ElementKind::T4, Some(_)) => disc,
            (ElementKind::T3, _) if self.within.is_some() => self.per_element * disc,
            (ElementKind::T3, _) => self.per_side * 2.0 * radius,
        }
    }

    /// Volume or free surface of each element.
    pub(super) fn shares(&self, edges: &Edges<'_>) -> Vec<f64> {
        let share = |element| {
            let own = if self.within.is_some() { self.per_element * measure(edges, element) } else { 0.0 };
            let mut sides = 0.0;
            self.each_side(edges, element, |side| sides += side.measure);
            own + if self.on_facets.is_some() { self.per_side * sides } else { 0.0 }
        };
        (0..edges.body.elements.len()).into_par_iter().map(share).collect()
    }

    /// The flaws of each element below a level, with the element, ascending.
    pub(super) fn flaws_below(&self, edges: &Edges<'_>, level: f64) -> Vec<(u32, Flaw)> {
        let of_element = |element: usize| {
            let mut found = Vec::new();
            let corners = corners(edges, element);
            let corners = &corners[..edges.body.shape.node_count()];
            if let Some(field) = &self.within {
                field.each_below(&Bounds::of(corners), level, &mut |flaw: Flaw| {
                    if contains(corners, flaw.place) {
                        found.push((element as u32, Flaw { place: on_level(flaw.place, corners), ..flaw }));
                    }
                });
            }
            if let Some(fields) = &self.on_facets {
                self.each_side(edges, element, |side| {
                    let field = &fields[2 * side.axis + usize::from(side.along)];
                    side.flaws_below(field, level, self.depth, |flaw| found.push((element as u32, flaw)));
                });
            }
            found
        };
        (0..edges.body.elements.len()).into_par_iter().flat_map_iter(of_element).collect()
    }

    fn each_side(&self, edges: &Edges<'_>, element: usize, mut see: impl FnMut(&Side<'_>)) {
        if self.free.is_empty() {
            return;
        }
        let nodes = edges.body.elements[element];
        let at = |node: u32| edges.nodes[node as usize];
        match edges.body.shape {
            ElementKind::T4 => {
                for facet in TETRAHEDRON_FACETS.map(|facet| facet.map(|corner| nodes[corner])) {
                    if self.free.binary_search(&sorted(facet)).is_ok() {
                        let corners = facet.map(at);
                        let across = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
                        see(&Side::new(&corners, across, 0.5 * across.norm()));
                    }
                }
            }
            ElementKind::T3 => {
                for [a, b] in [[0, 1], [1, 2], [2, 0]].map(|side| side.map(|corner: usize| nodes[corner])) {
                    if self.free.binary_search(&sorted([a, b, b])).is_ok() {
                        let corners = [at(a), at(b)];
                        let along = corners[1] - corners[0];
                        see(&Side::new(&corners, Vec3::new(along.y, -along.x, 0.0), along.norm()));
                    }
                }
            }
        }
    }
}

impl<'a> Side<'a> {
    /// - `outward`: not of any length
    fn new(corners: &'a [Vec3], outward: Vec3, measure: f64) -> Self {
        let size = |axis: usize| PREFERENCE[axis] * outward[axis].abs();
        let axis = (1..3).fold(0, |best, axis| if size(axis) > size(best) { axis } else { best });
        let cosine = outward[axis].abs() / outward.norm();
        Side { corners, axis, along: outward[axis] > 0.0, cosine, measure }
    }

    /// Its flaws below a level, moved on to it.
    fn flaws_below(&self, field: &FlawField, level: f64, depth: f64, mut see: impl FnMut(Flaw)) {
        let axis = self.axis;
        let mut bounds = Bounds::of(self.corners);
        if self.along {
            bounds.high[axis] += depth;
        } else {
            bounds.low[axis] -= depth;
        }
        // A layer over a tilted facet lies over more area than it covers along the axis.
        field.each_below(&bounds, level / self.cosine, &mut |flaw: Flaw| {
            let Some(height) = self.height(flaw.place) else { return };
            let above = if self.along { flaw.place[axis] - height } else { height - flaw.place[axis] };
            if (0.0..depth).contains(&above) {
                let mut place = on_level(flaw.place, if self.corners.len() == 2 { self.corners } else { &[] });
                place[axis] = height;
                see(Flaw { place, level: flaw.level * self.cosine });
            }
        });
    }

    /// Where a line along the axis through a point meets it; none where it passes by.
    fn height(&self, point: Vec3) -> Option<f64> {
        let axis = self.axis;
        if let [a, b] = *self.corners {
            let other = 1 - axis;
            let share = (point[other] - a[other]) / (b[other] - a[other]);
            return (0.0..=1.0).contains(&share).then(|| a[axis] + share * (b[axis] - a[axis]));
        }
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let [a, b, c] = [self.corners[0], self.corners[1], self.corners[2]];
        let area = |p: Vec3, q: Vec3, r: Vec3| (q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]);
        let whole = area(a, b, c);
        let shares = [area(point, b, c), area(a, point, c), area(a, b, point)].map(|part| part / whole);
        let height = shares[0] * a[axis] + shares[1] * b[axis] + shares[2] * c[axis];
        shares.iter().all(|share| *share >= 0.0).then_some(height)
    }
}

/// The nodes of a facet, ascending; a side repeats its higher node.
fn sorted(mut nodes: [u32; 3]) -> [u32; 3] {
    if nodes[1] == nodes[2] {
        let [a, b, _] = nodes;
        return [a.min(b), a.max(b), a.max(b)];
    }
    nodes.sort_unstable();
    nodes
}

fn corners(edges: &Edges<'_>, element: usize) -> [Vec3; 4] {
    edges.body.elements[element].map(|node| edges.nodes[node as usize])
}

/// Volume of a tetrahedron, area of a triangle.
pub(super) fn measure(edges: &Edges<'_>, element: usize) -> f64 {
    let [a, b, c, d] = corners(edges, element);
    let across = (b - a).cross(&(c - a));
    match edges.body.shape {
        ElementKind::T4 => across.dot(&(d - a)).abs() / 6.0,
        ElementKind::T3 => 0.5 * across.norm(),
    }
}

/// A point of the plane at the height of a triangle in it.
fn on_level(mut place: Vec3, corners: &[Vec3]) -> Vec3 {
    if let Some(corner) = corners.first().filter(|_| corners.len() < 4) {
        place.z = corner.z;
    }
    place
}

/// Whether a point lies in a tetrahedron or in a triangle of the plane.
fn contains(corners: &[Vec3], point: Vec3) -> bool {
    let to = |corner: Vec3| corner - point;
    match *corners {
        [a, b, c] => {
            let turn = |p: Vec3, q: Vec3| to(p).x * to(q).y - to(p).y * to(q).x;
            let turns = [turn(a, b), turn(b, c), turn(c, a)];
            turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0)
        }
        [a, b, c, d] => {
            let volume = |p: Vec3, q: Vec3, r: Vec3| to(p).cross(&to(q)).dot(&to(r));
            let volumes = [volume(b, d, c), volume(a, c, d), volume(a, d, b), volume(a, b, c)];
            volumes.iter().all(|volume| *volume >= 0.0) || volumes.iter().all(|volume| *volume <= 0.0)
        }
        _ => false,
    }
}
