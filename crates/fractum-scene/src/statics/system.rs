//! The secant stiffness as a matrix, and its solution.

use std::sync::Arc;

use fractum_fem::{CellDamage, Solid};
use fractum_math::{Ragged, Vec3};
use fractum_sparse::{BlockMatrix, Factor, Motions, Pattern, Preconditioner, SparseError, conjugate_gradients};

use super::LinearSolver;
use super::contact::Spring;
use super::faer::FaerFactor;

/// Unknowns up to which one factorisation is cheaper than an iteration, in space and in the plane.
const DIRECT: [usize; 2] = [25_000, 300_000];
/// Solutions with one matrix from which a factorisation pays on larger ones, and the unknowns up to which it fits.
const REUSE: usize = 7;
const DIRECT_IF_REUSED: usize = 250_000;
/// What anchors every node to its last place once there are discrete elements, over its stiffness: a piece that has come loose
/// then stays where it is, and equilibrium, which the forces alone are held against, does not know it.
const ANCHOR: f64 = 1e-10;
/// Nodes in a cluster of the coarse space.
pub(super) const CLUSTER: usize = 64;
/// Times that the tolerance of an iteration may be sharpened within a step, and by how much.
const SHARPENED: u32 = 2;
const SHARPER: f64 = 1e-3;
/// Iterations after which the linear solver gives up.
const MOST_ITERATIONS: usize = 5000;

/// Work of the linear solver so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LinearWork {
    /// Factorisations, complete or incomplete.
    pub factorisations: usize,
    /// Solutions.
    pub solutions: usize,
    /// Iterations of conjugate gradients.
    pub iterations: usize,
}

/// What a choice means for a system: any but [`LinearSolver::Auto`].
///
/// - `reuse`: solutions that are expected with one matrix
pub(super) fn settled(choice: LinearSolver, unknowns: usize, plane: bool, reuse: usize) -> LinearSolver {
    let fits = unknowns <= DIRECT[usize::from(plane)] || reuse >= REUSE && unknowns <= DIRECT_IF_REUSED;
    match choice {
        LinearSolver::Auto if fits => LinearSolver::Direct,
        LinearSolver::Auto => LinearSolver::Iterative,
        chosen => chosen,
    }
}

/// Which rows are coupled by the cells of a solid and by other cliques, and the place of the block of every pair of nodes of
/// every cell.
///
/// - `rows`: block rows, the first of which are the nodes
pub(super) fn lay_out<Clique: AsRef<[u32]>>(
    solid: &Solid,
    rows: usize,
    cliques: &[Clique],
) -> Result<(Arc<Pattern>, Vec<u32>), SparseError> {
    let cells = solid.cell_nodes();
    let pattern = Arc::new(Pattern::from_cliques(
        rows,
        &Ragged::from_rows(cells.rows().chain(cliques.iter().map(AsRef::as_ref))),
    ));
    if pattern.blocks() > u32::MAX as usize {
        return Err(SparseError::TooLarge { entries: pattern.blocks() });
    }
    let place = |(&i, &j): (&u32, &u32)| pattern.place(i as usize, j as usize) as u32;
    let pairs = cells.rows().flat_map(|row| row.iter().flat_map(move |i| row.iter().map(move |j| (i, j)))).map(place);
    let pairs = pairs.collect();
    Ok((pattern, pairs))
}

/// Adds the stiffness of the cells of a solid at some damage.
///
/// - `pairs`: place of the block of every pair of nodes of every cell
pub(super) fn add_cells<const B: usize>(
    matrix: &mut BlockMatrix<B>,
    pairs: &[u32],
    solid: &Solid,
    damage: &CellDamage,
) {
    solid.for_each_cell(damage, |cell| {
        let mut place = pairs[cell.first_pair..].iter();
        for gi in cell.gradients {
            for (gj, &place) in cell.gradients.iter().zip(&mut place) {
                matrix.add_at(place as usize, cell.between(gi, gj));
            }
        }
    });
}

enum Method<const B: usize> {
    Direct(Box<Factor>),
    Faer(Box<FaerFactor>),
    Iterative(Option<Box<Preconditioner<B>>>),
}

