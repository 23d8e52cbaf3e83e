//! Numbers as people and programs read them: shortest text that reads back to the same bits, and quantities with the
//! engineering prefix that suits their size.

use std::fmt::Write;

/// Appends the shortest text that reads back as exactly `value`: `0.1`, `3`, `1e-7`, `NaN`, `inf`.
pub fn push_shortest(text: &mut String, value: f64) {
    // Debug, unlike Display, changes to an exponent for large and small values. Writing to a String cannot fail.
    let _ = write!(text, "{value:?}");
    if text.ends_with(".0") {
        text.truncate(text.len() - 2);
    }
}

/// A unit with the prefix that suits a range of values: `value / factor` is read in `unit`.
#[derive(Clone, Debug, PartialEq)]
pub struct Prefixed {
    /// What one of `unit` is in the original unit.
    pub factor: f64,
    /// The unit with its prefix, written for reading: `kPa`, `mm/s`, `J/m²`; empty for a pure number.
    pub unit: String,
}

/// The prefix for values up to `largest` in absolute value, given in `unit` (SI, as `Pa`, `m/s`, `J/m^2`, `-`).
///
/// A unit whose first factor takes no prefix (already prefixed, a power, a pure number) is left as it is.
pub fn prefixed(largest: f64, unit: &str) -> Prefixed {
    const PREFIXES: [(i32, &str); 9] =
        [(-12, "p"), (-9, "n"), (-6, "µ"), (-3, "m"), (0, ""), (3, "k"), (6, "M"), (9, "G"), (12, "T")];
    let plain = || Prefixed { factor: 1.0, unit: readable_unit(unit) };
    if !(largest.is_finite() && largest > 0.0) {
        return plain();
    }
    let end = unit.find(['/', '*', '·', ' ']).unwrap_or(unit.len());
    let (first, rest) = unit.split_at(end);
    // The kilogram is the one base unit that bears a prefix already; time and mass stop at the second and kilogram.
    let (symbol, offset, highest) = match first {
        "Pa" | "N" | "J" | "W" | "Hz" | "V" | "A" => (first, 0, 12),
        "m" => ("m", 0, 3),
        "s" => ("s", 0, 0),
        "kg" => ("g", 3, 3),
        _ => return plain(),
    };
    let size = |exponent: i32| 10f64.powi(exponent - offset);
    // 0.9999 kN reads better than 999.9 N; half a unit in the fourth digit decides.
    let suits = |&&(exponent, _): &&(i32, &str)| exponent <= highest && largest >= 0.99995 * size(exponent);
    let &(exponent, prefix) = PREFIXES.iter().rev().find(suits).unwrap_or(&PREFIXES[0]);
    Prefixed { factor: size(exponent), unit: readable_unit(&format!("{prefix}{symbol}{rest}")) }
}

/// The unit in which people read a quantity, and its size in the SI unit: angles in degrees, all others in SI.
pub fn reading_unit(unit: &str) -> (&str, f64) {
    match unit {
        "rad" => ("deg", 1f64.to_radians()),
        "rad/s" => ("deg/s", 1f64.to_radians()),
        other => (other, 1.0),
    }
}

/// `value` with its prefixed unit and four significant digits: `10.24 kPa`, `0.05`, `-3.2 mm/s`, `n/a` for NaN; angles in
/// degrees.
pub fn quantity(value: f64, unit: &str) -> String {
    let (unit, size) = reading_unit(unit);
    let value = value / size;
    let prefixed = prefixed(value.abs(), unit);
    let number = significant(value / prefixed.factor, 4);
    if prefixed.unit.is_empty() || value.is_nan() { number } else { format!("{number} {}", prefixed.unit) }
}

/// An instant in words: `load factor 0.5` at rest, `12 ms` in motion.
pub fn instant_text(time: f64, at_rest: bool) -> String {
    if at_rest && time.is_finite() { format!("load factor {}", significant(time, 4)) } else { quantity(time, "s") }
}

/// The number of a natural vibration, which stands for an instant in a run that looks for these: `mode 3`.
pub fn mode_text(number: f64) -> String {
    format!("mode {}", significant(number, 6))
}

/// As [`instant_text`], where a bare time would not say what it is: `t = 5 ms`.
pub fn at_instant(time: f64, at_rest: bool) -> String {
    format!("{}{}", if at_rest { "" } else { "t = " }, instant_text(time, at_rest))
}

/// A share in per cent with three significant digits: `5 %`.
pub fn percent(share: f64) -> String {
    format!("{} %", significant(100.0 * share, 3))
}

