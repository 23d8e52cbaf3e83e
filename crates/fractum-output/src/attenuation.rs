//! Peak particle velocity against scaled distance: `ppv.csv`, and the power law through it.

use std::fmt::Write as _;

use fractum_math::elementary::{exp, ln};
use serde::{Deserialize, Serialize};

use crate::number::{or_null, push_shortest};

/// Largest velocities at stations of one hole, and their power law v = K s^-b by least squares of the logarithms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Attenuation {
    /// Name of the stations.
    pub name: String,
    /// Unit of the scaled distance s; `-` for radii of the hole.
    pub unit: String,
    /// Velocity K at the scaled distance 1 [m/s]; not a number with fewer than two stations that have moved.
    #[serde(with = "or_null")]
    pub intercept: f64,
    /// Exponent b [-], positive where the velocity falls with distance.
    #[serde(with = "or_null")]
    pub exponent: f64,
    /// Coefficient of determination of the straight line through the logarithms [-].
    #[serde(with = "or_null")]
    pub r_squared: f64,
    /// The stations, nearest first.
    pub stations: Vec<Station>,
}

/// Largest velocity at one station.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Station {
    /// Place without load [m].
    pub place: [f64; 3],
    /// Distance from the hole [m].
    pub distance: f64,
    /// Distance in the unit of the table.
    pub scaled_distance: f64,
    /// Largest magnitude of velocity [m/s].
    pub velocity: f64,
    /// When it was reached [s].
    pub time: f64,
}

/// Part of a run after which the largest velocity of a station is not known to be its peak: the wave has not passed.
const LATE: f64 = 0.99;

impl Station {
    /// Whether its velocity was still growing as the run ended.
    ///
    /// - `end`: when that was [s]
    pub fn is_late(&self, end: f64) -> bool {
        self.velocity > 0.0 && self.time > LATE * end
    }
}

impl Attenuation {
    /// The law of these stations, without those at rest and those whose velocity was still growing at the `end` [s].
    pub fn new(name: &str, unit: &str, stations: Vec<Station>, end: f64) -> Self {
        let counts = |of: &&Station| of.velocity > 0.0 && of.scaled_distance > 0.0 && !of.is_late(end);
        let moved = stations.iter().filter(counts);
        let points: Vec<[f64; 2]> = moved.map(|station| [ln(station.scaled_distance), ln(station.velocity)]).collect();
        let line = line_through(&points);
        Attenuation {
            name: name.into(),
            unit: unit.into(),
            intercept: exp(line.intercept),
            exponent: -line.slope,
            r_squared: line.r_squared,
            stations,
        }
    }

    /// Velocity of the law at a scaled distance [m/s].
    pub fn velocity(&self, scaled_distance: f64) -> f64 {
        self.intercept * exp(-self.exponent * ln(scaled_distance))
    }
}

/// The straight line of least squares through points.
pub(crate) struct Line {
    pub(crate) slope: f64,
    pub(crate) intercept: f64,
    /// Coefficient of determination [-].
    r_squared: f64,
}

/// The straight line of least squares through `points`; not a number for fewer than two abscissae.
pub(crate) fn line_through(points: &[[f64; 2]]) -> Line {
    let count = points.len() as f64;
    let mean = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
    let moment =
        |a: usize, b: usize| -> f64 { points.iter().map(|point| (point[a] - mean[a]) * (point[b] - mean[b])).sum() };
    let slope = moment(0, 1) / moment(0, 0);
    let r_squared = moment(0, 1) * moment(0, 1) / (moment(0, 0) * moment(1, 1));
    Line { slope, intercept: mean[1] - slope * mean[0], r_squared }
}

/// The text of `ppv.csv`: a line per station.
pub fn to_csv(lines: &[Attenuation]) -> String {
    let mut text = String::from(
        "name,x [m],y [m],z [m],distance [m],scaled_distance,unit of scaled_distance,ppv [m/s],time [s],law [m/s]\n",
    );
    for line in lines {
        for station in &line.stations {
            let Station { place, distance, scaled_distance, velocity, time } = station;
            let _ = write!(text, "\"{}\"", line.name.replace('"', "\"\""));
            for value in place.iter().chain([distance, scaled_distance]) {
                text.push(',');
                push_shortest(&mut text, *value);
            }
            let _ = write!(text, ",{}", line.unit);
            for value in [*velocity, *time, line.velocity(*scaled_distance)] {
                text.push(',');
                push_shortest(&mut text, value);
            }
            text.push('\n');
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stations(velocity: impl Fn(f64) -> f64) -> Vec<Station> {
        let station = |i: u32| {
            let distance = 2f64.powi(i as i32);
            Station { distance, scaled_distance: distance, velocity: velocity(distance), ..Station::default() }
        };
        (0..6).map(station).collect()
    }

    #[test]
    fn a_power_law_is_found_again() {
        let law = Attenuation::new("east", "-", stations(|s| 3.5 * s.powf(-1.6)), 1.0);
        assert!((law.intercept / 3.5 - 1.0).abs() < 1e-12 && (law.exponent - 1.6).abs() < 1e-12, "{law:?}");
        assert!((law.r_squared - 1.0).abs() < 1e-12 && (law.velocity(4.0) / 3.5 / 4f64.powf(-1.6) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn stations_that_rest_are_left_out_and_too_few_make_no_law() {
        let law = Attenuation::new("east", "-", stations(|s| if s > 8.0 { 0.0 } else { 1.0 / s }), 1.0);
        assert!((law.exponent - 1.0).abs() < 1e-12);
        assert!(Attenuation::new("east", "-", stations(|_| 0.0), 1.0).exponent.is_nan());
        assert!(Attenuation::new("east", "-", stations(|s| if s > 1.0 { 0.0 } else { 1.0 }), 1.0).exponent.is_nan());
    }

    #[test]
    fn stations_that_the_wave_has_not_passed_are_left_out() {
        let mut all = stations(|s| 3.5 * s.powf(-1.6));
        (all[5].velocity, all[5].time) = (1e-3, 1.0);
        assert!(all[5].is_late(1.0) && !all[4].is_late(1.0));
        let law = Attenuation::new("east", "-", all, 1.0);
        assert!((law.exponent - 1.6).abs() < 1e-12 && law.stations.len() == 6, "{law:?}");
    }

    #[test]
    fn every_line_has_the_columns_of_the_header() {
        let text = to_csv(&[Attenuation::new("east", "m/kg^(1/2)", stations(|s| 1.0 / s), 1.0)]);
        assert_eq!(text.lines().count(), 7);
        assert!(text.lines().all(|line| line.split(',').count() == 10), "{text}");
        assert!(text.lines().nth(2).unwrap().starts_with("\"east\",0,0,0,2,2,m/kg^(1/2),0.5,0,"));
    }
}
