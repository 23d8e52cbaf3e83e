//! The surface that the removal of elements has opened.
//!
//! Nothing is kept for it: it follows from the mesh and from which elements are left, so that a solid that loses none pays
//! nothing.

use std::collections::BTreeMap;

use fractum_math::{Ragged, Vec3};

use crate::body::{ElementKind, facet_area};
use crate::solid::{BodyModel, Solid};

/// Sides of a tetrahedron as its neighbours see them, counter-clockwise from inside it: nodes, the opposite node, and an
/// edge of the side by its local number, with the node of the side that is not on it.
const SIDES_T4: [([usize; 3], usize, usize, usize); 4] =
    [([0, 1, 2], 3, 0, 2), ([0, 3, 1], 2, 0, 3), ([0, 2, 3], 1, 1, 3), ([1, 3, 2], 0, 3, 3)];

/// Sides of a triangle as its neighbours see them; a side is an edge.
const SIDES_T3: [([usize; 3], usize, usize, usize); 3] =
    [([1, 0, 0], 2, 0, 0), ([2, 1, 1], 0, 1, 1), ([0, 2, 2], 1, 2, 2)];

/// A facet of an element that is still there, exposed by the removal of the element before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackFacet {
    /// Body it belongs to.
    pub body: usize,
    /// Element behind it.
    pub element: u32,
    /// Removed element that was before it, with its body: another one where the body ends there.
    pub removed: (usize, u32),
    /// Nodes, counter-clockwise as seen from the crack; a side of a triangle repeats its second node.
    pub nodes: [u32; 3],
    /// Present centre [m].
    pub centre: Vec3,
    /// Present area; length times depth in the plane [m²].
    pub area: f64,
    /// Present unit normal, into the crack.
    pub normal: Vec3,
    /// Distance along the normal by which the far node of the removed element has moved away [m]; negative if it came nearer.
    pub opening: f64,
}

/// All facets exposed by removal.
#[derive(Clone, Debug, Default)]
pub struct CrackSurface {
    /// Body by body, in the order of the removed elements; then those at borders of bodies.
    pub facets: Vec<CrackFacet>,
    /// Facets that share an edge with each facet (an end, in the plane), ascending.
    pub neighbours: Ragged,
}

impl CrackSurface {
    /// Area of both faces together [m²].
    pub fn area(&self) -> f64 {
        self.facets.iter().map(|facet| facet.area).sum::<f64>() + 0.0
    }

    /// The surface that the removal of elements has opened, at the present displacements.
    pub fn of(solid: &Solid) -> Self {
        let (mut facets, mut borders) = (Vec::new(), BTreeMap::new());
        for (body, model) in solid.bodies.iter().enumerate() {
            for removed in (0u32..).zip(&model.alive).filter(|(_, alive)| !**alive).map(|(element, _)| element) {
                add_exposed(solid, body, removed, &mut facets, &mut borders);
            }
        }
        add_beyond_borders(solid, &mut borders, &mut facets);
        CrackSurface::new(facets)
    }

    fn new(facets: Vec<CrackFacet>) -> Self {
        // Edges with their facets; in the plane the ends of the sides.
        let mut shared: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * facets.len());
        for (index, facet) in (0..).zip(&facets) {
            let [a, b, c] = facet.nodes;
            let pairs = if b == c { vec![[a, a], [b, b]] } else { vec![[a, b], [b, c], [c, a]] };
            shared.extend(pairs.into_iter().map(|[i, j]| ([i.min(j), i.max(j)], index)));
        }
        shared.sort_unstable();
        let mut rows = vec![Vec::new(); facets.len()];
        for group in shared.chunk_by(|a, b| a.0 == b.0) {
            for &(_, one) in group {
                rows[one as usize].extend(group.iter().map(|&(_, other)| other).filter(|&other| other != one));
            }
        }
        for row in &mut rows {
            row.sort_unstable();
            row.dedup();
        }
        CrackSurface { facets, neighbours: Ragged::from_rows(&rows) }
    }
}

/// Sides of removed elements on the outside of their body, by their nodes in ascending order: body, removed element, its nodes of the side
/// and the opposite one.
type Borders = BTreeMap<[u32; 3], (usize, u32, [u32; 3], u32)>;

/// Adds the facets that the removal of one element exposes in its own body; its sides where the body ends go to `borders`.
fn add_exposed(solid: &Solid, body: usize, removed: u32, facets: &mut Vec<CrackFacet>, borders: &mut Borders) {
    let model = &solid.bodies[body];
    let Some(edges) = &model.edges else { return };
    let element = model.body.elements[removed as usize];
    for &(local, opposite, edge, third) in sides(model) {
        let around = edges.around(edges.of_element(removed)[edge]);
        let has = |e: u32| e != removed && model.body.elements[e as usize].contains(&element[third]);
        let (nodes, opposite) = (local.map(|k| element[k]), element[opposite]);
        match around.iter().copied().find(|&e| has(e)) {
            Some(behind) if model.alive[behind as usize] => {
                facets.push(crack_facet(solid, (body, behind), (body, removed), nodes, opposite));
            }
            Some(_) => {}
            None if solid.bodies.len() == 1 => {}
            None => drop(borders.insert(sorted(nodes), (body, removed, nodes, opposite))),
        }
    }
}

