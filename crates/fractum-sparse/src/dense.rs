//! Dense kernels of the factorisation: products of tall blocks and the factor of a panel.
//!
//! Every entry adds its products in ascending order, one by one and not fused, so that neither the width of the vectors
//! nor the size of the tiles changes a bit: the version for AVX2 gives what any other processor gives.

/// Columns factored together within a panel.
const COLUMNS: usize = 8;
/// Columns of a tile; its rows fill two vectors.
const TILE_COLUMNS: usize = 6;

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

/// Lower part of A Bᵀ, where A is the block from row `from` on and B its first `n` rows; into `buffers.product`.
pub(crate) fn lower_product(block: Columns<'_>, from: usize, n: usize, buffers: &mut Buffers) {
    #[cfg(target_arch = "x86_64")]
    if std::arch::is_x86_feature_detected!("avx2") {
        // SAFETY: the instruction set was found on this machine.
        #[allow(unsafe_code)]
        return unsafe { lower_product_avx2(block, from, n, buffers) };
    }
    tiles::<4>(block, from, n, buffers);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
fn lower_product_avx2(block: Columns<'_>, from: usize, n: usize, buffers: &mut Buffers) {
    tiles::<8>(block, from, n, buffers);
}

#[inline(always)]
fn tiles<const ROWS: usize>(block: Columns<'_>, from: usize, n: usize, buffers: &mut Buffers) {
    let (m, depth) = (block.height - from, block.count);
    let Buffers { left, right, product } = buffers;
    pack::<ROWS>(block, from, m, left);
    pack::<TILE_COLUMNS>(block, from, n, right);
    product.resize(m * n, 0.0);
    for (tile_column, right) in right.chunks_exact(TILE_COLUMNS * depth).enumerate() {
        let column = tile_column * TILE_COLUMNS;
        let width = TILE_COLUMNS.min(n - column);
        for (tile_row, left) in left.chunks_exact(ROWS * depth).enumerate().skip(column / ROWS) {
            let row = tile_row * ROWS;
            let height = ROWS.min(m - row);
            let sums = tile::<ROWS>(left, right);
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
fn tile<const ROWS: usize>(left: &[f64], right: &[f64]) -> [[f64; ROWS]; TILE_COLUMNS] {
    let mut sums = [[0.0; ROWS]; TILE_COLUMNS];
    for (a, b) in left.as_chunks::<ROWS>().0.iter().zip(right.as_chunks::<TILE_COLUMNS>().0) {
        for c in 0..TILE_COLUMNS {
            for r in 0..ROWS {
                sums[c][r] += a[r] * b[c];
            }
        }
    }
    sums
}

/// Rows `from..from + count` of a block in strips of `ROWS`, each column by column; the last strip is filled up with zeros.
#[inline(always)]
fn pack<const ROWS: usize>(block: Columns<'_>, from: usize, count: usize, packed: &mut Vec<f64>) {
    packed.clear();
    for row in (0..count).step_by(ROWS) {
        let height = ROWS.min(count - row);
        for column in block.values.chunks_exact(block.height) {
            let entries = &column[from + row..from + row + height];
            if let Ok(entries) = <&[f64; ROWS]>::try_from(entries) {
                packed.extend_from_slice(entries);
            } else {
                packed.extend((0..ROWS).map(|r| entries.get(r).copied().unwrap_or(0.0)));
            }
        }
    }
}

/// Factors a panel in place: the Cholesky factor of its first `width` rows, and what is below solved with it.
///
/// # Errors
/// The column of the first pivot that is not positive.
pub(crate) fn factor_panel(panel: &mut [f64], height: usize, width: usize, buffers: &mut Buffers) -> Result<(), usize> {
    for start in (0..width).step_by(COLUMNS) {
        let count = COLUMNS.min(width - start);
        let (before, now) = panel.split_at_mut(start * height);
        if start > 0 {
            lower_product(Columns { values: before, height, count: start }, start, count, buffers);
            let m = height - start;
            for (c, column) in now.chunks_exact_mut(height).take(count).enumerate() {
                for (value, sum) in column[start + c..].iter_mut().zip(&buffers.product[c * m + c..]) {
                    *value -= sum;
                }
            }
        }
        factor_columns(&mut now[..count * height], height, start)?;
    }
    Ok(())
}

/// Factors a few columns, the first with its pivot in row `start`.
fn factor_columns(columns: &mut [f64], height: usize, start: usize) -> Result<(), usize> {
    for c in 0..columns.len() / height {
        let (before, now) = columns.split_at_mut(c * height);
        let pivot_row = start + c;
        let column = &mut now[pivot_row..height];
        for other in before.chunks_exact(height) {
            let other = &other[pivot_row..];
            let factor = other[0];
            for (value, other) in column.iter_mut().zip(other) {
                *value -= other * factor;
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

/// Σ aᵢ bᵢ in eight sums, added up in a fixed order.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    let mut sums = [0.0; 8];
    for (a, b) in a.iter().zip(b) {
        for i in 0..8 {
            sums[i] += a[i] * b[i];
        }
    }
    let [s0, s1, s2, s3, s4, s5, s6, s7] = sums;
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    ((s0 + s4) + (s1 + s5)) + ((s2 + s6) + (s3 + s7)) + rest
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
    fn the_width_of_the_vectors_changes_no_bit() {
        for (height, count, from, n) in [(5, 3, 1, 2), (40, 17, 0, 13), (61, 48, 12, 31), (200, 64, 3, 64)] {
            let values = numbers(height * count);
            let block = Columns { values: &values, height, count };
            let mut buffers = [Buffers::default(), Buffers::default(), Buffers::default(), Buffers::default()];
            lower_product(block, from, n, &mut buffers[0]);
            tiles::<4>(block, from, n, &mut buffers[1]);
            tiles::<8>(block, from, n, &mut buffers[2]);
            tiles::<16>(block, from, n, &mut buffers[3]);
            let m = height - from;
            for column in 0..n {
                for row in column..m {
                    let one_by_one = (0..count)
                        .fold(0.0, |sum, k| sum + values[k * height + from + row] * values[k * height + from + column]);
                    for buffers in &buffers {
                        assert_eq!(buffers.product[column * m + row].to_bits(), f64::to_bits(one_by_one));
                    }
                }
            }
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
