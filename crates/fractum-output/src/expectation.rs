//! What a case expects of a run, and whether it came out so: the lines under `expect` in `summary.json`.

use serde::{Deserialize, Serialize};

use crate::number::{or_null, percent, quantity};

/// What a value is held against, in SI.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// A value and how far from it, in the same unit (a relative tolerance is already multiplied out).
    Near {
        /// Reference value.
        value: f64,
        /// Largest difference, > 0.
        tolerance: f64,
        /// The tolerance as a fraction of the reference, where it was given so.
        relative: Option<f64>,
    },
    /// Between limits; at least one is there.
    Between {
        /// Lower limit.
        above: Option<f64>,
        /// Upper limit.
        below: Option<f64>,
    },
}

/// How a value is held against its reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Comparison {
    /// Error and tolerance are fractions of the reference.
    #[default]
    Relative,
    /// Error and tolerance have the unit of the reference.
    Absolute,
    /// The reference is an upper limit.
    Below,
    /// The reference is a lower limit.
    Above,
    /// The reference is the middle between two limits, which are the tolerance away.
    Between,
    /// There is no reference: the value is one of many runs that are compared with each other.
    Nothing,
}

/// One `[[expect]]` of the case against the run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Expectation {
    /// Name of the probe.
    pub quantity: String,
    /// Unit of value and reference.
    pub unit: String,
    /// What came out.
    #[serde(with = "or_null")]
    pub value: f64,
    /// What was expected.
    #[serde(with = "or_null")]
    pub reference: f64,
    /// What error and tolerance mean.
    #[serde(default)]
    pub comparison: Comparison,
    /// (value - reference) / |reference|, or value - reference; beyond limits how far, within them zero.
    #[serde(with = "or_null")]
    pub error: f64,
    /// Largest |error| that passes.
    #[serde(with = "or_null")]
    pub tolerance: f64,
    /// Whether it came out as expected; never for NaN.
    pub pass: bool,
    /// Where the reference is from.
    pub source: String,
}

impl Expectation {
    /// Holds `value` against `bound`, both in SI; `unit` is for the eye.
    pub fn hold(name: &str, unit: &str, value: f64, bound: Bound, source: &str) -> Self {
        let (comparison, reference, error, tolerance) = match bound {
            Bound::Near { value: reference, relative: Some(tolerance), .. } => {
                (Comparison::Relative, reference, (value - reference) / reference.abs(), tolerance)
            }
            Bound::Near { value: reference, tolerance, relative: None } => {
                (Comparison::Absolute, reference, value - reference, tolerance)
            }
            Bound::Between { above: Some(above), below: Some(below) } => {
                let (middle, half) = (f64::midpoint(above, below), 0.5 * (below - above));
                (Comparison::Between, middle, beyond(value, above, below), half)
            }
            Bound::Between { above: Some(above), below: None } => {
                (Comparison::Above, above, beyond(value, above, f64::INFINITY), 0.0)
            }
            Bound::Between { above: None, below } => {
                let below = below.unwrap_or(f64::NAN);
                (Comparison::Below, below, beyond(value, f64::NEG_INFINITY, below), 0.0)
            }
        };
        let pass = match comparison {
            Comparison::Relative | Comparison::Absolute => error.abs() <= tolerance,
            Comparison::Below | Comparison::Above | Comparison::Between | Comparison::Nothing => error == 0.0,
        };
        Self {
            quantity: name.into(),
            unit: unit.into(),
            value,
            reference,
            comparison,
            error,
            tolerance,
            // A value that is not a number passes nothing.
            pass: pass && value.is_finite(),
            source: source.into(),
        }
    }

    /// A value that has no reference.
    pub fn without_reference(name: &str, unit: &str, value: f64) -> Self {
        let nothing = f64::NAN;
        Self {
            quantity: name.into(),
            unit: unit.into(),
            value,
            reference: nothing,
            comparison: Comparison::Nothing,
            error: nothing,
            tolerance: nothing,
            pass: true,
            source: String::new(),
        }
    }

