use std::mem;

use thiserror::Error;

use crate::basis::Bundle;
use crate::block::{BlockMatrix, Pattern};
use crate::dense::{Buffers, Columns, factor_panel, lower_product, solve_backward, solve_forward};
use crate::modes::Inverse;
use crate::ordering::nested_dissection;
use crate::supernodes::Supernodes;

const NONE: u32 = u32::MAX;

/// Why a system cannot be solved directly.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum SparseError {
    /// The matrix is not positive definite.
    #[error("the matrix is not positive definite at unknown {component} of node {node}")]
    Indefinite {
        /// Node of the pivot.
        node: usize,
        /// Component of the pivot.
        component: usize,
    },
    /// Conjugate gradients do not converge.
    #[error("{iterations} iterations of conjugate gradients did not solve the system")]
    Stalled {
        /// Iterations done.
        iterations: usize,
    },
    /// The factor does not fit into the index type or the memory.
    #[error("the factor is too large: {entries} entries")]
    TooLarge {
        /// Entries of the factor, as far as they are known.
        entries: usize,
    },
}

/// Cholesky factor of a block matrix; keeps its ordering and its memory from one matrix to the next.
///
/// Left-looking by panels of at most 128 columns: a panel gathers what the panels before it subtract, then is factored. The
/// operations and their order are the same on every processor.
pub struct Factor {
    structure: Supernodes,
    /// Where every panel starts, and the end: columns of all its rows.
    starts: Vec<usize>,
    values: Vec<f64>,
    work: Work,
}

#[derive(Default)]
struct Work {
    buffers: Buffers,
    /// Panels that next subtract from a panel, as linked lists.
    heads: Vec<u32>,
    next: Vec<u32>,
    /// Rows of a panel that have been used up.
    reached: Vec<u32>,
    /// Row in the present panel of every node.
    row_of: Vec<u32>,
    targets: Vec<u32>,
    unknowns: Vec<f64>,
    below: Vec<f64>,
}

impl Factor {
    /// Orders and analyses a pattern of blocks of size `block`.
    ///
    /// - `places`: positions of the nodes, for the ordering
    ///
    /// # Errors
    /// [`SparseError::TooLarge`].
    pub fn new(pattern: &Pattern, places: &[[f64; 3]], block: usize) -> Result<Self, SparseError> {
        let size = pattern.nodes() * block;
        if size >= i32::MAX as usize {
            return Err(SparseError::TooLarge { entries: size });
        }
        let structure = Supernodes::new(pattern, nested_dissection(pattern, places), block);
        let mut starts = vec![0];
        for panel in 0..structure.len() {
            let entries = structure.rows(panel).len() * block * structure.nodes(panel).len() * block;
            starts.push(starts[panel] + entries);
        }
        Ok(Factor { structure, starts, values: Vec::new(), work: Work::default() })
    }

    /// Entries of the factor: 8 bytes each.
    pub fn entries(&self) -> usize {
        self.starts[self.structure.len()]
    }

    /// Factors a matrix of the pattern this was made for.
    ///
    /// # Errors
    /// [`SparseError::Indefinite`] with the place of the pivot that is not positive; [`SparseError::TooLarge`].
    pub fn refactor<const B: usize>(&mut self, a: &BlockMatrix<B>) -> Result<(), SparseError> {
        let entries = self.entries();
        let Factor { structure, starts, values, work, .. } = self;
        if values.is_empty() {
            values.try_reserve_exact(entries).map_err(|_| SparseError::TooLarge { entries })?;
            values.resize(entries, 0.0);
        }
        for list in [&mut work.heads, &mut work.next, &mut work.reached] {
            list.clear();
            list.resize(structure.len(), NONE);
        }
        work.row_of.resize(structure.order.len(), 0);
        for panel in 0..structure.len() {
            let (done, rest) = values.split_at_mut(starts[panel]);
            let now = &mut rest[..starts[panel + 1] - starts[panel]];
            let (nodes, rows) = (structure.nodes(panel), structure.rows(panel));
            let height = rows.len() * B;
            (0..).zip(rows).for_each(|(row, &node)| work.row_of[node as usize] = row);
            now.fill(0.0);
            put_matrix(now, a, structure, panel, &work.row_of);
            let mut other = mem::replace(&mut work.heads[panel], NONE);
            while other != NONE {
                let after = work.next[other as usize];
                let from = starts[other as usize]..starts[other as usize + 1];
                subtract::<B>(now, height, &done[from], structure, panel, other as usize, work);
                work.wait(structure, other as usize);
                other = after;
            }
            factor_panel(now, height, nodes.len() * B, &mut work.buffers).map_err(|column| {
                let node = structure.order[nodes.start + column / B] as usize;
                SparseError::Indefinite { node, component: column % B }
            })?;
            work.reached[panel] = nodes.len() as u32;
            work.wait(structure, panel);
        }
        Ok(())
    }

