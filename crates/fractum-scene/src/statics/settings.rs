use fractum_fem::LocalDamping;

use super::opening::Opening;

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

/// How natural vibrations are looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ModesSettings {
    /// Number of vibrations, the slowest ones.
    pub count: usize,
    /// How linear systems are solved.
    pub linear: LinearSolver,
}
