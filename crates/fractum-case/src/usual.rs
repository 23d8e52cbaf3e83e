//! Values that solids have: what lies far beyond them was probably meant in another unit.

use fractum_output::number::{push_shortest, quantity};
use fractum_output::warning::Code;

use super::tree::{Node, Value};
use super::{Diagnostic, Place};

/// What values of a quantity are usual.
pub(super) struct Usual {
    /// SI unit.
    unit: &'static str,
    /// Values that no real solid is beyond [SI].
    range: (f64, f64),
    /// The same in words.
    words: &'static str,
    /// Values that most solids have [SI]: a number in another unit should give one of them.
    common: (f64, f64),
    /// Units that are tried for the number, with their sizes [SI].
    units: &'static [(&'static str, f64)],
}

/// Young's modulus [Pa].
pub(super) const YOUNG_MODULUS: Usual = of_stress(
    (1e5, 1e13),
    "100 kPa to 10 TPa (rubber has 1 MPa, concrete 30 GPa, diamond 1.2 TPa)",
    (1e7, 1.3e12),
    &[("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3), ("Pa", 1.0)],
);

/// Strength in tension, compression or shear [Pa].
pub(super) const STRENGTH: Usual = of_stress(
    (1e3, 1e11),
    "1 kPa to 100 GPa (concrete has 3 MPa in tension, granite 10 MPa, steel 500 MPa)",
    (1e5, 5e9),
    &[("MPa", 1e6), ("kPa", 1e3), ("GPa", 1e9), ("Pa", 1.0)],
);

/// A modulus or a strength; the most common of its units is the first.
const fn of_stress(
    range: (f64, f64),
    words: &'static str,
    common: (f64, f64),
    units: &'static [(&'static str, f64)],
) -> Usual {
    Usual { unit: "Pa", range, words, common, units }
}

/// Mass density [kg/m³].
pub(super) const DENSITY: Usual = Usual {
    unit: "kg/m^3",
    range: (5.0, 3e4),
    words: "5 to 30000 kg/m^3 (foam has 30, rock 2700, steel 7850)",
    common: (200.0, 2.3e4),
    units: &[("g/cm^3", 1e3), ("kg/m^3", 1.0), ("t/mm^3", 1e12)],
};

/// Fracture energy [J/m²].
pub(super) const FRACTURE_ENERGY: Usual = Usual {
    unit: "J/m^2",
    range: (1e-4, 1e7),
    words: "0.1 mJ/m^2 to 10 MJ/m^2 (glass has 8 J/m^2, concrete 100 J/m^2)",
    common: FRACTURE_ENERGIES,
    units: ENERGIES,
};
/// Longest process zone E G_f/f_t² of a solid [m]: a longer one tells a wrong unit.
pub(crate) const LONGEST_ZONE: f64 = 100.0;
/// Lengths of the process zone E G_f/f_t² of solids [m]: ceramics have 0.1 mm, concrete 0.3 m.
pub const PROCESS_ZONES: std::ops::RangeInclusive<f64> = 1e-6..=LONGEST_ZONE;
const FRACTURE_ENERGIES: (f64, f64) = (1.0, 1e6);
const ENERGIES: &[(&str, f64)] = &[("J/m^2", 1.0), ("N/mm", 1e3), ("kJ/m^2", 1e3)];

/// Heat capacity per mass [J/(kg K)].
pub(super) const HEAT_CAPACITY: Usual = Usual {
    unit: "J/(kg K)",
    range: (20.0, 2e4),
    words: "20 J/(kg K) to 20 kJ/(kg K) (lead has 130, rock 800, water 4200 J/(kg K))",
    common: (100.0, 5e3),
    units: &[("J/(kg K)", 1.0), ("kJ/(kg K)", 1e3)],
};

/// Linear thermal expansion [1/K].
pub(super) const EXPANSION: Usual = Usual {
    unit: "1/K",
    range: (-1e-4, 1e-3),
    words: "-1e-4 to 1e-3 1/K (glass has 9e-6, rock 8e-6, steel 12e-6, rubber 2e-4 1/K)",
    common: (1e-7, 3e-4),
    units: &[],
};

/// Velocity of detonation [m/s].
pub(super) const DETONATION: Usual = Usual {
    unit: "m/s",
    range: (300.0, 1.2e4),
    words: "300 m/s to 12 km/s (black powder has 500 m/s, ANFO 4 km/s, PETN 8 km/s)",
    common: (1e3, 1e4),
    units: &[("km/s", 1e3), ("m/s", 1.0)],
};

/// Gas constant per mass [J/(kg K)].
pub(super) const GAS_CONSTANT: Usual = Usual {
    unit: "J/(kg K)",
    range: (30.0, 1e4),
    words: "30 to 10000 J/(kg K) (air has 287): 8.314 J/(mol K) over the molar mass",
    common: (100.0, 5e3),
    units: &[("J/(kg K)", 1.0), ("kJ/(kg K)", 1e3)],
};

/// Ratio of the heat capacities of a gas [-].
pub(super) const HEAT_RATIO: Usual = Usual {
    unit: "",
    range: (1.01, 5.0),
    words: "1.01 to 5 (air has 1.4, products of detonation 1.25 as a gas and 3 as dense as they are at first)",
    common: (1.01, 5.0),
    units: &[],
};

/// Pressure of gas in a hole [Pa].
pub(super) const GAS_PRESSURE: Usual = of_stress(
    (1e3, 1e11),
    "1 kPa to 100 GPa (air outside has 101 kPa)",
    (1e5, 2e10),
    &[("MPa", 1e6), ("kPa", 1e3), ("GPa", 1e9), ("Pa", 1.0)],
);

