//! What runs are compared by beside their references: `max(load) / (10 mm * 1 m)`, from the probes of `summary.json`.

use std::collections::BTreeMap;

use fractum_output::expectation::Expectation;
use fractum_output::summary::{Probe, Summary};

use crate::Dimension;
use crate::expression::{Named, Names, Op, Type, compile, parse_unit};
use crate::model::summary_quantities;

/// A quantity that is compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name of its column.
    label: String,
    /// A probe, a path of `summary.json`, or an expression of probes.
    text: String,
}

/// A function of an expression, and what it takes from a probe.
type Reduction = (&'static str, fn(&Probe) -> f64);

/// What a probe came to over a run.
const REDUCTIONS: [Reduction; 5] = [
    ("max", |probe| probe.max),
    ("min", |probe| probe.min),
    ("absmax", |probe| probe.max.abs().max(probe.min.abs())),
    ("final", |probe| probe.r#final),
    ("time_of_max", |probe| probe.time_of_max),
];

impl Quantity {
    /// Reads `max(load)`, or `strength = max(load) / area` with a name for its column.
    ///
    /// # Errors
    /// What is wrong, in one line. Names are looked up in each run.
    pub fn parse(text: &str) -> Result<Self, String> {
        let plain = |name: &str| name.chars().all(|c| c.is_alphanumeric() || " _-".contains(c));
        let (label, text) = match text.split_once('=') {
            Some((label, rest)) if plain(label) && !rest.starts_with('=') => (label, rest),
            _ => (text, text),
        };
        let (label, text) = (label.trim().to_owned(), text.trim().to_owned());
        if label.is_empty() || text.is_empty() {
            return Err("expected a probe such as load, a peak such as max(load), or NAME = EXPRESSION".into());
        }
        Ok(Self { label, text })
    }

    /// Its value in a run.
    ///
    /// # Errors
    /// Why the run has none, in one line.
    pub fn of(&self, summary: &Summary) -> Result<Expectation, String> {
        let line = |unit: &str, value| Ok(Expectation::without_reference(&self.label, unit, value));
        if let Some(probe) = summary.probes.get(&self.text) {
            return line(&probe.unit, probe.r#final);
        }
        if let Some((_, dimension)) = summary_quantities().find(|(path, _)| *path == self.text) {
            return line(&dimension.symbol(), summary.number(&self.text));
        }
        if let Some((name, field)) = self.text.strip_prefix("probes.").and_then(|rest| rest.rsplit_once('.'))
            && let Some((probe, (_, take))) = summary.probes.get(name).zip(REDUCTIONS.iter().find(|(n, _)| *n == field))
        {
            return line(if field == "time_of_max" { "s" } else { &probe.unit }, take(probe));
        }
        let compiled = compile(&self.text, &mut Probes(&summary.probes), false).map_err(|error| {
            let mut remedy = if error.remedy.is_empty() { String::new() } else { format!("; {}", error.remedy) };
            if error.message.starts_with("unknown function") {
                let of_probes: Vec<&str> = REDUCTIONS.iter().map(|(name, _)| *name).collect();
                remedy +=
                    &format!("; of a probe: {}; a probe with `expression` has further ones", of_probes.join(", "));
            }
            format!("\"{}\": {}{remedy}", self.text, error.message)
        })?;
        match compiled.kind {
            Type::Number { dimension, .. } => line(&dimension.symbol(), compiled.program.evaluate(&[])),
            Type::Truth => Err(format!("\"{}\" is a condition; expected a number", self.text)),
        }
    }
}

/// What runs without references and without wishes are compared by: the peak of each probe, the largest in size, and its last value.
pub fn of_probes(summary: &Summary) -> Vec<Expectation> {
    let mut lines = Vec::new();
    for (name, probe) in &summary.probes {
        let peak = if probe.min.abs() > probe.max.abs() { probe.min } else { probe.max };
        // A probe that is one number has no peak.
        if !probe.time_of_max.is_nan() {
            lines.push(Expectation::without_reference(&format!("peak of {name}"), &probe.unit, peak));
        }
        lines.push(Expectation::without_reference(name, &probe.unit, probe.r#final));
    }
    lines
}

/// The probes of a run as names of an expression; a name alone is its last value.
struct Probes<'a>(&'a BTreeMap<String, Probe>);

impl Probes<'_> {
    fn value(&self, name: &str, value: impl Fn(&Probe) -> f64) -> Option<Named> {
        let probe = self.0.get(name)?;
        // Units are printed from dimensions, and angles have none.
        let dimension = parse_unit(&probe.unit).map_or(Dimension::NONE, |unit| unit.dimension);
        Some(Named { op: Op::Constant(value(probe)), kind: Type::number(dimension) })
    }
}

impl Names for Probes<'_> {
    fn contains(&self, name: &str) -> bool {
        self.0.contains_key(name)
    }

    fn find(&mut self, name: &str) -> Option<Result<Named, String>> {
        self.value(name, |probe| probe.r#final).map(Ok)
    }

    fn all(&self) -> Vec<String> {
        self.0.keys().cloned().collect()
    }

    fn reduces(&self, function: &str) -> bool {
        REDUCTIONS.iter().any(|(name, _)| *name == function)
    }

    fn reduce(&mut self, function: &str, name: &str, _: Option<f64>) -> Result<Named, String> {
        let take = REDUCTIONS.iter().find(|(name, _)| *name == function).map(|(_, take)| take);
        let named = take.and_then(|take| self.value(name, take));
        let named = named.ok_or_else(|| format!("{function}() needs a probe; \"{name}\" is none"))?;
        let kind = if function == "time_of_max" { Type::number(Dimension::TIME) } else { named.kind };
        Ok(Named { kind, ..named })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn summary() -> Summary {
        let mut summary = Summary::default();
        let probe =
            |unit: &str, last, max, min, time_of_max| Probe { unit: unit.into(), r#final: last, max, min, time_of_max };
        summary.probes.insert("load".into(), probe("N", 1e3, 4e3, -5e3, 2e-3));
        summary.probes.insert("width".into(), probe("m", 0.2, 0.2, 0.2, f64::NAN));
        summary.counts.fragments = 3;
        summary
    }

    #[test]
    fn peaks_last_values_paths_and_expressions_have_values_and_units() {
        let told = |text: &str| {
            let line = Quantity::parse(text).unwrap().of(&summary()).unwrap();
            (line.quantity, line.value, line.unit)
        };
        for (text, label, value, unit) in [
            ("load", "load", 1e3, "N"),
            ("max(load)", "max(load)", 4e3, "N"),
            ("absmax(load)", "absmax(load)", 5e3, "N"),
            ("probes.load.min", "probes.load.min", -5e3, "N"),
            ("when = time_of_max(load)", "when", 2e-3, "s"),
            ("strength = max(load) / (width * 1 m)", "strength", 2e4, "Pa"),
            ("counts.fragments", "counts.fragments", 3.0, "1"),
        ] {
            assert_eq!(told(text), (label.to_owned(), value, unit.to_owned()), "{text}");
        }
        let refused = |text: &str| Quantity::parse(text).unwrap().of(&summary()).unwrap_err();
        assert!(refused("max(laod)").contains("laod") && refused("load + width").contains("load + width"));
        assert!(refused("mean(load)").contains("of a probe: max, min, absmax, final, time_of_max; a probe with"));
        assert!(refused("load > 3 N").contains("condition") && Quantity::parse("=1").is_err());
        let lines = of_probes(&summary());
        let names: Vec<&str> = lines.iter().map(|line| line.quantity.as_str()).collect();
        assert_eq!((names, lines[0].value), (vec!["peak of load", "load", "width"], -5e3));
    }
}
