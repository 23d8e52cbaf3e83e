use std::sync::Arc;

use fractum_math::Ragged;
use rayon::prelude::*;

use crate::basis::Bundle;

/// Which nodes are coupled: sorted rows with both triangles and the diagonal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pattern {
    starts: Vec<usize>,
    columns: Vec<u32>,
}

impl Pattern {
    /// Couples all nodes of every clique with each other, and every node with itself.
    pub fn from_cliques(nodes: usize, cliques: &Ragged) -> Self {
        let rows = (0..cliques.len()).map(|c| cliques.row(c));
        let of_node = Ragged::inverse(nodes, rows);
        let row = |node: usize| {
            let mut row: Vec<u32> = vec![node as u32];
            for &clique in of_node.row(node) {
                row.extend_from_slice(cliques.row(clique as usize));
            }
            row.sort_unstable();
            row.dedup();
            row
        };
        let rows: Vec<Vec<u32>> = (0..nodes).into_par_iter().with_min_len(256).map(row).collect();
        let mut starts = vec![0];
        for row in &rows {
            starts.push(starts[starts.len() - 1] + row.len());
        }
        Pattern { starts, columns: rows.concat() }
    }

    /// Number of nodes.
    pub fn nodes(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of blocks, both triangles counted.
    pub fn blocks(&self) -> usize {
        self.columns.len()
    }

    /// Neighbours of a node, itself among them, ascending.
    pub fn row(&self, node: usize) -> &[u32] {
        &self.columns[self.range(node)]
    }

    pub(crate) fn range(&self, node: usize) -> std::ops::Range<usize> {
        self.starts[node]..self.starts[node + 1]
    }

    /// Place of a block among all blocks, for [`BlockMatrix::add_at`].
    ///
    /// # Panics
    /// If the nodes are not coupled.
    pub fn place(&self, i: usize, j: usize) -> usize {
        let within = self.row(i).binary_search(&(j as u32)).expect("nodes of one clique are coupled");
        self.starts[i] + within
    }
}

/// A symmetric matrix of B × B blocks over a [`Pattern`].
#[derive(Clone, Debug)]
pub struct BlockMatrix<const B: usize> {
    pattern: Arc<Pattern>,
    values: Vec<[[f64; B]; B]>,
}

impl<const B: usize> BlockMatrix<B> {
    /// All zero.
    pub fn zeros(pattern: Arc<Pattern>) -> Self {
        let values = vec![[[0.0; B]; B]; pattern.blocks()];
        BlockMatrix { pattern, values }
    }

    /// Who is coupled with whom.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Sets all blocks to zero.
    pub fn clear(&mut self) {
        self.values.fill([[0.0; B]; B]);
    }

    /// Adds a block at (i, j); the caller adds its transpose at (j, i).
    ///
    /// # Panics
    /// If the nodes are not coupled.
    pub fn add(&mut self, i: usize, j: usize, block: [[f64; B]; B]) {
        self.add_at(self.pattern.place(i, j), block);
    }

    /// Adds a block at a place of the pattern.
    pub fn add_at(&mut self, place: usize, block: [[f64; B]; B]) {
        for (row, add) in self.values[place].iter_mut().zip(block) {
            for (value, add) in row.iter_mut().zip(add) {
                *value += add;
            }
        }
    }

    /// Blocks of a row, in the order of [`Pattern::row`].
    pub fn row(&self, node: usize) -> &[[[f64; B]; B]] {
        &self.values[self.pattern.range(node)]
    }

    /// Diagonal block of a node.
    pub fn diagonal(&self, node: usize) -> [[f64; B]; B] {
        self.values[self.pattern.place(node, node)]
    }

    /// y = A x.
    pub fn multiply(&self, x: &[[f64; B]], y: &mut [[f64; B]]) {
        y.par_iter_mut().enumerate().with_min_len(1024).for_each(|(i, y)| {
            let mut sum = [0.0; B];
            for (&j, block) in self.pattern.row(i).iter().zip(self.row(i)) {
                let x = &x[j as usize];
                for a in 0..B {
                    for b in 0..B {
                        sum[a] += block[a][b] * x[b];
                    }
                }
            }
            *y = sum;
        });
    }

    /// Y = A X for several vectors, which share the reading of the matrix.
    pub fn multiply_many(&self, x: &Bundle, y: &mut Bundle) {
        let width = x.width;
        if width == 0 {
            return;
        }
        y.values.par_chunks_mut(B * width).enumerate().with_min_len(256).for_each(|(i, y)| {
            y.fill(0.0);
            for (&j, block) in self.pattern.row(i).iter().zip(self.row(i)) {
                let x = &x.values[j as usize * B * width..][..B * width];
                for (y, row) in y.chunks_exact_mut(width).zip(block) {
                    for (x, &factor) in x.chunks_exact(width).zip(row) {
                        y.iter_mut().zip(x).for_each(|(y, x)| *y += factor * x);
                    }
                }
            }
        });
    }

    /// Adds to the diagonal.
    pub fn add_diagonal(&mut self, diagonal: &[[f64; B]], factor: f64) {
        for (node, values) in diagonal.iter().enumerate() {
            let place = self.pattern.place(node, node);
            (0..B).for_each(|a| self.values[place][a][a] += factor * values[a]);
        }
    }

    /// Takes held unknowns out: their rows and columns vanish, their diagonal keeps its size.
    ///
    /// - `held`: bit a of a node is set where its component a is prescribed
    ///
    /// A component without any stiffness gets the diagonal `spare`, so that the matrix stays definite.
    pub fn hold(&mut self, held: &[u8], spare: f64) {
        for i in 0..self.pattern.nodes() {
            let range = self.pattern.range(i);
            for (&j, block) in self.pattern.row(i).iter().zip(&mut self.values[range]) {
                let j = j as usize;
                for a in 0..B {
                    for b in 0..B {
                        let diagonal = i == j && a == b;
                        let out = held[i] >> a & 1 == 1 || held[j] >> b & 1 == 1;
                        if out && !diagonal {
                            block[a][b] = 0.0;
                        }
                        if diagonal && block[a][b] <= 0.0 {
                            block[a][b] = spare;
                        }
                    }
                }
            }
        }
    }

    /// Largest diagonal entry.
    pub fn largest_diagonal(&self) -> f64 {
        let of = |i: usize| self.diagonal(i).iter().enumerate().map(|(a, row)| row[a]).fold(0.0, f64::max);
        (0..self.pattern.nodes()).map(of).fold(0.0, f64::max)
    }
}
