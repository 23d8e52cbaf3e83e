//! Orders that keep what is close in space close in memory.

use fractum_math::Vec3;
use rayon::prelude::*;

use crate::mesh::bounding_box;
use crate::{CutFace, Group, Mesh};

/// Bits per axis of the grid on which points are ordered.
const BITS: u32 = 20;

/// Orders points along a Hilbert curve through their bounding cube, so that neighbours in space are mostly neighbours
/// in the order. Points in one cell of the grid (2⁻²⁰ of the largest extent) keep the order of their indices.
///
/// - returns `order`: new index k holds old index `order[k]`
///
/// Coordinates should be finite; others are taken as lying on the box.
pub fn hilbert_order(points: &[Vec3]) -> Vec<u32> {
    let (low, high) = bounding_box(points);
    let curve = HilbertCurve::new(low, high);
    let mut keys: Vec<(u64, u32)> =
        points.par_iter().enumerate().map(|(index, point)| (curve.position(point), index as u32)).collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, index)| index).collect()
}

/// The curve of [`hilbert_order`] through a box.
#[derive(Clone, Copy, Debug)]
pub struct HilbertCurve {
    low: Vec3,
    scale: f64,
}

impl HilbertCurve {
    /// The curve through the smallest cube that holds a box.
    pub fn new(low: Vec3, high: Vec3) -> Self {
        let extent = (high - low).max();
        let scale = if extent > 0.0 { f64::from((1u32 << BITS) - 1) / extent } else { 0.0 };
        HilbertCurve { low, scale }
    }

    /// Where a point lies along the curve.
    pub fn position(&self, point: &Vec3) -> u64 {
        let cell = |axis: usize| (((point[axis] - self.low[axis]) * self.scale) as u32).min((1 << BITS) - 1);
        hilbert_index([cell(0), cell(1), cell(2)])
    }
}

/// The inverse of a permutation: `invert(order)[order[k]] == k`.
///
/// # Panics
/// If `order` is not a permutation of its indices.
pub fn invert(order: &[u32]) -> Vec<u32> {
    let mut inverse = vec![u32::MAX; order.len()];
    for (new, &old) in order.iter().enumerate() {
        assert_eq!(inverse[old as usize], u32::MAX, "index {old} occurs twice in a permutation");
        inverse[old as usize] = new as u32;
    }
    inverse
}

/// The orders of a renumbered mesh: new index k holds old index `order[k]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Renumbering {
    /// Order of the nodes.
    pub nodes: Vec<u32>,
    /// Order of the point elements.
    pub points: Vec<u32>,
    /// Order of the lines.
    pub lines: Vec<u32>,
    /// Order of the triangles.
    pub triangles: Vec<u32>,
    /// Order of the tetrahedra.
    pub tetrahedra: Vec<u32>,
}

/// Renumbers the nodes along a Hilbert curve and the elements along the same curve through their centroids. Elements
/// keep the order of their own nodes; groups and tags follow.
pub fn renumber_along_hilbert_curve(mesh: &Mesh) -> (Mesh, Renumbering) {
    let renumbering = Renumbering {
        nodes: hilbert_order(&mesh.nodes),
        points: order_of_centroids(&mesh.nodes, &mesh.points),
        lines: order_of_centroids(&mesh.nodes, &mesh.lines),
        triangles: order_of_centroids(&mesh.nodes, &mesh.triangles),
        tetrahedra: order_of_centroids(&mesh.nodes, &mesh.tetrahedra),
    };
    (renumbering.apply(mesh), renumbering)
}

