use crate::basis::Bundle;
use crate::block::BlockMatrix;
use crate::cholesky::SparseError;
use crate::coarse::{Coarse, Motions};
use crate::modes::Inverse;

/// Approximate inverse for conjugate gradients: a block incomplete Cholesky factorisation without fill, in single
/// precision, plus a coarse space of rigid motions of clusters of nodes.
///
/// The incomplete factor takes care of what is local, the coarse space of what is not: with it the number of iterations
/// hardly grows with the mesh.
pub struct Preconditioner<const B: usize> {
    local: Incomplete<B>,
    coarse: Option<Coarse<B>>,
}

impl<const B: usize> Preconditioner<B> {
    /// Prepares the solution of systems with `a` (held unknowns taken out, see [`BlockMatrix::hold`]).
    ///
    /// - `motions`: rigid motions of the nodes; none leaves the coarse space away
    ///
    /// # Errors
    /// [`SparseError::Indefinite`] if `a` is far from positive definite.
    pub fn new(a: &BlockMatrix<B>, motions: Option<Motions<'_>>) -> Result<Self, SparseError> {
        let local = Incomplete::new(a)?;
        let coarse = motions.map(|motions| Coarse::new(a, motions)).transpose()?;
        Ok(Preconditioner { local, coarse })
    }

    /// z = M⁻¹ r.
    pub(crate) fn apply(&mut self, r: &[[f64; B]], z: &mut [[f64; B]]) {
        z.copy_from_slice(r);
        self.local.solve(z);
        if let Some(coarse) = &mut self.coarse {
            coarse.add_correction(r, z);
        }
    }
}

impl<const B: usize> Inverse<B> for Preconditioner<B> {
    fn apply(&mut self, vectors: &mut Bundle) {
        let mut corrected = self.coarse.as_ref().map(|_| vectors.clone());
        self.local.solve_many(vectors);
        if let (Some(coarse), Some(corrected)) = (&mut self.coarse, &mut corrected) {
            let mut sum = vec![[0.0; B]; vectors.values.len() / B / vectors.width.max(1)];
            corrected.each_vector(|vector| {
                sum.fill([0.0; B]);
                coarse.add_correction(vector, &mut sum);
                vector.copy_from_slice(&sum);
            });
            vectors.values.iter_mut().zip(&corrected.values).for_each(|(to, add)| *to += add);
        }
    }
}

/// L of A ≈ L Lᵀ on the lower triangle of the pattern, by rows; diagonal blocks inverted.
struct Incomplete<const B: usize> {
    starts: Vec<usize>,
    columns: Vec<u32>,
    blocks: Vec<[[f32; B]; B]>,
    inverse: Vec<[[f32; B]; B]>,
}

impl<const B: usize> Incomplete<B> {
    fn new(a: &BlockMatrix<B>) -> Result<Self, SparseError> {
        // Dropping fill can make a pivot negative; a heavier diagonal cures it.
        let mut shift = 0.0;
        loop {
            match Self::with_shift(a, shift) {
                Err(error) if shift > 1.0 => return Err(error),
                Err(_) => shift = if shift == 0.0 { 0.01 } else { 2.0 * shift },
                done => return done,
            }
        }
    }

    fn with_shift(a: &BlockMatrix<B>, shift: f64) -> Result<Self, SparseError> {
        let nodes = a.pattern().nodes();
        let (mut starts, mut columns) = (vec![0], Vec::new());
        let mut blocks: Vec<[[f64; B]; B]> = Vec::new();
        let mut inverse: Vec<[[f64; B]; B]> = Vec::with_capacity(nodes);
        // Where the blocks of the present row stand.
        let mut place = vec![usize::MAX; nodes];
        for i in 0..nodes {
            let first = blocks.len();
            let mut pivot = a.diagonal(i);
            for (&j, block) in a.pattern().row(i).iter().zip(a.row(i)).take_while(|(j, _)| (**j as usize) < i) {
                place[j as usize] = blocks.len();
                columns.push(j);
                blocks.push(*block);
            }
            for at in first..blocks.len() {
                let k = columns[at] as usize;
                let mut block = blocks[at];
                for other in starts[k]..starts[k + 1] {
                    let mine = place[columns[other] as usize];
                    if mine != usize::MAX {
                        subtract_product(&mut block, &blocks[mine], &blocks[other]);
                    }
                }
                // L_ik = block L_kk⁻ᵀ
                let mut scaled = [[0.0; B]; B];
                for (row, out) in block.iter().zip(&mut scaled) {
                    for (c, out) in out.iter_mut().enumerate() {
                        *out = (0..=c).map(|b| row[b] * inverse[k][c][b]).sum();
                    }
                }
                blocks[at] = scaled;
                subtract_product(&mut pivot, &scaled, &scaled);
            }
            for at in first..blocks.len() {
                place[columns[at] as usize] = usize::MAX;
            }
            starts.push(blocks.len());
            let diagonal = a.diagonal(i);
            for c in 0..B {
                pivot[c][c] += shift * diagonal[c][c];
            }
            inverse.push(
                inverse_of_root(&pivot, &diagonal)
                    .map_err(|component| SparseError::Indefinite { node: i, component })?,
            );
        }
        let single = |m: [[f64; B]; B]| m.map(|row| row.map(|v| v as f32));
        Ok(Incomplete {
            starts,
            columns,
            blocks: blocks.into_iter().map(single).collect(),
            inverse: inverse.into_iter().map(single).collect(),
        })
    }

