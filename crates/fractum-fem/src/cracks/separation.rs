//! How much of a solid has separated, and into how many cracks: from the faces that removal has opened, without load.
//!
//! A crack has two faces, so its area is half of theirs. Faces follow the sides of elements, which makes a straight crack
//! across an irregular mesh rougher than it is; each facet therefore counts with its projection on the mean plane of the
//! facets around it. A zone in which every element is gone counts with half of its rim.

use fractum_math::{Vec3, numbered_parts};

use crate::body::facet_area;
use crate::cracks::crack_surface::{CrackFacet, CrackSurface};
use crate::solid::Solid;

/// Times the mean of the normals goes on to the next neighbours: a reach of about three facets, within which a mesh is
/// rough and a crack is not curved.
const PASSES: usize = 4;

/// Cosine below which neighbours are the two faces of one crack, as they are at its tip.
pub(crate) const OTHER_FACE: f64 = -0.5;

/// An element that a crack has cut through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparatedElement {
    /// Body it belonged to.
    pub body: usize,
    /// Its number there.
    pub element: u32,
    /// Its middle without load [m].
    pub middle: Vec3,
}

/// A facet that faces a crack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeparatedFacet {
    /// Body of the removed element before it.
    pub body: usize,
    /// Removed element before it.
    pub removed: u32,
    /// Its share of the area of the crack without load, of which it is one of two faces [m²].
    pub area: f64,
}

/// What has separated.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Separation {
    /// Removed elements, body by body in their order.
    pub elements: Vec<SeparatedElement>,
    /// Facets that their removal has exposed.
    pub facets: Vec<SeparatedFacet>,
}

impl Separation {
    /// What has separated so far.
    pub fn of(solid: &Solid) -> Self {
        let mut elements = Vec::new();
        // A body that is gone as a whole has no cracks.
        for body in (0..solid.body_count()).filter(|&body| solid.alive(body).contains(&true)) {
            let removed = (0u32..).zip(solid.alive(body)).filter(|(_, alive)| !**alive).map(|(element, _)| element);
            let middle = |element| solid.element_middle(body, element);
            elements.extend(removed.map(|element| SeparatedElement { body, element, middle: middle(element) }));
        }
        if elements.is_empty() {
            return Separation::default();
        }
        Separation { elements, facets: separated_facets(solid, &CrackSurface::of(solid)) }
    }
}

fn separated_facets(solid: &Solid, surface: &CrackSurface) -> Vec<SeparatedFacet> {
    let facet = |(facet, (area, _)): (&CrackFacet, (f64, Vec3))| SeparatedFacet {
        body: facet.removed.0,
        removed: facet.removed.1,
        area: 0.5 * area,
    };
    surface.facets.iter().zip(projected_facets(solid, surface)).map(facet).collect()
}

/// Area of each facet without load on the mean plane of those around it [m²], and the normal of that plane, into the crack.
pub(crate) fn projected_facets(solid: &Solid, surface: &CrackSurface) -> Vec<(f64, Vec3)> {
    let vectors: Vec<Vec3> = surface.facets.iter().map(|facet| area_without_load(solid, facet)).collect();
    let same_face = |a: &Vec3, b: &Vec3| a.dot(b) > OTHER_FACE * (a.norm_squared() * b.norm_squared()).sqrt();
    let mut mean = vectors.clone();
    for _ in 0..PASSES {
        let around = |index: usize| {
            let others = surface.neighbours.row(index).iter().map(|&other| other as usize);
            let others = others.filter(|&other| same_face(&vectors[index], &vectors[other]));
            mean[index] + others.map(|other| mean[other]).sum::<Vec3>()
        };
        mean = (0..mean.len()).map(around).collect();
    }
    let projected = |(area, mean): (&Vec3, &Vec3)| match mean.try_normalize(0.0) {
        Some(normal) => (area.dot(&normal).max(0.0), normal),
        None => (area.norm(), *mean),
    };
    vectors.iter().zip(&mean).map(projected).collect()
}

/// Area of a facet times its normal without load; of a side in the plane its length times the depth [m²].
pub(crate) fn area_without_load(solid: &Solid, facet: &CrackFacet) -> Vec3 {
    let plane = facet.nodes[1] == facet.nodes[2];
    let corners = facet.nodes.map(|node| solid.reference[node as usize]);
    facet_area(corners, solid.body(facet.body).depth().filter(|_| plane))
}

