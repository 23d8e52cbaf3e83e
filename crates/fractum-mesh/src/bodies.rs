//! What bodies of a mesh are like, each and beside each other.

use std::collections::{BTreeMap, BTreeSet};

use fractum_math::Vec3;

use crate::mesh::bounding_box;
use crate::quality::{self, Lengths, Summary};
use crate::topology::{self, boundary_of_tetrahedra, boundary_of_triangles};
use crate::{Coincident, Group, Mesh, coincident_nodes};

/// Elements of a body that are looked for in another one.
const SAMPLE: usize = 2000;
/// Elements per node below which a body may have only two elements through its thickness: in space, in the plane.
const FEW: [f64; 2] = [4.6, 1.5];
/// Largest over smallest extent above which a body is slender.
pub const SLENDER: f64 = 4.0;
/// Share of the elements that lie at the surface where there are two through the thickness.
const AT_SURFACE: f64 = 0.98;
/// Bodies beyond which they are not held against each other: sets of parts, rather than bodies.
const MOST_BODIES: usize = 64;

/// The elements of a body: tetrahedra, or triangles of a plane mesh.
pub enum SolidElements {
    /// In space.
    Tetrahedra(Vec<[u32; 4]>),
    /// In the plane.
    Triangles(Vec<[u32; 3]>),
}

impl SolidElements {
    /// All of a mesh.
    pub fn of_mesh(mesh: &Mesh) -> Self {
        if mesh.tetrahedra.is_empty() {
            SolidElements::Triangles(mesh.triangles.clone())
        } else {
            SolidElements::Tetrahedra(mesh.tetrahedra.clone())
        }
    }

    /// Those of a group.
    pub fn of_group(mesh: &Mesh, group: &Group) -> Self {
        if mesh.tetrahedra.is_empty() {
            let triangle = |&member: &u32| mesh.triangles[member as usize];
            SolidElements::Triangles(group.triangles.iter().map(triangle).collect())
        } else {
            let tetrahedron = |&member: &u32| mesh.tetrahedra[member as usize];
            SolidElements::Tetrahedra(group.tetrahedra.iter().map(tetrahedron).collect())
        }
    }

    /// What they are called.
    pub fn what(&self) -> &'static str {
        match self {
            SolidElements::Tetrahedra(_) => "tetrahedra",
            SolidElements::Triangles(_) => "triangles",
        }
    }

    /// Their number.
    pub fn count(&self) -> usize {
        match self {
            SolidElements::Tetrahedra(elements) => elements.len(),
            SolidElements::Triangles(elements) => elements.len(),
        }
    }

    /// Lengths of their edges and their quality; none of no elements.
    pub fn quality(&self, nodes: &[Vec3]) -> Option<(Lengths, Summary)> {
        let (edges, summary) = match self {
            SolidElements::Tetrahedra(elements) => {
                (topology::edges_of_tetrahedra(elements).nodes, quality::summarize_tetrahedra(nodes, elements)?)
            }
            SolidElements::Triangles(elements) => {
                (topology::edges_of_triangles(elements).nodes, quality::summarize_triangles(nodes, elements)?)
            }
        };
        Some((quality::lengths(nodes, &edges)?, summary))
    }

    /// How many elements there are through a thickness, where these are one or two nearly everywhere; none where there are more.
    pub fn layers(&self) -> Option<u32> {
        match self {
            SolidElements::Tetrahedra(elements) => {
                let boundary = || boundary_of_tetrahedra(elements).iter().flat_map(|facet| facet.nodes).collect();
                layers(elements, FEW[0], boundary)
            }
            SolidElements::Triangles(elements) => {
                let boundary = || boundary_of_triangles(elements).iter().flat_map(|side| side.nodes).collect();
                layers(elements, FEW[1], boundary)
            }
        }
    }

    /// Share of these whose middle lies in one of the others; of many a sample is taken.
    pub fn share_within(&self, nodes: &[Vec3], others: &Self) -> f64 {
        match (self, others) {
            (SolidElements::Tetrahedra(own), SolidElements::Tetrahedra(others)) => share_within(nodes, own, others),
            (SolidElements::Triangles(own), SolidElements::Triangles(others)) => share_within(nodes, own, others),
            _ => 0.0,
        }
    }

    fn nodes(&self) -> &[u32] {
        match self {
            SolidElements::Tetrahedra(elements) => elements.as_flattened(),
            SolidElements::Triangles(elements) => elements.as_flattened(),
        }
    }

    fn extent(&self, at: &[Vec3]) -> (Vec3, Vec3) {
        bounding_box(&self.nodes().iter().map(|&node| at[node as usize]).collect::<Vec<Vec3>>())
    }
}

