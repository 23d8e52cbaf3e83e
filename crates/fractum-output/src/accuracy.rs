//! Passes: one case on several meshes, and what their peaks say of a mesh that is endlessly fine.
//!
//! The load at which a crack runs grows with the size h of the elements at it, P = P₀ (1 + e + a h/l), with l made of process zone and body in series, and e the
//! little that is left. Meshes scatter about that line in proportion to their size. P₀ and a are found by least squares, to which what is known of a and of
//! the scatter before any run is added as if it had been measured.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::number::{or_null, percent, quantity};

/// How often the truth lies within the bars.
pub const CONFIDENCE: f64 = 0.9;

/// What a case that asks for an accuracy came to.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Name of the probe of the load.
    pub load: String,
    /// What was asked for: half the width of the bar over the value [-].
    pub asked: f64,
    /// What was reached for the load.
    #[serde(with = "or_null")]
    pub reached: f64,
    /// Share of such bars that hold the truth [-].
    pub confidence: f64,
    /// Length l beside which elements are large or small: process zone and smallest extent of the body in series [m]; null without damage.
    #[serde(with = "or_null")]
    pub length: f64,
    /// The runs, the mesh of the user first.
    pub passes: Vec<Pass>,
    /// Peak of every probe on an endlessly fine mesh, by the name of the probe.
    pub probes: BTreeMap<String, Estimate>,
}

/// A run on one mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pass {
    /// Its name, and that of its folder.
    pub name: String,
    /// Size of elements where damage came [m].
    #[serde(with = "or_null")]
    pub size: f64,
    /// Whether its crack runs along a line of its mesh.
    #[serde(default)]
    pub line: bool,
    /// Elements of solids.
    pub elements: u64,
    /// How it ended, in a word.
    pub end: String,
    /// Why its peaks do not count; empty where they do.
    pub left_out: String,
    /// Time on the clock [s].
    #[serde(with = "or_null")]
    pub wall: f64,
    /// Peak of every probe, the largest in size.
    pub peaks: BTreeMap<String, f64>,
}

/// A value with its error bar.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// Unit of the value.
    pub unit: String,
    /// The value on an endlessly fine mesh.
    #[serde(with = "or_null")]
    pub value: f64,
    /// Half the width of its bar.
    #[serde(with = "or_null")]
    pub half: f64,
}

/// What is known of peaks before any run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Known {
    /// Mean of a, and its standard deviation.
    pub slope: [f64; 2],
    /// What is left of the excess on an endlessly fine mesh over the value, and its standard deviation.
    pub left: [f64; 2],
    /// Standard deviation of a mesh of the size l over the value; that of others is in proportion to their size.
    pub scatter: f64,
    /// Meshes that this knowledge of the scatter is worth.
    pub weight: f64,
}

/// Of loads at which cracks run under local damage, chosen on plates and beams of `cases/crack-size/scenes.csv`; `passes.py` holds the bars against all of them. What
/// is left comes of the energy that a crack through irregular triangles takes above the fracture energy.
pub const OF_LOADS: Known = Known { slope: [0.55, 0.35], left: [0.015, 0.012], scatter: 0.35, weight: 4.0 };

/// Of such loads under a phase field whose length goes down with the elements, chosen on five of these cracks.
pub const OF_FIELDS: Known = Known { slope: [0.6, 0.4], left: [0.0, 0.015], scatter: 0.35, weight: 4.0 };

/// Of other peaks, of which nothing is known.
pub const OF_OTHERS: Known = Known { slope: [0.0, 1.0], left: [0.0; 2], scatter: 0.35, weight: 0.0 };

/// Value and half of its bar from the peaks of some meshes; none without two of them.
///
/// - `sizes`: h/l of each
pub fn estimate(sizes: &[f64], peaks: &[f64], known: Known) -> Option<[f64; 2]> {
    let count = sizes.len().min(peaks.len());
    if count < 2 || !sizes.iter().all(|size| *size > 0.0) {
        return None;
    }
    // In units of the value of the finest mesh, which makes the slope that of a.
    let finest = (0..count).min_by(|i, j| sizes[*i].total_cmp(&sizes[*j]))?;
    let unit = peaks[finest];
    if unit == 0.0 {
        return peaks.iter().all(|peak| *peak == 0.0).then_some([0.0; 2]);
    }
    let ([mean, spread], lines) = (known.slope, || sizes.iter().zip(peaks).map(|(size, peak)| (*size, peak / unit)));
    // Normal equations of value and slope; the known slope is one more line.
    let (mut all, mut right) = ([0.0, 0.0, spread.powi(-2)], [0.0, mean * spread.powi(-2)]);
    for (size, peak) in lines() {
        let weight = (known.scatter * size).powi(-2);
        all = [all[0] + weight, all[1] + weight * size, all[2] + weight * size * size];
        right = [right[0] + weight * peak, right[1] + weight * size * peak];
    }
    let determinant = all[0] * all[2] - all[1] * all[1];
    let value = (right[0] * all[2] - right[1] * all[1]) / determinant;
    let slope = (right[1] * all[0] - right[0] * all[1]) / determinant;
    let off = |(size, peak): (f64, f64)| ((peak - value - slope * size) / (known.scatter * size)).powi(2);
    let squares = lines().map(off).sum::<f64>() + ((slope - mean) / spread).powi(2);
    let freedom = known.weight + count as f64 - 1.0;
    let variance = (known.weight + squares) / freedom * all[2] / determinant;
    let [left, its_spread] = known.left;
    let half = quantile(freedom) * (variance + its_spread * its_spread).sqrt();
    Some([value * unit / (1.0 + left), half * unit.abs()])
}