/// The crack that each of these removed elements is part of, numbered in their order, and how many cracks there are;
/// elements of one crack share nodes.
pub fn separate_cracks(solid: &Solid, elements: &[SeparatedElement]) -> (Vec<u32>, u32) {
    let corners = |of: &SeparatedElement| {
        let body = solid.body(of.body);
        body.elements[of.element as usize][..body.shape.node_count()].to_vec()
    };
    let mut ends: Vec<(u32, u32)> =
        (0..).zip(elements).flat_map(|(i, of)| corners(of).into_iter().map(move |n| (n, i))).collect();
    ends.sort_unstable();
    let links = ends.windows(2).filter(|pair| pair[0].0 == pair[1].0).map(|pair| [pair[0].1, pair[1].1]);
    numbered_parts(elements.len(), links)
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic};

    use super::*;
    use crate::body::{Body, ElementKind};
    use fractum_mesh::generate::{structured_box, structured_rectangle};

    const SIDE: f64 = 0.2;
    const THICKNESS: f64 = 0.3;

    /// A solid torn along planes: nodes beyond each one, y > offset + slope x within the limits of x, move by 5 mm.
    fn torn(shape: ElementKind, nodes: Vec<Vec3>, elements: Vec<[u32; 4]>, beyond: impl Fn(&Vec3) -> f64) -> Solid {
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let law = DamageLaw::rankine(3e6, 100.0);
        let mut body = Body::new("bar", shape, elements, elastic).smoothed().with_damage(law);
        body.thickness = THICKNESS;
        let mut solid = Solid::new(nodes, vec![body]).unwrap();
        for (u, p) in solid.displacement.iter_mut().zip(&solid.reference) {
            u.y = beyond(p);
        }
        solid.update_internal_forces(0.0, false);
        crate::removal::remove_cut_elements(&mut solid, 0.0, &mut Vec::new());
        solid
    }

    fn area(solid: &Solid) -> f64 {
        Separation::of(solid).facets.iter().map(|facet| facet.area).sum()
    }

    /// Moves inner nodes by up to half of the reach each way, always the same.
    fn jittered(mut nodes: Vec<Vec3>, sides: [f64; 3], reach: f64) -> Vec<Vec3> {
        let mut seed = 1u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        for node in &mut nodes {
            for axis in 0..3 {
                let inner = sides[axis] > 0.0 && node[axis] > 1e-9 && node[axis] < sides[axis] - 1e-9;
                node[axis] += if inner { reach * random() } else { 0.0 };
            }
        }
        nodes
    }

    fn plane(jitter: bool, beyond: impl Fn(&Vec3) -> f64) -> Solid {
        let mesh = structured_rectangle([40, 40], [SIDE, SIDE], None);
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let nodes = if jitter { jittered(mesh.nodes, [SIDE, SIDE, 0.0], 0.6 * SIDE / 40.0) } else { mesh.nodes };
        torn(ElementKind::T3, nodes, elements, beyond)
    }

    #[test]
    fn a_straight_crack_has_its_length_on_any_mesh() {
        for slope in [0.0, 0.3, 0.7, -0.5] {
            let length = SIDE * f64::hypot(1.0, slope);
            let across = |p: &Vec3| if p.y > 0.5 * SIDE + slope * (p.x - 0.5 * SIDE) { 5e-3 } else { 0.0 };
            for jitter in [false, true] {
                let measured = area(&plane(jitter, across)) / THICKNESS;
                assert!((measured / length - 1.0).abs() < 0.04, "slope {slope}, {jitter}: {}", measured / length);
            }
        }
    }

    #[test]
    fn a_plane_crack_in_space_has_its_area() {
        for slope in [0.0, 0.4] {
            let mesh = structured_box([12, 12, 12], Vec3::repeat(SIDE), None);
            for jitter in [false, true] {
                let nodes = mesh.nodes.clone();
                let nodes = if jitter { jittered(nodes, [SIDE; 3], 0.3 * SIDE / 12.0) } else { nodes };
                let across = |p: &Vec3| if p.y > 0.48 * SIDE + slope * (p.x - 0.5 * SIDE) { 5e-3 } else { 0.0 };
                let solid = torn(ElementKind::T4, nodes, mesh.tetrahedra.clone(), across);
                let ratio = area(&solid) / (SIDE * SIDE * f64::hypot(1.0, slope));
                assert!((ratio - 1.0).abs() < 0.06, "slope {slope}, {jitter}: {ratio}");
            }
        }
    }

    /// Faces of few elements are rougher than their neighbours tell; the sum of their vectors is that of their rim.
    #[test]
    fn flat_faces_have_the_area_of_their_mean_plane() {
        let sides = [0.3 * SIDE, SIDE, 0.3 * SIDE];
        let mesh = structured_box([3, 10, 3], Vec3::from(sides), None);
        let nodes = jittered(mesh.nodes, sides, 0.6 * SIDE / 10.0);
        let solid = torn(ElementKind::T4, nodes, mesh.tetrahedra, |p| if p.y > 0.5 * SIDE { 5e-3 } else { 0.0 });
        let section = 100.0 * sides[0] * sides[2];
        let cost = crate::cracks::cost_of_cracks(&solid).unwrap();
        let [rough, flat] = [cost.area, cost.flat].map(|area| area / section);
        assert!(rough > flat + 0.02 && (flat - 1.0).abs() < 0.03, "{rough}, {flat}");
    }

    #[test]
    fn cracks_that_share_no_node_are_counted_apart() {
        let bands = |p: &Vec3| {
            if p.y > 0.7 * SIDE {
                1e-2
            } else if p.y > 0.3 * SIDE {
                5e-3
            } else {
                0.0
            }
        };
        let solid = plane(true, bands);
        let Separation { elements, .. } = Separation::of(&solid);
        let (part, count) = separate_cracks(&solid, &elements);
        assert_eq!(count, 2);
        assert!(elements.iter().zip(&part).all(|(of, &part)| (of.middle.y < 0.5 * SIDE) == (part == 0)));
        assert_eq!(Separation::of(&plane(false, |_| 0.0)), Separation::default());
    }
}