    /// Solves with the last factor, in place.
    pub fn solve<const B: usize>(&mut self, x: &mut [[f64; B]]) {
        let Factor { structure, starts, values, work, .. } = self;
        let Work { unknowns, below, .. } = work;
        unknowns.clear();
        unknowns.extend(structure.order.iter().flat_map(|&old| x[old as usize]));
        for panel in 0..structure.len() {
            let (own, width, height) = extent::<B>(structure, panel);
            below.clear();
            below.resize(height - width, 0.0);
            let columns = Columns { values: &values[starts[panel]..starts[panel + 1]], height, count: width };
            solve_forward(columns, &mut unknowns[own..own + width], below);
            for (&node, sums) in structure.rows(panel)[width / B..].iter().zip(below.as_chunks::<B>().0) {
                (0..B).for_each(|b| unknowns[node as usize * B + b] -= sums[b]);
            }
        }
        for panel in (0..structure.len()).rev() {
            let (own, width, height) = extent::<B>(structure, panel);
            below.clear();
            let rows = &structure.rows(panel)[width / B..];
            below.extend(rows.iter().flat_map(|&node| &unknowns[node as usize * B..][..B]));
            let columns = Columns { values: &values[starts[panel]..starts[panel + 1]], height, count: width };
            solve_backward(columns, &mut unknowns[own..own + width], below);
        }
        for (&old, value) in structure.order.iter().zip(unknowns.as_chunks::<B>().0) {
            x[old as usize] = *value;
        }
    }
}

impl<const B: usize> Inverse<B> for Factor {
    fn apply(&mut self, vectors: &mut Bundle) {
        vectors.each_vector::<B>(|vector| self.solve(vector));
    }
}

impl Work {
    /// Enters a panel in the list of the panel that has its next row.
    fn wait(&mut self, structure: &Supernodes, panel: usize) {
        if let Some(&node) = structure.rows(panel).get(self.reached[panel] as usize) {
            let head = &mut self.heads[structure.owner(node)];
            self.next[panel] = mem::replace(head, panel as u32);
        }
    }
}

/// First unknown of a panel, its columns and its rows.
fn extent<const B: usize>(structure: &Supernodes, panel: usize) -> (usize, usize, usize) {
    let nodes = structure.nodes(panel);
    (nodes.start * B, nodes.len() * B, structure.rows(panel).len() * B)
}

/// Puts the lower triangle of the matrix into a panel.
fn put_matrix<const B: usize>(
    panel: &mut [f64],
    a: &BlockMatrix<B>,
    structure: &Supernodes,
    number: usize,
    row_of: &[u32],
) {
    let height = structure.rows(number).len() * B;
    for (column, node) in structure.nodes(number).enumerate() {
        let old = structure.order[node] as usize;
        for (&other, block) in a.pattern().row(old).iter().zip(a.row(old)) {
            let new = structure.position[other as usize] as usize;
            if new < node {
                continue;
            }
            let row = row_of[new] as usize * B;
            for (b, entries) in block.iter().enumerate() {
                // The block is that of (old, other): its rows are the columns here, by symmetry.
                panel[(column * B + b) * height + row..][..B].copy_from_slice(entries);
            }
        }
    }
}

/// Subtracts from a panel what a panel before it adds to its columns.
fn subtract<const B: usize>(
    now: &mut [f64],
    height: usize,
    before: &[f64],
    structure: &Supernodes,
    panel: usize,
    other: usize,
    work: &mut Work,
) {
    let (rows, end) = (structure.rows(other), structure.nodes(panel).end);
    let from = work.reached[other] as usize;
    let count = rows[from..].partition_point(|&node| (node as usize) < end);
    let block = Columns { values: before, height: rows.len() * B, count: structure.nodes(other).len() * B };
    lower_product(block, from * B, count * B, &mut work.buffers);
    work.reached[other] = (from + count) as u32;
    work.targets.clear();
    for &node in &rows[from..] {
        let row = work.row_of[node as usize] * B as u32;
        work.targets.extend(row..row + B as u32);
    }
    let m = work.targets.len();
    for (c, sums) in work.buffers.product.chunks_exact(m).take(count * B).enumerate() {
        let column = &mut now[work.targets[c] as usize * height..][..height];
        for (&target, sum) in work.targets[c..].iter().zip(&sums[c..]) {
            column[target as usize] -= sum;
        }
    }
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Factor").field("entries", &self.entries()).finish_non_exhaustive()
    }
}
