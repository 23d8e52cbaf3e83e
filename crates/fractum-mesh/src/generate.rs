//! Structured meshes for tests and benches: boxes of tetrahedra, rectangles of triangles.

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
    let nodes = grid.nodes(jitter);
    // the six ways from corner 000 to corner 111 along the axes; odd permutations change the sense
    const PATHS: [[usize; 3]; 6] = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
    let mut tetrahedra = Vec::with_capacity(6 * grid.cell_count());
    for cell in grid.cells() {
        for (number, path) in PATHS.iter().enumerate() {
            let mut corner = cell;
            let mut element = [grid.node(corner); 4];
            for (step, &axis) in path.iter().enumerate() {
                corner[axis] += 1;
                element[step + 1] = grid.node(corner);
            }
            if number >= 3 {
                element.swap(2, 3);
            }
            tetrahedra.push(element);
        }
    }
    let triangles: Vec<[u32; 3]> = boundary_of_tetrahedra(&tetrahedra).into_iter().map(|facet| facet.nodes).collect();
    let mut groups = grid.side_groups(2, 3, &triangles, |group| &mut group.triangles);
    let all = (0..tetrahedra.len() as u32).collect();
    groups.push(Group { name: "body".to_owned(), dimension: 3, tag: 1, tetrahedra: all, ..Group::default() });
    let first_tag = triangles.len() as u64 + 1;
    Mesh {
        node_tags: (1..=nodes.len() as u64).collect(),
        triangle_tags: (1..first_tag).collect(),
        tetrahedron_tags: (first_tag..first_tag + tetrahedra.len() as u64).collect(),
        nodes,
        triangles,
        tetrahedra,
        groups,
        ..Mesh::default()
    }
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
    let first_tag = lines.len() as u64 + 1;
    Mesh {
        node_tags: (1..=nodes.len() as u64).collect(),
        line_tags: (1..first_tag).collect(),
        triangle_tags: (first_tag..first_tag + triangles.len() as u64).collect(),
        nodes,
        lines,
        triangles,
        groups,
        ..Mesh::default()
    }
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
