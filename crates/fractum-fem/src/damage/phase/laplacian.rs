//! The Laplacian of a field that lives on edges.
//!
//! In triangles the field is linear with its values at the middles of the sides (Crouzeix and Raviart 1973). In tetrahedra its
//! gradient is Σ d_ij (∇N_i + ∇N_j) over the six edges, exact for linear fields; what that does not see is how the sums over the three pairs of opposite edges
//! differ, which a second term holds together.

use std::ops::Range;

use fractum_math::{FOUR, Lane};
use fractum_mesh::topology::{TETRAHEDRON_EDGES, TRIANGLE_EDGES};

use crate::body::ElementKind;
use crate::body::edges::BodyEdges;
use crate::cells::cell::Geometry;

/// Weight of the second term in tetrahedra. Without it two fields cost nothing; chosen so that an imposed plane crack costs
/// its area in Delaunay's tetrahedra, 0.996 to 1.005 of it.
const PAIRS: f64 = 0.3;

/// Rows of the Laplacian, the own edge first in each, four side by side.
///
/// All rows of a group of four have as many entries as its longest; those behind their own end are zeros on an edge of the group.
#[derive(Clone, Debug, Default)]
pub(crate) struct Rows {
    /// First entry of every group, and the end of the last.
    starts: Vec<u32>,
    columns: Vec<[u32; FOUR]>,
    values: Vec<Lane>,
    /// Entries of every row of its own.
    lengths: Vec<u32>,
    /// Half of the sum of the magnitudes of every row [m³/m²]: the diagonal, or more where values beside it are positive. Jacobi's iteration with
    /// it never grows (Gershgorin), while that with the diagonal does so by up to 2.1 a sweep in tetrahedra.
    bounds: Vec<f64>,
    /// Edges of the row that is being added.
    found: Vec<u32>,
}

impl Rows {
    fn group(&self, group: usize) -> Range<usize> {
        self.starts[group] as usize..self.starts[group + 1] as usize
    }

    /// Edges of a row.
    pub(crate) fn edges(&self, row: usize) -> impl Iterator<Item = u32> + '_ {
        let begin = self.group(row / FOUR).start;
        self.columns[begin..begin + self.lengths[row] as usize].iter().map(move |columns| columns[row % FOUR])
    }

    /// Values of a row [m³/m²].
    fn values(&self, row: usize) -> impl Iterator<Item = f64> + '_ {
        let begin = self.group(row / FOUR).start;
        self.values[begin..begin + self.lengths[row] as usize].iter().map(move |values| values.0[row % FOUR])
    }

    /// Value of a row on the diagonal [m³/m²].
    #[inline]
    pub(crate) fn diagonal(&self, row: usize) -> f64 {
        self.values[self.group(row / FOUR).start].0[row % FOUR]
    }

    /// (L d) of a group of rows, each summed in the order of its entries.
    #[inline(always)]
    pub(crate) fn products(&self, group: usize, field: &[f64]) -> Lane {
        let range = self.group(group);
        let mut flows = Lane::ZERO;
        for (columns, &values) in self.columns[range.clone()].iter().zip(&self.values[range]) {
            let mut d = Lane::ZERO;
            for k in 0..FOUR {
                d.0[k] = field[columns[k] as usize];
            }
            flows = flows + values * d;
        }
        flows
    }

    /// What a sweep may divide the residuals of a group of rows by [m³/m²]; ones where there are no rows.
    #[inline(always)]
    pub(crate) fn bounds(&self, group: usize) -> Lane {
        let mut bounds = Lane::splat(1.0);
        for (bound, own) in bounds.0.iter_mut().zip(&self.bounds[group * FOUR..]) {
            *bound = *own;
        }
        bounds
    }

    pub(crate) fn clear(&mut self) {
        *self = Rows::default();
    }

    /// These rows in this order.
    pub(crate) fn in_order(&self, order: &[usize]) -> Rows {
        let mut rows = Rows::default();
        for (new, &row) in order.iter().enumerate() {
            rows.found.clear();
            rows.found.extend(self.edges(row));
            rows.append();
            let begin = rows.group(new / FOUR).start;
            rows.values[begin..].iter_mut().zip(self.values(row)).for_each(|(values, own)| values.0[new % FOUR] = own);
            rows.bounds[new] = self.bounds[row];
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
        let count = geometry.body.shape.edge_count();
        self.found.clear();
        self.found.push(edge);
        for &element in around {
            for &other in &edges.of_element(element)[..count] {
                if !self.found.contains(&other) {
                    self.found.push(other);
                }
            }
        }
        self.append();
        self.refresh(self.lengths.len() - 1, geometry, edges, around, alive);
    }

    /// Adds a row of zeros with the edges that were found.
    fn append(&mut self) {
        let (row, length) = (self.lengths.len(), self.found.len());
        if row % FOUR == 0 {
            self.starts.resize(row / FOUR + 1, self.columns.len() as u32);
            self.starts.push(self.columns.len() as u32);
            self.columns.push([self.found[0]; FOUR]);
            self.values.push(Lane::ZERO);
        }
        let begin = self.starts[row / FOUR] as usize;
        let end = self.columns.len().max(begin + length);
        self.columns.resize(end, self.columns[begin]);
        self.values.resize(end, Lane::ZERO);
        self.starts[row / FOUR + 1] = end as u32;
        self.columns[begin..].iter_mut().zip(&self.found).for_each(|(columns, &edge)| columns[row % FOUR] = edge);
        self.lengths.push(length as u32);
        self.bounds.push(0.0);
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
        let (begin, lane) = (self.group(row / FOUR).start, row % FOUR);
        let range = begin..begin + self.lengths[row] as usize;
        let (columns, values) = (&self.columns[range.clone()], &mut self.values[range]);
        values.iter_mut().for_each(|values| values.0[lane] = 0.0);
        let count = geometry.body.shape.edge_count();
        for &element in around.iter().filter(|&&e| alive[e as usize]) {
            let of = edges.of_element(element);
            let of = &of[..count];
            let own = of.iter().position(|&e| e == columns[0][lane]).expect("an element around an edge has that edge");
            for (&other, value) in of.iter().zip(element_row(geometry, element as usize, own)) {
                let place = columns.iter().position(|c| c[lane] == other).expect("a row holds the edges around it");
                values[place].0[lane] += value;
            }
        }
        let diagonal = values[0].0[lane];
        self.bounds[row] = diagonal.max(0.5 * values.iter().map(|value| value.0[lane].abs()).sum::<f64>());
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
