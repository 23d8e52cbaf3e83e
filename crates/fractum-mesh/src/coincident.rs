//! Nodes of several bodies in the same places: found, and joined where whole faces meet.

use std::collections::{BTreeMap, BTreeSet};

use fractum_math::Vec3;

use crate::Mesh;
use crate::mesh::bounding_box;
use crate::topology::{TETRAHEDRON_EDGES, TRIANGLE_EDGES, boundary_of_tetrahedra, boundary_of_triangles};

/// Distance of two nodes that lie in one place, over the shortest edge at either.
const COINCIDENT: f64 = 1e-3;
/// The same over the size of the mesh, where the elements of a node are not known.
const OF_THE_MESH: f64 = 1e-7;
/// Cosine between directions along which two faces lie upon each other.
const ALONG: f64 = 0.999;

/// Two nodes in one place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Coincident {
    /// The bodies that they belong to, the lower first.
    pub bodies: [usize; 2],
    /// The nodes, that of the lower body first.
    pub nodes: [u32; 2],
}

/// Nodes of two bodies that lie in one place without being the same: nearer than a thousandth of the shortest edge at either.
///
/// - `bodies`: nodes of each
pub fn coincident_nodes<N: AsRef<[u32]>>(mesh: &Mesh, bodies: &[N]) -> Vec<Coincident> {
    let within = tolerances(mesh);
    // Along a direction in which nodes of a mesh of rows differ.
    let along = Vec3::new(0.577, 0.743, 0.339);
    let mut places: Vec<(f64, usize, u32)> = Vec::new();
    for (index, nodes) in bodies.iter().enumerate() {
        places.extend(nodes.as_ref().iter().map(|&node| (along.dot(&mesh.nodes[node as usize]), index, node)));
    }
    places.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
    let mut pairs = Vec::new();
    for (at, &(place, body, node)) in places.iter().enumerate() {
        let own = within[node as usize];
        let near = places[at + 1..].iter().take_while(|(other, ..)| other - place <= own);
        for &(_, other, twin) in near {
            let apart = mesh.nodes[node as usize] - mesh.nodes[twin as usize];
            if other == body || twin == node || apart.norm() > own.min(within[twin as usize]) {
                continue;
            }
            let (bodies, nodes) =
                if body < other { ([body, other], [node, twin]) } else { ([other, body], [twin, node]) };
            pairs.push(Coincident { bodies, nodes });
        }
    }
    pairs
}

/// The least of the nodes that lie in the place of each node, whatever bodies they belong to.
pub(crate) fn same_places(mesh: &Mesh) -> Vec<u32> {
    let each: Vec<[u32; 1]> = (0..mesh.nodes.len() as u32).map(|node| [node]).collect();
    let mut place: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
    for Coincident { nodes: [a, b], .. } in coincident_nodes(mesh, &each) {
        unite(&mut place, a, b);
    }
    (0..mesh.nodes.len() as u32).map(|node| root(&place, node)).collect()
}

/// How near a node of another body is in the place of each node.
fn tolerances(mesh: &Mesh) -> Vec<f64> {
    let mut shortest = vec![f64::INFINITY; mesh.nodes.len()];
    let mut note = |a: u32, b: u32| {
        let length = (mesh.nodes[a as usize] - mesh.nodes[b as usize]).norm();
        for node in [a, b] {
            shortest[node as usize] = length.min(shortest[node as usize]);
        }
    };
    let tetrahedra = mesh.tetrahedra.iter();
    tetrahedra.for_each(|nodes| TETRAHEDRON_EDGES.iter().for_each(|&[a, b]| note(nodes[a], nodes[b])));
    let triangles = mesh.triangles.iter();
    triangles.for_each(|nodes| TRIANGLE_EDGES.iter().for_each(|&[a, b]| note(nodes[a], nodes[b])));
    let (low, high) = bounding_box(&mesh.nodes);
    let unknown = OF_THE_MESH * (high - low).norm();
    shortest.into_iter().map(|length| if length < f64::INFINITY { COINCIDENT * length } else { unknown }).collect()
}

/// What two bodies have in common since their nodes were joined.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// The bodies, the lower first.
    pub bodies: [usize; 2],
    /// Places in which their nodes became one.
    pub nodes: usize,
    /// Faces (edges of plane bodies) that both have.
    pub faces: usize,
    /// One of these places.
    pub at: Vec3,
    /// Where they lie upon each other beside these faces without being joined: the number of edges (nodes of plane bodies) at which the faces of
    /// both end to conform, and one of these places.
    pub apart: Option<(usize, Vec3)>,
}

