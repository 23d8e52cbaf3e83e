//! Stiffness of the stress that solids have at the start: K_ij = ∫ ∇N_i · σ ∇N_j dV on every axis.

use fractum_fem::{SecantCell, Solid};
use fractum_math::{Mat3, Vec3};
use fractum_sparse::BlockMatrix;
use nalgebra::DMatrix;

use super::rigid_motions::RigidMotion;
use super::slowest::size;

/// Force of the stresses of the start on a rigid motion, over the largest that they could have, below which it is none; its
/// square is far above rounding.
const NO_FORCE: f64 = 1e-6;

/// Whether solids have a stress at the start.
pub(super) fn is_stressed(solid: &Solid) -> bool {
    !solid.initial_displacement.is_empty()
}

/// Adds it to the stiffness of a solid.
///
/// - `pairs`: place of the block of every pair of nodes of every cell
pub(super) fn add_stress<const B: usize>(matrix: &mut BlockMatrix<B>, pairs: &[u32], solid: &Solid) {
    solid.for_each_cell(&solid.cell_damage(), |cell| {
        let stress = stress_at_start(solid, &cell);
        let mut place = pairs[cell.first_pair..].iter();
        for gi in cell.gradients {
            let traction = stress * Vec3::from(*gi);
            for (gj, &place) in cell.gradients.iter().zip(&mut place) {
                let along: f64 = (0..B).map(|a| traction[a] * gj[a]).sum();
                let own = |a, b| if a == b { along } else { 0.0 };
                matrix.add_at(place as usize, std::array::from_fn(|a| std::array::from_fn(|b| own(a, b))));
            }
        }
    });
}

/// Stress of a cell at the start times its volume [J].
fn stress_at_start(solid: &Solid, cell: &SecantCell<'_>) -> Mat3 {
    cell.stress(&cell.gradient(&solid.initial_displacement))
}

/// The rigid motions on which the stresses of the start have no force: translations, and rotations about an axis along which
/// alone there is stress. The tractions that keep these stresses do not turn with the solids.
pub(super) fn without_force(solid: &Solid, motions: Vec<RigidMotion>) -> Vec<RigidMotion> {
    if motions.is_empty() {
        return motions;
    }
    let nodes = solid.reference.len();
    let mut forces = vec![vec![Vec3::zeros(); nodes]; motions.len()];
    let mut most = vec![0.0; nodes];
    let moved = motions.iter().flat_map(|motion| &motion.nodes).map(|v| v.norm()).fold(0.0, f64::max);
    let size = size(solid.reference.iter());
    solid.for_each_cell(&solid.cell_damage(), |cell| {
        let stress = stress_at_start(solid, &cell);
        for (motion, force) in motions.iter().zip(&mut forces) {
            let h = cell.gradient(&motion.nodes);
            for (&node, g) in cell.nodes.iter().zip(cell.gradients) {
                force[node as usize] += h * stress * Vec3::from(*g);
            }
        }
        for (&node, g) in cell.nodes.iter().zip(cell.gradients) {
            most[node as usize] += moved / size * stress.norm() * Vec3::from(*g).norm();
        }
    });
    let dot = |a: &[Vec3], b: &[Vec3]| a.iter().zip(b).map(|(a, b)| a.dot(b)).sum::<f64>();
    let gram = DMatrix::from_fn(motions.len(), motions.len(), |i, j| dot(&forces[i], &forces[j]));
    let none = NO_FORCE * NO_FORCE * most.iter().map(|f| f * f).sum::<f64>();
    let eigen = gram.symmetric_eigen();
    let kept = (0..motions.len()).filter(|&k| eigen.eigenvalues[k] <= none);
    let sum = |k: usize| {
        let mut sum = RigidMotion { nodes: vec![Vec3::zeros(); nodes], particles: Vec::new() };
        for (motion, factor) in motions.iter().zip(eigen.eigenvectors.column(k).iter()) {
            sum.nodes.iter_mut().zip(&motion.nodes).for_each(|(sum, v)| *sum += v * *factor);
        }
        sum
    };
    kept.map(sum).collect()
}
