//! Notches of solids: re-entrant edges of their surface, from which cracks run.

use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};
use std::f64::consts::PI;

use fractum_fem::{Body, ElementKind, Region, Solid};
use fractum_math::Vec3;
use fractum_math::elementary::atan2;
use fractum_mesh::topology::{boundary_of_tetrahedra, boundary_of_triangles};

/// Angle within the solids from which on an edge of their surface is a notch [rad]: 225 degrees, which round holes of ten facets do not reach.
const RE_ENTRANT: f64 = 1.25 * PI;

/// Where solids have notches, once something asks for them.
pub(super) struct Notches<'a> {
    /// Places of all nodes [m].
    pub(super) nodes: &'a [Vec3],
    solid: &'a Solid,
    boundary: &'a [[u32; 3]],
    found: OnceCell<HashSet<u32>>,
}

impl<'a> Notches<'a> {
    /// - `boundary`: facets of the surface of all solids; lines of plane ones have their second node twice
    pub(super) fn of(solid: &'a Solid, boundary: &'a [[u32; 3]]) -> Self {
        Notches { nodes: &solid.reference, solid, boundary, found: OnceCell::new() }
    }

    /// Whether a body has a notch where damage may occur.
    pub(super) fn has(&self, body: &Body) -> bool {
        let found = self.found.get_or_init(|| self.seek());
        let is_notch = |node: &u32| found.contains(node);
        match body.damage.as_ref().map(|zone| &zone.region) {
            Some(Region::Edges(marked)) if !found.is_empty() => {
                let (mut edge, mut has) = (0, false);
                body.each_edge(self.nodes.len(), |ends| {
                    has |= marked[edge] && ends.iter().any(is_notch);
                    edge += 1;
                });
                has
            }
            _ => body.elements.iter().any(|e| e[..body.shape.node_count()].iter().any(is_notch)),
        }
    }

    /// Nodes on re-entrant edges of the surface: angles of all elements at the edge, in the plane at the node, summed up.
    fn seek(&self) -> HashSet<u32> {
        let of_facet =
            |[a, b, c]: &[u32; 3]| if b == c { vec![[*a; 2], [*b; 2]] } else { vec![[*a, *b], [*b, *c], [*c, *a]] };
        let edges = self.boundary.iter().flat_map(of_facet);
        let mut angles: HashMap<[u32; 2], f64> = edges.map(|edge| (sorted(edge), 0.0)).collect();
        for index in 0..self.solid.body_count() {
            let body = self.solid.body(index);
            let pairs: &[[usize; 4]] = match body.shape {
                ElementKind::T3 => &[[0, 0, 1, 2], [1, 1, 2, 0], [2, 2, 0, 1]],
                ElementKind::T4 => {
                    &[[0, 1, 2, 3], [0, 2, 1, 3], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 0, 2], [2, 3, 0, 1]]
                }
            };
            for element in body.elements.iter() {
                for pair in pairs {
                    let [i, j, k, l] = pair.map(|corner| element[corner]);
                    if let Some(angle) = angles.get_mut(&sorted([i, j])) {
                        *angle += between([i, j, k, l].map(|node| self.nodes[node as usize]));
                    }
                }
            }
        }
        angles.into_iter().filter(|(_, angle)| *angle > RE_ENTRANT).flat_map(|(edge, _)| edge).collect()
    }
}

/// Whether solids have a notch where damage may occur.
pub fn is_notched(solid: &Solid) -> bool {
    let bodies = || (0..solid.body_count()).map(|index| solid.body(index));
    let of = |shape| bodies().filter(move |body| body.shape == shape).flat_map(|body| body.elements.iter());
    let triangles: Vec<[u32; 3]> = of(ElementKind::T3).map(|&[a, b, c, _]| [a, b, c]).collect();
    let tetrahedra: Vec<[u32; 4]> = of(ElementKind::T4).copied().collect();
    let mut boundary: Vec<[u32; 3]> = boundary_of_tetrahedra(&tetrahedra).iter().map(|facet| facet.nodes).collect();
    boundary.extend(boundary_of_triangles(&triangles).iter().map(|side| [side.nodes[0], side.nodes[1], side.nodes[1]]));
    let notches = Notches::of(solid, &boundary);
    bodies().any(|body| body.damage.is_some() && notches.has(body))
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}

/// Angle at the edge from i to j between the directions to k and to l, or at i where that is j [rad].
fn between([i, j, k, l]: [Vec3; 4]) -> f64 {
    let along = j - i;
    let square = along.dot(&along);
    let across = |place: Vec3| {
        let arm = place - i;
        if square > 0.0 { arm - along * (arm.dot(&along) / square) } else { arm }
    };
    let [first, second] = [across(k), across(l)];
    atan2(first.cross(&second).norm(), first.dot(&second))
}

