//! Quasi-static equilibrium: secant stiffness, damage by iteration, and a path that follows snap-back.
//!
//! Each step finds displacements u, damage d and load parameter t with K(d) u = f(t) and u = p(t) at the supports.
//! Under path control the step is the one in which the most strained edge goes a given way down its softening curve,
//! whatever the load does meanwhile: t may go back. With the damage of the last iterate K is linear, so that
//! u = a + (t - tⁿ) b from two right-hand sides, and t follows from the most strained edge alone.

mod anderson;
mod bonded;
mod bonded_modes;
mod contact;
mod coupled_modes;
mod equilibrium;
mod faer;
mod in_situ;
mod iteration;
mod lead;
mod linear_system;
mod modes;
mod opening;
mod path;
mod period;
mod prestress;
mod rigid_motions;
mod settings;
mod skew;
mod slowest;
mod solid_modes;
mod static_dynamic;
mod support_check;
mod system;
mod wet;

use fractum_fem::{CellDamage, DamagePoint, Seen, motion};
use fractum_math::{Sym3, Vec3};
use fractum_sparse::SparseError;
use serde::{Deserialize, Serialize};

pub use bonded::{BondedStaticSettings, BondedStaticState, BondedStatics};
pub use modes::{find_modes, modes_of, set_modes, show_mode};
pub use opening::Opening;
pub use period::Stiffness;
pub use settings::{Control, LinearSolver, ModesSettings, NoEquilibrium, StaticSettings};
pub use slowest::ModesError;
pub use static_dynamic::DynamicPhase;
pub use support_check::check_supports;
pub use system::LinearWork;

use crate::conduct::warm_to;
use crate::error::StepError;
use crate::interfaces::joints::PointPlace;
use crate::scene::Scene;
use crate::step::StepReport;
use anderson::Anderson;
use contact::{Pressed, Spring};
use equilibrium::{AppliedForces, accept_equilibrium, forces_at_rest, no_equilibrium};
use lead::Lead;
use linear_system::LinearSystem;

/// Share of the largest load factor below which a negative one is what rounding leaves.
const BELOW_NONE: f64 = 1e-3;
/// How far the most strained edge goes down its softening curve per step of a path: at first, at least and at most.
const GROWTH: [f64; 3] = [0.05, 0.01, 0.25];
/// The step that finds the onset of damage goes no further than this.
const ONSET: f64 = 1e-8;
/// How near to its strength an edge is at its onset: an iteration finds that state to its own tolerance only.
const NEAR_ONSET: f64 = 1e-4;
/// Damage below which an edge counts as intact: a phase field that was tried leaves some of rounding size.
const INTACT: f64 = 1e-12;
/// Accelerated iterations before a step is cut, and below which the next one may be larger.
const ITERATIONS: [usize; 2] = [16, 10];
/// Iterations in which damage only grows.
const MONOTONE_ITERATIONS: usize = 400;
/// Part of a step of the load parameter below which it is not cut any more.
const SMALLEST_PART: f64 = 1.0 / 64.0;
/// Part of a step of the opening below which a step of damage takes its place.
const SMALLEST_OPENING: f64 = 1.0 / 8.0;
/// Forces over the largest so far that count as none: what rounding leaves in a body that has parted.
const NO_FORCE: f64 = 1e-6;

/// The quasi-static solver of a scene.
pub struct StaticSolver {
    settings: StaticSettings,
    stop: fn() -> bool,
    system: LinearSystem,
    /// The matrix is that of an undamaged solid and stays so.
    elastic: bool,
    prepared: bool,
    pace: Pace,
    damage: CellDamage,
    trial: CellDamage,
    response: Response,
    touching: Touching,
    lead: Lead,
    /// Whether steps of the load parameter have given way to a path.
    follows: bool,
    edges: Edges,
    anderson: Anderson,
    /// The solution with liquid in interfaces, once it has begun.
    wet: Option<Box<wet::Wet>>,
    applied: AppliedForces,
    /// Largest forces of a state of equilibrium so far [N].
    largest_forces: f64,
    /// States of equilibrium found.
    steps: u64,
    iterations: usize,
}