impl Renumbering {
    /// The mesh in the new order.
    ///
    /// # Panics
    /// If the orders are not those of a mesh of this size.
    pub fn apply(&self, mesh: &Mesh) -> Mesh {
        let new_node = invert(&self.nodes);
        let group = |group: &Group| Group {
            points: members(&group.points, &self.points),
            lines: members(&group.lines, &self.lines),
            triangles: members(&group.triangles, &self.triangles),
            tetrahedra: members(&group.tetrahedra, &self.tetrahedra),
            ..group.clone()
        };
        Mesh {
            nodes: permute(&mesh.nodes, &self.nodes),
            node_tags: permute(&mesh.node_tags, &self.nodes),
            points: elements(&mesh.points, &self.points, &new_node),
            point_tags: permute(&mesh.point_tags, &self.points),
            lines: elements(&mesh.lines, &self.lines, &new_node),
            line_tags: permute(&mesh.line_tags, &self.lines),
            triangles: elements(&mesh.triangles, &self.triangles, &new_node),
            triangle_tags: permute(&mesh.triangle_tags, &self.triangles),
            tetrahedra: elements(&mesh.tetrahedra, &self.tetrahedra, &new_node),
            tetrahedron_tags: permute(&mesh.tetrahedron_tags, &self.tetrahedra),
            groups: mesh.groups.iter().map(group).collect(),
            notices: mesh.notices.clone(),
            whole: mesh.whole.clone(),
            cuts: mesh
                .cuts
                .iter()
                .map(|face| CutFace { sides: face.sides.map(|side| side.map(|n| new_node[n as usize])), ..*face })
                .collect(),
        }
    }

    /// The renumbering that leads back.
    pub fn inverse(&self) -> Renumbering {
        Renumbering {
            nodes: invert(&self.nodes),
            points: invert(&self.points),
            lines: invert(&self.lines),
            triangles: invert(&self.triangles),
            tetrahedra: invert(&self.tetrahedra),
        }
    }
}

/// Values in the new order: `permute(values, order)[k] == values[order[k]]`. With [`invert`] of the order, the way
/// back.
///
/// # Panics
/// If the lengths differ.
pub fn permute<T: Copy + Send + Sync>(values: &[T], order: &[u32]) -> Vec<T> {
    assert_eq!(values.len(), order.len(), "as many values as places");
    order.par_iter().map(|&old| values[old as usize]).collect()
}

fn elements<const N: usize>(elements: &[[u32; N]], order: &[u32], new_node: &[u32]) -> Vec<[u32; N]> {
    assert_eq!(elements.len(), order.len(), "as many elements as places");
    order.par_iter().map(|&old| elements[old as usize].map(|node| new_node[node as usize])).collect()
}

/// New indices of the members of a group, ascending.
fn members(members: &[u32], order: &[u32]) -> Vec<u32> {
    if members.is_empty() {
        return Vec::new();
    }
    let mut is_member = vec![false; order.len()];
    members.iter().for_each(|&member| is_member[member as usize] = true);
    (0..order.len() as u32).filter(|&new| is_member[order[new as usize] as usize]).collect()
}

fn order_of_centroids<const N: usize>(nodes: &[Vec3], elements: &[[u32; N]]) -> Vec<u32> {
    let centroid = |element: &[u32; N]| element.iter().map(|&node| nodes[node as usize]).sum::<Vec3>() / N as f64;
    hilbert_order(&elements.par_iter().map(centroid).collect::<Vec<_>>())
}

/// Position of a grid cell along the Hilbert curve of [`BITS`] levels, from the coordinates to their transpose and
/// then bit by bit. Skilling, *Programming the Hilbert curve*, AIP Conf. Proc. 707 (2004) 381-387.
fn hilbert_index(mut cell: [u32; 3]) -> u64 {
    // undo the rotations of the levels, coarsest first
    let mut level = 1 << (BITS - 1);
    while level > 1 {
        let below = level - 1;
        for axis in 0..3 {
            // where the bit is set invert the lower bits of x, else exchange them with those of this axis
            let set = if cell[axis] & level != 0 { below } else { 0 };
            let swap = (cell[0] ^ cell[axis]) & below & !set;
            cell[0] ^= swap | set;
            cell[axis] ^= swap;
        }
        level >>= 1;
    }
    // Gray code to binary
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let mut flip = 0;
    let mut level = 1 << (BITS - 1);
    while level > 1 {
        flip ^= if cell[2] & level != 0 { level - 1 } else { 0 };
        level >>= 1;
    }
    cell.iter_mut().for_each(|x| *x ^= flip);
    (spread(cell[0]) << 2) | (spread(cell[1]) << 1) | spread(cell[2])
}

