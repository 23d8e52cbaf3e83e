use fractum_math::{Vec3, sum_chunks};
use fractum_sparse::SparseError;
use serde::{Deserialize, Serialize};

use crate::condition::{HeatCondition, HeatFunction};
use crate::implicit::ImplicitHeat;
use crate::ledger::HeatLedger;
use crate::network::HeatNetwork;

/// Instants at which an implicit step looks at its sources.
const LOOKS: usize = 4;

/// Temperatures of the points of a network, and what heats them.
#[derive(Clone, Debug)]
pub struct HeatField {
    network: HeatNetwork,
    /// Places of the points at the start [m].
    places: Vec<Vec3>,
    conditions: Vec<HeatCondition>,
    /// Whether the temperature of each point is prescribed.
    held: Vec<bool>,
    /// Coefficient of heat transfer times area of each point [W/K].
    exchange: Vec<f64>,
    start: Vec<f64>,
    temperature: Vec<f64>,
    time: f64,
    ledger: HeatLedger,
    flow: Vec<f64>,
}

/// What changes in a field, for a checkpoint.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeatFieldState {
    temperature: Vec<f64>,
    time: f64,
    ledger: HeatLedger,
}

impl HeatField {
    /// A field at t = 0; points of prescribed temperature have theirs.
    ///
    /// - `places` of the points [m]; `temperature` at the start [K]
    pub fn new(
        network: HeatNetwork,
        places: Vec<Vec3>,
        mut temperature: Vec<f64>,
        conditions: Vec<HeatCondition>,
    ) -> Self {
        let count = network.len();
        let (mut held, mut exchange) = (vec![false; count], vec![0.0; count]);
        let start = temperature.clone();
        for condition in &conditions {
            match condition {
                HeatCondition::Temperature { points, value } => points.iter().for_each(|&i| {
                    held[i as usize] = true;
                    temperature[i as usize] = value(0.0, &places[i as usize]);
                }),
                HeatCondition::Convection { points, coefficient, .. } => {
                    points.iter().for_each(|&(i, area)| exchange[i as usize] += coefficient * area);
                }
                HeatCondition::Supply { .. } => {}
            }
        }
        // A prescribed temperature other than that of the start brings its heat at once.
        let risen = |i: usize| network.capacity()[i] * (temperature[i] - start[i]);
        let ledger = HeatLedger { held: sum_chunks(count, risen), ..HeatLedger::default() };
        HeatField {
            flow: vec![0.0; count],
            start,
            network,
            places,
            conditions,
            held,
            exchange,
            temperature,
            time: 0.0,
            ledger,
        }
    }

    /// Temperatures [K].
    pub fn temperature(&self) -> &[f64] {
        &self.temperature
    }

    /// Time of the temperatures [s].
    pub fn time(&self) -> f64 {
        self.time
    }

    /// Where the heat came from and is.
    pub fn ledger(&self) -> HeatLedger {
        let risen = |i: usize| self.network.capacity()[i] * (self.temperature[i] - self.start[i]);
        HeatLedger { stored: sum_chunks(self.temperature.len(), risen), ..self.ledger }
    }

    /// Capacities and conductances.
    pub fn network(&self) -> &HeatNetwork {
        &self.network
    }

    /// Gives the pairs other conductances [W/K].
    pub fn set_conductances(&mut self, conductances: &[f64]) {
        self.network.set_conductances(conductances);
    }

    /// A step of [`HeatField::step`] that is surely stable [s]; infinite where nothing conducts.
    ///
    /// By Gershgorin's theorem the largest eigenvalue of C⁻¹ K is at most max (Σ Gᵢⱼ + Σ |Gᵢⱼ| + h A)/Cᵢ over free points, and
    /// the explicit step is stable up to 2 over it; where no conductance is negative no temperature oscillates then.
    pub fn stable_step(&self) -> f64 {
        let rate = |i: usize| {
            let (sum, size) = self.network.sums(i);
            if self.held[i] { 0.0 } else { (sum + size + self.exchange[i]) / self.network.capacity()[i] }
        };
        2.0 / (0..self.network.len()).map(rate).fold(0.0, f64::max)
    }

    /// Advances temperatures by an explicit step of `dt` [s] (forward Euler).
    pub fn step(&mut self, dt: f64) {
        let powers = self.find_flows([self.time]);
        self.time += dt;
        let HeatField { flow, temperature, network, held, .. } = self;
        for (i, capacity) in network.capacity().iter().enumerate() {
            if !held[i] {
                temperature[i] += dt * flow[i] / capacity;
            }
        }
        let given = self.prescribe() - dt * self.flow_into_held();
        self.book(dt, powers, given);
    }

