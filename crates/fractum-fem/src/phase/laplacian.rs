//! The Laplacian of a field that lives on edges.
//!
//! In triangles the field is linear with its values at the middles of the sides (Crouzeix and Raviart 1973). In tetrahedra its
//! gradient is Σ d_ij (∇N_i + ∇N_j) over the six edges, exact for linear fields; what that does not see is how the sums over the three pairs of opposite edges
//! differ, which a second term holds together.

use fractum_mesh::topology::{TETRAHEDRON_EDGES, TRIANGLE_EDGES};

use crate::body::{BodyEdges, ElementKind};
use crate::cell::Geometry;

/// Weight of the second term in tetrahedra. Without it two fields cost nothing; chosen so that an imposed plane crack costs
/// its area in Delaunay's tetrahedra, 0.996 to 1.005 of it.
const PAIRS: f64 = 0.3;

/// Rows of the Laplacian, the own edge first in each.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    starts: Vec<u32>,
    columns: Vec<u32>,
    values: Vec<f64>,
    /// Half of the sum of the magnitudes of every row [m³/m²]: the diagonal, or more where values beside it are positive. Jacobi's iteration with
    /// it never grows (Gershgorin), while that with the diagonal does so by up to 2.1 a sweep in tetrahedra.
    bounds: Vec<f64>,
}

impl Rows {
    /// Edges of a row with their values [m³/m²].
    #[inline(always)]
    pub(crate) fn row(&self, row: usize) -> (&[u32], &[f64]) {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        (&self.columns[range.clone()], &self.values[range])
    }

    /// (L d) of a row, and the value on the diagonal.
    #[inline(always)]
    pub(crate) fn product(&self, row: usize, field: &[f64]) -> (f64, f64) {
        let (columns, values) = self.row(row);
        (columns.iter().zip(values).map(|(&column, value)| value * field[column as usize]).sum(), values[0])
    }

    /// What a sweep may divide the residual of a row by [m³/m²].
    #[inline(always)]
    pub(crate) fn bound(&self, row: usize) -> f64 {
        self.bounds[row]
    }

    pub(crate) fn clear(&mut self) {
        self.bounds.clear();
        self.starts.clear();
        self.columns.clear();
        self.values.clear();
    }

    /// These rows in this order.
    pub(crate) fn in_order(&self, order: &[usize]) -> Rows {
        let mut rows = Rows { starts: vec![0], ..Rows::default() };
        for &row in order {
            let (columns, values) = self.row(row);
            rows.columns.extend(columns);
            rows.values.extend(values);
            rows.bounds.push(self.bounds[row]);
            rows.starts.push(rows.columns.len() as u32);
        }
        rows
    }

    /// Adds the row of an edge, from the elements around it that are alive.
    pub(crate) fn push(
        &mut self,
        geometry: &Geometry<'_>,
        edges: &BodyEdges,
        (edge, around): (u32, &[u32]),
        alive: &[bool],
    ) {
        if self.starts.is_empty() {
            self.starts.push(0);
        }
        let begin = self.columns.len();
        let count = geometry.body.shape.edge_count();
        self.columns.push(edge);
        for &element in around {
            for &other in &edges.of_element[element as usize][..count] {
                if !self.columns[begin..].contains(&other) {
                    self.columns.push(other);
                }
            }
        }
        self.values.resize(self.columns.len(), 0.0);
        self.bounds.push(0.0);
        self.starts.push(self.columns.len() as u32);
        self.refresh(self.starts.len() - 2, geometry, edges, around, alive);
    }

    /// Computes the values of a row anew.
    pub(crate) fn refresh(
        &mut self,
        row: usize,
        geometry: &Geometry<'_>,
        edges: &BodyEdges,
        around: &[u32],
        alive: &[bool],
    ) {
        let range = self.starts[row] as usize..self.starts[row + 1] as usize;
        let (columns, values) = (&self.columns[range.clone()], &mut self.values[range]);
        values.fill(0.0);
        let count = geometry.body.shape.edge_count();
        for &element in around.iter().filter(|&&e| alive[e as usize]) {
            let of = &edges.of_element[element as usize][..count];
            let own = of.iter().position(|&e| e == columns[0]).expect("an element around an edge has that edge");
            for (&other, value) in of.iter().zip(element_row(geometry, element as usize, own)) {
                let place = columns.iter().position(|&e| e == other).expect("a row holds the edges around it");
                values[place] += value;
            }
        }
        self.bounds[row] = values[0].max(0.5 * values.iter().map(|value| value.abs()).sum::<f64>());
    }
}

/// One row of the Laplacian of an element [m³/m²].
fn element_row(geometry: &Geometry<'_>, element: usize, own: usize) -> [f64; 6] {
    let (volume, gradients) = geometry.element(element);
    let of = |ends: &[usize; 2]| gradients[ends[0]] + gradients[ends[1]];
    match geometry.body.shape {
        ElementKind::T3 => {
            let mine = of(&TRIANGLE_EDGES[own]);
            std::array::from_fn(|i| TRIANGLE_EDGES.get(i).map_or(0.0, |ends| 4.0 * volume * mine.dot(&of(ends))))
        }
        ElementKind::T4 => {
            let corners = geometry.body.elements[element].map(|node| geometry.nodes[node as usize]);
            let square: f64 =
                TETRAHEDRON_EDGES.iter().map(|&[i, j]| (corners[j] - corners[i]).norm_squared()).sum::<f64>() / 6.0;
            let mine = of(&TETRAHEDRON_EDGES[own]);
            std::array::from_fn(|i| {
                // An edge and that opposite to it share a pair.
                let pair = if i == own || i == 5 - own { 2.0 / 3.0 } else { -1.0 / 3.0 };
                volume * (mine.dot(&of(&TETRAHEDRON_EDGES[i])) + PAIRS / square * pair)
            })
        }
    }
}
