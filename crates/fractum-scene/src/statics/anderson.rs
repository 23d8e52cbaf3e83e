//! Anderson's acceleration of a fixed-point iteration x ← g(x).

use nalgebra::{DMatrix, DVector};

/// Iterates that are remembered.
const DEPTH: usize = 6;

/// Remembers the last iterates and mixes them into a better one.
#[derive(Clone, Debug, Default)]
pub(super) struct Anderson {
    /// Last x and g(x), oldest first.
    iterates: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Anderson {
    /// Forgets everything.
    pub(super) fn reset(&mut self) {
        self.iterates.clear();
    }

    /// Replaces `x` by the next iterate, given `g` = g(x): the combination of the last images whose residuals g - x
    /// cancel best.
    pub(super) fn next(&mut self, x: &mut Vec<f64>, g: &[f64]) {
        if self.iterates.len() > DEPTH {
            self.iterates.remove(0);
        }
        self.iterates.push((std::mem::take(x), g.to_vec()));
        x.extend_from_slice(g);
        let (last, before) = self.iterates.split_last().expect("an iterate was just added");
        let count = before.len();
        if count == 0 {
            return;
        }
        let residual = |it: &(Vec<f64>, Vec<f64>), i: usize| it.1[i] - it.0[i];
        // Differences to the last residual, as columns.
        let differ = |k: usize, i: usize| residual(last, i) - residual(&before[k], i);
        let points = g.len();
        let normal = DMatrix::from_fn(count, count, |a, b| {
            if a > b { 0.0 } else { (0..points).map(|i| differ(a, i) * differ(b, i)).sum::<f64>() }
        });
        let normal = DMatrix::from_fn(count, count, |a, b| normal[(a.min(b), a.max(b))]);
        let right = DVector::from_fn(count, |a, _| (0..points).map(|i| differ(a, i) * residual(last, i)).sum::<f64>());
        // A little weight on the diagonal keeps nearly parallel differences from cancelling each other.
        let shift = 1e-10 * normal.trace() / count as f64;
        let Some(root) = (normal + DMatrix::identity(count, count) * shift).cholesky() else { return };
        let weights = root.solve(&right);
        for (k, weight) in weights.iter().enumerate() {
            for (i, x) in x.iter_mut().enumerate() {
                *x -= weight * (last.1[i] - before[k].1[i]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_linear_iteration_ends_after_as_many_steps_as_it_has_modes() {
        // g(x) = A x + c with the slow modes 0.9, 0.8, -0.7: by itself 0.9 per step.
        let g = |x: &[f64]| vec![0.9 * x[0] + 1.0, 0.8 * x[1] + 0.1 * x[0] + 2.0, -0.7 * x[2] + 3.0];
        let mut x = vec![0.0; 3];
        let mut mixer = Anderson::default();
        for _ in 0..6 {
            let image = g(&x);
            mixer.next(&mut x, &image);
        }
        let error = x.iter().zip(g(&x)).map(|(x, g)| (x - g).abs()).fold(0.0, f64::max);
        assert!(error < 1e-6, "{error}");
    }
}