/// The doubt about a value [SI] that a key of a material has as `text`, in one line; none of usual ones and of other keys.
pub fn unusual(key: &str, text: &str, value: f64) -> Option<String> {
    let usual = match key {
        "density" => DENSITY,
        "young_modulus" => YOUNG_MODULUS,
        "tensile_strength" | "compressive_strength" => STRENGTH,
        "fracture_energy" => FRACTURE_ENERGY,
        _ => return None,
    };
    let place = Place { file: String::new(), line: 0, column: 0, key: key.to_owned() };
    let node = Node { value: Value::Text(text.to_owned()), place, raw: format!("\"{text}\"") };
    let doubt = usual.doubt(&node, value, None)?;
    Some(format!("{}; expected {}; {}", doubt.found, usual.words, doubt.remedy))
}

impl Usual {
    /// Whether solids have such a value.
    pub(super) fn is_usual(&self, value: f64) -> bool {
        (self.range.0..=self.range.1).contains(&value)
    }

    /// A doubt about the value of a node, unless it is usual, or 0 in any unit.
    ///
    /// - `parameter`: where the value stands if the node names a parameter
    pub(super) fn doubt(&self, node: &Node, value: f64, parameter: Option<Place>) -> Option<Diagnostic> {
        if self.is_usual(value) || value == 0.0 {
            return None;
        }
        let meant = self.meant(node, value);
        let place = parameter.unwrap_or_else(|| node.place.clone());
        let size = quantity(value, self.unit);
        let found = match (place == node.place, self.unit) {
            (true, "") => node.found(),
            (true, _) => format!("{}, which is {size}", node.found()),
            (false, _) => format!("is {size}"),
        };
        let doubt = Diagnostic::warning(Code::UnusualValue, &place, found).expected(self.words);
        Some(match meant {
            Some(meant) => doubt.remedy(format!("did you mean \"{meant}\"?")),
            None if self.unit.is_empty() => doubt,
            None => doubt.remedy("give the number with its unit"),
        })
    }

    /// The number of a node in the unit that makes it common; not in the one that it has.
    pub(super) fn meant(&self, node: &Node, value: f64) -> Option<String> {
        let number = number_of(node).unwrap_or(value);
        let is_own = |size: f64| (number * size - value).abs() <= 1e-9 * value.abs();
        let common = |size: f64| (self.common.0..=self.common.1).contains(&(number * size)) && !is_own(size);
        let (unit, _) = self.units.iter().find(|(_, size)| common(*size))?;
        Some(written(number, unit))
    }
}

/// The fracture energy that a number was meant to be so that it suits the other values of its material.
pub(super) fn energy_meant(node: &Node, suits: impl Fn(f64) -> bool) -> Option<String> {
    let number = number_of(node)?;
    let (low, high) = FRACTURE_ENERGIES;
    let right = |size: f64| (low..=high).contains(&(number * size)) && suits(number * size);
    ENERGIES.iter().find(|(_, size)| right(*size)).map(|(unit, _)| written(number, unit))
}

fn written(number: f64, unit: &str) -> String {
    let mut text = String::new();
    push_shortest(&mut text, number);
    format!("{text} {unit}")
}

/// The number that a value begins with: 2.65 of `"2.65 Pa"`; none of expressions.
fn number_of(node: &Node) -> Option<f64> {
    let text = match &node.value {
        Value::Number(number) => return Some(*number),
        Value::Text(text) => text.trim(),
        _ => return None,
    };
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let plain = unit.chars().all(|c| c.is_alphanumeric() || " /^µ-()".contains(c));
    number.parse().ok().filter(|_| plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meant(usual: &Usual, text: &str, value: f64) -> Option<String> {
        let place = Place { file: "case.toml".into(), line: 1, column: 1, key: "key".into() };
        let node = Node { value: Value::Text(text.into()), place, raw: format!("\"{text}\"") };
        usual.doubt(&node, value, None).map(|doubt| doubt.remedy)
    }

    #[test]
    fn the_unit_that_makes_a_number_common_is_named() {
        let named = |unit: &str| Some(format!("did you mean \"{unit}\"?"));
        assert_eq!(meant(&YOUNG_MODULUS, "50 Pa", 50.0), named("50 GPa"));
        assert_eq!(meant(&YOUNG_MODULUS, "30000 GPa", 3e13), named("30000 MPa"));
        assert_eq!(meant(&STRENGTH, "8 Pa", 8.0), named("8 MPa"));
        assert_eq!(meant(&DENSITY, "2.65 kg/m^3", 2.65), named("2.65 g/cm^3"));
        assert_eq!(meant(&DENSITY, "2.4e-9", 2.4e-9), named("2.4e-9 t/mm^3"));
        assert_eq!(meant(&HEAT_CAPACITY, "0.8 J/(kg K)", 0.8), named("0.8 kJ/(kg K)"));
        assert!(meant(&EXPANSION, "12e-3 1/K", 12e-3).is_some() && meant(&EXPANSION, "-2e-6 1/K", -2e-6).is_none());
        assert_eq!(meant(&YOUNG_MODULUS, "2*E", 50.0), named("50 GPa"));
        assert_eq!(meant(&YOUNG_MODULUS, "21 GPa", 21e9), None);
        let place = Place { file: "case.toml".into(), line: 1, column: 1, key: "density".into() };
        let node = Node { value: Value::Text("2600 kg/m^3".into()), place, raw: "\"2600 kg/m^3\"".into() };
        assert_eq!(DENSITY.meant(&node, 2600.0), None);
    }
}
