//! Thermal expansion of cells and bonds, and the work it does.

use fractum_fem::{Solid, motion};
use serde::{Deserialize, Serialize};

use super::step::SAME_TIME;
use crate::bonded::Bonded;

/// How temperatures expand bodies. Between two steps of conduction temperatures change in proportion to time: a jump would
/// shake the bodies, and damping would brake them for it.
#[derive(Clone, Debug)]
pub(super) struct Expansion {
    /// Temperature at which nothing is stressed [K].
    stress_free: f64,
    /// T - T₀ of the nodes where the present change began, and where it ends [K].
    rises: [Vec<f64>; 2],
    bonds: Vec<ExpandingBonds>,
    /// Temperatures where the present change began [K]; it ends at those of the field.
    from: Vec<f64>,
    /// Temperatures now [K].
    pub(super) now: Vec<f64>,
    /// When the present change began and when it ends [s].
    span: [f64; 2],
    /// Parts of the change that had passed at the step before, and now.
    passed: [f64; 2],
    /// All work booked so far [J].
    pub(super) work: f64,
}

/// The bonds of a body that expands.
#[derive(Clone, Debug)]
struct ExpandingBonds {
    /// Which bonded body.
    body: usize,
    /// Coefficient of linear expansion α [1/K].
    coefficient: f64,
    /// Lengths at T₀, and before the last change [m].
    lengths: Vec<f64>,
    before: Vec<f64>,
}

/// What changes in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct ExpansionState {
    from: Vec<f64>,
    span: [f64; 2],
    passed: [f64; 2],
    work: f64,
}

impl Expansion {
    /// None where no body expands.
    pub(super) fn new(
        solid: &mut Solid,
        bonded: &Bonded,
        solids: &[f64],
        of_bonded: &[f64],
        stress_free: f64,
    ) -> Option<Self> {
        if solids.iter().chain(of_bonded).all(|coefficient| *coefficient == 0.0) {
            return None;
        }
        motion::set_expansion(solid, solids);
        let expands = of_bonded.iter().enumerate().filter(|(_, coefficient)| **coefficient != 0.0);
        let bonds = expands.map(|(body, &coefficient)| {
            let own = &bonded.bodies()[body].bonds;
            let lengths: Vec<f64> = (0..own.len()).map(|bond| own.length(bond)).collect();
            ExpandingBonds { body, coefficient, before: lengths.clone(), lengths }
        });
        let zero = vec![0.0; solid.reference.len()];
        Some(Expansion {
            stress_free,
            rises: [zero.clone(), zero],
            bonds: bonds.collect(),
            from: Vec::new(),
            now: Vec::new(),
            span: [0.0; 2],
            passed: [0.0; 2],
            work: 0.0,
        })
    }

    /// Takes over temperatures as if they had always been so.
    ///
    /// - `time`: when [s]
    pub(super) fn start(&mut self, time: f64, solid: &mut Solid, bonded: &mut Bonded, temperature: &[f64]) {
        (self.from, self.now, self.span) = (temperature.to_vec(), temperature.to_vec(), [time; 2]);
        self.find_rises(temperature);
        motion::start_expanded(solid, &self.rises[0]);
        self.set_lengths(bonded);
        self.bonds.iter_mut().for_each(|own| own.forget(bonded));
    }

    /// Whether the present change ends before a time [s].
    pub(super) fn ends_before(&self, time: f64) -> bool {
        time > self.span[1] + SAME_TIME * (self.span[1] - self.span[0])
    }

    /// Begins a change from the present temperatures to those of the field.
    ///
    /// - `span`: when it begins and when it ends [s]
    pub(super) fn begin(&mut self, span: [f64; 2], solid: &mut Solid, temperature: &[f64]) {
        self.from.copy_from_slice(&self.now);
        (self.span, self.passed) = (span, [0.0; 2]);
        self.find_rises(temperature);
        let [from, to] = &self.rises;
        motion::begin_expansion(solid, [from, to]);
    }

    /// Leads temperatures to a time of the present change [s], for the step that follows; returns half of the work of the
    /// expansion, at the present stresses [J].
    pub(super) fn lead(&mut self, time: f64, solid: &mut Solid, bonded: &mut Bonded, temperature: &[f64]) -> f64 {
        self.passed = [self.passed[1], self.part_at(time)];
        self.find_now(temperature);
        motion::expand_to(solid, self.passed);
        self.bonds.iter_mut().for_each(|own| own.forget(bonded));
        self.set_lengths(bonded);
        self.half_work(solid, bonded)
    }

    /// Part of the present change at a time [s].
    fn part_at(&self, time: f64) -> f64 {
        let [begin, end] = self.span;
        if end > begin { ((time - begin) / (end - begin)).min(1.0) } else { 1.0 }
    }

