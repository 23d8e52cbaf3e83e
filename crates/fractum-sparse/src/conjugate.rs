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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cholesky::Factor;
    use crate::coarse::Motions;

    /// A net whose left side is held.
    fn net(n: u32) -> (BlockMatrix<2>, Vec<[f64; 3]>, Vec<u8>) {
        let (mut k, places) = crate::net::net(n);
        let held: Vec<u8> = places.iter().map(|p| if p[0] == 0.0 { 3 } else { 0 }).collect();
        k.hold(&held, 1.0);
        (k, places, held)
    }

    #[test]
    fn iteration_and_factorisation_agree() {
        let (k, places, held) = net(60);
        let b: Vec<[f64; 2]> = (0..3600)
            .map(|i| if held[i] == 3 { [0.0; 2] } else { [(i as f64 * 0.7).sin(), (i as f64 * 1.3).cos()] })
            .collect();
        let mut factor = Factor::new(k.pattern(), &places, 2).unwrap();
        factor.refactor(&k).unwrap();
        let mut exact = b.clone();
        factor.solve(&mut exact);
        let size = exact.as_flattened().iter().map(|v| v.abs()).fold(0.0, f64::max);
        let solve = |motions: Option<Motions<'_>>| {
            let mut x = vec![[0.0; 2]; b.len()];
            let mut preconditioner = Preconditioner::new(&k, motions).unwrap();
            let done = conjugate_gradients(&k, &b, &mut x, &mut preconditioner, 1e-12, 1000);
            assert!(done.residual <= 1e-12, "{done:?}");
            for (x, exact) in x.as_flattened().iter().zip(exact.as_flattened()) {
                assert!((x - exact).abs() < 1e-9 * size);
            }
            done.iterations
        };
        let alone = solve(None);
        let with_motions = solve(Some(Motions { places: &places, held: &held, cluster: 15 }));
        assert!(with_motions < alone, "{with_motions} against {alone} iterations");
    }

    #[test]
    fn a_free_body_is_found_indefinite() {
        let (mut k, places, _) = net(6);
        // Held nowhere: the springs leave the rigid motions alone.
        let springs_only = {
            let (mut free, _, held) = net(6);
            for (i, _) in held.iter().enumerate().filter(|(_, h)| **h == 3) {
                let d = free.diagonal(i);
                free.add(i, i, d.map(|row| row.map(|v| -v)));
            }
            free
        };
        k.clear();
        let mut factor = Factor::new(k.pattern(), &places, 2).unwrap();
        assert!(factor.refactor(&springs_only).is_err());
    }
}
