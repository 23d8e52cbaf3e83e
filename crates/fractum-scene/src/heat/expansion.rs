//! Thermal expansion of cells and bonds, and the work it does.

use fractum_fem::Solid;
use serde::{Deserialize, Serialize};

use crate::bonded::Bonded;

/// How temperatures expand bodies.
#[derive(Clone, Debug)]
pub(super) struct Expansion {
    /// Temperature at which nothing is stressed [K].
    stress_free: f64,
    /// T - T₀ of the nodes [K].
    rise: Vec<f64>,
    bonds: Vec<ExpandingBonds>,
    /// Temperatures before the last change [K].
    before: Vec<f64>,
    /// Half of the work of the last change is still to be booked.
    pending: bool,
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
    before: Vec<f64>,
    pending: bool,
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
        solid.set_expansion(solids);
        let expands = of_bonded.iter().enumerate().filter(|(_, coefficient)| **coefficient != 0.0);
        let bonds = expands.map(|(body, &coefficient)| {
            let own = &bonded.bodies()[body].bonds;
            let lengths: Vec<f64> = (0..own.len()).map(|bond| own.length(bond)).collect();
            ExpandingBonds { body, coefficient, before: lengths.clone(), lengths }
        });
        Some(Expansion {
            stress_free,
            rise: vec![0.0; solid.reference.len()],
            bonds: bonds.collect(),
            before: Vec::new(),
            pending: false,
            work: 0.0,
        })
    }

    /// Takes over temperatures as if they had always been so.
    pub(super) fn start(&mut self, solid: &mut Solid, bonded: &mut Bonded, temperature: &[f64]) {
        self.set_rise(temperature);
        solid.start_expanded(&self.rise);
        let particles = &temperature[self.rise.len()..];
        for own in &mut self.bonds {
            own.set_lengths(bonded, particles, self.stress_free);
            own.forget(bonded);
        }
        self.before = temperature.to_vec();
    }

    /// Takes over temperatures for the next step; returns half of the work of the expansion [J].
    pub(super) fn expand(&mut self, solid: &mut Solid, bonded: &mut Bonded, temperature: &[f64]) -> f64 {
        self.set_rise(temperature);
        let particles = &temperature[self.rise.len()..];
        let mut work = solid.expand(&self.rise);
        for own in &mut self.bonds {
            own.forget(bonded);
            own.set_lengths(bonded, particles, self.stress_free);
            work += own.half_work(bonded);
        }
        self.pending = true;
        self.work += work;
        work
    }

    /// The other half of the work, at the stresses of the step after it [J].
    pub(super) fn finish(&mut self, solid: &mut Solid, bonded: &mut Bonded, temperature: &[f64]) -> f64 {
        if !std::mem::take(&mut self.pending) {
            return 0.0;
        }
        let mut work = solid.finish_expansion();
        for own in &mut self.bonds {
            work += own.half_work(bonded);
        }
        self.before.copy_from_slice(temperature);
        self.work += work;
        work
    }

    fn set_rise(&mut self, temperature: &[f64]) {
        self.rise.iter_mut().zip(temperature).for_each(|(rise, t)| *rise = t - self.stress_free);
    }

    pub(super) fn state(&self) -> ExpansionState {
        ExpansionState { before: self.before.clone(), pending: self.pending, work: self.work }
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
        self.start(solid, bonded, &state.before);
        if state.pending {
            self.expand(solid, bonded, temperature);
        }
        ExpansionState { before: self.before, pending: self.pending, work: self.work } = state;
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
