//! Sparse symmetric positive definite systems in small dense blocks, one block row per node.
//!
//! - [`Pattern`] and [`BlockMatrix`]: who is coupled with whom, and how; assembly from cliques of nodes;
//! - [`Factor`]: Cholesky factorisation by panels in a nested-dissection ordering, alike on every processor;
//! - [`Preconditioner`], [`conjugate_gradients`]: an iterative solver with an incomplete factorisation and a coarse
//!   space of rigid motions;
//! - [`lowest_pairs`]: the lowest eigenpairs of a stiffness and a lumped mass.
//!
//! Everything gives the same bits on any number of threads.
//!
//! ```
//! use std::sync::Arc;
//! use fractum_math::Ragged;
//! use fractum_sparse::{BlockMatrix, Factor, Pattern};
//! // Two springs in a row, the first node held by a spring of its own.
//! let cliques = Ragged::from_rows([[0u32, 1], [1, 2]]);
//! let pattern = Arc::new(Pattern::from_cliques(3, &cliques));
//! let mut k = BlockMatrix::<1>::zeros(pattern);
//! for [i, j] in [[0, 1], [1, 2]] {
//!     k.add(i, i, [[1.0]]);
//!     k.add(j, j, [[1.0]]);
//!     k.add(i, j, [[-1.0]]);
//!     k.add(j, i, [[-1.0]]);
//! }
//! k.add(0, 0, [[1.0]]);
//! let place = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
//! let mut factor = Factor::new(k.pattern(), &place, 1).unwrap();
//! factor.refactor(&k).unwrap();
//! let mut x = vec![[0.0], [0.0], [1.0]];
//! factor.solve(&mut x);
//! assert!((x[2][0] - 3.0).abs() < 1e-14);
//! ```

mod basis;
mod block;
mod cholesky;
mod coarse;
mod conjugate;
mod dense;
mod incomplete;
mod modes;
#[cfg(test)]
mod net;
mod ordering;
mod supernodes;

pub use basis::Bundle;
pub use block::{BlockMatrix, Pattern};
pub use cholesky::{Factor, SparseError};
pub use coarse::Motions;
pub use conjugate::{Convergence, conjugate_gradients};
pub use incomplete::Preconditioner;
pub use modes::{Inverse, Pairs, Search, Vibration, lowest_pairs};
pub use ordering::nested_dissection;