    /// z ← (L Lᵀ)⁻¹ z.
    fn solve(&self, z: &mut [[f64; B]]) {
        for i in 0..self.inverse.len() {
            let mut sum = z[i];
            for at in self.starts[i]..self.starts[i + 1] {
                let (block, x) = (&self.blocks[at], &z[self.columns[at] as usize]);
                for a in 0..B {
                    for b in 0..B {
                        sum[a] -= f64::from(block[a][b]) * x[b];
                    }
                }
            }
            let inverse = &self.inverse[i];
            z[i] = std::array::from_fn(|a| (0..=a).map(|b| f64::from(inverse[a][b]) * sum[b]).sum());
        }
        for i in (0..self.inverse.len()).rev() {
            let inverse = &self.inverse[i];
            let x: [f64; B] = std::array::from_fn(|a| (a..B).map(|b| f64::from(inverse[b][a]) * z[i][b]).sum());
            z[i] = x;
            for at in self.starts[i]..self.starts[i + 1] {
                let (block, y) = (&self.blocks[at], &mut z[self.columns[at] as usize]);
                for b in 0..B {
                    for a in 0..B {
                        y[b] -= f64::from(block[a][b]) * x[a];
                    }
                }
            }
        }
    }
}

impl<const B: usize> Incomplete<B> {
    /// As [`Incomplete::solve`] for several vectors, which share the reading of the factor.
    fn solve_many(&self, vectors: &mut Bundle) {
        let width = vectors.width;
        if width == 0 {
            return;
        }
        let size = B * width;
        let mut own = vec![0.0; size];
        for i in 0..self.inverse.len() {
            let (done, rest) = vectors.values.split_at_mut(i * size);
            let now = &mut rest[..size];
            for at in self.starts[i]..self.starts[i + 1] {
                let x = &done[self.columns[at] as usize * size..][..size];
                for (row, now) in self.blocks[at].iter().zip(now.chunks_exact_mut(width)) {
                    subtract_rows(now, row.map(f64::from), x, width);
                }
            }
            own.copy_from_slice(now);
            now.fill(0.0);
            for (a, now) in now.chunks_exact_mut(width).enumerate() {
                for (b, own) in own.chunks_exact(width).enumerate().take(a + 1) {
                    let factor = f64::from(self.inverse[i][a][b]);
                    now.iter_mut().zip(own).for_each(|(now, own)| *now += factor * own);
                }
            }
        }
        for i in (0..self.inverse.len()).rev() {
            let (before, rest) = vectors.values.split_at_mut(i * size);
            let now = &mut rest[..size];
            own.fill(0.0);
            for (a, own) in own.chunks_exact_mut(width).enumerate() {
                for (b, now) in now.chunks_exact(width).enumerate().skip(a) {
                    let factor = f64::from(self.inverse[i][b][a]);
                    own.iter_mut().zip(now).for_each(|(own, now)| *own += factor * now);
                }
            }
            now.copy_from_slice(&own);
            for at in self.starts[i]..self.starts[i + 1] {
                let block = &self.blocks[at];
                let y = &mut before[self.columns[at] as usize * size..][..size];
                for (b, y) in y.chunks_exact_mut(width).enumerate() {
                    subtract_rows::<B>(y, std::array::from_fn(|a| f64::from(block[a][b])), now, width);
                }
            }
        }
    }
}

/// Subtracts a sum of the rows of `x`.
fn subtract_rows<const B: usize>(y: &mut [f64], factors: [f64; B], x: &[f64], width: usize) {
    for (x, factor) in x.chunks_exact(width).zip(factors) {
        y.iter_mut().zip(x).for_each(|(y, x)| *y -= factor * x);
    }
}

/// m ← m - a bᵀ.
fn subtract_product<const B: usize>(m: &mut [[f64; B]; B], a: &[[f64; B]; B], b: &[[f64; B]; B]) {
    for i in 0..B {
        for j in 0..B {
            for k in 0..B {
                m[i][j] -= a[i][k] * b[j][k];
            }
        }
    }
}

/// Inverse of the lower Cholesky root; the component of a pivot that is too small beside `scale` if there is none.
fn inverse_of_root<const B: usize>(m: &[[f64; B]; B], scale: &[[f64; B]; B]) -> Result<[[f64; B]; B], usize> {
    let mut root = [[0.0; B]; B];
    for i in 0..B {
        for j in 0..=i {
            let sum = m[i][j] - (0..j).map(|k| root[i][k] * root[j][k]).sum::<f64>();
            if i == j {
                if sum.is_nan() || sum <= 1e-6 * scale[i][i] {
                    return Err(i);
                }
                root[i][i] = sum.sqrt();
            } else {
                root[i][j] = sum / root[j][j];
            }
        }
    }
    let mut inverse = [[0.0; B]; B];
    for j in 0..B {
        inverse[j][j] = 1.0 / root[j][j];
        for i in j + 1..B {
            let sum: f64 = (j..i).map(|k| root[i][k] * inverse[k][j]).sum();
            inverse[i][j] = -sum / root[i][i];
        }
    }
    Ok(inverse)
}
