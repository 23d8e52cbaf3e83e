//! Where the ticks of an axis are and what they say.

use fractum_math::elementary::log10;
use fractum_output::number::{Prefixed, grouped, prefixed};

/// What an axis shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Name of the quantity.
    pub label: String,
    /// Its SI unit, `-` for a pure number; the axis shows it with the prefix that suits.
    pub unit: String,
    /// Whether the axis is logarithmic; values that are not positive are then left out.
    pub logarithmic: bool,
    /// Whether zero must be on the axis.
    pub from_zero: bool,
}

impl Axis {
    /// A linear axis.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), ..Self::default() }
    }

    /// The same with zero on it.
    pub fn from_zero(self) -> Self {
        Self { from_zero: true, ..self }
    }

    /// The same, logarithmic.
    pub fn logarithmic(self) -> Self {
        Self { logarithmic: true, ..self }
    }

    /// Whether a value has a place on the axis.
    pub(super) fn shows(&self, value: f64) -> bool {
        value.is_finite() && (!self.logarithmic || value > 0.0)
    }
}

/// An axis that knows its range and its length on paper.
pub(super) struct Scale {
    low: f64,
    high: f64,
    logarithmic: bool,
    pub(super) prefix: Prefixed,
    /// Pixels of `low` and `high`.
    ends: [f64; 2],
    pub(super) ticks: Vec<Tick>,
}

pub(super) struct Tick {
    pub(super) value: f64,
    pub(super) label: String,
}

impl Scale {
    /// The scale for `values` on `axis`, with some `count` ticks; `pad` is the share left free beyond the values.
    pub(super) fn new(axis: &Axis, values: impl Iterator<Item = f64>, ends: [f64; 2], count: usize, pad: f64) -> Self {
        let (mut low, mut high) = values
            .filter(|&value| axis.shows(value))
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
        if low > high {
            (low, high) = if axis.logarithmic { (1.0, 10.0) } else { (0.0, 1.0) };
        }
        if axis.logarithmic {
            return Self::logarithmic(axis, low, high, ends);
        }
        if axis.from_zero {
            (low, high) = (low.min(0.0), high.max(0.0));
        }
        if low == high {
            let room = if low == 0.0 { 1.0 } else { 0.1 * low.abs() };
            (low, high) = (low - room, high + room);
        } else {
            // Zero stays the end where it is one.
            let room = pad * (high - low);
            low -= if low == 0.0 { 0.0 } else { room };
            high += if high == 0.0 { 0.0 } else { room };
        }
        let prefix = prefixed(low.abs().max(high.abs()), &axis.unit);
        let ticks = linear_ticks(low / prefix.factor, high / prefix.factor, count)
            .into_iter()
            .map(|(value, label)| Tick { value: value * prefix.factor, label })
            .collect();
        Self { low, high, logarithmic: false, prefix, ends, ticks }
    }

    fn logarithmic(axis: &Axis, low: f64, high: f64, ends: [f64; 2]) -> Self {
        if high < 60.0 * low {
            return Self::narrow_logarithmic(axis, low, high, ends);
        }
        let decades = (log10(low).floor() as i32, (log10(high).ceil() as i32).max(log10(low).floor() as i32 + 1));
        let prefix = prefixed(high, &axis.unit);
        let step = ((decades.1 - decades.0) / 8 + 1) as usize;
        let ticks = (decades.0..=decades.1).step_by(step).map(|decade| {
            let value = 10f64.powi(decade);
            Tick { value, label: fractum_output::number::significant(value / prefix.factor, 3) }
        });
        let ticks = ticks.collect();
        let (low, high) = (10f64.powi(decades.0), 10f64.powi(decades.1));
        Self { low, high, logarithmic: true, prefix, ends, ticks }
    }

    /// Less than two decades: ticks at 1, 2 and 5 times powers of ten.
    fn narrow_logarithmic(axis: &Axis, low: f64, high: f64, ends: [f64; 2]) -> Self {
        let prefix = prefixed(high, &axis.unit);
        let first = log10(low).floor() as i32;
        let round = (first..first + 4).flat_map(|decade| [1.0, 2.0, 5.0].map(|factor| factor * 10f64.powi(decade)));
        let round: Vec<f64> = round.collect();
        let from = round.iter().rposition(|&tick| tick <= low * 1.000_001).unwrap_or(0);
        let to = round.iter().position(|&tick| tick >= high * 0.999_999).unwrap_or(round.len() - 1).max(from + 1);
        let label = |value: f64| fractum_output::number::significant(value / prefix.factor, 3);
        let ticks = round[from..=to].iter().map(|&value| Tick { value, label: label(value) }).collect();
        Self { low: round[from], high: round[to], logarithmic: true, prefix, ends, ticks }
    }

