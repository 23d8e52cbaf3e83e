//! Several vectors at once: side by side for products with sparse matrices, in chunks of rows for products with each other.

use nalgebra::DMatrix;
use rayon::prelude::*;

/// Vectors of blocks side by side: entry (unknown, vector) at `unknown * width + vector`.
#[derive(Clone, Debug, PartialEq)]
pub struct Bundle {
    /// Number of vectors.
    pub width: usize,
    /// Entries, unknown after unknown.
    pub values: Vec<f64>,
}

impl Bundle {
    /// All zero.
    pub fn zeros(unknowns: usize, width: usize) -> Self {
        Bundle { width, values: vec![0.0; unknowns * width] }
    }

    /// Calls `work` with every vector, and takes it back.
    pub fn each_vector<const B: usize>(&mut self, mut work: impl FnMut(&mut [[f64; B]])) {
        let unknowns = self.values.len() / self.width.max(1);
        let mut vector = vec![[0.0; B]; unknowns / B];
        for v in 0..self.width {
            let entries = self.values[v..].iter().step_by(self.width);
            vector.as_flattened_mut().iter_mut().zip(entries).for_each(|(to, from)| *to = *from);
            work(&mut vector);
            let entries = self.values[v..].iter_mut().step_by(self.width);
            entries.zip(vector.as_flattened()).for_each(|(to, from)| *to = *from);
        }
    }
}

/// Rows of a chunk: some tens of vectors of it stay in the cache, and sums over chunks have a fixed order.
const ROWS: usize = 1024;

/// Vectors in chunks of rows, in each of them one vector after the other.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    rows: usize,
    count: usize,
    chunks: Vec<Vec<f64>>,
}

impl Basis {
    pub(crate) fn new(rows: usize) -> Self {
        Basis { rows, count: 0, chunks: vec![Vec::new(); rows.div_ceil(ROWS)] }
    }

    pub(crate) fn count(&self) -> usize {
        self.count
    }

    /// Rows of a chunk.
    fn extent(rows: usize, chunk: usize) -> std::ops::Range<usize> {
        chunk * ROWS..((chunk + 1) * ROWS).min(rows)
    }

    /// Adds vectors given by their entries: row, number.
    pub(crate) fn extend(&mut self, count: usize, entry: impl Fn(usize, usize) -> f64 + Sync) {
        let rows = self.rows;
        self.chunks.par_iter_mut().enumerate().for_each(|(chunk, values)| {
            (0..count).for_each(|v| values.extend(Self::extent(rows, chunk).map(|row| entry(row, v))));
        });
        self.count += count;
    }

    /// Adds the vectors of another basis.
    pub(crate) fn append(&mut self, other: &Basis) {
        self.chunks.par_iter_mut().zip(&other.chunks).for_each(|(own, other)| own.extend_from_slice(other));
        self.count += other.count;
    }

    pub(crate) fn of_bundle(bundle: &Bundle) -> Self {
        let width = bundle.width;
        let mut basis = Basis::new(bundle.values.len() / width.max(1));
        basis.extend(width, |row, v| bundle.values[row * width + v]);
        basis
    }

    /// The vectors side by side, each entry times a weight of its row.
    pub(crate) fn bundle(&self, weight: impl Fn(usize) -> f64 + Sync) -> Bundle {
        let mut bundle = Bundle::zeros(self.rows, self.count);
        if self.count == 0 {
            return bundle;
        }
        let into = bundle.values.par_chunks_mut(ROWS * self.count).zip(&self.chunks).enumerate();
        into.for_each(|(chunk, (to, from))| {
            let rows = to.len() / self.count;
            for (v, column) in from.chunks_exact(rows).enumerate() {
                for (row, value) in column.iter().enumerate() {
                    to[row * self.count + v] = value * weight(chunk * ROWS + row);
                }
            }
        });
        bundle
    }

    /// Scalar products of all vectors with all of another basis, weighted row by row.
    pub(crate) fn products(&self, other: &Basis, weight: Option<&[f64]>) -> DMatrix<f64> {
        let of_chunk = |chunk: usize| {
            let extent = Self::extent(self.rows, chunk);
            let rows = extent.len();
            let weighted: Vec<f64> = match weight {
                Some(weight) => {
                    let weight = &weight[extent];
                    let columns = other.chunks[chunk].chunks_exact(rows);
                    columns.flat_map(|column| column.iter().zip(weight).map(|(a, w)| a * w)).collect()
                }
                None => Vec::new(),
            };
            let right = if weight.is_some() { &weighted } else { &other.chunks[chunk] };
            let left: Vec<&[f64]> = self.chunks[chunk].chunks_exact(rows).collect();
            let mut sums = DMatrix::zeros(self.count, other.count);
            for (b, column) in right.chunks_exact(rows).enumerate() {
                for (a, four) in left.chunks(4).enumerate() {
                    let products = dot_four(four, column);
                    (0..four.len()).for_each(|k| sums[(4 * a + k, b)] = products[k]);
                }
            }
            sums
        };
        let parts: Vec<DMatrix<f64>> = (0..self.chunks.len()).into_par_iter().map(of_chunk).collect();
        parts.into_iter().fold(DMatrix::zeros(self.count, other.count), |sum, part| sum + part)
    }