/// Linear system of the free unknowns, B per node.
pub(super) struct System<const B: usize> {
    matrix: BlockMatrix<B>,
    /// Place of the block of every pair of nodes of every cell.
    pairs: Vec<u32>,
    held: Vec<u8>,
    /// Stiffness of the anchor of every node [N/m]; empty where nothing is anchored.
    anchors: Vec<f64>,
    places: Vec<[f64; 3]>,
    method: Method<B>,
    tolerance: f64,
    /// How often the present step has asked for a sharper solution of the iteration.
    sharpened: u32,
    /// The factor to which an iteration that is not sharp enough hands over, for the present matrix.
    handed: Option<Box<Factor>>,
    right: Vec<[f64; B]>,
    solution: Vec<[f64; B]>,
    pub(super) work: LinearWork,
}

impl<const B: usize> System<B> {
    /// - `reuse`: solutions that are expected with one matrix
    /// - `touching`: nodes coupled beside those of cells
    pub(super) fn new(
        solid: &Solid,
        held: &[u8],
        choice: LinearSolver,
        reuse: usize,
        tolerance: f64,
        touching: &[[u32; 2]],
    ) -> Result<Self, SparseError> {
        let nodes = solid.reference.len();
        let (pattern, pairs) = lay_out(solid, nodes, touching)?;
        let places: Vec<[f64; 3]> = solid.reference.iter().map(|&p| p.into()).collect();
        let method = match settled(choice, nodes * B, B == 2, reuse) {
            LinearSolver::Faer => Method::Faer(Box::new(FaerFactor::new::<B>(&pattern, &places)?)),
            LinearSolver::Iterative => Method::Iterative(None),
            LinearSolver::Direct | LinearSolver::Auto => Method::Direct(Box::new(Factor::new(&pattern, &places, B)?)),
        };
        let held = if held.is_empty() { vec![0; nodes] } else { held.to_vec() };
        let zero = vec![[0.0; B]; nodes];
        Ok(System {
            matrix: BlockMatrix::zeros(pattern),
            pairs,
            held,
            anchors: Vec::new(),
            places,
            method,
            tolerance,
            sharpened: 0,
            handed: None,
            right: zero.clone(),
            solution: zero,
            work: LinearWork::default(),
        })
    }

    /// Whether the matrix has a place for the stiffness between two nodes.
    pub(super) fn couples(&self, [i, j]: [u32; 2]) -> bool {
        self.matrix.pattern().row(i as usize).binary_search(&j).is_ok()
    }

    /// Stiffness of the anchor of every node [N/m]; empty where nothing is anchored.
    pub(super) fn anchors(&self) -> &[f64] {
        &self.anchors
    }

    /// Takes over the stiffness of a solid at this damage, and of what it touches.
    ///
    /// - `anchored`: whether nodes are anchored
    pub(super) fn prepare(
        &mut self,
        solid: &Solid,
        damage: &CellDamage,
        springs: &[Spring],
        anchored: bool,
    ) -> Result<(), SparseError> {
        self.assemble(solid, damage, springs, anchored);
        self.factorise()
    }

    fn assemble(&mut self, solid: &Solid, damage: &CellDamage, springs: &[Spring], anchored: bool) {
        self.matrix.clear();
        self.handed = None;
        add_cells(&mut self.matrix, &self.pairs, solid, damage);
        let matrix = &mut self.matrix;
        for spring in springs {
            let block = std::array::from_fn(|a| std::array::from_fn(|b| spring.stiffness[(a, b)]));
            let node = spring.node as usize;
            matrix.add(node, node, block);
            if let Some(partner) = spring.partner {
                let partner = partner as usize;
                matrix.add(partner, partner, block);
                let opposite = block.map(|row: [f64; B]| row.map(|value| -value));
                matrix.add(node, partner, opposite);
                matrix.add(partner, node, opposite);
            }
        }
        self.anchors.clear();
        for node in 0..if anchored { self.held.len() } else { 0 } {
            let diagonal = matrix.diagonal(node);
            let anchor = ANCHOR * (0..B).map(|a| diagonal[a][a]).fold(0.0, f64::max);
            let own = |a, b| if a == b { anchor } else { 0.0 };
            matrix.add(node, node, std::array::from_fn(|a| std::array::from_fn(|b| own(a, b))));
            self.anchors.push(anchor);
        }
        let spare = matrix.largest_diagonal();
        matrix.hold(&self.held, spare);
    }