/// The mesh with the nodes of bodies joined where they have a face in common: one whose nodes lie in the same places. Nodes of a body are not
/// joined with each other, and faces that do not conform stay apart.
///
/// - `groups`: the group of each body; the mesh must be whole
pub fn joined_bodies(mesh: &Mesh, groups: &[&str]) -> (Mesh, Vec<Joint>) {
    let sets: Vec<Vec<u32>> = groups.iter().map(|group| mesh.group_nodes(group)).collect();
    let mut place: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
    for Coincident { nodes: [a, b], .. } in coincident_nodes(mesh, &sets) {
        unite(&mut place, a, b);
    }
    let surfaces: Vec<Vec<[u32; 3]>> = groups.iter().map(|group| surface(mesh, group)).collect();
    let mut faces: Vec<([u32; 3], usize, [u32; 3])> = Vec::new();
    for (body, surface) in surfaces.iter().enumerate() {
        faces.extend(surface.iter().map(|&facet| (facet.map(|node| root(&place, node)), body, facet)));
    }
    faces.iter_mut().for_each(|(places, ..)| *places = ascending(*places));
    faces.sort_unstable();
    let mut same: Vec<u32> = (0..mesh.nodes.len() as u32).collect();
    let mut joints = BTreeMap::<[usize; 2], Found>::new();
    for run in faces.chunk_by(|a, b| a.0 == b.0) {
        for (index, (_, second, other)) in run.iter().enumerate() {
            for (_, first, facet) in run[..index].iter().filter(|(_, first, _)| first != second) {
                let twin = |node: u32| other.iter().copied().find(|twin| root(&place, *twin) == root(&place, node));
                let Some(twins) = twins(facet, twin).filter(|twins| is_turned(twins, other)) else { continue };
                let found = joints.entry([*first, *second]).or_default();
                found.faces.insert(run[0].0);
                for (node, twin) in facet.iter().zip(twins).filter(|(node, twin)| **node != *twin) {
                    found.nodes.insert(root(&place, *node));
                    unite(&mut same, *node, twin);
                }
            }
        }
    }
    let report = |([first, second], found): ([usize; 2], Found)| {
        // Bodies that had these nodes in common are joined already.
        let at = mesh.nodes[*found.nodes.first()? as usize];
        let apart = apart(mesh, &place, [&surfaces[first], &surfaces[second]], &found.faces);
        Some(Joint { bodies: [first, second], nodes: found.nodes.len(), faces: found.faces.len(), at, apart })
    };
    let joints: Vec<Joint> = joints.into_iter().filter_map(report).collect();
    (renumbered(mesh, &same), joints)
}

/// Faces and nodes that two bodies have in common, by the places of their nodes.
#[derive(Default)]
struct Found {
    faces: BTreeSet<[u32; 3]>,
    nodes: BTreeSet<u32>,
}

/// The places of a facet in one order, whatever its sense; a side of a plane body repeats the last one.
fn ascending(mut places: [u32; 3]) -> [u32; 3] {
    places.sort_unstable();
    if places[0] == places[1] { [places[0], places[2], places[2]] } else { places }
}

/// The nodes of another facet in the places of those of a facet.
fn twins(facet: &[u32; 3], twin: impl Fn(u32) -> Option<u32>) -> Option<[u32; 3]> {
    let [a, b, c] = facet.map(twin);
    Some([a?, b?, c?])
}

/// Whether a facet by the nodes of another one has the opposite sense: they lie back to back.
fn is_turned(twins: &[u32; 3], other: &[u32; 3]) -> bool {
    let [a, b, c] = *other;
    // The sides of plane bodies repeat their second node.
    if b == c {
        return *twins == [b, a, a];
    }
    [[b, a, c], [a, c, b], [c, b, a]].contains(twins)
}

/// Outward facets of a body; the sides of a plane one repeat their second node.
fn surface(mesh: &Mesh, group: &str) -> Vec<[u32; 3]> {
    let groups = mesh.group(group);
    let tetrahedra: Vec<[u32; 4]> =
        groups.iter().flat_map(|group| &group.tetrahedra).map(|&element| mesh.tetrahedra[element as usize]).collect();
    if !tetrahedra.is_empty() {
        return boundary_of_tetrahedra(&tetrahedra).into_iter().map(|facet| facet.nodes).collect();
    }
    let triangles = groups.iter().flat_map(|group| &group.triangles);
    let triangles: Vec<[u32; 3]> = triangles.map(|&element| mesh.triangles[element as usize]).collect();
    boundary_of_triangles(&triangles).into_iter().map(|side| [side.nodes[0], side.nodes[1], side.nodes[1]]).collect()
}