    /// Advances temperatures to the time `to` [s], at any distance (backward Euler). Equal steps should lead to equal systems: the
    /// difference of two times is rounded, by less than 1e-9 of it. Sources count with their mean over the step, so that what begins or
    /// ends within it brings its part.
    ///
    /// # Errors
    /// A system that was not solved.
    pub fn step_implicitly(&mut self, solver: &mut ImplicitHeat, to: f64) -> Result<(), SparseError> {
        let dt = without_noise(to - self.time);
        let looks: [f64; LOOKS] = std::array::from_fn(|k| {
            let share = (k as f64 + 0.5) / LOOKS as f64;
            self.time + share * (to - self.time)
        });
        self.time = to;
        let risen = self.prescribe();
        let [supplied, convection] = self.find_flows(looks);
        let right = |i: usize| [if self.held[i] { 0.0 } else { dt * self.flow[i] }];
        let right: Vec<[f64; 1]> = (0..self.network.len()).map(right).collect();
        let change = solver.solve(&self.network, &self.exchange, &self.held, dt, &right)?;
        let change: Vec<f64> = change.into_iter().map(|[change]| change).collect();
        self.temperature.iter_mut().zip(&change).for_each(|(t, change)| *t += change);
        // The books need the flows at the end of the step: those at its start, sources included, and what the change adds.
        let HeatField { flow, network, held, exchange, .. } = self;
        for i in (0..network.len()).filter(|&i| held[i]) {
            flow[i] += network.flow_into(i, &change);
        }
        let cooler: f64 = exchange.iter().zip(&change).map(|(exchange, change)| exchange * change).sum();
        let given = risen - dt * self.flow_into_held();
        self.book(dt, [supplied, convection - cooler], given);
        Ok(())
    }

    /// Gives points of prescribed temperature that of the present time; returns the heat that this takes [J].
    fn prescribe(&mut self) -> f64 {
        let HeatField { network, places, conditions, temperature, time, .. } = self;
        let mut taken = 0.0;
        for condition in conditions {
            let HeatCondition::Temperature { points, value } = condition else { continue };
            for &i in points.iter() {
                let i = i as usize;
                let now = value(*time, &places[i]);
                taken += network.capacity()[i] * (now - temperature[i]);
                temperature[i] = now;
            }
        }
        taken
    }

    /// Heat that flowed into points of prescribed temperature [W].
    fn flow_into_held(&self) -> f64 {
        let of = |condition: &HeatCondition| match condition {
            HeatCondition::Temperature { points, .. } => points.iter().map(|&i| self.flow[i as usize]).sum(),
            _ => 0.0,
        };
        self.conditions.iter().map(of).sum()
    }

    /// - `powers` of flows and of convection [W]; `given`: heat of the points of prescribed temperature [J]
    fn book(&mut self, dt: f64, [supplied, convection]: [f64; 2], given: f64) {
        let books = &mut self.ledger;
        books.held += given;
        books.supplied += dt * supplied;
        books.convection += dt * convection;
    }

    /// Heat that flows into every point at the present temperatures [W]; sources are the mean of those at `looks` [s], T∞ is that of
    /// the present time. Returns the powers of flows and of convection [W].
    fn find_flows<const N: usize>(&mut self, looks: [f64; N]) -> [f64; 2] {
        let HeatField { network, places, conditions, temperature, flow, time, .. } = self;
        let mean = |value: &HeatFunction, place: &Vec3| looks.iter().map(|&t| value(t, place)).sum::<f64>() / N as f64;
        network.flows(temperature, flow);
        let (mut supplied, mut convection) = (0.0, 0.0);
        for condition in conditions {
            match condition {
                HeatCondition::Temperature { .. } => {}
                HeatCondition::Supply { points, value } => {
                    for &(i, share) in points.iter() {
                        let power = share * mean(value, &places[i as usize]);
                        flow[i as usize] += power;
                        supplied += power;
                    }
                }
                HeatCondition::Convection { points, coefficient, ambient } => {
                    for &(i, area) in points.iter() {
                        let i = i as usize;
                        let power = *coefficient * area * (ambient(*time, &places[i]) - temperature[i]);
                        flow[i] += power;
                        convection += power;
                    }
                }
            }
        }
        [supplied, convection]
    }

    /// Everything that changes.
    pub fn state(&self) -> HeatFieldState {
        HeatFieldState { temperature: self.temperature.clone(), time: self.time, ledger: self.ledger }
    }

    /// Puts a saved state back.
    pub fn restore(&mut self, state: HeatFieldState) {
        HeatFieldState { temperature: self.temperature, time: self.time, ledger: self.ledger } = state;
    }
}