    fn factorise(&mut self) -> Result<(), SparseError> {
        self.work.factorisations += 1;
        match &mut self.method {
            Method::Direct(factor) => factor.refactor(&self.matrix),
            Method::Faer(factor) => factor.refactor(&self.matrix),
            Method::Iterative(preconditioner) => {
                let motions = Motions { places: &self.places, held: &self.held, cluster: CLUSTER };
                *preconditioner = Some(Box::new(Preconditioner::new(&self.matrix, Some(motions))?));
                Ok(())
            }
        }
    }

    /// Solves for the free unknowns; the held ones stay zero.
    pub(super) fn solve(&mut self, right: &[Vec3], solution: &mut [Vec3]) -> Result<(), SparseError> {
        for (i, (to, from)) in self.right.iter_mut().zip(right).enumerate() {
            *to = std::array::from_fn(|a| if self.held[i] >> a & 1 == 1 { 0.0 } else { from[a] });
        }
        self.work.solutions += 1;
        let handed = self.handed.as_mut().filter(|_| self.sharpened > SHARPENED);
        match (handed, &mut self.method) {
            (Some(factor), _) | (None, Method::Direct(factor)) => {
                self.solution.copy_from_slice(&self.right);
                factor.solve(&mut self.solution);
            }
            (None, Method::Faer(factor)) => {
                self.solution.copy_from_slice(&self.right);
                factor.solve(&mut self.solution);
            }
            (None, Method::Iterative(preconditioner)) => {
                let tolerance = self.tolerance * SHARPER.powi(self.sharpened as i32);
                let preconditioner = preconditioner.as_mut().expect("the matrix was prepared");
                self.solution.fill([0.0; B]);
                let done = conjugate_gradients(
                    &self.matrix,
                    &self.right,
                    &mut self.solution,
                    preconditioner,
                    tolerance,
                    MOST_ITERATIONS,
                );
                self.work.iterations += done.iterations;
                if done.residual.is_nan() || done.residual > self.tolerance.max(1e-6) {
                    return Err(SparseError::Stalled { iterations: done.iterations });
                }
            }
        }
        for (to, from) in solution.iter_mut().zip(&self.solution) {
            *to = Vec3::from_fn(|a, _| if a < B { from[a] } else { 0.0 });
        }
        Ok(())
    }

    /// Goes on with the tolerance of the settings, for another step.
    pub(super) fn begin(&mut self) {
        self.sharpened = 0;
    }

    /// Makes the solutions of this step sharper: where stiffnesses differ by a million, what the soft part lacks is nothing beside the
    /// forces of the stiff one. An iteration that is not sharp enough hands over to a factorisation. Whether there was anything to gain.
    pub(super) fn sharpen(&mut self) -> Result<bool, SparseError> {
        if !matches!(self.method, Method::Iterative(_)) || self.sharpened > SHARPENED {
            return Ok(false);
        }
        self.sharpened += 1;
        if self.sharpened > SHARPENED && self.handed.is_none() {
            let mut factor = Box::new(Factor::new(self.matrix.pattern(), &self.places, B)?);
            factor.refactor(&self.matrix)?;
            self.work.factorisations += 1;
            self.handed = Some(factor);
        }
        Ok(true)
    }

    /// Entries of the factor, or of the matrix where there is none, and whether there is one.
    pub(super) fn entries(&self) -> (usize, bool) {
        match &self.method {
            Method::Direct(factor) => (factor.entries(), true),
            Method::Faer(factor) => (factor.entries(), true),
            Method::Iterative(_) => (B * B * self.matrix.pattern().blocks(), false),
        }
    }

    /// Whether the system is factored, and the entries of the factor.
    pub(super) fn factor_entries(&self) -> Option<usize> {
        match &self.method {
            Method::Direct(factor) => Some(factor.entries()),
            Method::Faer(factor) => Some(factor.entries()),
            Method::Iterative(_) => None,
        }
    }
}
