//! Quasi-static equilibrium: secant stiffness, damage by iteration, and a path that follows snap-back.
//!
//! Each step finds displacements u, damage d and load parameter t with K(d) u = f(t) and u = p(t) at the supports.
//! Under path control the step is the one in which the most strained edge goes a given way down its softening curve,
//! whatever the load does meanwhile: t may go back. With the damage of the last iterate K is linear, so that
//! u = a + (t - tⁿ) b from two right-hand sides, and t follows from the most strained edge alone.

mod anderson;
mod bonded;
mod contact;
mod equilibrium;
mod opening;
mod path;
mod period;
mod static_dynamic;
mod support_check;
mod system;

use fractum_fem::{CellDamage, DamagePoint, LocalDamping, Solid};
use fractum_math::{Sym3, Vec3};
use fractum_sparse::SparseError;
use serde::{Deserialize, Serialize};

pub use bonded::{BondedStaticSettings, BondedStaticState, BondedStatics};
pub use opening::Opening;
pub use period::Stiffness;
pub use static_dynamic::DynamicPhase;
pub use support_check::check_supports;
pub use system::LinearWork;

use crate::error::StepError;
use crate::scene::Scene;
use crate::step::StepReport;
use anderson::Anderson;
use contact::Spring;
use equilibrium::{AppliedForces, Boundary};
use system::System;

/// How the load parameter proceeds.
#[derive(Clone, Debug, PartialEq)]
pub enum Control {
    /// In steps of the load parameter.
    Time,
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

impl StaticSettings {
    /// The linear system of a scene.
    ///
    /// - `touching`: nodes coupled beside those of cells
    fn lay_out(&self, scene: &Scene, touching: &[[u32; 2]]) -> Result<Dimension, SparseError> {
        let elastic = !scene.solid.has_damage();
        let reuse = if elastic { (self.end / self.step).ceil() as usize } else { 2 };
        let held = scene.supports().held();
        Dimension::new(&scene.solid, held, self.linear, reuse, self.linear_tolerance, touching)
    }
}

/// How far the most strained edge goes down its softening curve per step of a path: at first, at least and at most.
const GROWTH: [f64; 3] = [0.05, 0.01, 0.25];
/// The step that finds the onset of damage goes no further than this.
const ONSET: f64 = 1e-8;
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

enum Dimension {
    Plane(System<2>),
    Space(System<3>),
}

impl Dimension {
    fn new(
        solid: &Solid,
        held: &[u8],
        linear: LinearSolver,
        reuse: usize,
        tolerance: f64,
        touching: &[[u32; 2]],
    ) -> Result<Self, SparseError> {
        Ok(if solid.is_plane() {
            Dimension::Plane(System::new(solid, held, linear, reuse, tolerance, touching)?)
        } else {
            Dimension::Space(System::new(solid, held, linear, reuse, tolerance, touching)?)
        })
    }

    fn couples(&self, pair: [u32; 2]) -> bool {
        match self {
            Dimension::Plane(system) => system.couples(pair),
            Dimension::Space(system) => system.couples(pair),
        }
    }

    fn anchors(&self) -> &[f64] {
        match self {
            Dimension::Plane(system) => system.anchors(),
            Dimension::Space(system) => system.anchors(),
        }
    }

    fn work(&mut self) -> &mut LinearWork {
        match self {
            Dimension::Plane(system) => &mut system.work,
            Dimension::Space(system) => &mut system.work,
        }
    }

    fn prepare(&mut self, scene: &Scene, damage: &CellDamage, springs: &[Spring]) -> Result<(), SparseError> {
        let anchored = !scene.debris.is_empty();
        match self {
            Dimension::Plane(system) => system.prepare(&scene.solid, damage, springs, anchored),
            Dimension::Space(system) => system.prepare(&scene.solid, damage, springs, anchored),
        }
    }

