//! Other meshes of the same body: one with half the edges, one with its inner nodes moved.

use fractum_math::Vec3;

use crate::free::{WORST_SHAPE, around_nodes, free_nodes};
use crate::quality::{signed_volume, tetrahedron, triangle};
use crate::{Group, Mesh, generate::unit_interval};

/// The mesh with every edge halved: a triangle becomes 4, a tetrahedron 8 (the inner octahedron is cut along its
/// shortest diagonal: Bey, *Computing* 55 (1995)). Groups keep their names and places; sides stay as straight as they are.
///
/// The mesh must be whole; what is known of other processes is dropped.
pub fn halved(mesh: &Mesh) -> Mesh {
    let middles = Middles::new(mesh);
    let mid = |a: u32, b: u32| middles.of(a, b);
    let mut nodes = mesh.nodes.clone();
    nodes.extend(middles.edges.iter().map(|[a, b]| 0.5 * (mesh.nodes[*a as usize] + mesh.nodes[*b as usize])));

    let lines = mesh.lines.iter().flat_map(|&[a, b]| [[a, mid(a, b)], [mid(a, b), b]]).collect();
    let triangle = |&[a, b, c]: &[u32; 3]| {
        let [ab, bc, ca] = [mid(a, b), mid(b, c), mid(c, a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
    };
    let triangles: Vec<[u32; 3]> = mesh.triangles.iter().flat_map(triangle).collect();
    let tetrahedra: Vec<[u32; 4]> =
        mesh.tetrahedra.iter().flat_map(|&t| parts_of_tetrahedron(t, &middles, &nodes)).collect();
    let group = |group: &Group| Group {
        lines: children(&group.lines, 2),
        triangles: children(&group.triangles, 4),
        tetrahedra: children(&group.tetrahedra, 8),
        ..group.clone()
    };
    let mut halved = Mesh {
        nodes,
        points: mesh.points.clone(),
        lines,
        triangles,
        tetrahedra,
        groups: mesh.groups.iter().map(group).collect(),
        notices: mesh.notices.clone(),
        ..Mesh::default()
    };
    halved.number();
    halved
}

/// The children of some elements, each of which becomes `count` that follow each other.
fn children(parents: &[u32], count: u32) -> Vec<u32> {
    parents.iter().flat_map(|parent| count * parent..count * (parent + 1)).collect()
}

/// Four corners and the octahedron between them, all with positive volume.
fn parts_of_tetrahedron([a, b, c, d]: [u32; 4], middles: &Middles, nodes: &[Vec3]) -> [[u32; 4]; 8] {
    let [ab, ac, ad] = [b, c, d].map(|n| middles.of(a, n));
    let [bc, bd, cd] = [middles.of(b, c), middles.of(b, d), middles.of(c, d)];
    // A diagonal, and what surrounds it in turn.
    let diagonals = [[ab, cd, ac, ad, bd, bc], [ac, bd, ab, bc, cd, ad], [ad, bc, ab, ac, cd, bd]];
    let length = |diagonal: &[u32; 6]| (nodes[diagonal[0] as usize] - nodes[diagonal[1] as usize]).norm_squared();
    let shortest = diagonals.into_iter().reduce(|best, next| if length(&next) < length(&best) { next } else { best });
    let [one, other, ring @ ..] = shortest.unwrap_or(diagonals[0]);
    let inner = [0, 1, 2, 3].map(|i| [one, other, ring[i], ring[(i + 1) % 4]]);
    let corners = [[a, ab, ac, ad], [ab, b, bc, bd], [ac, bc, c, cd], [ad, bd, cd, d]];
    let mut parts = [corners, inner].concat();
    for part in &mut parts {
        if signed_volume(part.map(|n| nodes[n as usize])) < 0.0 {
            part.swap(2, 3);
        }
    }
    std::array::from_fn(|i| parts[i])
}

/// Middles of all edges, as nodes behind those of the mesh.
struct Middles {
    /// Edges by their nodes, the lower first, ascending.
    edges: Vec<[u32; 2]>,
    first: u32,
}

impl Middles {
    fn new(mesh: &Mesh) -> Self {
        let mut edges: Vec<[u32; 2]> = mesh.lines.clone();
        edges.extend(mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]));
        let of_tetrahedron = |&[a, b, c, d]: &[u32; 4]| [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]];
        edges.extend(mesh.tetrahedra.iter().flat_map(of_tetrahedron));
        edges.iter_mut().for_each(|edge| edge.sort_unstable());
        edges.sort_unstable();
        edges.dedup();
        Middles { edges, first: mesh.nodes.len() as u32 }
    }

    fn of(&self, a: u32, b: u32) -> u32 {
        let edge = [a.min(b), a.max(b)];
        self.first + self.edges.partition_point(|other| *other < edge) as u32
    }
}