    /// Where `value` is on paper [pixels].
    pub(super) fn place(&self, value: f64) -> f64 {
        let share = if self.logarithmic {
            log10(value / self.low) / log10(self.high / self.low)
        } else {
            (value - self.low) / (self.high - self.low)
        };
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    /// Whether `value` is between the ends.
    pub(super) fn contains(&self, value: f64) -> bool {
        value >= self.low && value <= self.high
    }
}

/// Decimals of a tick that fit beside an axis.
const MOST_DECIMALS: usize = 4;

/// Ticks at multiples of 1, 2 or 5 times a power of ten, with as many decimals as they need.
pub(crate) fn linear_ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let rough = (high - low) / count.max(1) as f64;
    let exponent = log10(rough).floor() as i32;
    // Powers as quotients where possible: 0.1 is 1/10, not an inexact product.
    let unit = |factor: f64| if exponent < 0 { factor / 10f64.powi(-exponent) } else { factor * 10f64.powi(exponent) };
    let Some(step) = [1.0, 2.0, 5.0, 10.0].map(unit).into_iter().find(|&step| step >= rough * 0.999_999) else {
        return Vec::new();
    };
    let decimals = (-(log10(step) + 1e-9).floor()).max(0.0) as usize;
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    // A range far from zero and narrow beyond the digits of a double has no sensible ticks.
    if last - first > 4 * count as i64 + 4 {
        return Vec::new();
    }
    (first..=last)
        .map(|multiple| {
            let value = multiple as f64 * step;
            let label = if multiple == 0 {
                "0".into()
            } else if decimals > MOST_DECIMALS || value.abs() >= 1e7 {
                fractum_output::number::significant(value, 6)
            } else {
                grouped(&format!("{value:.decimals$}"))
            };
            (value, label)
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(axis: &Axis, values: &[f64]) -> Vec<String> {
        let scale = Scale::new(axis, values.iter().copied(), [0.0, 100.0], 5, 0.0);
        scale.ticks.into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn ticks_are_round_numbers_in_the_prefixed_unit() {
        assert_eq!(labels(&Axis::new("load", "N"), &[0.0, 25_000.0]), ["0", "5", "10", "15", "20", "25"]);
        assert_eq!(labels(&Axis::new("time", "s"), &[0.0, 1e-3]), ["0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(labels(&Axis::new("edges", "-"), &[0.0, 19_000.0])[1..3], ["5000", "10\u{202f}000"]);
        assert_eq!(labels(&Axis::new("u", "m"), &[-0.003, 0.003]), ["-2", "0", "2"]);
        // An area takes no prefix.
        assert_eq!(labels(&Axis::new("cracks", "m^2"), &[0.0, 4e-6])[1..3], ["1e-6", "2e-6"]);
    }

    #[test]
    fn a_logarithmic_axis_has_its_decades() {
        let axis = Axis::new("size", "m").logarithmic();
        assert_eq!(labels(&axis, &[-1.0, 0.0, 0.0004, 0.05]), ["0.1", "1", "10", "100"]);
        assert_eq!(labels(&axis, &[0.003, 0.04]), ["2", "5", "10", "20", "50"]);
        assert_eq!(labels(&axis, &[0.01]), ["10", "20"]);
    }

    #[test]
    fn a_single_value_or_none_still_makes_a_scale() {
        for values in [&[][..], &[0.0], &[-7.5], &[f64::NAN]] {
            let scale = Scale::new(&Axis::new("q", "Pa"), values.iter().copied(), [0.0, 100.0], 5, 0.05);
            assert!(
                !scale.ticks.is_empty()
                    && scale.place(values.first().copied().unwrap_or(0.0)).is_nan()
                        == values.iter().any(|v| v.is_nan())
            );
        }
    }

    proptest! {
        #[test]
        fn ticks_lie_on_the_axis_and_are_few(low in -1e9f64..1e9, extent in 1e-6f64..1e9) {
            let scale = Scale::new(&Axis::new("q", "Pa"), [low, low + extent].into_iter(), [10.0, 310.0], 5, 0.05);
            prop_assert!(scale.ticks.len() <= 12);
            for tick in &scale.ticks {
                prop_assert!((9.0..=311.0).contains(&scale.place(tick.value)), "{}", tick.label);
            }
        }
    }
}