    fn solve(&mut self, right: &[Vec3], solution: &mut [Vec3]) -> Result<(), SparseError> {
        match self {
            Dimension::Plane(system) => system.solve(right, solution),
            Dimension::Space(system) => system.solve(right, solution),
        }
    }
}

/// The quasi-static solver of a scene.
pub struct StaticSolver {
    settings: StaticSettings,
    stop: fn() -> bool,
    system: Dimension,
    /// The matrix is that of an undamaged solid and stays so.
    elastic: bool,
    prepared: bool,
    growth: f64,
    part: f64,
    damage: CellDamage,
    trial: CellDamage,
    start: Vec<Vec3>,
    slope: Vec<Vec3>,
    right: Vec<Vec3>,
    /// What touches in the last iterate, which is `place`.
    springs: Vec<Spring>,
    /// Pairs of nodes that have touched so far and belong to no cell, and how many of them the system has places for.
    touching: Vec<[u32; 2]>,
    coupled: usize,
    place: Vec<Vec3>,
    start_stress: Vec<Sym3>,
    slope_stress: Vec<Sym3>,
    q: Vec<f64>,
    /// Equivalent stresses over κ, at least 1: those that the damage of the trial comes from, and those that it brings.
    loading: Vec<f64>,
    image: Vec<f64>,
    /// What the last step added to `loading` per growth: the next one is likely to go on like that.
    trend: Vec<f64>,
    mixer: Anderson,
    outer: AppliedForces,
    /// Largest forces of a state of equilibrium so far [N].
    largest_forces: f64,
    iterations: usize,
}

/// What a static solver remembers from step to step, for a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StaticState {
    growth: f64,
    part: f64,
    trend: Vec<f64>,
    touching: Vec<[u32; 2]>,
    outer: AppliedForces,
    largest_forces: f64,
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
        let system = settings.lay_out(scene, &[])?;
        let zero = vec![Vec3::zeros(); solid.reference.len()];
        Ok(StaticSolver {
            settings,
            stop: || false,
            system,
            elastic,
            prepared: false,
            growth: GROWTH[0],
            part: 1.0,
            damage: solid.cell_damage(),
            trial: solid.cell_damage(),
            start: zero.clone(),
            slope: zero.clone(),
            right: zero,
            springs: Vec::new(),
            touching: Vec::new(),
            coupled: 0,
            place: Vec::new(),
            start_stress: Vec::new(),
            slope_stress: Vec::new(),
            q: Vec::new(),
            loading: Vec::new(),
            image: Vec::new(),
            trend: Vec::new(),
            mixer: Anderson::default(),
            outer: AppliedForces::default(),
            largest_forces: 0.0,
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
        let linear = match &self.system {
            Dimension::Plane(system) => system.work,
            Dimension::Space(system) => system.work,
        };
        (linear, self.iterations)
    }

    /// What it remembers, for a checkpoint.
    pub fn state(&self) -> StaticState {
        let (linear, iterations) = self.work();
        StaticState {
            growth: self.growth,
            part: self.part,
            trend: self.trend.clone(),
            touching: self.touching.clone(),
            outer: self.outer.clone(),
            largest_forces: self.largest_forces,
            iterations: iterations as u64,
            factorisations: linear.factorisations as u64,
            solutions: linear.solutions as u64,
            linear_iterations: linear.iterations as u64,
        }
    }

    /// Puts back what a solver of the same scene, prepared before any step, remembered.
    pub fn restore(&mut self, state: StaticState) {
        (self.growth, self.part, self.trend, self.outer) = (state.growth, state.part, state.trend, state.outer);
        self.touching = state.touching;
        self.largest_forces = state.largest_forces;
        self.iterations = state.iterations as usize;
        *self.system.work() = LinearWork {
            factorisations: state.factorisations as usize,
            solutions: state.solutions as usize,
            iterations: state.linear_iterations as usize,
        };
    }

    /// Goes on from the state in which motion has left the scene.
    pub fn resume_from_motion(&mut self, scene: &mut Scene) {
        self.outer = scene.forces_at_rest();
        self.growth = GROWTH[0];
        self.trend.clear();
    }

    /// Entries of the Cholesky factor; none with an iterative solver.
    pub fn factor_entries(&self) -> Option<usize> {
        match &self.system {
            Dimension::Plane(system) => system.factor_entries(),
            Dimension::Space(system) => system.factor_entries(),
        }
    }

    /// Whether the run is over.
    pub fn is_finished(&self, scene: &Scene) -> bool {
        let open = match &self.settings.control {
            Control::Opening(opening) => opening.of(&scene.solid.displacement) >= opening.end * (1.0 - 1e-12),
            Control::Time | Control::Path => false,
        };
        open || scene.clock.time >= self.settings.end * (1.0 - 1e-12) || scene.clock.step >= self.settings.most_steps
    }

    /// Finds the next state of equilibrium.
    ///
    /// # Errors
    /// [`StepError`] if there is none, or none that the iteration finds.
    pub fn step(&mut self, scene: &mut Scene) -> Result<StepReport, StepError> {
        scene.solid.update_gates();
        let points = scene.solid.damage_points();
        self.damage = scene.solid.cell_damage();
        let intact = points.iter().all(|point| point.damage == 0.0);
        let mut monotone = false;
        let mut by_damage = self.settings.control == Control::Path;
        loop {
            let longest = (self.settings.end - scene.clock.time).min(self.settings.step * self.part);
            let growth = if intact { ONSET } else { self.growth };
            let found = self.iterate(scene, &points, longest, growth, by_damage, monotone)?;
            if let Some((time, iterations)) = found
                && !self.jumps(&points)
            {
                self.trend.clear();
                self.trend
                    .extend(self.q.iter().zip(&points).map(|(q, point)| (q / point.kappa - 1.0).max(0.0) / growth));
                if !monotone && iterations <= ITERATIONS[1] {
                    self.growth = (1.4 * self.growth).min(GROWTH[2]);
                    self.part = (2.0 * self.part).min(1.0);
                }
                scene.solid.raise_history(&self.q, &scene.solid.displacement.clone(), &self.start);
                return scene.accept_equilibrium(&self.start, time, &mut self.outer);
            }
            let smallest = match self.settings.control {
                Control::Time => self.part <= SMALLEST_PART,
                Control::Opening(_) if !by_damage => {
                    // Where several states have this opening, a step of damage is still one of them.
                    by_damage = self.part <= SMALLEST_OPENING;
                    false
                }
                Control::Path | Control::Opening(_) => self.growth <= GROWTH[1] || intact,
            };
            if smallest && monotone {
                return Err(scene.no_equilibrium());
            }
            monotone = smallest;
            self.growth = (0.5 * self.growth).max(GROWTH[1]);
            self.part = (0.5 * self.part).max(SMALLEST_PART);
        }
    }

    /// Whether the state found lies beyond states that are no equilibrium: some edge went further down its softening curve
    /// than any step of a path takes it.
    fn jumps(&self, points: &[DamagePoint]) -> bool {
        let far = |(point, q): (&DamagePoint, &f64)| !point.broken && *q > path::limit(point, GROWTH[2]) * (1.0 + 1e-9);
        self.settings.control == Control::Time && points.iter().zip(&self.q).any(far)
    }

    /// Iterates to equilibrium from the present state; the new load parameter, with the displacements in `self.start` and
    /// the equivalent stresses that the edges have seen in `self.q`, or nothing if the iteration does not get there.
    ///
    /// - `by_damage`: go as far as `growth` allows, whatever the control
    /// - `monotone`: damage only grows from iterate to iterate. As no edge passes `growth` this always ends, with edges
    ///   that may have seen a little more than they bear in the end
    fn iterate(
        &mut self,
        scene: &mut Scene,
        points: &[DamagePoint],
        longest: f64,
        growth: f64,
        by_damage: bool,
        monotone: bool,
    ) -> Result<Option<(f64, usize)>, StepError> {
        let present = scene.clock.time;
        let mut tau = longest;
        self.trial.clone_from(&self.damage);
        self.mixer.reset();
        self.loading.clear();
        self.loading.resize(points.len(), 1.0);
        if !monotone && by_damage && self.trend.len() == points.len() {
            for ((ratio, trend), point) in self.loading.iter_mut().zip(&self.trend).zip(points) {
                *ratio = if point.damage > 0.0 { 1.0 + trend * growth } else { 1.0 };
            }
            self.q.clear();
            self.q.extend(self.loading.iter().zip(points).map(|(ratio, point)| ratio * point.kappa));
            scene.solid.trial_damage(&self.q, &mut self.trial);
        }
        self.place.clone_from(&scene.solid.displacement);
        let mut found_at = present;
        for iteration in 1..=if monotone { MONOTONE_ITERATIONS } else { ITERATIONS[0] } {
            if (self.stop)() {
                return Err(StepError::Interrupted { step: scene.clock.step, time: present });
            }
            self.iterations += 1;
            scene.debris.meet(&scene.solid, &self.place);
            self.springs = scene.springs(&self.place, [present, found_at], longest, iteration == 1);
            self.couple(scene)?;
            if !(self.elastic && self.prepared && scene.shape_contacts.is_empty()) {
                self.system.prepare(scene, &self.trial, &self.springs).map_err(|e| scene.come_apart(e))?;
                self.prepared = true;
            }
            let ahead = if tau.abs() > 1e-9 * self.settings.end { tau } else { longest };
            let here = scene.boundary_at(present, present);
            let there = scene.boundary_at(present, present + ahead);
            self.respond(scene, &here, &there, ahead, present - found_at)?;
            if points.is_empty() {
                tau = longest;
            } else {
                scene.solid.effective_stresses(&self.start, &mut self.start_stress);
                scene.solid.effective_stresses(&self.slope, &mut self.slope_stress);
                tau = match &self.settings.control {
                    Control::Time => longest,
                    Control::Opening(opening) if !by_damage => {
                        let target = opening.of(&scene.solid.displacement) + opening.step * self.part;
                        let found = opening.find(target.min(opening.end), &self.start, &self.slope);
                        let Some(tau) = found else { return Ok(None) };
                        tau.min(self.settings.end - present)
                    }
                    Control::Path | Control::Opening(_) => {
                        let found = path::largest_step(
                            &scene.solid,
                            points,
                            &self.start_stress,
                            &self.slope_stress,
                            growth,
                            longest,
                        );
                        let Some(tau) = found else { return Ok(None) };
                        tau
                    }
                };
            }
            for (u, b) in self.start.iter_mut().zip(&self.slope) {
                *u += b * tau;
            }
            for (a, &b) in self.start_stress.iter_mut().zip(&self.slope_stress) {
                *a += b * tau;
            }
            scene.solid.equivalent_stresses(points, &self.start_stress, |point| point.kappa, &mut self.q);
            if monotone {
                for ((q, ratio), point) in self.q.iter_mut().zip(&self.loading).zip(points) {
                    *q = q.max(ratio * point.kappa);
                }
            }
            scene.solid.trial_damage(&self.q, &mut self.trial);
            let mut exact = scene.boundary_at(present, present + tau);
            if scene.has_contacts() {
                found_at = present + tau;
                self.place.clone_from(&self.start);
                scene.debris.meet(&scene.solid, &self.place);
                for spring in scene.springs(&self.place, [present, found_at], longest, false) {
                    spring.push(spring.force, &mut exact.force);
                }
            }
            let (missing, forces) = scene.unbalance(&self.trial, &self.start, &exact.force, &mut self.right);
            if missing <= self.settings.tolerance * forces.max(NO_FORCE * self.largest_forces) {
                self.largest_forces = self.largest_forces.max(forces);
                return Ok(Some((present + tau, iteration)));
            }
            self.image.clear();
            self.image.extend(points.iter().zip(&self.q).map(|(point, q)| (q / point.kappa).max(1.0)));
            if monotone {
                if self.jumps(points) {
                    return Ok(None);
                }
                self.loading.copy_from_slice(&self.image);
                continue;
            }
            self.mixer.next(&mut self.loading, &self.image);
            self.loading.iter_mut().for_each(|ratio| *ratio = ratio.max(1.0));
            for ((q, ratio), point) in self.q.iter_mut().zip(&self.loading).zip(points) {
                *q = ratio * point.kappa;
            }
            scene.solid.trial_damage(&self.q, &mut self.trial);
        }
        Ok(None)
    }

    /// Gives the system places for all pairs of nodes that touch.
    fn couple(&mut self, scene: &Scene) -> Result<(), StepError> {
        let missing = |pair: &[u32; 2]| !self.system.couples(*pair) && !self.touching.contains(pair);
        let found: Vec<[u32; 2]> = self.springs.iter().filter_map(Spring::pair).filter(missing).collect();
        self.touching.extend(found);
        if self.touching.len() > self.coupled {
            let work = *self.system.work();
            self.system = self.settings.lay_out(scene, &self.touching).map_err(|e| scene.come_apart(e))?;
            *self.system.work() = work;
            (self.coupled, self.prepared) = (self.touching.len(), false);
        }
        Ok(())
    }

    /// Displacements at the present load parameter and their slope, for the damage of the trial.
    ///
    /// - `since`: from the iterate at which the springs were found to the present load parameter [s]
    fn respond(
        &mut self,
        scene: &Scene,
        here: &Boundary,
        there: &Boundary,
        ahead: f64,
        since: f64,
    ) -> Result<(), StepError> {
        let solid = &scene.solid;
        let mut field = here.displacement.clone();
        solid.secant_force(&self.trial, &field, &mut self.right);
        for (right, force) in self.right.iter_mut().zip(&here.force) {
            *right = force - *right;
        }
        for spring in &self.springs {
            let moved = spring.of(&field) - spring.of(&self.place);
            spring.push(spring.force + spring.rate * since - spring.stiffness * moved, &mut self.right);
        }
        for (i, anchor) in self.system.anchors().iter().enumerate() {
            self.right[i] += (self.place[i] - field[i]) * *anchor;
        }
        self.system.solve(&self.right, &mut self.start).map_err(|e| scene.come_apart(e))?;
        scene.check_loose(&self.start, 1.0)?;
        for (u, p) in self.start.iter_mut().zip(&field) {
            *u += p;
        }
        let held = scene.supports().held();
        for (i, p) in field.iter_mut().enumerate() {
            let bits = held.get(i).copied().unwrap_or(0);
            let change = (there.displacement[i] - here.displacement[i]) / ahead;
            *p = Vec3::from_fn(|a, _| if bits & (1 << a) == 0 { 0.0 } else { change[a] });
        }
        solid.secant_force(&self.trial, &field, &mut self.right);
        for (i, right) in self.right.iter_mut().enumerate() {
            *right = (there.force[i] - here.force[i]) / ahead - *right;
        }
        for spring in &self.springs {
            spring.push(spring.rate - spring.stiffness * spring.of(&field), &mut self.right);
        }
        self.system.solve(&self.right, &mut self.slope).map_err(|e| scene.come_apart(e))?;
        scene.check_loose(&self.slope, ahead)?;
        for (u, p) in self.slope.iter_mut().zip(&field) {
            *u += p;
        }
        Ok(())
    }
}
