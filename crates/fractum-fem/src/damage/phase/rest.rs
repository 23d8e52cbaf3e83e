//! The phase field at rest: a projected Newton method for given drives.

use fractum_math::{FOUR, Lane, widest};

use super::laplacian::Rows;
use super::{Drive, DriveOfFour, PhaseField};

/// Newton steps at most, and the change of d at which they end.
const STEPS: usize = 40;
const CHANGE: f64 = 1e-7;
/// Iterations of the linear solution at most, and the part of its residual that it leaves.
const ITERATIONS: usize = 200;
const RESIDUAL: f64 = 1e-4;

/// A row that is not held.
struct Free {
    row: u32,
    edge: u32,
    /// The diagonal of its equation, and the part of it that is not of the Laplacian.
    diagonal: f64,
    slope: f64,
}

/// Vectors of the linear solution over the edges of the body, zero where an edge is held.
#[derive(Default)]
struct Solution {
    free: Vec<Free>,
    change: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
}

impl PhaseField {
    /// The d ≥ that of the last equilibrium that solve R = 0 for these drives of the active edges, from a guess in `d`.
    ///
    /// The slope of the term k (1 - d) is left out of the Newton matrix, which so stays positive definite.
    pub(crate) fn settle(&self, drives: &[Drive], d: &mut [f64]) {
        for (value, least) in d.iter_mut().zip(&self.value) {
            *value = value.max(*least);
        }
        let mut work = Solution::default();
        for vector in [&mut work.change, &mut work.residual, &mut work.direction, &mut work.image] {
            vector.resize(d.len(), 0.0);
        }
        for _ in 0..STEPS {
            self.free_edges(drives, d, &mut work);
            if work.free.is_empty() {
                return;
            }
            conjugate_gradients(&self.rows, self.law.gradient, &mut work);
            let mut largest: f64 = 0.0;
            for own in &work.free {
                let edge = own.edge as usize;
                let next = (d[edge] + work.change[edge]).clamp(self.value[edge], 1.0);
                largest = largest.max((next - d[edge]).abs());
                d[edge] = next;
            }
            for own in &work.free {
                let edge = own.edge as usize;
                (work.change[edge], work.direction[edge]) = (0.0, 0.0);
            }
            if largest < CHANGE {
                return;
            }
        }
    }

    /// Finds the edges that are not held, with the right-hand side -R of their equations.
    fn free_edges(&self, drives: &[Drive], d: &[f64], work: &mut Solution) {
        work.free.clear();
        for (group, (active, drives)) in self.active.chunks(FOUR).zip(drives.chunks(FOUR)).enumerate() {
            let (mut four, mut values) = (DriveOfFour::default(), Lane::ZERO);
            for (k, (own, drive)) in active.iter().zip(drives).enumerate() {
                four.set(k, drive);
                values.0[k] = d[own.edge as usize];
            }
            let (Lane(residuals), Lane(slopes)) = self.law.residual(&four, self.rows.products(group, d), values);
            for (k, own) in active.iter().enumerate() {
                let (edge, row, residual) = (own.edge as usize, group * FOUR + k, residuals[k]);
                let held = residual >= 0.0 && d[edge] <= self.value[edge] || residual <= 0.0 && d[edge] >= 1.0;
                let own = self.law.gradient * self.rows.diagonal(row);
                let diagonal = slopes[k] + own;
                if !held && diagonal > 0.0 {
                    work.residual[edge] = -residual;
                    let (row, edge) = (row as u32, edge as u32);
                    work.free.push(Free { row, edge, diagonal, slope: diagonal - own });
                }
            }
        }
    }
}

widest! {
    /// Solves (V max(ω'', 0) Y + c L) δ = -R on the free edges, with the diagonal as preconditioner.
    fn conjugate_gradients(rows: &Rows, gradient: f64, work: &mut Solution) = conjugate_directions;
}

#[inline(always)]
fn conjugate_directions(rows: &Rows, gradient: f64, work: &mut Solution) {
    let Solution { free, change, residual, direction, image } = work;
    let mut product = 0.0;
    for own in &*free {
        let e = own.edge as usize;
        let r = residual[e];
        direction[e] = r / own.diagonal;
        product += r * direction[e];
    }
    let enough = RESIDUAL * RESIDUAL * product;
    for _ in 0..ITERATIONS {
        let mut curvature = 0.0;
        let (mut group, mut flows) = (usize::MAX, Lane::ZERO);
        for own in &*free {
            let (e, row) = (own.edge as usize, own.row as usize);
            if group != row / FOUR {
                group = row / FOUR;
                flows = rows.products(group, direction);
            }
            image[e] = own.slope * direction[e] + gradient * flows.0[row % FOUR];
            curvature += direction[e] * image[e];
        }
        if curvature.is_nan() || curvature <= 0.0 {
            return;
        }
        let step = product / curvature;
        let mut next = 0.0;
        for own in &*free {
            let e = own.edge as usize;
            change[e] += step * direction[e];
            residual[e] -= step * image[e];
            next += residual[e] * residual[e] / own.diagonal;
        }
        if next <= enough {
            return;
        }
        let turn = next / product;
        for own in &*free {
            let e = own.edge as usize;
            direction[e] = residual[e] / own.diagonal + turn * direction[e];
        }
        product = next;
    }
}