/// How far the next step goes.
#[derive(Clone, Debug)]
struct Pace {
    growth: f64,
    part: f64,
    /// What the last step added to the loading of every edge per growth: the next one is likely to go on like that.
    trend: Vec<f64>,
}

/// Displacements that are linear in the load parameter, u = a + τ b, with their effective stresses.
#[derive(Clone, Debug, Default)]
struct Response {
    start: Vec<Vec3>,
    slope: Vec<Vec3>,
    /// Right-hand side, or unbalanced forces [N].
    right: Vec<Vec3>,
    /// Forces that the state of the last equilibrium bears, with the temperatures and loads of the next one [N].
    given: f64,
    /// The same with those by which the supports and loads of the step drive what is free, with all else in its place [N].
    driving: f64,
    start_stress: Vec<Sym3>,
    slope_stress: Vec<Sym3>,
}

/// What touches.
#[derive(Clone, Debug, Default)]
struct Touching {
    /// Springs of the last iterate, which is `place`.
    springs: Vec<Spring>,
    place: Vec<Vec3>,
    /// Springs of shapes that press at the end of the last linear solution, ascending by shape and node.
    kept: Vec<Pressed>,
    /// Pairs of nodes that have touched so far and belong to no cell, and how many of them the system has places for.
    pairs: Vec<[u32; 2]>,
    coupled: usize,
    /// Stretches of what is brought back, from one equilibrium of a step to the next.
    stretch: Anderson,
}

/// What the edges see.
#[derive(Clone, Debug, Default)]
struct Edges {
    /// What they see.
    seen: Vec<Seen>,
    /// Equivalent stresses over κ, at least 1, then the shares of their openings: those that the damage of the trial comes from, and those that it brings.
    loading: Vec<f64>,
    image: Vec<f64>,
}

/// What a static solver remembers from step to step, for a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StaticState {
    growth: f64,
    part: f64,
    trend: Vec<f64>,
    touching: Vec<[u32; 2]>,
    lead: Option<PointPlace>,
    follows: bool,
    applied: AppliedForces,
    largest_forces: f64,
    steps: u64,
    iterations: u64,
    factorisations: u64,
    solutions: u64,
    linear_iterations: u64,
}

impl StaticSolver {
    /// Prepares the solution of a scene.
    ///
    /// # Errors
    /// [`SparseError::TooLarge`] if the factor does not fit.
    pub fn new(scene: &Scene, settings: StaticSettings) -> Result<Self, SparseError> {
        let solid = &scene.solid;
        let elastic = !solid.has_damage();
        let joined = if scene.optional.liquid.is_some() { wet::pairs(scene) } else { Vec::new() };
        let system = settings.lay_out(scene, &joined)?;
        let zero = vec![Vec3::zeros(); solid.reference.len()];
        Ok(StaticSolver {
            settings,
            stop: || false,
            system,
            elastic,
            prepared: false,
            pace: Pace { growth: GROWTH[0], part: 1.0, trend: Vec::new() },
            damage: solid.cell_damage(),
            trial: solid.cell_damage(),
            response: Response { start: zero.clone(), slope: zero.clone(), right: zero, ..Response::default() },
            touching: Touching::default(),
            lead: Lead::default(),
            follows: false,
            edges: Edges::default(),
            anderson: Anderson::default(),
            wet: None,
            applied: AppliedForces::default(),
            largest_forces: 0.0,
            steps: 0,
            iterations: 0,
        })
    }

    /// Gives up with [`StepError::Interrupted`] when `stop` says so, which is asked in every iteration.
    pub fn with_stop(self, stop: fn() -> bool) -> Self {
        StaticSolver { stop, ..self }
    }

    /// Settings of the solution.
    pub fn settings(&self) -> &StaticSettings {
        &self.settings
    }

    /// Work of the linear solver, and equilibrium iterations.
    pub fn work(&self) -> (LinearWork, usize) {
        (self.system.done(), self.iterations)
    }

