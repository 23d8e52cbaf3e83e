//! Meshes that the program makes itself: structured boxes and rectangles, and plane bodies within outlines.

pub(crate) mod delaunay;
pub(crate) mod outline;
pub(crate) mod squares;

pub use outline::{Curve, Outline, Piece, fill};

use std::collections::{BTreeMap, BTreeSet};

use fractum_math::Vec3;

use crate::topology::{boundary_of_tetrahedra, boundary_of_triangles};
use crate::{Group, Mesh};

/// Random displacement of the interior nodes, the same for the same seed on every machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jitter {
    /// Largest displacement along each axis, as a fraction of the cell; at least 0 and below 1/6, where no element
    /// can invert.
    pub fraction: f64,
    /// Another seed gives another mesh.
    pub seed: u64,
}

/// A box from the origin to `size`, of `cells[0]`·`cells[1]`·`cells[2]` cells with six tetrahedra each (Kuhn), all
/// with the same diagonal.
///
/// Groups: `body`, and of the boundary triangles `x-`, `x+`, `y-`, `y+`, `z-`, `z+`.
///
/// # Panics
/// If a number of cells is 0, a size is not positive, the jitter is out of range, or the mesh exceeds 32 bit indices.
pub fn structured_box(cells: [u32; 3], size: Vec3, jitter: Option<Jitter>) -> Mesh {
    let grid = Grid::new(cells, size);
    let tetrahedra = grid.cells().flat_map(|cell| grid.tetrahedra(cell, [false; 3])).collect();
    grid.solid(grid.nodes(jitter), tetrahedra)
}

/// As [`structured_box`] of some cells alone, each of which is the mirror of its neighbours, so that no diagonal is favoured.
///
/// - `keep`: whether a cell is there
///
/// # Panics
/// As [`structured_box`].
pub fn mirrored_cells(cells: [u32; 3], size: Vec3, keep: impl Fn([u32; 3]) -> bool) -> Mesh {
    let grid = Grid::new(cells, size);
    let kept = grid.cells().filter(|&cell| keep(cell));
    let tetrahedra = kept.flat_map(|cell| grid.tetrahedra(cell, cell.map(|index| index % 2 == 1))).collect();
    let mut mesh = grid.solid(grid.nodes(None), tetrahedra);
    let used: BTreeSet<u32> = mesh.tetrahedra.iter().flatten().copied().collect();
    let new: BTreeMap<u32, u32> = used.iter().copied().zip(0..).collect();
    mesh.nodes = used.iter().map(|&node| mesh.nodes[node as usize]).collect();
    mesh.tetrahedra.iter_mut().flatten().for_each(|node| *node = new[node]);
    mesh.triangles.iter_mut().flatten().for_each(|node| *node = new[node]);
    mesh.number();
    mesh
}

/// A rectangle from the origin to `size` in the xy-plane, of `cells[0]`·`cells[1]` cells with two counter-clockwise
/// triangles each, all with the same diagonal.
///
/// Groups: `body`, and of the boundary lines `x-`, `x+`, `y-`, `y+`.
///
/// # Panics
/// As [`structured_box`].
pub fn structured_rectangle(cells: [u32; 2], size: [f64; 2], jitter: Option<Jitter>) -> Mesh {
    let grid = Grid::new([cells[0], cells[1], 0], Vec3::new(size[0], size[1], 0.0));
    let nodes = grid.nodes(jitter);
    let mut triangles = Vec::with_capacity(2 * grid.cell_count());
    for [i, j, _] in grid.cells() {
        let [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|[i, j]| grid.node([i, j, 0]));
        triangles.push([a, b, c]);
        triangles.push([a, c, d]);
    }
    let lines: Vec<[u32; 2]> = boundary_of_triangles(&triangles).into_iter().map(|edge| edge.nodes).collect();
    let sides = grid.side_groups(1, 2, &lines, |group| &mut group.lines);
    plane_mesh(nodes, lines, triangles, sides)
}