#[cfg(test)]
mod tests {
    use std::slice::from_ref;

    use fractum_fem::{DamageLaw, Elastic};
    use fractum_mesh::generate::{Jitter, mirrored_cells, structured_rectangle};

    use super::*;

    const ELASTIC: Elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };

    /// Whether the first of some bodies with damage has a notch.
    fn is_notched(nodes: &[Vec3], bodies: &[Vec<[u32; 4]>], shape: ElementKind, region: Option<Region>) -> bool {
        // Nodes without elements have no mass.
        let mut used: Vec<u32> = bodies.concat().concat();
        used.sort_unstable();
        used.dedup();
        let number = |node: u32| used.binary_search(&node).unwrap() as u32;
        let renumbered = |elements: &Vec<[u32; 4]>| elements.iter().map(|e| e.map(number)).collect::<Vec<_>>();
        let bodies: Vec<Vec<[u32; 4]>> = bodies.iter().map(renumbered).collect();
        let nodes: Vec<Vec3> = used.iter().map(|&node| nodes[node as usize]).collect();
        let body = |elements: &Vec<[u32; 4]>| {
            let mut body = Body::new("body", shape, elements.clone(), ELASTIC).smoothed();
            body = body.with_damage(DamageLaw::rankine(3e6, 100.0));
            if let Some(region) = &region {
                body.damage.as_mut().unwrap().region = region.clone();
            }
            body
        };
        let all = bodies.concat();
        let boundary: Vec<[u32; 3]> = match shape {
            ElementKind::T4 => boundary_of_tetrahedra(&all).iter().map(|f| f.nodes).collect(),
            ElementKind::T3 => {
                let triangles: Vec<[u32; 3]> = all.iter().map(|e| [e[0], e[1], e[2]]).collect();
                boundary_of_triangles(&triangles).iter().map(|e| [e.nodes[0], e.nodes[1], e.nodes[1]]).collect()
            }
        };
        let solid = Solid::new(nodes, bodies.iter().map(body).collect()).unwrap();
        Notches::of(&solid, &boundary).has(solid.body(0))
    }

    #[test]
    fn corners_and_slits_of_plates_are_notches() {
        for seed in [1, 2, 3] {
            let mesh = structured_rectangle([8, 8], [0.8, 0.8], Some(Jitter { fraction: 0.15, seed }));
            let all: Vec<[u32; 4]> = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
            let middle = |e: &[u32; 4]| e[..3].iter().map(|&n| mesh.nodes[n as usize]).sum::<Vec3>() / 3.0;
            let [outside, inside] = [false, true].map(|within| {
                let is_in = |e: &&[u32; 4]| (middle(e).x > 0.4 && middle(e).y > 0.4) == within;
                all.iter().filter(is_in).copied().collect::<Vec<_>>()
            });
            let has = |bodies: &[Vec<[u32; 4]>], region| is_notched(&mesh.nodes, bodies, ElementKind::T3, region);
            assert!(!has(from_ref(&all), None) && !has(from_ref(&inside), None));
            assert!(has(from_ref(&outside), None));
            assert!(!has(&[outside.clone(), inside], None), "another body fills the corner");
            let count = {
                let mut count = 0;
                let body = Body::new("body", ElementKind::T3, outside.clone(), ELASTIC);
                body.each_edge(mesh.nodes.len(), |_| count += 1);
                count
            };
            assert!(!has(&[outside], Some(Region::Edges(vec![false; count]))), "no damage there");
            // A slit: nodes between x = 0 and the middle are doubled.
            let mut nodes = mesh.nodes.clone();
            let mut twin = HashMap::new();
            for (node, place) in mesh.nodes.iter().enumerate() {
                if (place.y - 0.4).abs() < 0.03 && place.x < 0.35 {
                    twin.insert(node as u32, nodes.len() as u32);
                    nodes.push(*place);
                }
            }
            let cut = all.iter().map(|e| if middle(e).y > 0.4 { e.map(|n| *twin.get(&n).unwrap_or(&n)) } else { *e });
            assert!(is_notched(&nodes, &[cut.collect()], ElementKind::T3, None));
        }
    }

    #[test]
    fn inner_edges_of_angles_are_notches_and_boxes_have_none() {
        for keep in [2, 4] {
            let mesh = mirrored_cells([4, 4, 1], Vec3::new(0.4, 0.4, 0.1), |[i, j, _]| i < keep || j < keep);
            let has = is_notched(&mesh.nodes, from_ref(&mesh.tetrahedra), ElementKind::T4, None);
            assert_eq!(has, keep == 2);
        }
    }
}
