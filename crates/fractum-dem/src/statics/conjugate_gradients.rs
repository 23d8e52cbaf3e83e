//! Preconditioned conjugate gradients on the lattice.

use rayon::prelude::*;

use super::Tolerance;
use super::lattice::{BLOCK, Dof6, Equilibrium, Lattice, LatticeSupports, dot};
use crate::DemError;

/// Unknowns and working arrays of a solve, in scaled variables (rotations times a length of the lattice).
#[derive(Clone, Debug)]
pub(crate) struct Iterate {
    /// Displacements and rotations.
    pub(crate) x: Vec<Dof6>,
    /// Unbalanced forces; zero where a support holds.
    pub(crate) r: Vec<Dof6>,
    /// Inverse diagonal of the stiffness; zero where nothing is stiff.
    pub(crate) inverse: Vec<Dof6>,
    p: Vec<Dof6>,
    q: Vec<Dof6>,
}

impl Iterate {
    /// Starts from a state and its unbalanced forces.
    pub(crate) fn new(lattice: &Lattice, x: Vec<Dof6>, r: Vec<Dof6>) -> Self {
        let n = x.len();
        let reciprocal = |v: f64| if v > 0.0 { 1.0 / v } else { 0.0 };
        let inverse = lattice.diagonal().iter().map(|d| d.map(reciprocal)).collect();
        Iterate { x, r, inverse, p: vec![[0.0; 6]; n], q: vec![[0.0; 6]; n] }
    }

    /// Reduces the unbalanced forces until their square is at most `target`; `reference` is the square of the forces
    /// they are compared with. Returns the number of iterations.
    ///
    /// # Errors
    /// [`DemError::NotConverged`], [`DemError::Interrupted`].
    pub(crate) fn solve(
        &mut self,
        lattice: &Lattice,
        fixed: &[u8],
        target: f64,
        reference: f64,
        tolerance: Tolerance,
    ) -> Result<usize, DemError> {
        let Iterate { x, r, inverse, p, q } = self;
        let failed = |iterations, residual: f64| {
            let residual = (residual / reference).sqrt();
            Err(DemError::NotConverged { iterations, residual, asked: tolerance.residual })
        };
        let mut residual: f64 = r.iter().map(|v| dot(v, v)).sum();
        let mut rz: f64 = r.iter().zip(inverse.iter()).map(|(r, m)| weighted(r, m)).sum();
        let mut beta = 0.0;
        let mut iterations = 0;
        while residual > target {
            if iterations == tolerance.iterations || !residual.is_finite() {
                return failed(iterations, residual);
            }
            if (tolerance.stop)() {
                return Err(DemError::Interrupted);
            }
            iterations += 1;
            p.par_chunks_mut(BLOCK).zip(r.par_chunks(BLOCK)).zip(inverse.par_chunks(BLOCK)).for_each(|((p, r), m)| {
                for i in 0..p.len() {
                    for d in 0..6 {
                        p[i][d] = m[i][d] * r[i][d] + beta * p[i][d];
                    }
                }
            });
            let curvature = lattice.apply(p, fixed, q);
            let step = rz / curvature;
            if curvature <= 0.0 || !step.is_finite() {
                return failed(iterations, residual);
            }
            let sums: Vec<(f64, f64)> = x
                .par_chunks_mut(BLOCK)
                .zip(r.par_chunks_mut(BLOCK))
                .zip(p.par_chunks(BLOCK).zip(q.par_chunks(BLOCK)))
                .zip(inverse.par_chunks(BLOCK))
                .map(|(((x, r), (p, q)), m)| {
                    let (mut plain, mut weight) = (0.0, 0.0);
                    for i in 0..x.len() {
                        for d in 0..6 {
                            x[i][d] += step * p[i][d];
                            r[i][d] -= step * q[i][d];
                            let square = r[i][d] * r[i][d];
                            plain += square;
                            weight += square * m[i][d];
                        }
                    }
                    (plain, weight)
                })
                .collect();
            let before = rz;
            (residual, rz) = sums.iter().fold((0.0, 0.0), |(a, b), s| (a + s.0, b + s.1));
            beta = rz / before;
        }
        Ok(iterations)
    }
}

#[inline]
fn weighted(a: &Dof6, m: &Dof6) -> f64 {
    (0..6).map(|d| a[d] * a[d] * m[d]).sum()
}

impl Lattice {
    /// Solves K u = loads under supports by preconditioned conjugate gradients, from a first guess.
    ///
    /// Rigid motions that nothing prevents are left as in the guess (the loads must not drive them).
    ///
    /// - `loads`: forces [N] and moments [N m] per particle, or none
    /// - `guess`: displacements and rotations to start from; prescribed values replace theirs
    ///
    /// # Errors
    /// Array lengths; [`DemError::NotConverged`].
    pub fn solve(
        &self,
        supports: &LatticeSupports,
        loads: Option<&[Dof6]>,
        guess: &[Dof6],
        tolerance: Tolerance,
    ) -> Result<Equilibrium, DemError> {
        let n = self.len();
        for (what, found) in
            [("supports", supports.fixed.len()), ("guess", guess.len()), ("loads", loads.map_or(n, <[_]>::len))]
        {
            if found != n {
                return Err(DemError::Length { what, found, expected: n });
            }
        }
        let back = 1.0 / self.scale();
        let mut x: Vec<Dof6> = guess.iter().map(|g| self.rescale(g, self.scale())).collect();
        for i in 0..n {
            let value = self.rescale(&supports.value[i], self.scale());
            (0..6).filter(|d| supports.fixed[i] >> d & 1 == 1).for_each(|d| x[i][d] = value[d]);
        }
        let load = |i: usize| loads.map_or([0.0; 6], |l| self.rescale(&l[i], back));
        // The reference force counts the reactions of the first guess, so that it does not vanish for pure supports.
        let mut r = vec![[0.0; 6]; n];
        self.apply(&x, &vec![0; n], &mut r);
        let mut reference = 0.0;
        for i in 0..n {
            let applied = load(i);
            for d in 0..6 {
                let fixed = supports.fixed[i] >> d & 1 == 1;
                reference += if fixed { r[i][d] * r[i][d] } else { applied[d] * applied[d] };
                r[i][d] = if fixed { 0.0 } else { applied[d] - r[i][d] };
            }
        }
        let target = tolerance.residual * tolerance.residual * reference;
        let mut iterate = Iterate::new(self, x, r);
        let iterations = iterate.solve(self, &supports.fixed, target, reference, tolerance)?;
        let mut x = iterate.x;
        let mut force = iterate.r;
        let work = self.apply(&x, &vec![0; n], &mut force);
        x.iter_mut().for_each(|v| *v = self.rescale(v, back));
        force.iter_mut().for_each(|v| *v = self.rescale(v, self.scale()));
        Ok(Equilibrium { state: x, force, energy: 0.5 * work, iterations })
    }
}