/// A mesh of triangles with the group `body` of them all after those of lines.
pub fn plane_mesh(nodes: Vec<Vec3>, lines: Vec<[u32; 2]>, triangles: Vec<[u32; 3]>, sides: Vec<Group>) -> Mesh {
    let all = (0..triangles.len() as u32).collect();
    let mut groups = sides;
    groups.push(Group { name: "body".to_owned(), dimension: 2, tag: 1, triangles: all, ..Group::default() });
    let mut mesh = Mesh { nodes, lines, triangles, groups, ..Mesh::default() };
    mesh.number();
    mesh
}

/// A grid of cells; an axis with 0 cells is absent.
struct Grid {
    cells: [u32; 3],
    size: Vec3,
}

impl Grid {
    fn new(cells: [u32; 3], size: Vec3) -> Self {
        assert!(cells[0] > 0 && cells[1] > 0, "a structured mesh needs cells along every axis, has {cells:?}");
        for axis in 0..3 {
            let present = cells[axis] > 0;
            let fits = if present { size[axis].is_finite() && size[axis] > 0.0 } else { size[axis] == 0.0 };
            assert!(
                fits,
                "a structured mesh needs cells and a positive size along every axis, has {cells:?}, {size:?}"
            );
        }
        let nodes: u128 = cells.iter().map(|&n| u128::from(n) + 1).product();
        assert!(6 * nodes < u128::from(u32::MAX), "a structured mesh of {cells:?} cells exceeds 32 bit indices");
        Grid { cells, size }
    }

    fn cell_count(&self) -> usize {
        self.cells.iter().map(|&n| n.max(1) as usize).product()
    }

    /// Lowest corner of each cell, x fastest.
    fn cells(&self) -> impl Iterator<Item = [u32; 3]> {
        let [nx, ny, nz] = self.cells.map(|n| n.max(1));
        (0..nz).flat_map(move |k| (0..ny).flat_map(move |j| (0..nx).map(move |i| [i, j, k])))
    }

    fn node(&self, [i, j, k]: [u32; 3]) -> u32 {
        i + (self.cells[0] + 1) * (j + (self.cells[1] + 1) * k)
    }

    /// The six tetrahedra of a cell, which may be mirrored along each axis.
    fn tetrahedra(&self, cell: [u32; 3], mirrored: [bool; 3]) -> [[u32; 4]; 6] {
        // The six ways from corner 000 to corner 111 along the axes; odd permutations change the sense, and so does a mirror.
        const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
        let turned = mirrored.iter().filter(|&&mirrored| mirrored).count() % 2 == 1;
        let mut tetrahedra = [[0; 4]; 6];
        for (number, (path, element)) in PATHS.iter().zip(&mut tetrahedra).enumerate() {
            let mut corner: [u32; 3] = std::array::from_fn(|axis| cell[axis] + u32::from(mirrored[axis]));
            element[0] = self.node(corner);
            for (step, &axis) in path.iter().enumerate() {
                corner[axis] = 2 * cell[axis] + 1 - corner[axis];
                element[step + 1] = self.node(corner);
            }
            if (number >= 3) != turned {
                element.swap(2, 3);
            }
        }
        tetrahedra
    }

    /// A mesh of tetrahedra with its sides.
    fn solid(&self, nodes: Vec<Vec3>, tetrahedra: Vec<[u32; 4]>) -> Mesh {
        let facets = boundary_of_tetrahedra(&tetrahedra);
        let triangles: Vec<[u32; 3]> = facets.into_iter().map(|facet| facet.nodes).collect();
        let mut groups = self.side_groups(2, 3, &triangles, |group| &mut group.triangles);
        let all = (0..tetrahedra.len() as u32).collect();
        groups.push(Group { name: "body".to_owned(), dimension: 3, tag: 1, tetrahedra: all, ..Group::default() });
        let mut mesh = Mesh { nodes, triangles, tetrahedra, groups, ..Mesh::default() };
        mesh.number();
        mesh
    }

