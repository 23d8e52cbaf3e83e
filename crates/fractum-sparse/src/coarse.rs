use std::sync::Arc;

use fractum_math::Ragged;

use crate::block::{BlockMatrix, Pattern};
use crate::cholesky::{Factor, SparseError};

/// What the coarse space needs to know of the nodes.
#[derive(Clone, Copy, Debug)]
pub struct Motions<'a> {
    /// Positions of the nodes, close to each other along the numbering.
    pub places: &'a [[f64; 3]],
    /// Bit a of a node is set where its component a is prescribed.
    pub held: &'a [u8],
    /// Nodes of a cluster.
    pub cluster: usize,
}

/// Rigid motions of a cluster: translations and rotations in space, the first three of them used in the plane.
const MODES: usize = 6;

/// Coarse system of rigid motions of clusters, which are runs of consecutive nodes.
pub(crate) struct Coarse<const B: usize> {
    cluster: usize,
    modes: Vec<[[f64; B]; MODES]>,
    factor: Factor,
    right: Vec<[f64; MODES]>,
}

impl<const B: usize> Coarse<B> {
    pub(crate) fn new(a: &BlockMatrix<B>, motions: Motions<'_>) -> Result<Self, SparseError> {
        let Motions { places, held, cluster } = motions;
        let nodes = places.len();
        let count = nodes.div_ceil(cluster);
        let mut centres = vec![[0.0; 3]; count];
        let mut modes = vec![[[0.0; B]; MODES]; nodes];
        for (c, centre) in centres.iter_mut().enumerate() {
            let range = c * cluster..((c + 1) * cluster).min(nodes);
            for axis in 0..3 {
                centre[axis] = places[range.clone()].iter().map(|p| p[axis]).sum::<f64>() / range.len() as f64;
            }
            let spread = |n: usize| (0..3).map(|a| (places[n][a] - centre[a]).powi(2)).sum::<f64>();
            let size = (range.clone().map(spread).sum::<f64>() / range.len() as f64).sqrt().max(f64::MIN_POSITIVE);
            for n in range {
                let x: [f64; 3] = std::array::from_fn(|a| (places[n][a] - centre[a]) / size);
                modes[n] = rigid_motions(x, held[n]);
            }
        }
        let matrix = Self::galerkin(a, &modes, cluster, count);
        let mut factor = Factor::new(matrix.pattern(), &centres, MODES)?;
        factor.refactor(&matrix)?;
        Ok(Coarse { cluster, modes, factor, right: vec![[0.0; MODES]; count] })
    }

    /// Zᵀ A Z.
    fn galerkin(a: &BlockMatrix<B>, modes: &[[[f64; B]; MODES]], cluster: usize, count: usize) -> BlockMatrix<MODES> {
        let mut cliques: Vec<[u32; 2]> = Vec::new();
        for i in 0..modes.len() {
            let own = (i / cluster) as u32;
            let mut last = u32::MAX;
            for &j in a.pattern().row(i) {
                let other = j / cluster as u32;
                if other > own && other != last {
                    cliques.push([own, other]);
                    last = other;
                }
            }
        }
        cliques.sort_unstable();
        cliques.dedup();
        let pattern = Arc::new(Pattern::from_cliques(count, &Ragged::from_rows(&cliques)));
        let mut matrix = BlockMatrix::<MODES>::zeros(pattern);
        for i in 0..modes.len() {
            // Neighbours of one cluster follow each other: their sum is added once.
            let mut sum = [[0.0; MODES]; MODES];
            let mut at = usize::MAX;
            for (&j, block) in a.pattern().row(i).iter().zip(a.row(i)) {
                let j = j as usize;
                if j / cluster != at {
                    if at != usize::MAX {
                        matrix.add(i / cluster, at, sum);
                    }
                    (sum, at) = ([[0.0; MODES]; MODES], j / cluster);
                }
                for q in 0..MODES {
                    let y: [f64; B] = std::array::from_fn(|r| (0..B).map(|c| block[r][c] * modes[j][q][c]).sum());
                    for p in 0..MODES {
                        sum[p][q] += (0..B).map(|r| modes[i][p][r] * y[r]).sum::<f64>();
                    }
                }
            }
            if at != usize::MAX {
                matrix.add(i / cluster, at, sum);
            }
        }
        // Motions that a cluster cannot make, or that others of it make already, get a diagonal of their own.
        let scale = matrix.largest_diagonal();
        for c in 0..count {
            let mut lift = [[0.0; MODES]; MODES];
            for (m, row) in lift.iter_mut().enumerate() {
                row[m] = if matrix.diagonal(c)[m][m] <= 1e-9 * scale { scale } else { 1e-9 * scale };
            }
            matrix.add(c, c, lift);
        }
        matrix
    }

    /// z += Z (Zᵀ A Z)⁻¹ Zᵀ r.
    pub(crate) fn add_correction(&mut self, r: &[[f64; B]], z: &mut [[f64; B]]) {
        self.right.fill([0.0; MODES]);
        for (i, r) in r.iter().enumerate() {
            let right = &mut self.right[i / self.cluster];
            for (mode, right) in self.modes[i].iter().zip(right) {
                *right += (0..B).map(|c| mode[c] * r[c]).sum::<f64>();
            }
        }
        self.factor.solve(&mut self.right);
        for (i, z) in z.iter_mut().enumerate() {
            let weights = &self.right[i / self.cluster];
            for (mode, weight) in self.modes[i].iter().zip(weights) {
                for c in 0..B {
                    z[c] += mode[c] * weight;
                }
            }
        }
    }
}

/// Translations, then rotations about z, x, y; held components do not move.
fn rigid_motions<const B: usize>(x: [f64; 3], held: u8) -> [[f64; B]; MODES] {
    let full =
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-x[1], x[0], 0.0], [0.0, 0.0, 1.0], [0.0, -x[2], x[1]], [x[2], 0.0, -x[0]]];
    let used = if B == 3 { MODES } else { 3 };
    std::array::from_fn(|m| std::array::from_fn(|c| if m < used && held >> c & 1 == 0 { full[m][c] } else { 0.0 }))
}
