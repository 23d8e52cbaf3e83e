//! Edges whose strength and fracture energy grow with the rate of strain.

use std::sync::Arc;

use fractum_kernels::Sym3;
use fractum_kernels::damage::{EdgeDamage, EdgeRate, RateLaw, Seen, Softens, Waiting};

use crate::body::rate::RateCurves;
use crate::damage::threshold::IN_RESERVE;

/// What a field of edges knows of rates.
#[derive(Clone, Debug)]
pub(crate) struct RateField {
    curves: Arc<RateCurves>,
    watched: f64,
    /// Sum of the steps since the start [s].
    clock: f64,
    pub(crate) edges: Vec<EdgeRate>,
}

impl RateField {
    /// Edges of these strengths that nothing has happened to.
    pub(crate) fn new(curves: Arc<RateCurves>, strength: &[f64]) -> Self {
        let watched = curves.watched();
        let edges = strength.iter().map(|&strength| EdgeRate::intact(strength)).collect();
        RateField { curves, watched, clock: 0.0, edges }
    }

    /// History of an intact edge of this strength at rest [Pa].
    pub(crate) fn intact(&self, strength: f64) -> EdgeDamage {
        EdgeDamage::intact(self.watched * strength)
    }

    /// Lets time go on [s].
    pub(crate) fn pass(&mut self, dt: f64) {
        self.clock += dt;
    }

    /// What an edge is by now, for a checkpoint.
    pub(crate) fn saved(&self, index: usize) -> (f64, EdgeRate) {
        (self.clock, self.edges[index])
    }

    /// Takes over what was saved of an edge; returns its strength [Pa].
    pub(crate) fn restore(&mut self, index: usize, (clock, edge): (f64, EdgeRate)) -> f64 {
        (self.clock, self.edges[index]) = (clock, edge);
        edge.strength
    }

    /// The edges with their step.
    pub(crate) fn in_step(&mut self, dt: f64) -> (RateInStep<'_>, &mut [EdgeRate]) {
        let RateField { curves, watched, clock, edges } = self;
        (RateInStep { law: curves.law(*watched), now: *clock, dt }, edges)
    }
}

/// What the edges of a field share in a step.
#[derive(Clone, Copy)]
pub(crate) struct RateInStep<'a> {
    law: RateLaw<'a>,
    now: f64,
    dt: f64,
}

impl RateInStep<'_> {
    /// Whether the damage of an edge that sees this goes on or begins; where it begins, the edge takes over the strength of its rate [Pa].
    ///
    /// - `length`: characteristic length [m]; `stress`: effective one [Pa]
    pub(crate) fn lets_grow(
        &self,
        softens: &Softens,
        rate: &mut EdgeRate,
        (edge, seen): (&mut EdgeDamage, &mut Seen),
        (strength, length): (&mut f64, f64),
        stress: Sym3,
    ) -> bool {
        if rate.rate >= 0.0 {
            return true;
        }
        let ratio = softens.length_ratio(*strength, length);
        let waiting = Waiting {
            strength: *strength,
            modulus: softens.restraint.modulus,
            length_ratio: [ratio, ratio.max(IN_RESERVE)],
            now: self.now,
            dt: self.dt,
        };
        if !rate.begins(&self.law, &waiting, stress, seen.stress) {
            return false;
        }
        *strength = rate.strength;
        // The lateral stress is that at the onset.
        seen.lateral *= rate.strength / edge.kappa;
        edge.kappa = rate.strength;
        true
    }
}

/// The rates at which the edges of a body began to break.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RateReport {
    /// Edges whose damage has begun.
    pub count: usize,
    /// Of these, such as would have been stronger in smaller elements.
    pub limited: usize,
    /// Least, mean (of the logarithm) and largest rate of strain [1/s].
    pub rates: [f64; 3],
}

impl RateReport {
    /// Of edges in any order.
    pub(crate) fn of<'a>(edges: impl Iterator<Item = &'a EdgeRate>) -> Self {
        let mut report = RateReport { rates: [f64::INFINITY, 0.0, 0.0], ..RateReport::default() };
        let mut sum = 0.0;
        for edge in edges.filter(|edge| edge.rate >= 0.0) {
            report.count += 1;
            report.limited += usize::from(edge.is_limited);
            let [least, _, most] = report.rates;
            report.rates = [least.min(edge.rate), 0.0, most.max(edge.rate)];
            sum += fractum_kernels::elementary::ln(edge.rate.max(f64::MIN_POSITIVE));
        }
        if report.count > 0 {
            report.rates[1] = fractum_kernels::elementary::exp(sum / report.count as f64);
        }
        report
    }
}