    /// Grid coordinates of a node.
    fn place(&self, node: u32) -> [u32; 3] {
        let [nx, ny] = [self.cells[0] + 1, self.cells[1] + 1];
        [node % nx, node / nx % ny, node / nx / ny]
    }

    fn nodes(&self, jitter: Option<Jitter>) -> Vec<Vec3> {
        if let Some(Jitter { fraction, .. }) = jitter {
            assert!((0.0..1.0 / 6.0).contains(&fraction), "jitter {fraction} is not in 0..1/6");
        }
        let count: u32 = self.cells.iter().map(|n| n + 1).product();
        let spacing = |axis: usize| self.size[axis] / f64::from(self.cells[axis].max(1));
        let position = |node: u32| {
            let place = self.place(node);
            let interior = (0..3).all(|axis| self.cells[axis] == 0 || (1..self.cells[axis]).contains(&place[axis]));
            Vec3::from_fn(|axis, _| {
                let n = self.cells[axis];
                let exact = if place[axis] == n { self.size[axis] } else { f64::from(place[axis]) * spacing(axis) };
                match jitter {
                    Some(jitter) if interior && n > 0 => {
                        let unit = unit_interval(jitter.seed, 3 * u64::from(node) + axis as u64);
                        exact + spacing(axis) * jitter.fraction * (2.0 * unit - 1.0)
                    }
                    _ => exact,
                }
            })
        };
        (0..count).map(position).collect()
    }

    /// The boundary sides by the plane that holds them, as groups with tags from 1.
    fn side_groups<const N: usize>(
        &self,
        dimension: u8,
        axes: usize,
        sides: &[[u32; N]],
        members: impl Fn(&mut Group) -> &mut Vec<u32>,
    ) -> Vec<Group> {
        const NAMES: [&str; 6] = ["x-", "x+", "y-", "y+", "z-", "z+"];
        let new = |(name, tag): (&&str, i32)| Group { name: (*name).to_owned(), dimension, tag, ..Group::default() };
        let mut groups: Vec<Group> = NAMES[..2 * axes].iter().zip(1..).map(new).collect();
        for (index, side) in sides.iter().enumerate() {
            for axis in 0..axes {
                for (end, plane) in [0, self.cells[axis]].into_iter().enumerate() {
                    if side.iter().all(|&node| self.place(node)[axis] == plane) {
                        members(&mut groups[2 * axis + end]).push(index as u32);
                    }
                }
            }
        }
        groups
    }
}

/// A number in 0..1 that depends on seed and counter only (SplitMix64: Steele, Lea, Flood, OOPSLA 2014).
pub(crate) fn unit_interval(seed: u64, counter: u64) -> f64 {
    let mut z = seed.wrapping_add(counter.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality::signed_volume;

    #[test]
    fn mirrored_cells_fill_an_angle_with_the_sides_of_its_box() {
        let mesh = mirrored_cells([4, 3, 2], Vec3::new(4.0, 3.0, 2.0), |[i, j, _]| i == 0 || j == 0);
        let volumes: Vec<f64> =
            mesh.tetrahedra.iter().map(|t| signed_volume(t.map(|node| mesh.nodes[node as usize]))).collect();
        assert!(volumes.iter().all(|volume| (volume - 1.0 / 6.0).abs() < 1e-12) && volumes.len() == 6 * 6 * 2);
        // Sides of an angle: two of 6 squares, a rim of 14 by 2; were a diagonal not shared, inner sides would be among them.
        assert_eq!(boundary_of_tetrahedra(&mesh.tetrahedra).len(), 2 * (2 * 6 + 14 * 2));
        assert_eq!((mesh.group_nodes("x+").len(), mesh.group_nodes("y+").len()), (6, 6));
    }
}