/// Moves bit k to bit 3k, for 21 bits.
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x) & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{Jitter, structured_box};

    #[test]
    fn consecutive_cells_of_a_full_grid_share_a_face() {
        let n = 16u32;
        let cells: Vec<[u32; 3]> = (0..n * n * n).map(|i| [i % n, i / n % n, i / n / n]).collect();
        let points: Vec<Vec3> = cells.iter().map(|c| Vec3::new(c[0].into(), c[1].into(), c[2].into())).collect();
        let order = hilbert_order(&points);
        for pair in order.windows(2) {
            let step = points[pair[0] as usize] - points[pair[1] as usize];
            assert_eq!(step.abs().sum(), 1.0);
        }
    }

    #[test]
    fn renumbering_and_its_inverse_give_the_mesh_back() {
        let jitter = Some(Jitter { fraction: 0.1, seed: 3 });
        let mesh = structured_box([5, 4, 3], Vec3::new(1.0, 1.0, 0.4), jitter);
        let (new, renumbering) = renumber_along_hilbert_curve(&mesh);
        assert_ne!(new.nodes, mesh.nodes);
        assert_eq!(renumbering.inverse().apply(&new), mesh);
        let values: Vec<u64> = permute(&mesh.node_tags, &renumbering.nodes);
        assert_eq!(values, new.node_tags);
        for (group, old) in new.groups.iter().zip(&mesh.groups) {
            assert!(group.triangles.is_sorted() && group.tetrahedra.is_sorted());
            let tags = |mesh: &Mesh, group: &Group| -> Vec<u64> {
                let mut tags: Vec<u64> =
                    mesh.group_nodes(&group.name).iter().map(|&n| mesh.node_tags[n as usize]).collect();
                tags.sort_unstable();
                tags
            };
            assert_eq!(tags(&new, group), tags(&mesh, old));
        }
    }

    #[test]
    fn neighbours_come_close_in_the_order() {
        let mesh = structured_box([16, 16, 16], Vec3::new(1.0, 1.0, 1.0), None);
        let shuffled: Vec<u32> = (0..4913u64).map(|k| (k * 1999 % 4913) as u32).collect();
        let scattered = Renumbering {
            nodes: shuffled,
            triangles: (0..mesh.triangles.len() as u32).collect(),
            tetrahedra: (0..mesh.tetrahedra.len() as u32).collect(),
            ..Renumbering::default()
        };
        let span = |mesh: &Mesh| -> f64 {
            let spread = |e: &[u32; 4]| f64::from(e.iter().max().unwrap() - e.iter().min().unwrap());
            let mut spans: Vec<f64> = mesh.tetrahedra.iter().map(spread).collect();
            spans.sort_by(f64::total_cmp);
            spans[spans.len() / 2]
        };
        let scattered = scattered.apply(&mesh);
        let (ordered, _) = renumber_along_hilbert_curve(&scattered);
        assert!(span(&ordered) < 200.0 && span(&scattered) > 2000.0);
    }

    #[test]
    fn equal_points_keep_their_order_and_strange_ones_do_no_harm() {
        assert_eq!(hilbert_order(&[Vec3::zeros(); 5]), [0, 1, 2, 3, 4]);
        assert!(hilbert_order(&[]).is_empty());
        let strange = [Vec3::new(f64::NAN, 0.0, 1.0), Vec3::new(f64::INFINITY, 0.0, 0.0), Vec3::zeros()];
        let order = hilbert_order(&strange);
        assert_eq!(invert(&invert(&order)), order);
    }
}
