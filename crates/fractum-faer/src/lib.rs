//! Sparse Cholesky factorisation of symmetric positive definite matrices by the library faer, in double precision.
//!
//! This is the only crate that instantiates faer; nothing in its interface is generic, so that faer is compiled once.
//!
//! - [`Factor::analyse`]: structure of the factor for an elimination order that the caller gives;
//! - [`Factor::factorise`]: A = L Lᵀ for the values of a matrix;
//! - [`Factor::solve`]: A x = b for several right-hand sides together.
//!
//! The bits of the result depend on the vector instructions of the processor, and not on the number of threads.
//!
//! ```
//! use fractum_faer::Factor;
//! // Lower triangle of [[4, 1], [1, 3]] by columns.
//! let mut factor = Factor::analyse(vec![0, 2, 3], vec![0, 1, 1], &[1, 0]).unwrap();
//! factor.factorise(&[4.0, 1.0, 3.0], 1).unwrap();
//! let mut x = [1.0, 2.0];
//! factor.solve(&mut x, 1);
//! assert!((x[0] - 1.0 / 11.0).abs() < 1e-15 && (x[1] - 7.0 / 11.0).abs() < 1e-15);
//! ```

#![forbid(unsafe_code)]

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::perm::PermRef;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side};
use thiserror::Error;

/// Why a matrix cannot be factored.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq)]
pub enum FactorError {
    /// The matrix is not positive definite.
    #[error("the matrix is not positive definite at unknown {unknown}")]
    Indefinite {
        /// Unknown of the pivot that is not positive.
        unknown: usize,
    },
    /// The factor does not fit into the index type or the memory.
    #[error("the factor is too large: {entries} entries")]
    TooLarge {
        /// Entries of the factor, as far as they are known.
        entries: usize,
    },
}

/// Cholesky factor of a matrix; keeps its structure and its memory from one matrix to the next.
pub struct Factor {
    /// Lower triangle of the matrix: starts of the columns, and rows.
    starts: Vec<u32>,
    rows: Vec<u32>,
    order: Vec<u32>,
    symbolic: SymbolicCholesky<u32>,
    values: Vec<f64>,
    memory: Memory,
}

/// Working memory of faer.
struct Memory(MemBuffer);

impl Memory {
    fn at_least(&mut self, request: StackReq) -> Result<&mut MemStack, FactorError> {
        if self.0.len() < request.unaligned_bytes_required() {
            let too_large =
                |_| FactorError::TooLarge { entries: request.unaligned_bytes_required() / size_of::<f64>() };
            self.0 = MemBuffer::try_new(request).map_err(too_large)?;
        }
        Ok(MemStack::new(&mut self.0))
    }
}

impl Factor {
    /// Analyses the lower triangle of a matrix.
    ///
    /// - `starts`, `rows`: of its columns, rows ascending and none above the diagonal
    /// - `order`: unknowns in the order of elimination, `order[new] = old`
    ///
    /// # Errors
    /// [`FactorError::TooLarge`].
    pub fn analyse(starts: Vec<u32>, rows: Vec<u32>, order: &[u32]) -> Result<Self, FactorError> {
        let size = order.len();
        let mut position = vec![0u32; size];
        (0..).zip(order).for_each(|(new, &old)| position[old as usize] = new);
        let permutation = PermRef::new_checked(order, &position, size);
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &starts, None, &rows);
        let too_large = |_| FactorError::TooLarge { entries: rows.len() };
        let symbolic = factorize_symbolic_cholesky(
            pattern,
            Side::Lower,
            SymmetricOrdering::Custom(permutation),
            CholeskySymbolicParams::default(),
        )
        .map_err(too_large)?;
        let memory = Memory(MemBuffer::new(StackReq::EMPTY));
        Ok(Factor { starts, rows, order: order.to_vec(), symbolic, values: Vec::new(), memory })
    }

    /// Entries of the factor: 8 bytes each.
    pub fn entries(&self) -> usize {
        self.symbolic.len_val()
    }

    /// Factors a matrix of the structure this was made for.
    ///
    /// - `values`: of its lower triangle, in the order of the rows
    /// - `threads`: that may be used
    ///
    /// # Errors
    /// [`FactorError::Indefinite`] with the unknown of a pivot that is not positive; [`FactorError::TooLarge`].
    pub fn factorise(&mut self, values: &[f64], threads: usize) -> Result<(), FactorError> {
        let (size, entries) = (self.order.len(), self.entries());
        if self.values.is_empty() {
            self.values.try_reserve_exact(entries).map_err(|_| FactorError::TooLarge { entries })?;
            self.values.resize(entries, 0.0);
        }
        let pattern = SymbolicSparseColMatRef::new_checked(size, size, &self.starts, None, &self.rows);
        let matrix = SparseColMatRef::new(pattern, values);
        let par = parallelism(threads);
        let request = self.symbolic.factorize_numeric_llt_scratch::<f64>(par, Default::default());
        let stack = self.memory.at_least(request)?;
        let done = self.symbolic.factorize_numeric_llt(
            &mut self.values,
            matrix,
            Side::Lower,
            Default::default(),
            par,
            stack,
            Default::default(),
        );
        done.map(|_| ()).map_err(|LltError::NonPositivePivot { index }| FactorError::Indefinite {
            unknown: self.order[index.min(size - 1)] as usize,
        })
    }

    /// Solves with the last factor, in place.
    ///
    /// - `right`: right-hand sides, one after the other
    /// - `threads`: that may be used
    pub fn solve(&mut self, right: &mut [f64], threads: usize) {
        let size = self.order.len();
        if size == 0 || right.is_empty() {
            return;
        }
        let (count, par) = (right.len() / size, parallelism(threads));
        let request = self.symbolic.solve_in_place_scratch::<f64>(count, par);
        let stack = self.memory.at_least(request).expect("less memory than the factor takes");
        let factor = LltRef::new(&self.symbolic, &self.values);
        let right = MatMut::from_column_major_slice_mut(right, size, count);
        factor.solve_in_place_with_conj(Conj::No, right, par, stack);
    }
}