    /// What it remembers, for a checkpoint.
    pub fn state(&self) -> StaticState {
        let (linear, iterations) = self.work();
        StaticState {
            growth: self.pace.growth,
            part: self.pace.part,
            trend: self.pace.trend.clone(),
            touching: self.touching.pairs.clone(),
            lead: self.lead.at,
            follows: self.follows,
            applied: self.applied.clone(),
            largest_forces: self.largest_forces,
            steps: self.steps,
            iterations: iterations as u64,
            factorisations: linear.factorisations as u64,
            solutions: linear.solutions as u64,
            linear_iterations: linear.iterations as u64,
        }
    }

    /// Puts back what a solver of the same scene, prepared before any step, remembered.
    pub fn restore(&mut self, state: StaticState) {
        self.pace = Pace { growth: state.growth, part: state.part, trend: state.trend };
        self.applied = state.applied;
        self.touching.pairs = state.touching;
        (self.lead.at, self.follows) = (state.lead, state.follows);
        (self.largest_forces, self.steps) = (state.largest_forces, state.steps);
        self.iterations = state.iterations as usize;
        *self.system.work() = LinearWork {
            factorisations: state.factorisations as usize,
            solutions: state.solutions as usize,
            iterations: state.linear_iterations as usize,
        };
    }

    /// Goes on from the state in which motion has left the scene.
    pub fn resume_from_motion(&mut self, scene: &mut Scene) {
        self.applied = forces_at_rest(scene);
        self.pace.growth = GROWTH[0];
        self.pace.trend.clear();
        self.lead = Lead::default();
    }

    /// Entries of the Cholesky factor; none with an iterative solver.
    pub fn factor_entries(&self) -> Option<usize> {
        self.system.factor_entries()
    }

    /// Whether the run is over.
    pub fn is_finished(&self, scene: &Scene) -> bool {
        let open = match &self.settings.control {
            Control::Opening(opening) => opening.of(&scene.solid.displacement) >= opening.end * (1.0 - 1e-12),
            Control::Time | Control::TimeThenPath | Control::Path => false,
        };
        let at_end = scene.clock.time >= self.settings.end * (1.0 - 1e-12);
        open || at_end || self.has_used_up_its_steps() || self.has_given_way(scene)
    }

    /// Whether the path has come below no load at all: loads that hold from the start are more than what is left bears.
    pub fn has_given_way(&self, scene: &Scene) -> bool {
        scene.clock.time < -BELOW_NONE * self.settings.end
    }

    /// Whether it has found as many states of equilibrium as it may; steps of motion between them do not count.
    pub fn has_used_up_its_steps(&self) -> bool {
        self.steps >= self.settings.most_steps
    }

