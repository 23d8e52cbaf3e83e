//! `loads[].detonation`: a front that runs along a hole. `loads[].scatter`: delays by chance.

use std::f64::consts::PI;

use fractum_math::elementary::{cos, hypot, ln};
use rand_distr::{Distribution as _, OpenClosed01};
use rand_pcg::Pcg64Mcg;

use crate::Diagnostic;
use crate::model::{Detonation, InCracks};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::{direction, point};
use crate::usual::DETONATION;

/// Where and when a pressure acts beside its facets and time.
#[derive(Clone, Copy)]
pub(super) struct Acts {
    pub(super) in_cracks: Option<InCracks>,
    pub(super) detonation: Option<Detonation>,
}

/// The front of a pressure; nothing where it is wrong.
pub(super) fn detonation(load: &Table<'_>) -> Option<Option<Detonation>> {
    let Some(table) = load.table("detonation") else { return Some(None) };
    let velocity = table.quantity("velocity").positive().usual(&DETONATION).required();
    let along = optional(&table, "along", |key| direction(&table, key).given());
    let primer = optional(&table, "primer", |key| point(&table, key).given());
    if !table.has("along") && !table.has("primer") {
        let note = Diagnostic::error(&table.place, "does not say where the front begins");
        let note = note
            .expected("along, the direction in which it runs through the hole, or primer, the point where it begins");
        table.reader.note(note);
        return None;
    }
    table.finish("here");
    Some(Some(Detonation { velocity: velocity?, along: along?, primer: primer? }))
}

/// How delays scatter about those given.
pub(super) struct DelayScatter {
    /// Standard deviation that all delays have [s], and as a part of the delay.
    deviation: [f64; 2],
    seed: u64,
}

impl DelayScatter {
    /// That of a firing sequence; nothing where it is wrong.
    pub(super) fn read(load: &Table<'_>) -> Option<Option<Self>> {
        let Some(table) = load.table("scatter") else { return Some(None) };
        let deviation = table.quantity("deviation").not_negative().or_if_absent(0.0);
        let relative = table.quantity("relative").not_negative().or_if_absent(0.0);
        let seed = table.integer("seed").or(1);
        let (reader, place) = (table.reader, table.place.clone());
        table.finish("here");
        let deviation = [deviation?, relative?];
        if deviation == [0.0; 2] {
            let note = Diagnostic::error(&place, "scatters nothing");
            reader.note(note.expected("a deviation, such as \"1 ms\", or relative, such as \"2 %\""));
            return None;
        }
        Some(Some(DelayScatter { deviation, seed }))
    }

    /// The delay of a row: normally distributed about the one given, never before 0 [s].
    pub(super) fn of(&self, row: usize, delay: f64) -> f64 {
        let [all, relative] = self.deviation;
        let deviation = hypot(all, relative * delay);
        // Every row has its own stream.
        let mut generator = Pcg64Mcg::new(u128::from(self.seed) << 64 | row as u128);
        let [radius, turn]: [f64; 2] = [(); 2].map(|()| OpenClosed01.sample(&mut generator));
        // Box and Muller, *Ann. Math. Stat.* 29 (1958) 610.
        (delay + deviation * (-2.0 * ln(radius)).sqrt() * cos(2.0 * PI * turn)).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn delays_have_the_deviation_asked_for_and_the_same_bits_for_a_seed() {
        for (deviation, relative) in [(1e-3, 0.0), (0.0, 0.02), (1e-3, 0.02)] {
            for seed in [1, 2, 77] {
                let scatter = DelayScatter { deviation: [deviation, relative], seed };
                let (count, delay) = (10_000, 0.1);
                let delays: Vec<f64> = (0..count).map(|row| scatter.of(row, delay)).collect();
                let mean = delays.iter().sum::<f64>() / count as f64;
                let variance = delays.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / (count - 1) as f64;
                let expected = f64::hypot(deviation, relative * delay);
                // Four standard errors.
                assert!((mean - delay).abs() < 4.0 * expected / (count as f64).sqrt(), "{mean} of {delay}");
                assert!((variance.sqrt() / expected - 1.0).abs() < 4.0 / (2.0 * count as f64).sqrt(), "{variance}");
                let beyond = delays.iter().filter(|d| (*d - delay).abs() > 1.96 * expected).count();
                assert!((400..600).contains(&beyond), "{beyond} of {count} beyond 1.96 deviations");
                let again = DelayScatter { deviation: [deviation, relative], seed };
                assert!((0..count).all(|row| again.of(row, delay) == delays[row]));
            }
        }
        let early = DelayScatter { deviation: [1.0, 0.0], seed: 3 };
        assert!((0..100).all(|row| early.of(row, 0.0) >= 0.0));
    }
}
