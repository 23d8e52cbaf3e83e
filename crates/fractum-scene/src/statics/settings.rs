use fractum_fem::LocalDamping;

use super::SMALLEST_PART;
use super::opening::Opening;

/// Part of the end within which two instants are the same.
const ROUNDING: f64 = 1e-12;

/// How the load parameter proceeds.
#[derive(Clone, Debug, PartialEq)]
pub enum Control {
    /// In steps of the load parameter.
    Time,
    /// In steps of the load parameter, and along the path from the first one on that has no equilibrium.
    TimeThenPath,
    /// In steps of damage, through snap-back.
    Path,
    /// In steps of the opening of a crack, through snap-back.
    Opening(Opening),
}

/// How linear systems are solved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinearSolver {
    /// By size and reuse.
    Auto,
    /// Sparse Cholesky factorisation.
    Direct,
    /// Conjugate gradients.
    Iterative,
    /// Sparse Cholesky factorisation by the library faer.
    Faer,
}

/// What happens where a step has no equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoEquilibrium {
    /// The run ends.
    Stop,
    /// The scene moves until it has come to rest.
    Motion,
}

/// Settings of the quasi-static solution.
#[derive(Clone, Debug, PartialEq)]
pub struct StaticSettings {
    /// How the load parameter proceeds.
    pub control: Control,
    /// Largest step of the load parameter [s].
    pub step: f64,
    /// Instants at which a step ends, since loads or supports turn there [s].
    pub turns: Vec<f64>,
    /// End of the load parameter [s].
    pub end: f64,
    /// Steps after which the run ends in any case.
    pub most_steps: u64,
    /// Unbalanced force over the internal forces at which a step is accepted.
    pub tolerance: f64,
    /// Relative residual of iterative linear solutions.
    pub linear_tolerance: f64,
    /// How linear systems are solved.
    pub linear: LinearSolver,
    /// What happens where a step has no equilibrium.
    pub no_equilibrium: NoEquilibrium,
    /// Damping of the motion between two states of equilibrium; without it, twice the critical damping of the first period, so
    /// that it creeps to the next one instead of shooting past it.
    pub damping: Option<LocalDamping>,
}

impl StaticSettings {
    /// How far a step goes at most from an instant, the largest step being cut to a part [s].
    ///
    /// Beyond a turn steps begin small and double until they make one whole step: work is that of the mean of the forces before and after a step, which is none where friction
    /// turns within it.
    pub(super) fn longest(&self, present: f64, part: f64) -> f64 {
        let passed = |turn: f64| turn <= present + ROUNDING * self.end;
        let turns = || self.turns.iter().copied();
        let next = turns().filter(|turn| !passed(*turn)).fold(self.end, f64::min);
        let last = turns().filter(|turn| passed(*turn)).fold(f64::NEG_INFINITY, f64::max);
        let begins = if next - last > self.step { SMALLEST_PART * self.step } else { self.step };
        (next - present).min(self.step * part).min(begins.max(present - last))
    }
}

/// How natural vibrations are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModesSettings {
    /// Number of vibrations, the slowest ones.
    pub count: usize,
    /// How linear systems are solved.
    pub linear: LinearSolver,
}