    /// Finds the next state of equilibrium.
    ///
    /// # Errors
    /// [`StepError`] if there is none, or none that the iteration finds.
    pub fn step(&mut self, scene: &mut Scene) -> Result<StepReport, StepError> {
        if scene.optional.liquid.is_some() {
            return self.step_wet(scene);
        }
        motion::wake_phase_fields(&mut scene.solid);
        let points = scene.solid.damage_points();
        self.damage = scene.solid.cell_damage();
        let intact = points.iter().all(|point| point.damage < INTACT) && scene.interfaces().is_whole();
        let mut monotone = false;
        let mut by_path = self.follows || self.settings.control == Control::Path;
        // Steps of the load meet the onset of the first face: it may be the peak.
        let mut meets_onset =
            intact && !by_path && self.settings.control == Control::TimeThenPath && self.opens(scene).is_none();
        by_path |= meets_onset;
        let mut by_damage = by_path;
        let edges_at_onset = intact && by_path && path::is_at_onset(&scene.solid, &points, NEAR_ONSET);
        let mut held = true;
        loop {
            let opens = if intact && by_path { self.opens(scene) } else { None };
            let at_onset = edges_at_onset || opens.is_some();
            let longest = self.settings.longest(scene.clock.time, self.pace.part);
            // A path stops just below the onset of damage, which may be its peak, and just above it where equilibrium goes on there.
            let growth = match intact {
                true if by_path && !at_onset => -ONSET,
                true if held && opens.is_none() => ONSET,
                _ => self.pace.growth,
            };
            self.lead.at = self.lead.at.or(opens);
            let leads = self.lead.at;
            warm_to(scene, scene.clock.time + longest)?;
            // A piece may come loose within the step, and not in a shorter one.
            let (found, loose) = match self.iterate(scene, &points, longest, growth, by_damage, monotone) {
                Err(error @ StepError::ComeApart { .. }) => (None, Some(error)),
                found => (found?, None),
            };
            if let Some((time, iterations)) = found
                && !self.jumps(scene, &points, by_damage)
            {
                self.pace.trend.clear();
                self.pace.trend.extend(
                    self.edges
                        .seen
                        .iter()
                        .zip(&points)
                        .map(|(seen, point)| (seen.stress / point.kappa - 1.0).max(0.0) / growth),
                );
                if !monotone && iterations <= ITERATIONS[1] {
                    self.pace.growth = (1.4 * self.pace.growth).min(GROWTH[2]);
                    self.pace.part = (2.0 * self.pace.part).min(1.0);
                }
                self.choose_lead(scene, &points);
                let before = scene.solid.displacement.clone();
                scene.solid.raise_history(&self.edges.seen, &self.trial, &before, &self.response.start);
                self.steps += 1;
                return accept_equilibrium(scene, &self.response.start, time, &mut self.applied);
            }
            self.lead.at = leads;
            if meets_onset {
                (meets_onset, by_path, by_damage) = (false, false, false);
                continue;
            }
            if at_onset && held {
                held = false;
                if opens.is_none() {
                    continue;
                }
            }
            // What slides between elastic bodies by turns does so in shorter steps too: more iterations cost less than they do. What softens is
            // followed in shorter ones.
            let slides = !scene.interfaces().is_empty() && !scene.interfaces().may_soften();
            if points.is_empty() && slides && !monotone {
                monotone = true;
                continue;
            }
            let smallest = match self.settings.control {
                Control::Time => self.pace.part <= SMALLEST_PART,
                Control::TimeThenPath if !by_path => self.pace.part <= SMALLEST_PART,
                Control::Opening(_) if !by_damage => {
                    // Where several states have this opening, a step of damage is still one of them.
                    by_damage = self.pace.part <= SMALLEST_OPENING;
                    false
                }
                Control::TimeThenPath | Control::Path | Control::Opening(_) => {
                    let shortest = scene.interfaces().is_empty() || self.pace.part <= SMALLEST_PART;
                    (self.pace.growth <= GROWTH[1] && shortest) || growth.abs() == ONSET
                }
            };
            if smallest && monotone {
                if self.settings.control == Control::TimeThenPath && !by_path {
                    (self.follows, by_path, by_damage, monotone) = (true, true, true, false);
                    (self.pace.growth, self.pace.part) = (GROWTH[0], 1.0);
                    continue;
                }
                warm_to(scene, scene.clock.time)?;
                return Err(loose.unwrap_or_else(|| no_equilibrium(scene, by_path)));
            }
            monotone = smallest;
            self.pace.growth = (0.5 * self.pace.growth).max(GROWTH[1]);
            self.pace.part = (0.5 * self.pace.part).max(SMALLEST_PART);
        }
    }

    /// Whether a path has taken the place of steps of the load parameter.
    pub fn has_turned_to_path(&self) -> bool {
        self.follows
    }

    /// The point of an interface that stands at its strength.
    fn opens(&self, scene: &Scene) -> Option<PointPlace> {
        let (at, ratio) = scene.interfaces().farthest(|node| scene.solid.displacement[node as usize], 0.0)?;
        (ratio >= 1.0 - NEAR_ONSET).then_some(at)
    }

    /// What has gone farthest in a step leads the next one.
    fn choose_lead(&mut self, scene: &Scene, points: &[DamagePoint]) {
        if self.settings.control == Control::Time || !scene.interfaces().may_soften() {
            return;
        }
        let grown = |(seen, point): (&Seen, &DamagePoint)| {
            if point.broken { 0.0 } else { (seen.stress - point.kappa) / point.kappa.max(point.softening) }
        };
        let edges = self.edges.seen.iter().zip(points).map(grown).fold(0.0, f64::max);
        let most = scene.interfaces().most_grown(|node| self.response.start[node as usize]);
        self.lead.at = most.filter(|(_, growth)| *growth > edges).map(|(at, _)| at);
    }
}
