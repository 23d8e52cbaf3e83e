use std::sync::Arc;

use fractum_math::Ragged;
use fractum_sparse::{BlockMatrix, Pattern, Preconditioner, SparseError, conjugate_gradients};

use crate::network::HeatNetwork;

/// Residual over the right-hand side at which a solution is accepted: what heat balances lose by it is of this order.
const TOLERANCE: f64 = 1e-13;
/// Residual that is accepted where rounding allows no less.
const ACCEPTED: f64 = 1e-10;
/// Iterations after which a system counts as unsolvable.
const MOST: usize = 10_000;

/// The systems of implicit steps, prepared for one step size and set of conductances.
#[derive(Default)]
pub struct ImplicitHeat {
    prepared: Option<Prepared>,
    /// Systems prepared so far.
    preparations: u64,
}

struct Prepared {
    dt: f64,
    matrix: BlockMatrix<1>,
    preconditioner: Preconditioner<1>,
}

impl ImplicitHeat {
    /// Forgets the prepared system; to be called when conductances have changed.
    pub fn renew(&mut self) {
        self.prepared = None;
    }

    /// Solves (C + Δt (K + h A)) ΔT = `right`, with ΔT = 0 where temperatures are prescribed.
    ///
    /// - `exchange`: h A of each point [W/K]; `held`: whether its temperature is prescribed
    pub(crate) fn solve(
        &mut self,
        network: &HeatNetwork,
        exchange: &[f64],
        held: &[bool],
        dt: f64,
        right: &[[f64; 1]],
    ) -> Result<Vec<[f64; 1]>, SparseError> {
        let prepared = match self.prepared.take().filter(|prepared| prepared.dt == dt) {
            Some(prepared) => prepared,
            None => {
                self.preparations += 1;
                let own = |i: usize| network.capacity()[i] + dt * exchange[i];
                let matrix = matrix(network, dt, own, held);
                Prepared { dt, preconditioner: Preconditioner::new(&matrix, None)?, matrix }
            }
        };
        let Prepared { matrix, preconditioner, .. } = self.prepared.insert(prepared);
        solve(matrix, preconditioner, right)
    }
}

/// `own` of each point on the diagonal, and `factor` times the conductances; rows of `held` points are taken out.
pub(crate) fn matrix(network: &HeatNetwork, factor: f64, own: impl Fn(usize) -> f64, held: &[bool]) -> BlockMatrix<1> {
    let pattern = Pattern::from_cliques(network.len(), &Ragged::from_rows(network.pairs()));
    let mut matrix = BlockMatrix::<1>::zeros(Arc::new(pattern));
    for (pair, &[i, j]) in network.pairs().iter().enumerate() {
        let (i, j, conductance) = (i as usize, j as usize, factor * network.conductance(pair));
        matrix.add(i, i, [[conductance]]);
        matrix.add(j, j, [[conductance]]);
        matrix.add(i, j, [[-conductance]]);
        matrix.add(j, i, [[-conductance]]);
    }
    (0..network.len()).for_each(|i| matrix.add(i, i, [[own(i)]]));
    let held: Vec<u8> = held.iter().map(|&held| u8::from(held)).collect();
    matrix.hold(&held, 1.0);
    matrix
}

/// The solution.
pub(crate) fn solve(
    matrix: &BlockMatrix<1>,
    preconditioner: &mut Preconditioner<1>,
    right: &[[f64; 1]],
) -> Result<Vec<[f64; 1]>, SparseError> {
    let mut x = vec![[0.0]; right.len()];
    let done = conjugate_gradients(matrix, right, &mut x, preconditioner, TOLERANCE, MOST);
    if done.residual <= ACCEPTED { Ok(x) } else { Err(SparseError::Stalled { iterations: done.iterations }) }
}

impl std::fmt::Debug for ImplicitHeat {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "ImplicitHeat({} systems prepared)", self.preparations)
    }
}
