//! The solver of a case.

use fractum_dem::Batch;
use fractum_math::Vec3;
use fractum_scene::statics::{LinearSolver, NoEquilibrium};

use super::super::choice::choice;
use super::super::{Place, Spanned};

/// Time and its steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Solver {
    /// Kind of solver.
    pub kind: SolverKind,
    /// Where it is written.
    pub place: Place,
    /// Begin of the stage [s]; 0 in a run of one.
    pub begin: f64,
    /// End of the run or stage [s], > 0.
    pub end: f64,
    /// Where its end is written.
    pub end_place: Place,
    /// Factor on the stable step [-], within 0..=2.
    pub safety: f64,
    /// How the stable step is found.
    pub time_step: TimeStep,
    /// Fixed time step [s], > 0; `None` = from the stable one.
    pub step: Option<Spanned<f64>>,
    /// Options of a static run, or of one that may become static; `None` with the explicit solver.
    pub statics: Option<StaticOptions>,
    /// Natural vibrations that are looked for; with `SolverKind::Modes` only.
    pub modes: Option<ModesOptions>,
    /// Where it is asked that fine elements take short steps by themselves; `None` where all take the same.
    pub subcycling: Option<Place>,
    /// What overlaps at the start does.
    pub initial_overlap: InitialOverlap,
    /// Free pieces outside it leave the run.
    pub domain: Option<Spanned<fractum_scene::Domain>>,
    /// Early end.
    pub stop_when: Option<StopWhen>,
    /// How near to the truth the load shall be; `None` = one run, as it comes.
    pub accuracy: Option<AskedAccuracy>,
    /// Energy imbalance over external work at which to warn [-].
    pub balance_warning: f64,
    /// Energy imbalance over external work at which to stop [-].
    pub balance_stop: f64,
}

/// An accuracy that is asked for, by several runs on meshes of their own.
#[derive(Debug, Clone, PartialEq)]
pub struct AskedAccuracy {
    /// Half of the error bar of the load over the load [-].
    pub share: Spanned<f64>,
    /// Runs at most.
    pub most_runs: usize,
}

/// Kinds of solvers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolverKind {
    /// Explicit central differences.
    Explicit,
    /// Quasi-static equilibrium.
    Static,
    /// Whichever suits the scene.
    Auto,
    /// Conduction of heat alone.
    Heat,
    /// Natural vibrations.
    Modes,
}

choice!(SolverKind { "explicit" => Explicit, "static" => Static, "auto" => Auto, "heat" => Heat, "modes" => Modes });

/// What concerns natural vibrations only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ModesOptions {
    /// Number of vibrations, ≥ 1.
    pub count: usize,
    /// How linear systems are solved.
    pub linear_solver: LinearSolver,
}

/// What concerns a static run only.
#[derive(Debug, Clone, PartialEq)]
pub struct StaticOptions {
    /// How the load parameter proceeds; `None` = along the path where something may break, else by time.
    pub control: Option<Control>,
    /// The opening that controls the path; with `Control::Opening` only.
    pub opening: Option<Opening>,
    /// How linear systems are solved.
    pub linear_solver: LinearSolver,
    /// Unbalanced force over internal forces at which a step is accepted [-], > 0.
    pub tolerance: f64,
    /// Steps after which the run ends in any case, ≥ 1.
    pub most_steps: u64,
    /// How many bonds of a bonded body break between two equilibria.
    pub batch: Batch,
    /// What happens where a step has no equilibrium.
    pub no_equilibrium: NoEquilibrium,
}

choice!(NoEquilibrium { "stop" => Stop, "motion" => Motion });

choice!(Batch { "site" => PerSite, "one" => One });

/// How the load parameter of a static run proceeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Control {
    /// By steps of time.
    Time,
    /// By steps of damage, through snap-back.
    Path,
    /// By steps of the opening of a crack, through snap-back.
    Opening,
}

choice!(Control { "time" => Time, "path" => Path, "opening" => Opening });

/// The opening of a crack that controls a static run.
#[derive(Debug, Clone, PartialEq)]
pub struct Opening {
    /// Mesh group on one side.
    pub group: Spanned<String>,
    /// Mesh group on the other side.
    pub against: Spanned<String>,
    /// Unit vector along which `group` moves away from `against`.
    pub along: Vec3,
    /// Growth in a step [m], > 0.
    pub step: f64,
    /// Opening at which the run ends [m], > 0.
    pub end: f64,
}

choice!(LinearSolver { "auto" => Auto, "direct" => Direct, "iterative" => Iterative, "faer" => Faer });

/// How the stable time step is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TimeStep {
    /// Largest frequency of the assembled mesh by power iteration.
    PowerIteration,
    /// Largest frequency of any single element: smaller, and rigorous.
    Element,
}

choice!(TimeStep { "power-iteration" => PowerIteration, "element" => Element });

/// What overlaps at the start does.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InitialOverlap {
    /// It pushes apart at once.
    Push,
    /// It gives no force, and touches no nearer than it starts until it has parted.
    Keep,
}

choice!(InitialOverlap { "push" => Push, "keep" => Keep });

/// Ends the run early, when a probe has fallen below a fraction of its largest value so far.
#[derive(Debug, Clone, PartialEq)]
pub struct StopWhen {
    /// Index into `Case::probes` of a column of the history.
    pub probe: usize,
    /// Fraction of the largest value so far [-], within 0..1.
    pub below: f64,
    /// Not before this time [s].
    pub after: f64,
    /// Time that it must have stayed below [s]; where nothing is said, see [`StopWhen::DEEP`] and [`StopWhen::SHARE`].
    pub lasting: Option<f64>,
}

impl StopWhen {
    /// Fraction of the largest value so far: a drop below it ends the run at once, since a load that has fallen so far seldom rises above its peak again.
    pub const DEEP: f64 = 0.5;
    /// A smaller drop must last for this part of the time from the start to the largest value.
    pub const SHARE: f64 = 0.25;
}