/// The mesh with its inner nodes moved at random by up to `share` of the shortest edge at each. Nodes of sides, of lines and surfaces
/// of the mesh, and between groups stay; so does a node whose move would leave an element misshapen.
///
/// - `share`: from 0 to 0.5
/// - `seed`: another one gives another mesh
pub fn scrambled(mesh: &Mesh, share: f64, seed: u64) -> Mesh {
    let mut moved = mesh.clone();
    let plane = mesh.tetrahedra.is_empty();
    let of_node = around_nodes(mesh);
    let free = free_nodes(mesh, &of_node);
    let shape = |nodes: &[Vec3], element: u32| {
        if plane {
            let corners = mesh.triangles[element as usize].map(|n| nodes[n as usize]);
            let turned = crate::quality::area_vector(corners).z < 0.0;
            if turned { -1.0 } else { triangle(corners).radius_ratio }
        } else {
            let corners = mesh.tetrahedra[element as usize].map(|n| nodes[n as usize]);
            if signed_volume(corners) <= 0.0 { -1.0 } else { tetrahedron(corners).radius_ratio }
        }
    };
    for node in (0..mesh.nodes.len()).filter(|&node| free[node]) {
        let around = of_node.row(node);
        let before = moved.nodes[node];
        let worst = |nodes: &[Vec3]| around.iter().map(|&element| shape(nodes, element)).fold(f64::INFINITY, f64::min);
        let allowed = worst(&moved.nodes).min(WORST_SHAPE);
        let corners = |element: u32| -> Vec<u32> {
            if plane { mesh.triangles[element as usize].to_vec() } else { mesh.tetrahedra[element as usize].to_vec() }
        };
        let others = around.iter().flat_map(|&element| corners(element)).filter(|&other| other as usize != node);
        let shortest =
            others.map(|other| (mesh.nodes[other as usize] - mesh.nodes[node]).norm()).fold(f64::INFINITY, f64::min);
        let random = |axis: usize| 2.0 * unit_interval(seed, 3 * node as u64 + axis as u64) - 1.0;
        let step = Vec3::new(random(0), random(1), if plane { 0.0 } else { random(2) }) * (share * shortest);
        moved.nodes[node] = before + step;
        if worst(&moved.nodes) < allowed {
            moved.nodes[node] = before;
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{structured_box, structured_rectangle};
    use crate::topology::boundary_of_tetrahedra;

    fn volume(mesh: &Mesh) -> f64 {
        mesh.tetrahedra.iter().map(|t| signed_volume(t.map(|n| mesh.nodes[n as usize]))).sum()
    }

    fn area(mesh: &Mesh) -> f64 {
        let corners = |t: &[u32; 3]| t.map(|n| mesh.nodes[n as usize]);
        mesh.triangles.iter().map(|t| crate::quality::area_vector(corners(t)).z).sum()
    }

    #[test]
    fn halves_have_the_volume_and_the_sides_of_the_whole() {
        let whole = structured_box([3, 2, 2], Vec3::new(3.0, 1.0, 2.0), None);
        let half = halved(&scrambled(&whole, 0.3, 7));
        assert_eq!(half.tetrahedra.len(), 8 * whole.tetrahedra.len());
        assert!((volume(&half) - 6.0).abs() < 1e-12);
        assert!(half.tetrahedra.iter().all(|t| signed_volume(t.map(|n| half.nodes[n as usize])) > 0.0));
        assert_eq!(boundary_of_tetrahedra(&half.tetrahedra).len(), 4 * whole.triangles.len(), "it hangs together");
        for (name, axis, at) in [("x-", 0, 0.0), ("x+", 0, 3.0), ("z+", 2, 2.0)] {
            let side = half.group_nodes(name);
            assert!(side.iter().all(|&n| half.nodes[n as usize][axis] == at), "{name}");
            assert_eq!(half.group(name)[0].triangles.len(), 4 * whole.group(name)[0].triangles.len());
        }
        let whole = structured_rectangle([4, 3], [2.0, 1.0], None);
        let half = halved(&whole);
        assert_eq!((half.triangles.len(), half.nodes.len()), (96, 9 * 7));
        assert!((area(&half) - 2.0).abs() < 1e-13);
        assert_eq!(half.group_nodes("x+").len(), 7);
        assert!(half.triangles.iter().all(|t| crate::quality::area_vector(t.map(|n| half.nodes[n as usize])).z > 0.0));
    }

    #[test]
    fn only_inner_nodes_move_and_no_element_is_spoilt() {
        let whole = structured_box([4, 4, 4], Vec3::new(1.0, 1.0, 1.0), None);
        let moved = scrambled(&whole, 0.3, 1);
        let is_inner = |node: &Vec3| node.iter().all(|x| *x > 0.0 && *x < 1.0);
        let changed = |n: usize| moved.nodes[n] != whole.nodes[n];
        assert!((0..125).all(|n| !changed(n) || is_inner(&whole.nodes[n])));
        assert!((0..125).filter(|&n| changed(n)).count() > 20, "27 are inside");
        assert!((volume(&moved) - 1.0).abs() < 1e-13);
        let worst = moved.tetrahedra.iter().map(|t| tetrahedron(t.map(|n| moved.nodes[n as usize])).radius_ratio);
        assert!(worst.fold(f64::INFINITY, f64::min) >= WORST_SHAPE);
        assert_ne!(moved, scrambled(&whole, 0.3, 2));
        // A power of two changes no bit.
        let mut small = whole.clone();
        small.nodes.iter_mut().for_each(|x| *x /= 1024.0);
        assert!(scrambled(&small, 0.3, 1).nodes.iter().zip(&moved.nodes).all(|(a, b)| *a * 1024.0 == *b));
    }

    #[test]
    fn nodes_between_groups_stay() {
        let mut two = structured_rectangle([6, 6], [1.0, 1.0], None);
        let is_left = |t: &[u32; 3]| t.iter().map(|&n| two.nodes[n as usize].x).sum::<f64>() < 1.5;
        let left = (0..two.triangles.len() as u32).filter(|&i| is_left(&two.triangles[i as usize])).collect();
        two.groups.push(Group { name: "left".into(), dimension: 2, tag: 2, triangles: left, ..Group::default() });
        let moved = scrambled(&two, 0.3, 1);
        let stayed = |n: usize| moved.nodes[n] == two.nodes[n];
        assert!((0..49).filter(|&n| two.nodes[n].x == 0.5).all(stayed));
        assert!((0..49).filter(|&n| !stayed(n)).count() > 12);
    }
}