/// Where two bodies lie upon each other beside the faces that they have in common: a face of each goes on from the last of these in one direction.
fn apart(
    mesh: &Mesh,
    place: &[u32],
    surfaces: [&Vec<[u32; 3]>; 2],
    common: &BTreeSet<[u32; 3]>,
) -> Option<(usize, Vec3)> {
    let at = |node: u32| mesh.nodes[root(place, node) as usize];
    // Every side of a face with the direction into the face; that of a plane body ends at its nodes.
    let sides = |facet: &[u32; 3]| -> Vec<([u32; 2], Vec3)> {
        let [a, b, c] = facet.map(|node| root(place, node));
        if facet[1] == facet[2] {
            return [(a, b), (b, a)].map(|(end, other)| ([end, end], (at(other) - at(end)).normalize())).to_vec();
        }
        let side = |a: u32, b: u32, c: u32| {
            let (edge, into) = ((at(b) - at(a)).normalize(), at(c) - at(a));
            ([a.min(b), a.max(b)], (into - edge * edge.dot(&into)).normalize())
        };
        vec![side(a, b, c), side(b, c, a), side(c, a, b)]
    };
    let keys = |facet: &[u32; 3]| ascending(facet.map(|node| root(place, node)));
    let mut rim = BTreeSet::new();
    let of_first = surfaces[0].iter().filter(|facet| common.contains(&keys(facet)));
    of_first.flat_map(sides).for_each(|(side, _)| _ = rim.insert(side));
    let [first, second] = surfaces.map(|surface| {
        let free = surface.iter().filter(|facet| !common.contains(&keys(facet)));
        free.flat_map(sides).filter(|(side, _)| rim.contains(side)).collect::<BTreeMap<_, _>>()
    });
    let upon = |(side, into): &(&[u32; 2], &Vec3)| second.get(*side).is_some_and(|other| into.dot(other) > ALONG);
    let all: Vec<[u32; 2]> = first.iter().filter(upon).map(|(side, _)| *side).collect();
    all.first().map(|&[a, b]| (all.len(), 0.5 * (at(a) + at(b))))
}

/// The least node of those that are one with a node.
fn root(same: &[u32], mut node: u32) -> u32 {
    while same[node as usize] != node {
        node = same[node as usize];
    }
    node
}

fn unite(same: &mut [u32], a: u32, b: u32) {
    let [a, b] = [root(same, a), root(same, b)];
    same[a.max(b) as usize] = a.min(b);
}