/// `value` with `digits` significant digits at most, no trailing zeros, and an exponent where it is shorter.
pub fn significant(value: f64, digits: usize) -> String {
    if value.is_nan() {
        return "n/a".into();
    }
    if value.is_infinite() {
        return if value > 0.0 { "∞" } else { "-∞" }.into();
    }
    if value == 0.0 {
        return "0".into();
    }
    // Rounded once, in decimal: the exponent is that of the rounded number.
    let rounded = format!("{value:.*e}", digits.saturating_sub(1));
    let Some((mantissa, exponent)) = rounded.split_once('e') else { return rounded };
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-3..=5).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        without_trailing_zeros(&format!("{value:.decimals$}")).to_string()
    } else {
        format!("{}e{exponent}", without_trailing_zeros(mantissa))
    }
}

/// A unit as it is printed in books: `m^3` → `m³`, `N*m` → `N·m`, `-` → nothing.
pub fn readable_unit(unit: &str) -> String {
    if unit == "-" || unit == "1" {
        return String::new();
    }
    unit.replace("^2", "²").replace("^3", "³").replace("^4", "⁴").replace("^-1", "⁻¹").replace('*', "·")
}

/// `12345` as `12 345`, with a narrow space that does not break.
pub fn grouped(number: &str) -> String {
    let digits = number.trim_start_matches('-');
    if digits.len() < 5 || digits.contains('.') {
        return number.to_string();
    }
    let mut text = String::from(&number[..number.len() - digits.len()]);
    for (index, digit) in digits.chars().enumerate() {
        if index > 0 && (digits.len() - index).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

fn without_trailing_zeros(text: &str) -> &str {
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { text }
}

/// A number that JSON may lack: `null` stands for NaN and the infinities, and reads back as NaN.
pub(crate) mod or_null {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(crate) fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        if value.is_finite() { serializer.serialize_f64(*value) } else { serializer.serialize_none() }
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(deserializer)?.unwrap_or(f64::NAN))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn shortest(value: f64) -> String {
        let mut text = String::new();
        push_shortest(&mut text, value);
        text
    }

    proptest! {
        #[test]
        fn shortest_text_reads_back_to_the_same_bits(bits: u64) {
            let value = f64::from_bits(bits);
            let back: f64 = shortest(value).parse().unwrap();
            prop_assert!(back.to_bits() == value.to_bits() || (back.is_nan() && value.is_nan()));
        }

        #[test]
        fn a_quantity_stays_within_half_a_unit_of_its_fourth_digit(mantissa in 1.0f64..10.0, exponent in -20i32..20) {
            let value = mantissa * 10f64.powi(exponent);
            let text = quantity(value, "Pa");
            let number: f64 = text.split(' ').next().unwrap().parse().unwrap();
            let back = number * prefixed(value, "Pa").factor;
            prop_assert!((back - value).abs() <= 0.500001e-3 * 10f64.powi(exponent), "{} {}", value, text);
        }
    }

    #[test]
    fn shortest_text_is_plain_where_plain_is_short() {
        assert_eq!(
            ["0.1", "3", "1e-7", "-0", "2.5e20", "NaN", "inf"].map(|t| shortest(t.parse().unwrap())),
            ["0.1", "3", "1e-7", "-0", "2.5e20", "NaN", "inf"]
        );
    }

    #[test]
    fn large_counts_are_grouped_by_thousands() {
        assert_eq!(
            ["9999", "12345", "-1234567", "12345.5"].map(grouped),
            ["9999", "12\u{202f}345", "-1\u{202f}234\u{202f}567", "12345.5"]
        );
    }

    #[test]
    fn quantities_take_the_prefix_of_their_size() {
        let cases = [
            (10_241.3, "Pa", "10.24 kPa"),
            (21e9, "Pa", "21 GPa"),
            (999.96, "N", "1 kN"),
            (-0.0032, "m/s", "-3.2 mm/s"),
            (1.84e-4, "s", "184 µs"),
            (1200.0, "s", "1200 s"),
            (0.0125, "kg", "12.5 g"),
            (3.2e4, "kg", "32000 kg"),
            (3.2e7, "kg", "3.2e7 kg"),
            (1.0e-3, "J/m^2", "1 mJ/m²"),
            (1.2e-4, "m^3", "1.2e-4 m³"),
            (31_416.0, "N*m", "31.42 kN·m"),
            (0.05, "-", "0.05"),
            (12_345.6, "-", "12346"),
            (0.0, "Pa", "0 Pa"),
            (f64::NAN, "Pa", "n/a"),
            (5.0, "kN", "5 kN"),
            (std::f64::consts::FRAC_PI_4, "rad", "45 deg"),
            (std::f64::consts::PI, "rad/s", "180 deg/s"),
        ];
        for (value, unit, text) in cases {
            assert_eq!(quantity(value, unit), text);
        }
    }
}