    /// What was asked for, in words: `50 MPa ± 5 %`, `below 0.001`.
    pub fn required(&self) -> String {
        let Expectation { reference, tolerance, .. } = *self;
        let shown = |value| quantity(value, &self.unit);
        match self.comparison {
            Comparison::Relative => format!("{} ± {}", shown(reference), percent(tolerance)),
            Comparison::Absolute => format!("{} ± {}", shown(reference), shown(tolerance)),
            Comparison::Below => format!("below {}", shown(reference)),
            Comparison::Above => format!("above {}", shown(reference)),
            Comparison::Between => format!("{} to {}", shown(reference - tolerance), shown(reference + tolerance)),
            Comparison::Nothing => String::new(),
        }
    }

    /// The error in words: a share or a quantity; nothing within limits.
    pub fn off(&self) -> String {
        match self.comparison {
            Comparison::Relative => percent(self.error),
            Comparison::Below | Comparison::Above | Comparison::Between if self.error == 0.0 => String::new(),
            Comparison::Nothing => String::new(),
            _ => quantity(self.error, &self.unit),
        }
    }
}

/// How far `value` lies outside two limits, negative below them; NaN stays NaN.
fn beyond(value: f64, above: f64, below: f64) -> f64 {
    if value > below {
        value - below
    } else if value < above {
        value - above
    } else {
        value * 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(value: f64, relative: Option<f64>, tolerance: f64) -> Bound {
        Bound::Near { value, tolerance, relative }
    }

    #[test]
    fn a_value_passes_within_its_tolerance_only() {
        let hold = |value, bound| Expectation::hold("q", "Pa", value, bound, "");
        let five = |reference| near(reference, Some(0.05), f64::NAN);
        assert!(hold(10.5, five(10.0)).pass && hold(-10.5, five(-10.0)).pass);
        assert!(!hold(10.51, five(10.0)).pass && !hold(f64::NAN, five(10.0)).pass);
        assert_eq!(hold(-11.0, five(-10.0)).error, -0.1);
        let zero = near(0.0, None, 0.05);
        assert!(hold(0.04, zero).pass && !hold(0.06, zero).pass);
        for (above, below, good, bad) in [
            (None, Some(1.0), vec![-5.0, 1.0], vec![1.1, f64::NAN, f64::INFINITY]),
            (Some(1.0), None, vec![1.0, 7.0], vec![0.9, f64::NAN, f64::INFINITY]),
            (Some(1.0), Some(2.0), vec![1.0, 1.5, 2.0], vec![0.9, 2.1, f64::NAN]),
        ] {
            let bound = Bound::Between { above, below };
            assert!(good.into_iter().all(|value| hold(value, bound).pass), "{bound:?}");
            assert!(bad.into_iter().all(|value| !hold(value, bound).pass), "{bound:?}");
        }
    }

    #[test]
    fn what_was_asked_for_is_said_in_its_own_terms() {
        let said = |value, unit, bound| {
            let line = Expectation::hold("q", unit, value, bound, "");
            (line.required(), line.off())
        };
        let pair = |a: &str, b: &str| (a.to_string(), b.to_string());
        assert_eq!(said(49e6, "Pa", near(50e6, Some(0.05), 2.5e6)), pair("50 MPa ± 5 %", "-2 %"));
        // An angle of 3 degrees off is 3 degrees off, not some per cent.
        assert_eq!(said(42.0, "deg", near(45.0, None, 5.0)), pair("45 deg ± 5 deg", "-3 deg"));
        assert_eq!(said(2e-4, "", Bound::Between { above: None, below: Some(1e-3) }), pair("below 0.001", ""));
        assert_eq!(said(90.0, "", Bound::Between { above: Some(100.0), below: None }), pair("above 100", "-10"));
        assert_eq!(said(31.0, "", Bound::Between { above: Some(10.0), below: Some(30.0) }), pair("10 to 30", "1"));
    }
}
