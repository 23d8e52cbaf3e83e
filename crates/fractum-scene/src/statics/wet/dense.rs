//! Dense systems of equations by elimination with row pivoting, in a fixed order of operations.

/// A square matrix by rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Dense {
    size: usize,
    rows: Vec<f64>,
}

impl Dense {
    /// Makes it a matrix of zeros.
    pub(super) fn reset(&mut self, size: usize) {
        self.size = size;
        self.rows.clear();
        self.rows.resize(size * size, 0.0);
    }

    /// Adds to an entry.
    pub(super) fn add(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row * self.size + column] += value;
    }

    /// Solves for a right-hand side in place, and leaves the matrix eliminated; whether that is possible. Pivots are compared over the largest entries of
    /// their rows, which may be of any unit.
    pub(super) fn solve(&mut self, right: &mut [f64]) -> bool {
        let n = self.size;
        let largest = |row: &[f64]| row.iter().fold(0.0f64, |most, value| most.max(value.abs()));
        let mut scale: Vec<f64> = self.rows.chunks_exact(n).map(largest).collect();
        for k in 0..n {
            let weight = |row: usize| self.rows[row * n + k].abs() / scale[row];
            let mut pivot = k;
            for row in k + 1..n {
                if weight(row) > weight(pivot) {
                    pivot = row;
                }
            }
            let found = weight(pivot);
            if !(found > 0.0 && found.is_finite()) {
                return false;
            }
            if pivot != k {
                for column in k..n {
                    self.rows.swap(k * n + column, pivot * n + column);
                }
                scale.swap(k, pivot);
                right.swap(k, pivot);
            }
            let (above, below) = self.rows.split_at_mut((k + 1) * n);
            let pivots = &above[k * n + k..];
            for (index, row) in below.chunks_exact_mut(n).enumerate() {
                let factor = row[k] / pivots[0];
                if factor != 0.0 {
                    for (value, pivot) in row[k + 1..].iter_mut().zip(&pivots[1..]) {
                        *value -= factor * pivot;
                    }
                    right[k + 1 + index] -= factor * right[k];
                }
            }
        }
        for k in (0..n).rev() {
            let row = &self.rows[k * n..(k + 1) * n];
            let known: f64 = row[k + 1..].iter().zip(&right[k + 1..]).map(|(a, x)| a * x).sum();
            right[k] = (right[k] - known) / row[k];
        }
        right.iter().all(|x| x.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_whose_rows_have_any_unit_is_solved() {
        let n = 40;
        let entry =
            |i: usize, j: usize| ((i * 37 + j * 11 + i * j * 5) as f64 * 0.7).sin() * 10f64.powi(i as i32 % 19 - 9);
        let x: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
        let mut right: Vec<f64> = (0..n).map(|i| (0..n).map(|j| entry(i, j) * x[j]).sum()).collect();
        let mut matrix = Dense::default();
        matrix.reset(n);
        (0..n).for_each(|i| (0..n).for_each(|j| matrix.add(i, j, entry(i, j))));
        assert!(matrix.solve(&mut right));
        assert!(right.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-6), "{right:?}");
        matrix.reset(2);
        assert!(!matrix.solve(&mut [1.0, 1.0]));
    }
}
