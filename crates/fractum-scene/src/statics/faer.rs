//! Block matrices for the factorisation by faer.

use fractum_faer::FactorError;
use fractum_sparse::{BlockMatrix, Bundle, Inverse, Pattern, SparseError, nested_dissection};

/// Cholesky factor by faer, on all threads of the pool that the caller is in.
pub(super) struct FaerFactor {
    factor: fractum_faer::Factor,
    /// Unknowns of a node.
    block: usize,
    /// Lower triangle of the last matrix.
    values: Vec<f64>,
    right: Vec<f64>,
}

impl FaerFactor {
    pub(super) fn new<const B: usize>(pattern: &Pattern, places: &[[f64; 3]]) -> Result<Self, SparseError> {
        let (mut starts, mut rows) = (vec![0u32], Vec::new());
        for node in 0..pattern.nodes() {
            for b in 0..B {
                for &other in pattern.row(node).iter().filter(|other| **other as usize >= node) {
                    let first = if other as usize == node { b } else { 0 };
                    rows.extend((first..B).map(|a| other * B as u32 + a as u32));
                }
                let end = u32::try_from(rows.len()).map_err(|_| SparseError::TooLarge { entries: rows.len() })?;
                starts.push(end);
            }
        }
        let order = nested_dissection(pattern, places);
        let order: Vec<u32> = order.iter().flat_map(|node| (0..B as u32).map(move |a| node * B as u32 + a)).collect();
        let factor = fractum_faer::Factor::analyse(starts, rows, &order).map_err(|error| of_blocks(error, B))?;
        Ok(FaerFactor { factor, block: B, values: Vec::new(), right: Vec::new() })
    }

    /// Entries of the factor: 8 bytes each.
    pub(super) fn entries(&self) -> usize {
        self.factor.entries()
    }

    /// Factors a matrix of the pattern this was made for.
    pub(super) fn refactor<const B: usize>(&mut self, a: &BlockMatrix<B>) -> Result<(), SparseError> {
        self.values.clear();
        for node in 0..a.pattern().nodes() {
            for b in 0..B {
                for (&other, block) in a.pattern().row(node).iter().zip(a.row(node)) {
                    // The block is that of (node, other): its row is a column here, by symmetry.
                    let first = if other as usize == node { b } else { 0 };
                    if other as usize >= node {
                        self.values.extend_from_slice(&block[b][first..]);
                    }
                }
            }
        }
        let threads = rayon::current_num_threads();
        self.factor.factorise(&self.values, threads).map_err(|error| of_blocks(error, self.block))
    }

    /// Solves with the last factor, in place.
    pub(super) fn solve<const B: usize>(&mut self, x: &mut [[f64; B]]) {
        self.factor.solve(x.as_flattened_mut(), rayon::current_num_threads());
    }
}

impl<const B: usize> Inverse<B> for FaerFactor {
    fn apply(&mut self, vectors: &mut Bundle) {
        let width = vectors.width;
        if width == 0 {
            return;
        }
        let unknowns = vectors.values.len() / width;
        self.right.clear();
        (0..width).for_each(|v| self.right.extend(vectors.values[v..].iter().step_by(width)));
        self.factor.solve(&mut self.right, rayon::current_num_threads());
        for (v, column) in self.right.chunks_exact(unknowns).enumerate() {
            vectors.values[v..].iter_mut().step_by(width).zip(column).for_each(|(to, from)| *to = *from);
        }
    }
}

fn of_blocks(error: FactorError, block: usize) -> SparseError {
    match error {
        FactorError::Indefinite { unknown } => {
            SparseError::Indefinite { node: unknown / block, component: unknown % block }
        }
        FactorError::TooLarge { entries } => SparseError::TooLarge { entries },
    }
}