    /// Has solids expanded as at a time of the present change [s], at which an equilibrium is tried.
    pub(super) fn try_at(&mut self, time: f64, solid: &mut Solid, temperature: &[f64]) {
        self.passed[1] = self.part_at(time);
        self.find_now(temperature);
        motion::expand_to(solid, self.passed);
    }

    /// Takes what was tried as the step before, too; returns half of the work, at the stresses of before [J].
    ///
    /// - `first`: whether no equilibrium came before: bodies had no stress yet
    pub(super) fn settle(&mut self, solid: &mut Solid, bonded: &mut Bonded, first: bool) -> f64 {
        let work = if first { 0.0 } else { self.half_work(solid, bonded) };
        motion::expand_to(solid, [self.passed[1]; 2]);
        work
    }

    /// The other half, at the stresses of the equilibrium, with that of the strains at the start where it is the first [J].
    pub(super) fn finish_settled(&mut self, solid: &Solid, bonded: &mut Bonded, first: bool) -> f64 {
        let mut work = self.half_work(solid, bonded);
        if first {
            let start = motion::starting_work(solid);
            self.work += start;
            work += start;
        }
        self.passed[0] = self.passed[1];
        work
    }

    /// The other half of the work, at the stresses of the step after it [J].
    pub(super) fn finish(&mut self, solid: &Solid, bonded: &mut Bonded) -> f64 {
        self.half_work(solid, bonded)
    }

    fn half_work(&mut self, solid: &Solid, bonded: &mut Bonded) -> f64 {
        let [before, now] = self.passed;
        let mut work = 0.5 * (now - before) * motion::expansion_work(solid);
        for own in &self.bonds {
            work += own.half_work(bonded);
        }
        self.work += work;
        work
    }

    fn find_rises(&mut self, temperature: &[f64]) {
        for (rises, temperatures) in self.rises.iter_mut().zip([self.from.as_slice(), temperature]) {
            rises.iter_mut().zip(temperatures).for_each(|(rise, t)| *rise = t - self.stress_free);
        }
    }

    fn find_now(&mut self, temperature: &[f64]) {
        let part = self.passed[1];
        let ends = self.from.iter().zip(temperature);
        self.now.iter_mut().zip(ends).for_each(|(now, (from, to))| *now = from + part * (to - from));
    }

    fn set_lengths(&mut self, bonded: &mut Bonded) {
        let Expansion { bonds, now, rises, stress_free, .. } = self;
        let particles = &now[rises[0].len()..];
        bonds.iter_mut().for_each(|own| own.set_lengths(bonded, particles, *stress_free));
    }

    pub(super) fn state(&self) -> ExpansionState {
        ExpansionState { from: self.from.clone(), span: self.span, passed: self.passed, work: self.work }
    }

    /// Puts a saved state back.
    ///
    /// - `temperature`: that of the field then
    pub(super) fn restore(
        &mut self,
        solid: &mut Solid,
        bonded: &mut Bonded,
        temperature: &[f64],
        state: ExpansionState,
    ) {
        let ExpansionState { from, span, passed, work } = state;
        self.now.copy_from_slice(&from);
        self.begin(span, solid, temperature);
        for part in passed {
            self.passed = [self.passed[1], part];
            motion::expand_to(solid, self.passed);
            self.find_now(temperature);
            self.bonds.iter_mut().for_each(|own| own.forget(bonded));
            self.set_lengths(bonded);
        }
        motion::find_expansion_work(solid);
        self.work = work;
    }
}

impl ExpandingBonds {
    /// Lengths without load at temperatures of the particles.
    fn set_lengths(&mut self, bonded: &mut Bonded, particles: &[f64], stress_free: f64) {
        let bonds = &mut bonded.bodies[self.body].bonds;
        for (bond, length) in self.lengths.iter().enumerate() {
            let [first, second] = bonds.pairs()[bond].map(|i| particles[i as usize]);
            bonds.set_length(bond, length * (1.0 + self.coefficient * (0.5 * (first + second) - stress_free)));
        }
    }

    fn forget(&mut self, bonded: &Bonded) {
        let bonds = &bonded.bodies[self.body].bonds;
        self.before.iter_mut().enumerate().for_each(|(bond, before)| *before = bonds.length(bond));
    }

    /// Half of the energy that the last change of lengths brings at the present places [J].
    fn half_work(&self, bonded: &mut Bonded) -> f64 {
        let particles = &bonded.particles;
        let bonds = &mut bonded.bodies[self.body].bonds;
        let mut work = 0.0;
        for (bond, &before) in self.before.iter().enumerate() {
            let now = bonds.length(bond);
            if now == before || !bonds.is_live(bond) {
                continue;
            }
            let after = bonds.energy_of(bond, particles).total();
            bonds.set_length(bond, before);
            work += 0.5 * (after - bonds.energy_of(bond, particles).total());
            bonds.set_length(bond, now);
        }
        work
    }
}
