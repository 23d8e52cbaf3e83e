use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use thiserror::Error;

use crate::block::{BlockMatrix, Pattern};
use crate::ordering::nested_dissection;

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
pub struct Factor {
    block: usize,
    symbolic: SymbolicCholesky<u32>,
    /// Lower triangle by columns.
    starts: Vec<u32>,
    rows: Vec<u32>,
    matrix: Vec<f64>,
    values: Vec<f64>,
    work: MemBuffer,
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
        let entries = pattern.blocks() * block * block;
        if size >= i32::MAX as usize || entries / 2 + size >= i32::MAX as usize {
            return Err(SparseError::TooLarge { entries });
        }
        let order = nested_dissection(pattern, places);
        let forward: Vec<u32> =
            order.iter().flat_map(|&n| (0..block as u32).map(move |a| n * block as u32 + a)).collect();
        let mut inverse = vec![0u32; size];
        for (new, &old) in (0..).zip(&forward) {
            inverse[old as usize] = new;
        }
        let (mut starts, mut rows) = (vec![0u32], Vec::new());
        for i in 0..pattern.nodes() {
            let below = pattern.row(i).iter().filter(|&&j| j as usize >= i);
            for a in 0..block {
                for &j in below.clone() {
                    let first = if j as usize == i { a } else { 0 };
                    rows.extend((first..block).map(|b| j * block as u32 + b as u32));
                }
                starts.push(rows.len() as u32);
            }
        }
        let lower = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        let order = SymmetricOrdering::Custom(PermRef::new_checked(&forward, &inverse, size));
        let symbolic = factorize_symbolic_cholesky(lower, Side::Lower, order, CholeskySymbolicParams::default())
            .map_err(|_| SparseError::TooLarge { entries })?;
        let factoring = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let solving = symbolic.solve_in_place_scratch::<f64>(1, Par::Seq);
        let work = MemBuffer::try_new(factoring.or(solving));
        let work = work.map_err(|_| SparseError::TooLarge { entries: symbolic.len_val() })?;
        let matrix = vec![0.0; rows.len()];
        Ok(Factor { block, symbolic, starts, rows, matrix, values: Vec::new(), work })
    }

    /// Entries of the factor: 8 bytes each.
    pub fn entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Factors a matrix of the pattern this was made for.
    ///
    /// # Errors
    /// [`SparseError::Indefinite`] with the place of the pivot that is not positive.
    pub fn refactor<const B: usize>(&mut self, a: &BlockMatrix<B>) -> Result<(), SparseError> {
        let mut next = 0;
        for i in 0..a.pattern().nodes() {
            for row in 0..B {
                for (&j, block) in a.pattern().row(i).iter().zip(a.row(i)).filter(|(j, _)| **j as usize >= i) {
                    let first = if j as usize == i { row } else { 0 };
                    for &value in &block[row][first..] {
                        self.matrix[next] = value;
                        next += 1;
                    }
                }
            }
        }
        let size = self.starts.len() - 1;
        let lower = SymbolicSparseColMatRef::new_checked(size, size, &self.starts, None, &self.rows);
        let lower = SparseColMatRef::new(lower, &self.matrix);
        self.values.resize(self.symbolic.len_val(), 0.0);
        let stack = MemStack::new(&mut self.work);
        let done = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            lower,
            Side::Lower,
            Default::default(),
            Par::Seq,
            stack,
            Default::default(),
        );
        match done {
            Ok(_) => Ok(()),
            Err(LltError::NonPositivePivot { index }) => {
                let old = self.symbolic.perm().map_or(index, |perm| perm.arrays().0[index] as usize);
                Err(SparseError::Indefinite { node: old / self.block, component: old % self.block })
            }
        }
    }

    /// Solves with the last factor, in place.
    pub fn solve<const B: usize>(&mut self, x: &mut [[f64; B]]) {
        let flat = x.as_flattened_mut();
        let size = flat.len();
        let right = MatMut::from_column_major_slice_mut(flat, size, 1);
        let factor = LltRef::<u32, f64>::new(&self.symbolic, &self.values);
        factor.solve_in_place_with_conj(Conj::No, right, Par::Seq, MemStack::new(&mut self.work));
    }
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Factor").field("entries", &self.entries()).finish_non_exhaustive()
    }
}