/// The mesh in which nodes that are one are one.
fn renumbered(mesh: &Mesh, same: &[u32]) -> Mesh {
    let mut number = vec![0; mesh.nodes.len()];
    let (mut nodes, mut node_tags) = (Vec::new(), Vec::new());
    for node in 0..mesh.nodes.len() {
        let first = root(same, node as u32) as usize;
        number[node] = if first == node { nodes.len() as u32 } else { number[first] };
        if first == node {
            nodes.push(mesh.nodes[node]);
            node_tags.push(mesh.node_tags[node]);
        }
    }
    let mut joined = Mesh { nodes, node_tags, ..mesh.clone() };
    let renumber = |node: &mut u32| *node = number[*node as usize];
    joined.points.as_flattened_mut().iter_mut().for_each(renumber);
    joined.lines.as_flattened_mut().iter_mut().for_each(renumber);
    joined.triangles.as_flattened_mut().iter_mut().for_each(renumber);
    joined.tetrahedra.as_flattened_mut().iter_mut().for_each(renumber);
    joined
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Group;
    use crate::generate::{structured_box, structured_rectangle};

    /// Both meshes as one, the nodes of the second behind those of the first, with the groups `NAME-0` and `NAME-1`.
    fn beside(meshes: &[Mesh]) -> Mesh {
        let mut all = Mesh::default();
        for (index, mesh) in meshes.iter().enumerate() {
            let [nodes, triangles, tetrahedra, lines] =
                [all.nodes.len(), all.triangles.len(), all.tetrahedra.len(), all.lines.len()].map(|count| count as u32);
            all.nodes.extend(&mesh.nodes);
            all.triangles.extend(mesh.triangles.iter().map(|element| element.map(|node| node + nodes)));
            all.tetrahedra.extend(mesh.tetrahedra.iter().map(|element| element.map(|node| node + nodes)));
            all.lines.extend(mesh.lines.iter().map(|element| element.map(|node| node + nodes)));
            all.groups.extend(mesh.groups.iter().map(|group| Group {
                name: format!("{}-{index}", group.name),
                lines: group.lines.iter().map(|element| element + lines).collect(),
                triangles: group.triangles.iter().map(|element| element + triangles).collect(),
                tetrahedra: group.tetrahedra.iter().map(|element| element + tetrahedra).collect(),
                ..group.clone()
            }));
        }
        all.node_tags = (1..=all.nodes.len() as u64).collect();
        all
    }

    fn moved(mut mesh: Mesh, by: [f64; 3]) -> Mesh {
        mesh.nodes.iter_mut().for_each(|node| *node += Vec3::from(by));
        mesh
    }

    const BODIES: [&str; 3] = ["body-0", "body-1", "body-2"];

    fn block(cells: [u32; 3]) -> Mesh {
        structured_box(cells, Vec3::new(1.0, 1.0, 1.0), None)
    }

    #[test]
    fn three_blocks_at_one_edge_have_its_nodes_in_common() {
        for size in [1e-3, 1.0, 1e3] {
            let blocks = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 1e-5]];
            let mut mesh = beside(&blocks.map(|by| moved(block([3, 3, 3]), by)));
            mesh.nodes.iter_mut().for_each(|node| *node *= size);
            let (joined, joints) = joined_bodies(&mesh, &BODIES[..3]);
            let counts: Vec<(usize, usize)> = joints.iter().map(|joint| (joint.nodes, joint.faces)).collect();
            assert_eq!(counts, [(16, 18), (16, 18)], "the first and the last meet at an edge alone");
            assert!(joints.iter().all(|joint| joint.apart.is_none()), "{joints:?}");
            assert_eq!(joined.nodes.len(), 3 * 64 - 32);
            let sets = [0, 1, 2].map(|body| joined.group_nodes(&format!("body-{body}")));
            assert_eq!(sets[0].iter().filter(|node| sets[2].contains(node)).count(), 4);
            assert_eq!(coincident_nodes(&joined, &sets), []);
            assert_eq!(joined.group_nodes("x+-0"), joined.group_nodes("x--1"), "groups of both sides are kept");
        }
    }

    #[test]
    fn faces_that_do_not_conform_stay_apart() {
        let mesh = beside(&[block([2, 2, 2]), moved(block([3, 3, 3]), [1.0, 0.0, 0.0])]);
        let sets = [mesh.group_nodes("body-0"), mesh.group_nodes("body-1")];
        assert_eq!(coincident_nodes(&mesh, &sets).len(), 4, "the corners");
        let (joined, joints) = joined_bodies(&mesh, &BODIES[..2]);
        assert_eq!((joined.nodes.len(), joints), (mesh.nodes.len(), Vec::new()));
        // Nor do bodies within each other, and the nodes of one body.
        let twice = beside(&[block([2, 2, 2]), block([2, 2, 2])]);
        assert_eq!(joined_bodies(&twice, &BODIES[..2]).1, []);
        assert_eq!(joined_bodies(&twice, &BODIES[..1]).1, []);
    }

    #[test]
    fn a_face_that_conforms_in_part_tells_where_it_ends() {
        // A second row whose cells are as wide as those of the first one, and others beside them.
        let upper = |cells: [u32; 2], width: f64| structured_rectangle(cells, [width, 1.0], None);
        let wide = moved(upper([3, 2], 0.5), [0.5, 1.0, 0.0]);
        let row = beside(&[moved(upper([2, 2], 0.5), [0.0, 1.0, 0.0]), wide]);
        let (row, joints) = joined_bodies(&row, &BODIES[..2]);
        assert_eq!((joints[0].nodes, joints[0].faces), (3, 2));
        let mut row = row;
        row.groups.retain(|group| group.name.starts_with("body"));
        row.groups[0].triangles = (0..row.triangles.len() as u32).collect();
        row.groups.truncate(1);
        row.groups[0].name = "body".to_owned();
        let mesh = beside(&[upper([4, 2], 1.0), row]);
        let (_, joints) = joined_bodies(&mesh, &BODIES[..2]);
        assert_eq!((joints[0].nodes, joints[0].faces), (3, 2));
        let (count, at) = joints[0].apart.expect("both go on to the right");
        assert_eq!((count, at), (1, Vec3::new(0.5, 1.0, 0.0)));
    }
}
