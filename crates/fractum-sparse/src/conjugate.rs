use fractum_math::sum_chunks;

use crate::block::BlockMatrix;
use crate::incomplete::Preconditioner;

/// How an iteration went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Convergence {
    /// Iterations done.
    pub iterations: usize,
    /// Norm of the residual over that of the right-hand side.
    pub residual: f64,
}

/// Solves A x = b by preconditioned conjugate gradients, beginning with the `x` given.
///
/// Ends once the residual has fallen to `tolerance` of the right-hand side, or after `most` iterations; the caller looks
/// at the residual that is returned.
pub fn conjugate_gradients<const B: usize>(
    a: &BlockMatrix<B>,
    b: &[[f64; B]],
    x: &mut [[f64; B]],
    preconditioner: &mut Preconditioner<B>,
    tolerance: f64,
    most: usize,
) -> Convergence {
    let scale = dot(b, b).sqrt();
    if scale == 0.0 {
        x.fill([0.0; B]);
        return Convergence { iterations: 0, residual: 0.0 };
    }
    let mut q = vec![[0.0; B]; b.len()];
    a.multiply(x, &mut q);
    let mut r: Vec<[f64; B]> = b.iter().zip(&q).map(|(b, q)| std::array::from_fn(|c| b[c] - q[c])).collect();
    let mut z = vec![[0.0; B]; b.len()];
    let mut p = vec![[0.0; B]; b.len()];
    let mut rho = 0.0;
    let mut residual = dot(&r, &r).sqrt() / scale;
    let mut iterations = 0;
    while residual > tolerance && iterations < most {
        preconditioner.apply(&r, &mut z);
        let next = dot(&r, &z);
        let beta = if iterations == 0 { 0.0 } else { next / rho };
        rho = next;
        for (p, z) in p.iter_mut().zip(&z) {
            *p = std::array::from_fn(|c| z[c] + beta * p[c]);
        }
        a.multiply(&p, &mut q);
        let alpha = rho / dot(&p, &q);
        if !alpha.is_finite() {
            break;
        }
        for i in 0..b.len() {
            for c in 0..B {
                x[i][c] += alpha * p[i][c];
                r[i][c] -= alpha * q[i][c];
            }
        }
        residual = dot(&r, &r).sqrt() / scale;
        iterations += 1;
    }
    Convergence { iterations, residual }
}

fn dot<const B: usize>(a: &[[f64; B]], b: &[[f64; B]]) -> f64 {
    sum_chunks(a.len(), |i| (0..B).map(|c| a[i][c] * b[i][c]).sum())
}
