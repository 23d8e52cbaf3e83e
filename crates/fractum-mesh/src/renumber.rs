//! Orders that keep what is close in space close in memory.

use fractum_math::Vec3;
use rayon::prelude::*;

use crate::mesh::bounding_box;

/// Bits per axis of the grid on which points are ordered.
const BITS: u32 = 20;

/// Orders points along a Hilbert curve through their bounding cube, so that neighbours in space are mostly neighbours
/// in the order. Points in one cell of the grid (2⁻²⁰ of the largest extent) keep the order of their indices.
///
/// - returns `order`: new index k holds old index `order[k]`
///
/// Coordinates should be finite; others are taken as lying on the box.
pub fn hilbert_order(points: &[Vec3]) -> Vec<u32> {
    let (low, high) = bounding_box(points);
    let extent = (high - low).max();
    let scale = if extent > 0.0 { f64::from((1u32 << BITS) - 1) / extent } else { 0.0 };
    let mut keys: Vec<(u64, u32)> = points
        .par_iter()
        .enumerate()
        .map(|(index, point)| {
            let cell = std::array::from_fn(|axis| (((point[axis] - low[axis]) * scale) as u32).min((1 << BITS) - 1));
            (hilbert_index(cell), index as u32)
        })
        .collect();
    keys.par_sort_unstable();
    keys.into_iter().map(|(_, index)| index).collect()
}

/// The inverse of a permutation: `invert(order)[order[k]] == k`.
///
/// # Panics
/// If `order` is not a permutation of its indices.
pub fn invert(order: &[u32]) -> Vec<u32> {
    let mut inverse = vec![u32::MAX; order.len()];
    for (new, &old) in order.iter().enumerate() {
        assert_eq!(inverse[old as usize], u32::MAX, "index {old} occurs twice in a permutation");
        inverse[old as usize] = new as u32;
    }
    inverse
}

/// Position of a grid cell along the Hilbert curve of [`BITS`] levels, from the coordinates to their transpose and
/// then bit by bit. Skilling, *Programming the Hilbert curve*, AIP Conf. Proc. 707 (2004) 381-387.
fn hilbert_index(mut cell: [u32; 3]) -> u64 {
    // undo the rotations of the levels, coarsest first
    let mut level = 1 << (BITS - 1);
    while level > 1 {
        let below = level - 1;
        for axis in 0..3 {
            if cell[axis] & level != 0 {
                cell[0] ^= below;
            } else {
                let swap = (cell[0] ^ cell[axis]) & below;
                cell[0] ^= swap;
                cell[axis] ^= swap;
            }
        }
        level >>= 1;
    }
    // Gray code to binary
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let mut flip = 0;
    let mut level = 1 << (BITS - 1);
    while level > 1 {
        if cell[2] & level != 0 {
            flip ^= level - 1;
        }
        level >>= 1;
    }
    cell.iter_mut().for_each(|x| *x ^= flip);
    (spread(cell[0]) << 2) | (spread(cell[1]) << 1) | spread(cell[2])
}

/// Moves bit k to bit 3k, for 21 bits.
fn spread(x: u32) -> u64 {
    let mut x = u64::from(x) & 0x1f_ffff;
    x = (x | x << 32) & 0x001f_0000_0000_ffff;
    x = (x | x << 16) & 0x001f_0000_ff00_00ff;
    x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_cells_of_a_full_grid_share_a_face() {
        let n = 16u32;
        let cells: Vec<[u32; 3]> = (0..n * n * n).map(|i| [i % n, i / n % n, i / n / n]).collect();
        let points: Vec<Vec3> = cells.iter().map(|c| Vec3::new(c[0].into(), c[1].into(), c[2].into())).collect();
        let order = hilbert_order(&points);
        for pair in order.windows(2) {
            let step = points[pair[0] as usize] - points[pair[1] as usize];
            assert_eq!(step.abs().sum(), 1.0);
        }
    }

    #[test]
    fn equal_points_keep_their_order_and_strange_ones_do_no_harm() {
        assert_eq!(hilbert_order(&[Vec3::zeros(); 5]), [0, 1, 2, 3, 4]);
        assert!(hilbert_order(&[]).is_empty());
        let strange = [Vec3::new(f64::NAN, 0.0, 1.0), Vec3::new(f64::INFINITY, 0.0, 0.0), Vec3::zeros()];
        let order = hilbert_order(&strange);
        assert_eq!(invert(&invert(&order)), order);
    }
}
