use nalgebra::{DMatrix, SVector};
use rayon::prelude::*;

use crate::{CHUNK, sum_chunks};

/// A linear operator: one vector of `N` components for each.
pub type Operator<'a, const N: usize> = dyn FnMut(&[SVector<f64, N>]) -> Vec<SVector<f64, N>> + 'a;

/// Largest eigenvalue of a symmetric operator by the Lanczos process, from below; without convergence to wait for, as some
/// tens of steps find it to well within two per cent where it stands for the highest frequency of a body.
///
/// - `count`: vectors of `N` components that the operator takes
/// - `steps`: products with it, at most
/// - `apply`: the operator; it gives one vector per vector
pub fn largest_eigenvalue<const N: usize>(count: usize, steps: usize, apply: &mut Operator<'_, N>) -> f64 {
    type Vectors<const N: usize> = Vec<SVector<f64, N>>;
    let norm = |v: &Vectors<N>| sum_chunks(v.len(), |i| v[i].norm_squared()).sqrt();
    let mut q: Vectors<N> = (0..count).map(start_vector).collect();
    let start = norm(&q);
    q.iter_mut().for_each(|v| *v /= start);
    let mut before: Vectors<N> = vec![SVector::zeros(); count];
    let (mut alphas, mut betas) = (Vec::new(), Vec::<f64>::new());
    for _ in 0..steps.min(N * count) {
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
    if size == 0 { 0.0 } else { tridiagonal.symmetric_eigenvalues().max() }
}

/// A reproducible vector without symmetry.
fn start_vector<const N: usize>(index: usize) -> SVector<f64, N> {
    SVector::from_fn(|axis, _| {
        let mut x = (index as u64 * N as u64 + axis as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
        x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Vec3;

    #[test]
    fn the_highest_mode_of_a_chain_is_found() {
        // Springs of 1 between masses of 1, free ends: ω² = 4 sin²(π k/2n), k = n − 1; transverse motion without stiffness.
        let n = 30;
        let chain = |q: &[Vec3]| {
            let pull = |i: usize, j: Option<usize>| j.map_or(0.0, |j| q.get(j).map_or(0.0, |other| q[i].x - other.x));
            (0..n).map(|i| Vec3::x() * (pull(i, Some(i + 1)) + pull(i, i.checked_sub(1)))).collect()
        };
        let exact = 4.0 * (0.5 * std::f64::consts::PI * (n - 1) as f64 / n as f64).sin().powi(2);
        let found = largest_eigenvalue(n, 30, &mut { chain });
        assert!((found / exact - 1.0).abs() < 1e-6, "{found} {exact}");
        assert_eq!(largest_eigenvalue(0, 10, &mut |_: &[Vec3]| Vec::new()), 0.0);
    }
}
