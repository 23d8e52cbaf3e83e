//! A net of springs for the tests of solvers.

use std::sync::Arc;

use fractum_math::Ragged;

use crate::block::{BlockMatrix, Pattern};

/// A square net of n × n nodes with springs along its lines and diagonals: stiffness and places.
pub(crate) fn net(n: u32) -> (BlockMatrix<2>, Vec<[f64; 3]>) {
    let at = |i: u32, j: u32| i + n * j;
    let places: Vec<[f64; 3]> = (0..n * n).map(|k| [f64::from(k % n), f64::from(k / n), 0.0]).collect();
    let mut springs = Vec::new();
    for j in 0..n {
        for i in 0..n {
            let ends = [(i + 1, j), (i, j + 1), (i + 1, j + 1), (i + 1, j.wrapping_sub(1))];
            springs.extend(ends.iter().filter(|(a, b)| *a < n && *b < n).map(|&(a, b)| [at(i, j), at(a, b)]));
        }
    }
    let pattern = Arc::new(Pattern::from_cliques(places.len(), &Ragged::from_rows(&springs)));
    let mut k = BlockMatrix::<2>::zeros(pattern);
    for [i, j] in springs {
        let (p, q) = (places[i as usize], places[j as usize]);
        let (x, y) = (q[0] - p[0], q[1] - p[1]);
        let along = [[x * x, x * y], [x * y, y * y]];
        let against = along.map(|row| row.map(|v: f64| -v));
        for (a, b, block) in [(i, i, along), (j, j, along), (i, j, against), (j, i, against)] {
            k.add(a as usize, b as usize, block);
        }
    }
    (k, places)
}