/// Loads of cracks along lines that runs with damage have found: the share by which they are too high and its standard deviation from crack to crack, the standard
/// deviation from line to line, and the number of lines that this knowledge of the latter is worth. Chosen on the same cracks.
const OF_LINES: [f64; 4] = [0.004, 0.006, 0.004, 4.0];

/// Value and half of its bar from the peaks of passes along lines; none without two of them.
pub fn of_lines(peaks: &[f64]) -> Option<[f64; 2]> {
    let count = peaks.len() as f64;
    let mean = peaks.iter().sum::<f64>() / count;
    if peaks.len() < 2 || mean == 0.0 {
        return None;
    }
    let [above, spread, scatter, weight] = OF_LINES;
    let squares: f64 = peaks.iter().map(|peak| (peak / mean - 1.0).powi(2)).sum();
    let freedom = weight + count - 1.0;
    let variance = (weight * scatter * scatter + squares) / freedom;
    let half = quantile(freedom) * (variance / count + spread * spread).sqrt();
    Some([mean / (1.0 + above), half * mean.abs()])
}

/// Within how many standard deviations nine of ten values lie, by Student's distribution with so many degrees of freedom.
///
/// The expansion of Cornish and Fisher about the normal distribution, Abramowitz and Stegun 26.7.5; 0.5 % off at 2 degrees.
fn quantile(freedom: f64) -> f64 {
    let x: f64 = 1.644_853_627;
    let terms = [
        (x.powi(3) + x) / 4.0,
        (5.0 * x.powi(5) + 16.0 * x.powi(3) + 3.0 * x) / 96.0,
        (3.0 * x.powi(7) + 19.0 * x.powi(5) + 17.0 * x.powi(3) - 15.0 * x) / 384.0,
    ];
    terms.iter().zip(1..).fold(x, |sum, (term, power)| sum + term / freedom.powi(power))
}

impl Estimate {
    /// `178.4 kN ± 2.1 % (9 in 10)`.
    pub fn words(&self) -> String {
        let share = if self.value == 0.0 { 0.0 } else { (self.half / self.value).abs() };
        format!("{} \u{b1} {}", quantity(self.value, &self.unit), percent(share))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_student() {
        for (freedom, exact) in [(3.0, 2.353), (5.0, 2.015), (8.0, 1.860), (20.0, 1.725), (1e6, 1.645)] {
            assert!((quantile(freedom) / exact - 1.0).abs() < 0.003, "{freedom}: {}", quantile(freedom));
        }
    }

    #[test]
    fn a_line_without_scatter_is_found_and_units_change_nothing() {
        let sizes = [0.1, 0.1, 0.05, 0.025];
        let peaks = sizes.map(|h| 200.0 * (1.015 + 0.55 * h));
        let [value, half] = estimate(&sizes, &peaks, OF_LOADS).unwrap();
        assert!((value / 200.0 - 1.0).abs() < 1e-3 && half > 0.0 && half < 8.0, "{value} {half}");
        let [mirrored, same] = estimate(&sizes, &peaks.map(|peak| -1e3 * peak), OF_LOADS).unwrap();
        assert!((mirrored + 1e3 * value).abs() < 1e-6 && (same - 1e3 * half).abs() < 1e-6);
        assert_eq!(estimate(&sizes, &[0.0; 4], OF_LOADS), Some([0.0; 2]));
        assert_eq!(estimate(&sizes[..1], &peaks[..1], OF_LOADS), None);
        // What does not depend on the mesh has no bar.
        let [value, half] = estimate(&sizes, &[3.0; 4], OF_OTHERS).unwrap();
        assert!((value - 3.0).abs() < 1e-12 && half < 1e-9, "{value} {half}");
    }

    #[test]
    fn lines_tell_more_than_damage_and_their_scatter_lengthens_the_bar() {
        let [value, half] = of_lines(&[100.4, 100.4]).unwrap();
        // Two lines alike: four fifths of the known variance of one, and Student's factor for five degrees of freedom.
        let exact = 100.4 * 2.015 * (0.8 * 0.004f64.powi(2) / 2.0 + 0.006f64.powi(2)).sqrt();
        assert!((value - 100.0).abs() < 1e-12 && (half / exact - 1.0).abs() < 0.003, "{value} {half} {exact}");
        assert_eq!(of_lines(&[-100.4e3, -100.4e3]).map(|own| own.map(f64::abs)), Some([1e3 * value, 1e3 * half]));
        let [_, wide] = of_lines(&[98.4, 102.4]).unwrap();
        let [_, sure] = of_lines(&[100.4; 8]).unwrap();
        assert!(wide > 1.5 * half && sure < 0.95 * half, "{wide} {sure}");
        assert_eq!(of_lines(&[100.0]), None);
        assert_eq!(of_lines(&[]), None);
    }

    /// Random lines about what is known: nine of ten bars hold the truth.
    #[test]
    fn bars_hold_the_truth_as_often_as_they_say() {
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        // The sum of twelve is nearly normal.
        let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let sizes = [0.1, 0.1, 0.05, 0.05, 0.025, 0.025];
        let mut held = 0;
        let Known { slope: [mean, spread], left: [left, its_spread], scatter, .. } = OF_LOADS;
        for _ in 0..2000 {
            let (slope, left) = (mean + spread * normal(), left + its_spread * normal());
            let peaks = sizes.map(|h| 1.0 + left + slope * h + scatter * h * normal());
            let [value, half] = estimate(&sizes, &peaks, OF_LOADS).unwrap();
            held += usize::from((value - 1.0).abs() <= half);
        }
        assert!((0.88..0.96).contains(&(f64::from(held as u32) / 2000.0)), "{held} of 2000");
    }
}