impl std::fmt::Debug for Factor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Factor").field("entries", &self.entries()).finish_non_exhaustive()
    }
}

fn parallelism(threads: usize) -> Par {
    if threads > 1 { Par::rayon(threads) } else { Par::Seq }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The five-point net of n × n nodes with a little more than its springs on the diagonal.
    fn net(n: u32) -> (Vec<u32>, Vec<u32>, Vec<f64>) {
        let (mut starts, mut rows, mut values) = (vec![0], Vec::new(), Vec::new());
        for node in 0..n * n {
            let mut push = |row: u32, value: f64| {
                rows.push(row);
                values.push(value);
            };
            push(node, 4.01);
            if node % n + 1 < n {
                push(node + 1, -1.0);
            }
            if node / n + 1 < n {
                push(node + n, -1.0);
            }
            starts.push(rows.len() as u32);
        }
        (starts, rows, values)
    }

    #[test]
    fn several_threads_give_the_bits_of_one() {
        let (starts, rows, values) = net(120);
        let size = starts.len() - 1;
        let order: Vec<u32> = (0..size as u32).rev().collect();
        let right: Vec<f64> = (0..3 * size).map(|i| (0.7 * i as f64).sin()).collect();
        let solved = |threads: usize| {
            let mut factor = Factor::analyse(starts.clone(), rows.clone(), &order).unwrap();
            factor.factorise(&values, threads).unwrap();
            let mut x = right.clone();
            factor.solve(&mut x, threads);
            x
        };
        let one = solved(1);
        let mut residual = right.clone();
        for side in 0..3 {
            let at = |i: u32| side * size + i as usize;
            for column in 0..size as u32 {
                for entry in starts[column as usize]..starts[column as usize + 1] {
                    let (row, value) = (rows[entry as usize], values[entry as usize]);
                    residual[at(row)] -= value * one[at(column)];
                    if row != column {
                        residual[at(column)] -= value * one[at(row)];
                    }
                }
            }
        }
        assert!(residual.iter().all(|r| r.abs() < 1e-12));
        assert!(solved(2) == one && solved(4) == one);
    }

    #[test]
    fn an_indefinite_matrix_is_told_with_its_unknown() {
        let mut factor = Factor::analyse(vec![0, 2, 3], vec![0, 1, 1], &[0, 1]).unwrap();
        assert_eq!(factor.factorise(&[1.0, 2.0, 1.0], 1), Err(FactorError::Indefinite { unknown: 1 }));
        let mut factor = Factor::analyse(vec![0, 2, 3], vec![0, 1, 1], &[1, 0]).unwrap();
        assert_eq!(factor.factorise(&[1.0, 2.0, 1.0], 1), Err(FactorError::Indefinite { unknown: 0 }));
    }
}
