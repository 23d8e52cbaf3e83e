//! The slowest vibrations beside rigid motions and mechanisms, whatever vibrates.

use fractum_math::Vec3;
use fractum_sparse::{
    BlockMatrix, Factor, Inverse, Motions, Pairs, Preconditioner, Search, SparseError, Vibration, lowest_pairs,
};
use thiserror::Error;

use super::LinearSolver;
use super::faer::FaerFactor;
use super::settings::ModesSettings;
use super::system::CLUSTER;
use crate::modes::{Mode, Modes};

/// Residuals at which a vibration is accepted: with a factorisation, and with an iterative solver.
const TOLERANCES: [f64; 2] = [1e-6, 1e-5];
/// Shift of a singular stiffness over the square of the time that a wave takes across the bodies: far below the slowest
/// vibration of any but the most slender body, and far above the rounding of the largest one.
const SHIFT: f64 = 1e-6;
/// Eigenvalue over the same square below which a motion counts as one without stiffness.
const NO_STIFFNESS: f64 = 1e-10;
/// Extensions of the basis after which the search ends.
const MOST_EXTENSIONS: usize = 400;
/// Factors of the shift by which a growing motion is looked for, and how often it is raised.
const GROWING: (f64, i32) = (100.0, 7);

/// Why there are no natural vibrations.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ModesError {
    /// A linear system was not solved.
    #[error(transparent)]
    Linear(#[from] SparseError),
    /// The state that vibrates is not stable.
    #[error("a motion grows by e in {time:.3e} s")]
    Unstable {
        /// Time in which the fastest one grows by e [s].
        time: f64,
    },
    /// No unknown with a mass is free.
    #[error("supports prescribe the motion of all that has a mass")]
    Held,
}

/// What vibrates, and how its systems are solved.
pub(super) struct Vibrating<'a, const B: usize> {
    /// Stiffness; held unknowns are taken out.
    pub(super) stiffness: BlockMatrix<B>,
    /// Diagonal of the masses; 0 where an unknown is held.
    pub(super) mass: Vec<[f64; B]>,
    /// Where the unknowns are.
    pub(super) places: Vec<[f64; 3]>,
    /// What is held, for the coarse space of an iteration; none where unknowns are not displacements alone.
    pub(super) held: Option<&'a [u8]>,
    /// Any but [`LinearSolver::Auto`].
    pub(super) linear: LinearSolver,
    /// Square of the speed of a wave over the size of the bodies [1/s²].
    pub(super) rate: f64,
    /// Whether stresses of the start may make it unstable.
    pub(super) stressed: bool,
}

/// Vibrations, and motions without stiffness beside the rigid ones.
pub(super) struct Found<const B: usize> {
    pairs: Pairs<B>,
    mechanisms: usize,
    entries: Option<usize>,
}

/// What is told beside the vibrations.
pub(super) struct Counts {
    pub(super) pieces: usize,
    pub(super) loose: usize,
    pub(super) rigid_motions: usize,
}

/// Motion of nodes, and displacements and rotations of particles.
pub(super) type Motion = (Vec<Vec3>, Vec<[Vec3; 2]>);