/// Adds the facets of other bodies that removed elements have left bare, of those that may break: ranks have all elements of these alone.
/// A body that has wholly left takes no crack with it.
fn add_beyond_borders(solid: &Solid, borders: &mut Borders, facets: &mut Vec<CrackFacet>) {
    borders.retain(|_, (body, ..)| solid.bodies[*body].alive.contains(&true));
    if borders.is_empty() {
        return;
    }
    let mut is_bare = vec![false; solid.reference.len()];
    borders.keys().flatten().for_each(|&node| is_bare[node as usize] = true);
    for (body, model) in solid.bodies.iter().enumerate().filter(|(_, model)| model.body.damage.is_some()) {
        for (behind, element) in (0..).zip(model.body.elements.iter()).filter(|&(e, _)| model.alive[e as usize]) {
            for side in sides(model).iter().map(|(local, ..)| local.map(|k| element[k])) {
                let bare = side.iter().all(|&node| is_bare[node as usize]);
                let before = bare.then(|| borders.get(&sorted(side))).flatten();
                if let Some(&(other, removed, nodes, opposite)) = before.filter(|(other, ..)| *other != body) {
                    facets.push(crack_facet(solid, (body, behind), (other, removed), nodes, opposite));
                }
            }
        }
    }
}

fn sides(model: &BodyModel) -> &'static [([usize; 3], usize, usize, usize)] {
    if model.body.shape == ElementKind::T4 { &SIDES_T4 } else { &SIDES_T3 }
}

/// Nodes of a side in an order that both elements give it.
fn sorted([a, b, c]: [u32; 3]) -> [u32; 3] {
    let mut nodes = [a, b, if b == c { a.max(b) } else { c }];
    nodes.sort_unstable();
    nodes
}

fn crack_facet(
    solid: &Solid,
    (body, element): (usize, u32),
    removed: (usize, u32),
    nodes: [u32; 3],
    opposite: u32,
) -> CrackFacet {
    let [a, b, c] = nodes.map(|node| solid.position(node as usize));
    let moved = nodes.map(|node| solid.displacement[node as usize]);
    let (area, centre, mean) = if nodes[1] == nodes[2] {
        (facet_area([a, b, c], solid.bodies[body].body.depth()), (a + b) * 0.5, (moved[0] + moved[1]) * 0.5)
    } else {
        ((b - a).cross(&(c - a)) * 0.5, (a + b + c) / 3.0, (moved[0] + moved[1] + moved[2]) / 3.0)
    };
    let normal = area.try_normalize(0.0).unwrap_or_else(Vec3::zeros);
    let opening = (solid.displacement[opposite as usize] - mean).dot(&normal);
    CrackFacet { body, element, removed, nodes, centre, area: area.norm(), normal, opening }
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic};

    use super::*;
    use crate::body::Body;
    use fractum_mesh::generate::{structured_box, structured_rectangle};

    /// A bar, a stronger body of its own up to x = `border`.
    fn broken(shape: ElementKind, nodes: Vec<Vec3>, elements: Vec<[u32; 4]>, border: f64) -> Solid {
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.0 };
        let law = DamageLaw::rankine(3e6, 100.0);
        let is_rest = |element: &[u32; 4]| element.iter().all(|&n| nodes[n as usize].x < border + 1e-9);
        let (rest, elements): (Vec<_>, Vec<_>) = elements.into_iter().partition(is_rest);
        let mut bodies = vec![Body::new("bar", shape, elements, elastic).smoothed().with_damage(law)];
        if !rest.is_empty() {
            let strong = DamageLaw::rankine(3e12, 1e15);
            bodies.push(Body::new("rest", shape, rest, elastic).smoothed().with_damage(strong));
        }
        bodies.iter_mut().for_each(|body| body.thickness = 0.3);
        let mut solid = Solid::new(nodes, bodies).unwrap();
        assert!(CrackSurface::of(&solid).facets.is_empty());
        // The column of elements between x = 2 and 3 opens by 5 mm.
        for (u, p) in solid.displacement.iter_mut().zip(&solid.reference) {
            u.x = if p.x > 0.25 { 5e-3 } else { 0.0 };
        }
        solid.update_internal_forces(0.0, false);
        crate::removal::remove_cut_elements(&mut solid, 0.0, &mut Vec::new());
        solid
    }

    #[test]
    fn a_bar_torn_in_two_shows_both_faces_of_its_cross_section() {
        let flat = structured_rectangle([5, 3], [0.5, 0.2], None);
        let elements: Vec<_> = flat.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let deep = structured_box([5, 3, 2], Vec3::new(0.5, 0.2, 0.3), None);
        for border in [0.0, 0.2] {
            let solids = [
                broken(ElementKind::T3, flat.nodes.clone(), elements.clone(), border),
                broken(ElementKind::T4, deep.nodes.clone(), deep.tetrahedra.clone(), border),
            ];
            for solid in &solids {
                shows_both_faces(solid);
            }
        }
    }

    fn shows_both_faces(solid: &Solid) {
        let crack = CrackSurface::of(solid);
        let section = 0.2 * 0.3;
        assert!((crack.area() / (2.0 * section) - 1.0).abs() < 1e-12, "{}", crack.area());
        for (index, facet) in crack.facets.iter().enumerate() {
            assert!((facet.opening - 5e-3).abs() < 1e-12 && facet.normal.x.abs() > 1.0 - 1e-12, "{facet:?}");
            assert!(solid.alive(facet.body)[facet.element as usize] && !solid.alive(0)[facet.removed.1 as usize]);
            let side = if facet.centre.x < 0.25 { 1.0 } else { -1.0 };
            assert_eq!(facet.normal.x.signum(), side);
            for &other in crack.neighbours.row(index) {
                assert_eq!(crack.facets[other as usize].normal.x.signum(), side);
                assert!(crack.neighbours.row(other as usize).contains(&(index as u32)));
            }
            assert!(!crack.neighbours.row(index).is_empty());
        }
    }
}