/// - `few`: elements per node of a body with two layers
/// - `boundary`: nodes on the surface
fn layers<const N: usize>(elements: &[[u32; N]], few: f64, boundary: impl Fn() -> Vec<u32>) -> Option<u32> {
    let highest = *elements.as_flattened().iter().max()? as usize;
    let marked = |nodes: &[u32]| {
        let mut marked = vec![false; highest + 1];
        nodes.iter().for_each(|&node| marked[node as usize] = true);
        marked
    };
    let own = marked(elements.as_flattened());
    let count = own.iter().filter(|own| **own).count();
    if elements.len() as f64 > few * count as f64 {
        return None;
    }
    let at_surface = marked(&boundary());
    let inner = elements.iter().filter(|nodes| nodes.iter().all(|&node| !at_surface[node as usize])).count();
    if inner as f64 / elements.len() as f64 > 1.0 - AT_SURFACE {
        return None;
    }
    let has_inner_node = own.iter().zip(&at_surface).any(|(own, at_surface)| *own && !at_surface);
    Some(if has_inner_node { 2 } else { 1 })
}

fn share_within<const N: usize>(nodes: &[Vec3], elements: &[[u32; N]], others: &[[u32; N]]) -> f64 {
    let corners = |element: &[u32; N]| element.map(|node| nodes[node as usize]);
    let [(low, high), (from, to)] =
        [elements, others].map(|all| bounding_box(&all.iter().flat_map(corners).collect::<Vec<Vec3>>()));
    let (low, high) = (low.sup(&from), high.inf(&to));
    let inside = |x: &Vec3| (0..N - 1).all(|axis| low[axis] < x[axis] && x[axis] < high[axis]);
    let middles = elements.iter().map(|element| corners(element).iter().sum::<Vec3>() / N as f64).filter(inside);
    let mut middles: Vec<Vec3> = middles.collect();
    let count = middles.len();
    let stride = count.div_ceil(SAMPLE).max(1);
    middles = middles.into_iter().step_by(stride).collect();
    middles.sort_unstable_by(|a, b| a.x.total_cmp(&b.x));
    let mut found = vec![false; middles.len()];
    for corners in others.iter().map(corners) {
        let [first, last] =
            corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(x.x), h.max(x.x)]);
        let begin = middles.partition_point(|x| x.x < first);
        let near = middles[begin..].iter().take_while(|x| x.x <= last).enumerate();
        near.filter(|(_, x)| holds(&corners, x)).for_each(|(at, _)| found[begin + at] = true);
    }
    let looked = middles.len().max(1) as f64;
    found.into_iter().filter(|found| *found).count() as f64 / looked * count as f64 / elements.len().max(1) as f64
}

/// Whether a triangle or a tetrahedron holds a point.
fn holds<const N: usize>(corners: &[Vec3; N], x: &Vec3) -> bool {
    let size = |corners: &[Vec3; N]| {
        let [a, b] = [1, 2].map(|corner| corners[corner] - corners[0]);
        let across = if N == 3 { Vec3::z() } else { corners[N - 1] - corners[0] };
        a.cross(&b).dot(&across)
    };
    let whole = size(corners);
    // A place on a face belongs to both elements.
    let inside = |corner: usize| {
        let mut with = *corners;
        with[corner] = *x;
        size(&with) * whole >= 0.0
    };
    whole != 0.0 && (0..N).all(inside)
}

/// The groups that bodies may be made of, with their elements.
pub fn bodies(mesh: &Mesh) -> Vec<(&Group, SolidElements)> {
    let all = mesh.groups.iter().map(|group| (group, SolidElements::of_group(mesh, group)));
    all.filter(|(_, elements)| elements.count() > 0).collect()
}