impl<const B: usize> Vibrating<'_, B> {
    /// The slowest vibrations beside motions without stiffness.
    pub(super) fn slowest(
        &self,
        mut rigid: Vec<Vec<[f64; B]>>,
        settings: ModesSettings,
        stop: fn() -> bool,
    ) -> Result<Found<B>, ModesError> {
        if self.mass.iter().flatten().all(|mass| *mass == 0.0) {
            return Err(ModesError::Held);
        }
        let (known, small) = (rigid.len(), SHIFT * self.rate);
        let tolerance = TOLERANCES[usize::from(self.linear == LinearSolver::Iterative)];
        let search = Search { count: settings.count, tolerance, small, most: MOST_EXTENSIONS, stop };
        loop {
            let shift = if rigid.is_empty() { 0.0 } else { small };
            let found = match self.lowest(&rigid, shift, search) {
                Err(SparseError::Indefinite { .. }) if shift == 0.0 => self.lowest(&rigid, small, search),
                found => found,
            };
            let (pairs, entries) = match found {
                Err(SparseError::Indefinite { .. }) if self.stressed => self.growing(&rigid, search)?,
                found => found?,
            };
            match pairs.values.first() {
                Some(value) if self.stressed && *value < -NO_STIFFNESS * self.rate => {
                    return Err(ModesError::Unstable { time: 1.0 / (-value).sqrt() });
                }
                _ => {}
            }
            let loose = pairs.values.iter().take_while(|value| **value < NO_STIFFNESS * self.rate).count();
            if loose == 0 || !pairs.converged {
                return Ok(Found { pairs, mechanisms: rigid.len() - known, entries });
            }
            rigid.extend(pairs.vectors.into_iter().take(loose));
        }
    }

    /// The motion that grows fastest.
    fn growing(&self, rigid: &[Vec<[f64; B]>], search: Search) -> Result<(Pairs<B>, Option<usize>), SparseError> {
        let (factor, times) = GROWING;
        let search = Search { count: 1, ..search };
        let shift = |raised: i32| SHIFT * self.rate * factor.powi(raised);
        let mut tries = (1..times).map(|raised| self.lowest(rigid, shift(raised), search));
        let found = tries.find(|found| !matches!(found, Err(SparseError::Indefinite { .. })));
        found.unwrap_or_else(|| self.lowest(rigid, shift(times), search))
    }

    /// The lowest pairs of the stiffness, and the entries of the factor.
    fn lowest(
        &self,
        rigid: &[Vec<[f64; B]>],
        shift: f64,
        search: Search,
    ) -> Result<(Pairs<B>, Option<usize>), SparseError> {
        let Vibrating { stiffness, mass, places, .. } = self;
        let mut shifted = stiffness.clone();
        shifted.add_diagonal(mass, shift);
        let mut entries = None;
        let mut inverse: Box<dyn Inverse<B>> = match self.linear {
            LinearSolver::Faer => {
                let mut factor = FaerFactor::new::<B>(stiffness.pattern(), places)?;
                entries = Some(factor.entries());
                factor.refactor(&shifted)?;
                Box::new(factor)
            }
            LinearSolver::Iterative => {
                let motions = self.held.map(|held| Motions { places, held, cluster: CLUSTER });
                Box::new(Preconditioner::new(&shifted, motions)?)
            }
            LinearSolver::Auto | LinearSolver::Direct => {
                let mut factor = Factor::new(stiffness.pattern(), places, B)?;
                entries = Some(factor.entries());
                factor.refactor(&shifted)?;
                Box::new(factor)
            }
        };
        drop(shifted);
        Ok((lowest_pairs(Vibration { stiffness, mass, rigid }, &mut *inverse, search), entries))
    }

    /// What was found, as a scene keeps it.
    ///
    /// - `moves`: whether the first unknowns of a row are displacements
    /// - `motion`: the motion that unknowns mean
    pub(super) fn told(
        &self,
        found: Found<B>,
        Counts { pieces, loose, rigid_motions }: Counts,
        moves: impl Fn(usize) -> bool,
        motion: impl Fn(&[[f64; B]]) -> Motion,
    ) -> Modes {
        let Found { pairs, mechanisms, entries } = found;
        let mass = &self.mass;
        let total = |of: &dyn Fn(usize, usize) -> f64| {
            Vec3::from_fn(|axis, _| {
                let rows = (0..mass.len()).filter(|&row| axis < B && moves(row));
                rows.map(|row| of(row, axis)).sum()
            })
        };
        let modes = pairs.values.iter().zip(&pairs.vectors).zip(&pairs.residuals).map(|((value, vector), residual)| {
            let (shape, particles) = motion(vector);
            Mode {
                frequency: value.max(0.0).sqrt() / (2.0 * std::f64::consts::PI),
                residual: *residual,
                participation: total(&|row, axis| mass[row][axis] * vector[row][axis]),
                shape,
                particles,
            }
        });
        Modes {
            modes: modes.collect(),
            pieces,
            loose,
            rigid_motions,
            mechanisms,
            free_mass: total(&|row, axis| mass[row][axis]),
            work: (pairs.extensions, entries),
            converged: pairs.converged,
        }
    }
}

/// Diagonal of the box around points [m].
pub(super) fn size<'a>(points: impl Iterator<Item = &'a Vec3>) -> f64 {
    let empty = (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY));
    let (low, high) = points.fold(empty, |(low, high), p| (low.inf(p), high.sup(p)));
    (high - low).norm()
}
