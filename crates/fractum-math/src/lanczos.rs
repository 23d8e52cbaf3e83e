use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::{CHUNK, Vec3, sum_chunks};

/// Largest eigenvalue of a symmetric operator on `count` vectors, by the Lanczos process.
///
/// - `steps`: most products with the operator
/// - `apply`: the operator; must have the same bits for any number of threads, as the result then has
///
/// It converges from below. Golub and Van Loan, *Matrix Computations* (2013), 10.1.
pub fn largest_eigenvalue(count: usize, steps: usize, mut apply: impl FnMut(&[Vec3]) -> Vec<Vec3>) -> f64 {
    let norm = |v: &[Vec3]| sum_chunks(v.len(), |i| v[i].norm_squared()).sqrt();
    let mut q: Vec<Vec3> = (0..count).map(|i| start_vector(i as u64)).collect();
    let start = norm(&q);
    q.iter_mut().for_each(|v| *v /= start);
    let mut before = vec![Vec3::zeros(); count];
    let (mut alphas, mut betas) = (Vec::new(), Vec::<f64>::new());
    for _ in 0..steps.min(3 * count) {
        let mut w = apply(&q);
        let alpha = sum_chunks(count, |i| w[i].dot(&q[i]));
        let beta = betas.last().copied().unwrap_or(0.0);
        w.par_iter_mut().enumerate().with_min_len(CHUNK).for_each(|(i, w)| *w -= q[i] * alpha + before[i] * beta);
        alphas.push(alpha);
        let next = norm(&w);
        if next <= 1e-12 * alpha.abs() {
            break;
        }
        w.iter_mut().for_each(|v| *v /= next);
        betas.push(next);
        before = std::mem::replace(&mut q, w);
    }
    let size = alphas.len();
    let tridiagonal = DMatrix::from_fn(size, size, |i, j| match i.abs_diff(j) {
        0 => alphas[i],
        1 => betas[i.min(j)],
        _ => 0.0,
    });
    tridiagonal.symmetric_eigenvalues().max()
}

/// A reproducible vector without symmetry.
fn start_vector(index: u64) -> Vec3 {
    let component = |axis: u64| {
        let mut x = (index * 3 + axis).wrapping_add(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    Vec3::new(component(0), component(1), component(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chain_of_springs_has_its_known_highest_frequency() {
        // Fixed chain of n masses: λ = 4 sin²(π n/(2 (n + 1))).
        let n = 30;
        let chain = |q: &[Vec3]| -> Vec<Vec3> {
            let at = |i: isize| if (0..n as isize).contains(&i) { q[i as usize] } else { Vec3::zeros() };
            (0..n as isize).map(|i| at(i) * 2.0 - at(i - 1) - at(i + 1)).collect()
        };
        let exact = 4.0 * (std::f64::consts::PI * n as f64 / (2.0 * (n as f64 + 1.0))).sin().powi(2);
        let found = largest_eigenvalue(n, 60, chain);
        assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
    }
}