/// A step [s] of 30 binary digits: what differences of growing times leave in the last digits makes no other step.
fn without_noise(dt: f64) -> f64 {
    const LOST: u32 = f64::MANTISSA_DIGITS - 30;
    f64::from_bits((dt.to_bits() + (1 << (LOST - 1))) & !((1 << LOST) - 1))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    /// A bar of `count` points along x, its first point at `hot` or free, with a source and convection at its end.
    fn bar(count: usize, hot: Option<f64>) -> HeatField {
        let pairs: Vec<[u32; 2]> = (1..count as u32).map(|i| [i - 1, i]).collect();
        let network = HeatNetwork::new(vec![2.0; count], &pairs, &vec![5.0; pairs.len()]);
        let places = (0..count).map(|i| Vec3::x() * i as f64).collect();
        let last = count as u32 - 1;
        let mut conditions = vec![
            HeatCondition::Supply { points: vec![(last / 2, 0.5)], value: Arc::new(|t, _| 40.0 * t) },
            HeatCondition::Convection { points: vec![(last, 0.1)], coefficient: 3.0, ambient: Arc::new(|_, _| 280.0) },
        ];
        if let Some(hot) = hot {
            conditions.push(HeatCondition::Temperature { points: vec![0], value: Arc::new(move |t, _| hot + t) });
        }
        HeatField::new(network, places, vec![300.0; count], conditions)
    }

    #[test]
    fn both_steps_keep_the_heat_and_agree() {
        let (mut explicit, mut implicit) = (bar(30, Some(400.0)), bar(30, Some(400.0)));
        let dt = 0.01 * explicit.stable_step();
        let mut solver = ImplicitHeat::default();
        for step in 1..=2000 {
            explicit.step(dt);
            implicit.step_implicitly(&mut solver, f64::from(step) * dt).unwrap();
        }
        assert_eq!(format!("{solver:?}"), "ImplicitHeat(1 systems prepared)");
        for field in [&explicit, &implicit] {
            let ledger = field.ledger();
            assert!(ledger.stored > 100.0 && ledger.residual().abs() < 1e-11 * ledger.stored, "{ledger:?}");
        }
        for (a, b) in explicit.temperature().iter().zip(implicit.temperature()) {
            assert!((a - b).abs() < 0.05, "{a} {b}");
        }
    }

    /// A bar that is brought from 300 to 400 K takes C ΔT, however the end that brings it there gets its own temperature.
    #[test]
    fn a_temperature_that_leaps_at_the_start_brings_the_heat_of_its_points() {
        for implicit in [false, true] {
            let mut field = bar(4, Some(400.0));
            field.exchange.fill(0.0);
            field.conditions = vec![HeatCondition::Temperature { points: vec![0], value: Arc::new(|_, _| 400.0) }];
            let (dt, mut solver) = (0.5 * field.stable_step(), ImplicitHeat::default());
            for step in 1..=1000 {
                match implicit {
                    true => field.step_implicitly(&mut solver, f64::from(step) * dt).unwrap(),
                    false => field.step(dt),
                }
            }
            let HeatLedger { stored, held, .. } = field.ledger();
            assert!((stored - 800.0).abs() < 1e-6 && (held - 800.0).abs() < 1e-6, "{stored} {held}");
        }
    }

    /// Long implicit steps bring the heat of a source that grows wholly, and that of one which ends within a step but for an eighth of it.
    #[test]
    fn a_source_that_ends_within_a_step_brings_its_heat() {
        let brought = |source: fn(f64) -> f64| {
            let mut field = bar(30, None);
            field.conditions =
                vec![HeatCondition::Supply { points: vec![(7, 1.0)], value: Arc::new(move |t, _| source(t)) }];
            let mut solver = ImplicitHeat::default();
            (1..=5).for_each(|step| field.step_implicitly(&mut solver, f64::from(step) * 20.0).unwrap());
            field.ledger().supplied
        };
        assert!((brought(|t| 3.0 * t) / 15_000.0 - 1.0).abs() < 1e-12);
        assert!((brought(|t| if t < 33.333 { 3.0 } else { 0.0 }) / 3.0 - 33.333).abs() <= 2.5);
    }

    #[test]
    fn the_stable_step_is_stable_and_little_more_is_not() {
        // Ends that alternate are the highest mode of a chain: eigenvalue 4 G/C, the bound itself.
        let grows = |factor: f64| {
            let mut field = bar(30, None);
            field.conditions.clear();
            field.exchange.fill(0.0);
            field.temperature.iter_mut().enumerate().for_each(|(i, t)| *t += if i % 2 == 0 { 1.0 } else { -1.0 });
            let dt = factor * field.stable_step();
            (0..500).for_each(|_| field.step(dt));
            field.temperature.iter().any(|t| (t - 300.0).abs() > 2.0)
        };
        assert!(!grows(1.0) && grows(1.05));
    }
}
