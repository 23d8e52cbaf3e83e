//! Dense kernels of the factorisation: products of tall blocks and the factor of a panel.
//!
//! Every entry adds its products in ascending order, one by one and rounded once each, so that neither the width of the
//! vectors nor the size of the tiles changes a bit: the version for AVX2 gives what any other processor gives.

use fractum_math::widest;

/// Columns of a panel that are factored one by one.
const FEW: usize = 8;
/// Rows of a tile, two vectors of 256 bits, and its columns: twelve sums of the sixteen registers.
const ROWS: usize = 8;
const COLUMNS: usize = 6;

/// Buffers of the kernels, kept from panel to panel.
#[derive(Default)]
pub(crate) struct Buffers {
    left: Vec<f64>,
    right: Vec<f64>,
    /// The last product, by columns of `m` entries; entries above the diagonal are not defined.
    pub(crate) product: Vec<f64>,
}

/// Columns of a dense block: `height` rows, one column after another.
#[derive(Clone, Copy)]
pub(crate) struct Columns<'a> {
    pub(crate) values: &'a [f64],
    pub(crate) height: usize,
    /// Number of columns.
    pub(crate) count: usize,
}

widest! {
    /// Lower part of A Bᵀ, where A is the block from row `from` on and B its first `n` rows; into `buffers.product`.
    pub(crate) fn lower_product(block: Columns<'_>, from: usize, n: usize, buffers: &mut Buffers) = tiles;
}

widest! {
    /// Factors a few columns, the first with its pivot in row `start`.
    fn factor_columns(columns: &mut [f64], height: usize, start: usize) -> Result<(), usize> = factor_one_by_one;
}

widest! {
    /// Solves with the columns of a panel: `own` for its unknowns, to be subtracted in `below` for its other rows.
    pub(crate) fn solve_forward(panel: Columns<'_>, own: &mut [f64], below: &mut [f64]) = forward;
}

widest! {
    /// Solves with the transposed columns of a panel, `below` being known.
    pub(crate) fn solve_backward(panel: Columns<'_>, own: &mut [f64], below: &[f64]) = backward;
}

#[inline(always)]
fn tiles(block: Columns<'_>, from: usize, n: usize, buffers: &mut Buffers) {
    let (m, depth) = (block.height - from, block.count);
    let Buffers { left, right, product } = buffers;
    pack::<ROWS>(block, from, m, left);
    pack::<COLUMNS>(block, from, n, right);
    product.resize(m * n, 0.0);
    for (tile_row, left) in left.chunks_exact(ROWS * depth).enumerate() {
        let row = tile_row * ROWS;
        let height = ROWS.min(m - row);
        for (tile_column, right) in right.chunks_exact(COLUMNS * depth).enumerate() {
            let column = tile_column * COLUMNS;
            if column >= row + height {
                break;
            }
            let width = COLUMNS.min(n - column);
            let sums = tile(left, right);
            for (c, sums) in sums[..width].iter().enumerate() {
                let start = (column + c) * m + row;
                if height == ROWS {
                    product[start..start + ROWS].copy_from_slice(sums);
                } else {
                    product[start..start + height].copy_from_slice(&sums[..height]);
                }
            }
        }
    }
}

#[inline(always)]
fn tile(left: &[f64], right: &[f64]) -> [[f64; ROWS]; COLUMNS] {
    let mut sums = [[0.0; ROWS]; COLUMNS];
    for (a, b) in left.as_chunks::<ROWS>().0.iter().zip(right.as_chunks::<COLUMNS>().0) {
        for c in 0..COLUMNS {
            for r in 0..ROWS {
                sums[c][r] = a[r].mul_add(b[c], sums[c][r]);
            }
        }
    }
    sums
}

/// Rows `from..from + count` of a block in strips of `ROWS`, each column by column; the last strip is filled up with zeros.
#[inline(always)]
fn pack<const ROWS: usize>(block: Columns<'_>, from: usize, count: usize, packed: &mut Vec<f64>) {
    let depth = block.count;
    packed.resize(count.div_ceil(ROWS) * ROWS * depth, 0.0);
    let strips = packed.as_chunks_mut::<ROWS>().0;
    for (c, column) in block.values.chunks_exact(block.height).enumerate() {
        let (whole, rest) = column[from..from + count].as_chunks::<ROWS>();
        for (strip, entries) in whole.iter().enumerate() {
            strips[strip * depth + c] = *entries;
        }
        if !rest.is_empty() {
            strips[whole.len() * depth + c] = std::array::from_fn(|r| rest.get(r).copied().unwrap_or(0.0));
        }
    }
}

/// Factors a panel in place: the Cholesky factor of its first `width` rows, and what is below solved with it.
///
/// # Errors
/// The column of the first pivot that is not positive.
pub(crate) fn factor_panel(panel: &mut [f64], height: usize, width: usize, buffers: &mut Buffers) -> Result<(), usize> {
    factor_halves(&mut panel[..width * height], height, 0, buffers)
}

/// Factors the first half of the columns, subtracts its product from the second, and factors that.
///
/// - `start`: row of the first pivot
fn factor_halves(columns: &mut [f64], height: usize, start: usize, buffers: &mut Buffers) -> Result<(), usize> {
    let count = columns.len() / height;
    if count <= FEW {
        return factor_columns(columns, height, start);
    }
    let half = (count / 2).next_multiple_of(FEW);
    let (before, now) = columns.split_at_mut(half * height);
    factor_halves(before, height, start, buffers)?;
    let next = start + half;
    lower_product(Columns { values: before, height, count: half }, next, count - half, buffers);
    for (c, (column, sums)) in now.chunks_exact_mut(height).zip(buffers.product.chunks_exact(height - next)).enumerate()
    {
        for (value, sum) in column[next + c..].iter_mut().zip(&sums[c..]) {
            *value -= sum;
        }
    }
    factor_halves(now, height, next, buffers)
}

#[inline(always)]
fn factor_one_by_one(columns: &mut [f64], height: usize, start: usize) -> Result<(), usize> {
    for c in 0..columns.len() / height {
        let (before, now) = columns.split_at_mut(c * height);
        let pivot_row = start + c;
        let column = &mut now[pivot_row..height];
        for other in before.chunks_exact(height) {
            let other = &other[pivot_row..];
            let factor = other[0];
            for (value, other) in column.iter_mut().zip(other) {
                *value = other.mul_add(-factor, *value);
            }
        }
        // Written so that NaN fails as well.
        if !(column[0] > 0.0 && column[0].is_finite()) {
            return Err(pivot_row);
        }
        let root = column[0].sqrt();
        column[0] = root;
        let scale = 1.0 / root;
        column[1..].iter_mut().for_each(|value| *value *= scale);
    }
    Ok(())
}

#[inline(always)]
fn forward(panel: Columns<'_>, own: &mut [f64], below: &mut [f64]) {
    for (c, column) in panel.values.chunks_exact(panel.height).enumerate() {
        let (diagonal, rest) = column.split_at(panel.count);
        let value = own[c] / diagonal[c];
        own[c] = value;
        own[c + 1..].iter_mut().zip(&diagonal[c + 1..]).for_each(|(own, l)| *own = l.mul_add(-value, *own));
        below.iter_mut().zip(rest).for_each(|(below, l)| *below = l.mul_add(value, *below));
    }
}

#[inline(always)]
fn backward(panel: Columns<'_>, own: &mut [f64], below: &[f64]) {
    for (c, column) in panel.values.chunks_exact(panel.height).enumerate().rev() {
        let (diagonal, rest) = column.split_at(panel.count);
        let sum = dot(rest, below) + dot(&diagonal[c + 1..], &own[c + 1..]);
        own[c] = (own[c] - sum) / diagonal[c];
    }
}

/// Σ aᵢ bᵢ in sixteen sums, added up in a fixed order.
#[inline(always)]
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<16>(), b.as_chunks::<16>());
    let mut sums = [0.0; 16];
    for (a, b) in a.iter().zip(b) {
        for i in 0..16 {
            sums[i] = a[i].mul_add(b[i], sums[i]);
        }
    }
    for half in [8, 4, 2, 1] {
        for i in 0..half {
            sums[i] += sums[i + half];
        }
    }
    a_rest.iter().zip(b_rest).fold(sums[0], |sum, (a, b)| a.mul_add(*b, sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(count: usize) -> Vec<f64> {
        let mut state = 7u64;
        let next = |_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        (0..count).map(next).collect()
    }

    #[test]
    fn any_processor_gives_the_same_bits() {
        let [mut fast, mut plain] = [Buffers::default(), Buffers::default()];
        for (height, count, from, n) in [(5, 3, 1, 2), (40, 17, 0, 13), (61, 48, 12, 31), (200, 64, 3, 64)] {
            let values = numbers(height * count);
            let block = Columns { values: &values, height, count };
            lower_product(block, from, n, &mut fast);
            tiles(block, from, n, &mut plain);
            let m = height - from;
            for column in 0..n {
                for row in column..m {
                    let entry = |row: usize, k: usize| values[k * height + from + row];
                    let one_by_one = (0..count).fold(0.0, |sum, k| entry(row, k).mul_add(entry(column, k), sum));
                    for buffers in [&fast, &plain] {
                        assert_eq!(buffers.product[column * m + row].to_bits(), f64::to_bits(one_by_one));
                    }
                }
            }
            let bits = |numbers: &[f64]| numbers.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
            let (mut own, mut below) =
                ([numbers(count), numbers(count)], [numbers(height - count), numbers(height - count)]);
            solve_forward(block, &mut own[0], &mut below[0]);
            forward(block, &mut own[1], &mut below[1]);
            assert_eq!((bits(&own[0]), bits(&below[0])), (bits(&own[1]), bits(&below[1])));
            solve_backward(block, &mut own[0], &below[0]);
            backward(block, &mut own[1], &below[1]);
            assert_eq!(bits(&own[0]), bits(&own[1]));
            let mut columns = [values.clone(), values.clone()];
            columns.iter_mut().for_each(|columns| (0..count).for_each(|c| columns[c * height + c] = 1.0 + c as f64));
            factor_columns(&mut columns[0], height, 0).unwrap();
            factor_one_by_one(&mut columns[1], height, 0).unwrap();
            assert_eq!(bits(&columns[0]), bits(&columns[1]));
        }
    }

    #[test]
    fn a_panel_times_its_transpose_gives_the_matrix_back() {
        let (height, width) = (37, 21);
        let root = numbers(height * height);
        let matrix = |r: usize, c: usize| {
            (0..height).map(|k| root[r * height + k] * root[c * height + k]).sum::<f64>()
                + if r == c { 1.0 } else { 0.0 }
        };
        let mut panel: Vec<f64> =
            (0..width).flat_map(|c| (0..height).map(move |r| (r, c))).map(|(r, c)| matrix(r, c)).collect();
        factor_panel(&mut panel, height, width, &mut Buffers::default()).unwrap();
        for c in 0..width {
            for r in c..height {
                let back: f64 = (0..=c.min(r)).map(|k| panel[k * height + r] * panel[k * height + c]).sum();
                assert!((back - matrix(r, c)).abs() < 1e-12, "{r} {c}");
            }
        }
        panel[0] = -1.0;
        assert_eq!(factor_panel(&mut panel, height, width, &mut Buffers::default()), Err(0));
    }
}