/// Hints on bodies that have few elements through a thickness, nodes in the same places, or elements within each other.
pub(crate) fn hints(mesh: &Mesh) -> Vec<String> {
    if mesh.tetrahedra.is_empty() && !mesh.is_in_plane() {
        return Vec::new();
    }
    let mut known: BTreeSet<(&[u32], &[u32])> = BTreeSet::new();
    let mut bodies = bodies(mesh);
    // Several names of one body are one.
    bodies.retain(|(group, _)| known.insert((&group.tetrahedra, &group.triangles)));
    let boxes: Vec<(Vec3, Vec3)> = bodies.iter().map(|(_, elements)| elements.extent(&mesh.nodes)).collect();
    let mut hints = Vec::new();
    for ((group, elements), (low, high)) in bodies.iter().zip(&boxes) {
        let extent = high - low;
        let axes = if mesh.tetrahedra.is_empty() { 2 } else { 3 };
        let smallest = extent.iter().take(axes).copied().fold(f64::INFINITY, f64::min);
        if extent.max() > SLENDER * smallest
            && let Some(layers) = elements.layers()
        {
            let through = if layers == 1 { "one element" } else { "two elements" };
            hints.push(format!(
                "group \"{}\": {through} through the thickness: linear elements are too stiff where it is bent; take three, \
                 better six",
                group.name
            ));
        }
    }
    if bodies.len() > MOST_BODIES {
        return hints;
    }
    // Groups with common elements are parts of each other, or of one body.
    let members = |group: &Group| [group.tetrahedra.clone(), group.triangles.clone()];
    let have_common = |first: usize, second: usize| {
        let [own, other] = [first, second].map(|body| members(bodies[body].0));
        own.iter().zip(&other).any(|(own, other)| own.iter().any(|member| other.binary_search(member).is_ok()))
    };
    let nodes: Vec<Vec<u32>> = bodies.iter().map(|(_, elements)| sorted(elements.nodes())).collect();
    let mut pairs = BTreeMap::<[usize; 2], (usize, u32)>::new();
    for Coincident { bodies, nodes: [node, _] } in coincident_nodes(mesh, &nodes) {
        pairs.entry(bodies).or_insert((0, node)).0 += 1;
    }
    for ([first, second], (count, node)) in pairs {
        if !have_common(first, second) {
            let [x, y, z] = [0, 1, 2].map(|axis| mesh.nodes[node as usize][axis]);
            hints.push(format!(
                "groups \"{}\" and \"{}\": {count} nodes of one lie on nodes of the other, such as at {x:.4} {y:.4} {z:.4}, \
                 and nothing joins them: set mesh.join = true in the case, or mesh both with common nodes",
                bodies[first].0.name, bodies[second].0.name
            ));
        }
    }
    for second in 0..bodies.len() {
        for first in 0..second {
            let [(low, high), (from, to)] = [boxes[first], boxes[second]];
            let axes = if mesh.tetrahedra.is_empty() { 0..2 } else { 0..3 };
            if axes.clone().any(|axis| high[axis] <= from[axis] || to[axis] <= low[axis]) || have_common(first, second)
            {
                continue;
            }
            for [own, other] in [[second, first], [first, second]] {
                let share = bodies[own].1.share_within(&mesh.nodes, &bodies[other].1);
                if share > 0.0 {
                    hints.push(format!(
                        "group \"{}\": {:.0} % of its elements lie within \"{}\", and would be counted twice: cut one out of the \
                         other (Boolean difference, or fragments, in Gmsh)",
                        bodies[own].0.name,
                        (100.0 * share).max(1.0),
                        bodies[other].0.name
                    ));
                    break;
                }
            }
        }
    }
    hints
}

fn sorted(nodes: &[u32]) -> Vec<u32> {
    let mut nodes = nodes.to_vec();
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::structured_box;

    /// Two meshes as one, with a body each.
    fn beside(first: &Mesh, second: &Mesh, by: Vec3) -> Mesh {
        let (mut mesh, count) = (first.clone(), first.nodes.len() as u32);
        mesh.nodes.extend(second.nodes.iter().map(|x| x + by));
        let start = mesh.tetrahedra.len() as u32;
        mesh.tetrahedra.extend(second.tetrahedra.iter().map(|element| element.map(|node| node + count)));
        mesh.groups = vec![
            Group { name: "first".into(), dimension: 3, tag: 1, tetrahedra: (0..start).collect(), ..Group::default() },
            Group {
                name: "second".into(),
                dimension: 3,
                tag: 2,
                tetrahedra: (start..mesh.tetrahedra.len() as u32).collect(),
                ..Group::default()
            },
        ];
        mesh
    }

    #[test]
    fn bodies_are_held_against_each_other() {
        let cube = structured_box([4; 3], Vec3::new(1.0, 1.0, 1.0), None);
        let said = |by: f64| hints(&beside(&cube, &cube, Vec3::new(by, 0.0, 0.0))).join("\n");
        assert_eq!(said(1.5), "");
        let touching = said(1.0);
        assert!(
            touching.starts_with("groups \"first\" and \"second\": 25 nodes of one lie on nodes of the other"),
            "{touching}"
        );
        assert!(!touching.contains("counted twice"), "{touching}");
        // A half is in the other: of the elements of the second those with x below 1.
        let within = said(0.45);
        assert!(within.contains("% of its elements lie within") && !within.contains("lie on nodes"), "{within}");
    }

    #[test]
    fn layers_through_a_plate_are_counted() {
        for (layers, thin) in [(1, Some(1)), (2, Some(2)), (4, None)] {
            let plate = structured_box([20, 20, layers], Vec3::new(1.0, 1.0, 0.1), None);
            assert_eq!(SolidElements::of_mesh(&plate).layers(), thin, "{layers}");
            let mut plate = plate;
            plate.groups.clear();
            plate.add_group_of_all("plate");
            assert_eq!(hints(&plate).len(), usize::from(thin.is_some()), "{:?}", hints(&plate));
        }
    }
}