    /// Weighted squares of the vectors.
    pub(crate) fn squares(&self, weight: &[f64]) -> Vec<f64> {
        let of_chunk = |(chunk, values): (usize, &Vec<f64>)| -> Vec<f64> {
            let extent = Self::extent(self.rows, chunk);
            let weight = &weight[extent.clone()];
            let square = |column: &[f64]| column.iter().zip(weight).map(|(v, w)| v * v * w).sum();
            values.chunks_exact(extent.len()).map(square).collect()
        };
        let parts: Vec<Vec<f64>> = self.chunks.par_iter().enumerate().map(of_chunk).collect();
        let mut sums = vec![0.0; self.count];
        parts.iter().for_each(|part| sums.iter_mut().zip(part).for_each(|(sum, part)| *sum += part));
        sums
    }

    /// Vectors that are sums of these: one for each column of coefficients.
    pub(crate) fn combined(&self, coefficients: &DMatrix<f64>) -> Basis {
        let mut sums = Basis::new(self.rows);
        sums.extend(coefficients.ncols(), |_, _| 0.0);
        sums.add(self, coefficients);
        sums
    }

    /// Adds sums of the vectors of another basis.
    pub(crate) fn add(&mut self, other: &Basis, coefficients: &DMatrix<f64>) {
        let rows = self.rows;
        self.chunks.par_iter_mut().zip(&other.chunks).enumerate().for_each(|(chunk, (to, from))| {
            let rows = Self::extent(rows, chunk).len();
            for (v, to) in to.chunks_exact_mut(rows).enumerate() {
                for (k, from) in from.chunks_exact(rows).enumerate() {
                    let factor = coefficients[(k, v)];
                    to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
                }
            }
        });
    }

    /// Adds vectors of another basis, multiplied row by row and vector by vector.
    pub(crate) fn add_weighted(&mut self, other: &Basis, weight: &[f64], factor: &[f64]) {
        let rows = self.rows;
        self.chunks.par_iter_mut().zip(&other.chunks).enumerate().for_each(|(chunk, (to, from))| {
            let extent = Self::extent(rows, chunk);
            let (rows, weight) = (extent.len(), &weight[extent]);
            for ((to, from), factor) in to.chunks_exact_mut(rows).zip(from.chunks_exact(rows)).zip(factor) {
                for ((to, from), weight) in to.iter_mut().zip(from).zip(weight) {
                    *to += factor * weight * from;
                }
            }
        });
    }

    /// A vector.
    pub(crate) fn vector<const B: usize>(&self, number: usize) -> Vec<[f64; B]> {
        let mut vector = vec![[0.0; B]; self.rows / B];
        for (chunk, values) in self.chunks.iter().enumerate() {
            let extent = Self::extent(self.rows, chunk);
            let own = &values[number * extent.len()..][..extent.len()];
            vector.as_flattened_mut()[extent].copy_from_slice(own);
        }
        vector
    }
}

/// Scalar products of up to four vectors with one.
fn dot_four(four: &[&[f64]], other: &[f64]) -> [f64; 4] {
    const LANES: usize = 4;
    let mut sums = [[0.0; LANES]; 4];
    let (whole, rest) = other.as_chunks::<LANES>();
    if let [a, b, c, d] = four {
        let (a4, b4, c4, d4) =
            (a.as_chunks::<LANES>().0, b.as_chunks::<LANES>().0, c.as_chunks::<LANES>().0, d.as_chunks::<LANES>().0);
        for ((((x, a), b), c), d) in whole.iter().zip(a4).zip(b4).zip(c4).zip(d4) {
            for l in 0..LANES {
                sums[0][l] += a[l] * x[l];
                sums[1][l] += b[l] * x[l];
                sums[2][l] += c[l] * x[l];
                sums[3][l] += d[l] * x[l];
            }
        }
    } else {
        for (sums, vector) in sums.iter_mut().zip(four) {
            for (x, a) in whole.iter().zip(vector.as_chunks::<LANES>().0) {
                (0..LANES).for_each(|l| sums[l] += a[l] * x[l]);
            }
        }
    }
    let mut products = [0.0; 4];
    for ((product, sums), vector) in products.iter_mut().zip(sums).zip(four) {
        let tail: f64 = rest.iter().zip(vector.as_chunks::<LANES>().1).map(|(x, a)| x * a).sum();
        *product = (sums[0] + sums[1]) + (sums[2] + sums[3]) + tail;
    }
    products
}
