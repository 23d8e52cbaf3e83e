//! What runs say together: by setting, by size, by seed.

use fractum_math::elementary::ln;

use super::run::{CASE, Measured, Run, SETTING};
use crate::attenuation::line_through;
use crate::expectation::{Comparison, Expectation};

/// Ratio of neighbouring sizes from which an order of convergence can be read off.
const DISTINCT: f64 = 1.15;

/// Relative errors below this are of rounding and have no order.
const ROUNDING: f64 = 1e-8;

/// What an axis of a family varies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Varies {
    /// The case or the size of its elements: a setting is judged over all of them.
    Case,
    /// A seed: a setting is judged over all of them.
    Seed,
    /// A setting.
    Setting,
}

/// Runs that are compared with each other, and their axes with more than one value.
#[derive(Clone, Debug)]
pub struct Family<'a> {
    /// Its name.
    pub label: &'a str,
    /// Its runs.
    pub runs: Vec<&'a Run>,
    /// Names of its axes, and what they vary.
    pub axes: Vec<(&'a str, Varies)>,
}

/// An observed order of convergence: the error falls with the size to this power.
#[derive(Clone, Debug, PartialEq)]
pub struct Order {
    /// The runs that it is of.
    pub label: String,
    /// Quantity.
    pub quantity: String,
    /// Slope of the logarithms of error and size by least squares [-].
    pub order: f64,
    /// Number of sizes.
    pub sizes: usize,
}

/// Scatter over seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Scatter {
    /// The runs that it is of.
    pub label: String,
    /// Quantity.
    pub quantity: String,
    /// Unit of mean and deviation.
    pub unit: String,
    /// Mean value.
    pub mean: f64,
    /// Standard deviation of the sample.
    pub deviation: f64,
    /// Number of seeds.
    pub seeds: usize,
}

/// A setting over the cases of its family.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict<'a> {
    /// The setting; empty where the family has one only.
    pub label: String,
    /// Its runs that have finished.
    pub finished: Vec<&'a Run>,
    /// Its runs that were refused or stopped themselves, or are still open.
    pub unfinished: usize,
    /// Time of the finished runs over that of the first setting, in the cases that both have finished; none without such cases.
    pub time_ratio: Option<f64>,
}

impl Verdict<'_> {
    /// Time of its finished runs [s].
    pub fn seconds(&self) -> f64 {
        self.measured().map(Measured::seconds).sum()
    }

    /// What its finished runs took and gave.
    pub fn measured(&self) -> impl Iterator<Item = &Measured> {
        self.finished.iter().filter_map(|run| run.measured())
    }

    /// The reference of that name where it is missed most, and how many runs miss it.
    pub fn worst(&self, quantity: &str) -> Option<(&Expectation, usize)> {
        let lines: Vec<&Expectation> =
            self.measured().flat_map(|run| &run.expect).filter(|line| line.quantity == quantity).collect();
        let worst = lines.iter().max_by(|a, b| severity(a).total_cmp(&severity(b)))?;
        Some((worst, lines.iter().filter(|line| !line.pass).count()))
    }
}

/// How far a value is from what was expected, to compare values of one reference.
fn severity(line: &Expectation) -> f64 {
    match line.comparison {
        _ if line.value.is_nan() => f64::INFINITY,
        Comparison::Relative | Comparison::Absolute => line.error.abs(),
        Comparison::Below => line.value,
        Comparison::Above => -line.value,
        Comparison::Between => (line.value - line.reference).abs(),
        Comparison::Nothing => 0.0,
    }
}

/// The families of a study, in the order of their first runs.
pub fn families(runs: &[Run]) -> Vec<Family<'_>> {
    let mut labels: Vec<&str> = Vec::new();
    for run in runs {
        if !labels.contains(&run.planned.family.as_str()) {
            labels.push(&run.planned.family);
        }
    }
    let family = |label| {
        let runs: Vec<&Run> = runs.iter().filter(|run| run.planned.family == label).collect();
        let mut names: Vec<&str> = Vec::new();
        for (name, _) in runs.iter().flat_map(|run| run.planned.coordinates()) {
            if !names.contains(&name) && runs.iter().any(|run| run.on(name) != runs[0].on(name)) {
                names.push(name);
            }
        }
        // What a setting sets is told by its label.
        let follows = |name: &str| {
            let same = |a: &Run, b: &Run| a.on(SETTING) != b.on(SETTING) || a.on(name) == b.on(name);
            names.contains(&SETTING) && runs.iter().all(|a| runs.iter().all(|b| same(a, b)))
        };
        let names: Vec<&str> =
            names.iter().copied().filter(|name| [CASE, SETTING].contains(name) || !follows(name)).collect();
        let mut family = Family { label, runs, axes: Vec::new() };
        family.axes = names.iter().map(|name| (*name, family.varies(&names, name))).collect();
        family
    };
    labels.into_iter().map(family).collect()
}

impl<'a> Family<'a> {
    /// What an axis varies: runs that differ in it alone have elements of other sizes, or not.
    fn varies(&self, names: &[&str], axis: &str) -> Varies {
        if axis == CASE {
            return Varies::Case;
        }
        if axis == SETTING {
            return Varies::Setting;
        }
        if axis.ends_with("seed") {
            return Varies::Seed;
        }
        let same = |a: &Run, b: &Run| names.iter().all(|name| *name == axis || a.on(name) == b.on(name));
        let sizes = |run: &Run| run.measured().map_or(f64::NAN, |run| run.size);
        let differs = |a: &Run, b: &Run| (sizes(a) - sizes(b)).abs() > 0.01 * sizes(a);
        let resized = self.runs.iter().any(|a| self.runs.iter().any(|b| same(a, b) && differs(a, b)));
        if resized { Varies::Case } else { Varies::Setting }
    }

    /// Values of a run on the axes of some kinds, for people: `local`, `tilt-10, safety 0.5`.
    pub fn name(&self, run: &Run, of: &[Varies]) -> String {
        let shown = self.axes.iter().filter(|(_, varies)| of.contains(varies));
        let words = shown.map(|(axis, _)| match *axis {
            CASE | SETTING => run.on(axis).to_owned(),
            key => format!("{} {}", key.rsplit('.').next().unwrap_or(key), run.on(key)),
        });
        words.collect::<Vec<_>>().join(", ")
    }

    /// The whole name of a run in its family.
    pub fn full_name(&self, run: &Run) -> String {
        self.name_or_label(run, &[Varies::Case, Varies::Setting, Varies::Seed])
    }

    /// As [`Self::full_name`] for what holds with every seed.
    pub fn name_for_any_seed(&self, run: &Run) -> String {
        self.name_or_label(run, &[Varies::Case, Varies::Setting])
    }

    fn name_or_label(&self, run: &Run, kinds: &[Varies]) -> String {
        let name = self.name(run, kinds);
        if name.is_empty() { self.label.to_owned() } else { name }
    }

    /// Runs that differ in one axis only, for each combination of the others: the runs and what they have in common.
    fn along(&self, axis: &str) -> Vec<(String, Vec<&'a Run>)> {
        let others: Vec<&(&str, Varies)> = self.axes.iter().filter(|(name, _)| *name != axis).collect();
        let key = |run: &Run| others.iter().map(|(name, _)| run.on(name).to_owned()).collect::<Vec<_>>();
        let mut groups: Vec<(Vec<String>, Vec<&Run>)> = Vec::new();
        for run in self.runs.iter().filter(|run| run.measured().is_some()) {
            let key = key(run);
            match groups.iter_mut().find(|group| group.0 == key) {
                Some(group) => group.1.push(run),
                None => groups.push((key, vec![run])),
            }
        }
        let without = Family { axes: others.into_iter().copied().collect(), ..self.clone() };
        groups.into_iter().map(|(_, runs)| (without.full_name(runs[0]), runs)).collect()
    }

    /// Quantities of its references, in the order of the cases.
    pub fn quantities(&self) -> Vec<&'a str> {
        let mut names: Vec<&str> = Vec::new();
        for line in self.runs.iter().filter_map(|run| run.measured()).flat_map(|run| &run.expect) {
            if !names.contains(&line.quantity.as_str()) {
                names.push(&line.quantity);
            }
        }
        names
    }

    /// Observed orders of convergence along every axis that changes the size of elements.
    pub fn orders(&self) -> Vec<Order> {
        let mut found = Vec::new();
        for (axis, _) in self.axes.iter().filter(|(_, varies)| *varies == Varies::Case) {
            for (label, mut runs) in self.along(axis) {
                let size = |run: &&Run| run.measured().map_or(f64::NAN, |run| run.size);
                runs.sort_by(|a, b| size(a).total_cmp(&size(b)));
                let distinct = runs.windows(2).all(|pair| size(&pair[1]) > DISTINCT * size(&pair[0]));
                if runs.len() < 2 || !distinct {
                    continue;
                }
                let sizes: Vec<f64> = runs.iter().map(size).collect();
                for quantity in self.quantities() {
                    if let Some(order) = order(&runs, &sizes, quantity) {
                        let (label, quantity) = (label.clone(), quantity.to_owned());
                        found.push(Order { label, quantity, order, sizes: runs.len() });
                    }
                }
            }
        }
        found
    }

    /// Mean and scatter over seeds.
    pub fn scatters(&self) -> Vec<Scatter> {
        let mut found = Vec::new();
        for (axis, _) in self.axes.iter().filter(|(_, varies)| *varies == Varies::Seed) {
            for (label, runs) in self.along(axis).into_iter().filter(|(_, runs)| runs.len() > 1) {
                for quantity in self.quantities() {
                    let lines: Vec<&Expectation> = runs.iter().filter_map(|run| reference(run, quantity)).collect();
                    let Some(first) = lines.first().filter(|_| lines.len() > 1) else { continue };
                    let count = lines.len() as f64;
                    let mean = lines.iter().map(|line| line.value).sum::<f64>() / count;
                    let square = lines.iter().map(|line| (line.value - mean).powi(2)).sum::<f64>() / (count - 1.0);
                    found.push(Scatter {
                        label: label.clone(),
                        quantity: quantity.to_owned(),
                        unit: first.unit.clone(),
                        mean,
                        deviation: square.sqrt(),
                        seeds: lines.len(),
                    });
                }
            }
        }
        found
    }

    /// Runs of one name, in the order of the first of each.
    fn grouped(&self, name: impl Fn(&Run) -> String) -> Vec<(String, Vec<&'a Run>)> {
        let mut groups: Vec<(String, Vec<&'a Run>)> = Vec::new();
        for run in &self.runs {
            let name = name(run);
            match groups.iter_mut().find(|group| group.0 == name) {
                Some(group) => group.1.push(run),
                None => groups.push((name, vec![run])),
            }
        }
        groups
    }

    /// Every setting over all cases and seeds.
    pub fn verdicts(&self) -> Vec<Verdict<'a>> {
        let groups = self.grouped(|run| self.name(run, &[Varies::Setting]));
        let first = groups.first().map_or_else(Vec::new, |(_, runs)| runs.clone());
        let verdict = |(label, runs): (String, Vec<&'a Run>)| {
            let all = runs.len();
            let time_ratio = self.time_ratio(&runs, &first);
            let finished: Vec<&Run> = runs.into_iter().filter(|run| run.measured().is_some()).collect();
            Verdict { label, unfinished: all - finished.len(), finished, time_ratio }
        };
        groups.into_iter().map(verdict).collect()
    }

    /// Time of runs over that of others, in the cases that both have finished.
    fn time_ratio(&self, runs: &[&Run], others: &[&Run]) -> Option<f64> {
        let shared = [Varies::Case, Varies::Seed];
        let (mut time, mut of_others) = (0.0, 0.0);
        for run in runs {
            let name = self.name(run, &shared);
            let other = others.iter().find(|other| self.name(other, &shared) == name);
            if let (Some(run), Some(other)) = (run.measured(), other.and_then(|other| other.measured())) {
                time += run.seconds();
                of_others += other.seconds();
            }
        }
        (of_others > 0.0).then(|| time / of_others)
    }

    /// The cheapest run whose relative errors are all within `share`, and which meets its other references, with every seed:
    /// of its seeds the one that took longest.
    pub fn cheapest(&self, share: f64) -> Option<(&'a Run, &'a Measured)> {
        let groups = self.grouped(|run| self.name_for_any_seed(run));
        let by_time = |a: &(&Run, &Measured), b: &(&Run, &Measured)| a.1.seconds().total_cmp(&b.1.seconds());
        let dearest = |(_, runs): (String, Vec<&'a Run>)| {
            let measured: Option<Vec<_>> = runs.into_iter().map(|run| Some((run, run.measured()?))).collect();
            let good = measured.filter(|runs| runs.iter().all(|(_, measured)| measured.is_within(share)))?;
            good.into_iter().max_by(by_time)
        };
        groups.into_iter().filter_map(dearest).min_by(by_time)
    }

    /// The cheapest setting of several whose runs are all within `share`.
    pub fn cheapest_setting(&self, share: f64) -> Option<Verdict<'a>> {
        let verdicts = self.verdicts();
        if verdicts.len() < 2 {
            return None;
        }
        let good = |verdict: &Verdict<'_>| {
            verdict.unfinished == 0 && verdict.measured().all(|measured| measured.is_within(share))
        };
        verdicts.into_iter().filter(good).min_by(|a, b| a.seconds().total_cmp(&b.seconds()))
    }
}

fn reference<'a>(run: &'a Run, quantity: &str) -> Option<&'a Expectation> {
    run.measured()?.expect.iter().find(|line| line.quantity == quantity)
}

/// The order of one quantity; none where an error is of rounding or changes its sign, or is no share of a reference.
fn order(runs: &[&Run], sizes: &[f64], quantity: &str) -> Option<f64> {
    let lines: Option<Vec<&Expectation>> = runs.iter().map(|run| reference(run, quantity)).collect();
    let lines = lines?;
    let side = lines.first()?.error.signum();
    let usable = lines
        .iter()
        .all(|line| line.comparison == Comparison::Relative && line.error.is_finite() && line.error * side > ROUNDING);
    let points: Vec<[f64; 2]> =
        sizes.iter().zip(&lines).map(|(size, line)| [ln(*size), ln(line.error.abs())]).collect();
    usable.then(|| line_through(&points).slope)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::expectation::Bound;
    use crate::study::run::{End, Planned};

    /// A run at some coordinates whose value is off 10 by an error.
    fn run(at: &[(&str, &str)], size: f64, error: f64, seconds: f64) -> Run {
        let bound = Bound::Near { value: 10.0, tolerance: 0.1, relative: Some(0.01) };
        let limit = Bound::Between { above: None, below: Some(1.0) };
        let expect = vec![
            Expectation::hold("strength", "Pa", 10.0 * (1.0 + error), bound, ""),
            Expectation::hold("share", "", 0.5, limit, ""),
        ];
        let measured = Measured { size, wall: 9.0, processor: Some(seconds), expect, ..Measured::default() };
        let mut planned = Planned { family: "disc".into(), ..Planned::default() };
        for (axis, value) in at {
            match *axis {
                CASE => planned.case_label = value.to_string(),
                SETTING => planned.setting = value.to_string(),
                key => planned.overrides.push((key.to_owned(), value.to_string())),
            }
        }
        Run { planned, end: End::Finished(Box::new(measured)), ..Run::default() }
    }

    #[test]
    fn the_order_is_that_of_the_errors_along_the_size_alone() {
        let at = |mesh, law| [("case", "disc"), ("mesh.file", mesh), ("law", law)];
        let mut runs = Vec::new();
        for (mesh, size) in [("a", 4.0), ("b", 2.0), ("c", 1.0)] {
            runs.push(run(&at(mesh, "square"), size, 1e-3 * size * size, 1.0));
            runs.push(run(&at(mesh, "line"), size, -2e-3 * size, 1.0));
            runs.push(run(&at(mesh, "swings"), size, 1e-3 * (size - 1.5), 1.0));
            runs.push(run(&at(mesh, "exact"), size, 1e-12 * size, 1.0));
        }
        let families = families(&runs);
        let family = &families[0];
        assert_eq!(family.axes, [("mesh.file", Varies::Case), ("law", Varies::Setting)]);
        let orders = family.orders();
        assert_eq!(orders.iter().map(|order| order.label.as_str()).collect::<Vec<_>>(), ["law square", "law line"]);
        assert!((orders[0].order - 2.0).abs() < 1e-9 && (orders[1].order - 1.0).abs() < 1e-9, "{orders:?}");
        assert_eq!(orders[0].sizes, 3);
        assert!(orders.iter().all(|order| order.quantity == "strength"), "a limit has no order");
    }

    #[test]
    fn scatter_is_over_seeds() {
        let at = |seed| [("case", "disc"), ("materials.rock.damage.scatter.seed", seed)];
        let runs = [run(&at("1"), 1.0, 0.0, 1.0), run(&at("2"), 1.0, 0.1, 1.0), run(&at("3"), 1.0, 0.2, 1.0)];
        let families = families(&runs);
        assert!(families[0].orders().is_empty());
        let scatters = families[0].scatters();
        assert_eq!((scatters.len(), scatters[0].seeds), (2, 3));
        assert!((scatters[0].mean - 11.0).abs() < 1e-12 && (scatters[0].deviation - 1.0).abs() < 1e-12);
    }

    #[test]
    fn one_good_seed_is_not_enough() {
        let at = |count, seed| [("bodies[0].particles", count), ("bodies[0].seed", seed)];
        let runs = [
            run(&at("1000", "1"), 1.0, 0.05, 1.0),
            run(&at("1000", "2"), 1.0, 0.001, 1.0),
            run(&at("3000", "1"), 1.0, 0.01, 3.0),
            run(&at("3000", "2"), 1.0, -0.01, 3.5),
        ];
        let families = families(&runs);
        let (cheapest, measured) = families[0].cheapest(0.02).unwrap();
        assert_eq!((families[0].name_for_any_seed(cheapest).as_str(), measured.seconds()), ("particles 3000", 3.5));
    }

    #[test]
    fn the_cheapest_is_within_the_error_and_meets_the_limits() {
        let at = |case, setting| [("case", case), ("setting", setting)];
        let mut runs = vec![
            run(&at("a", "quick"), 1.0, 0.001, 1.0),
            run(&at("b", "quick"), 1.0, -0.05, 2.0),
            run(&at("a", "slow"), 1.0, -0.01, 4.0),
            run(&at("b", "slow"), 1.0, 0.015, 5.0),
        ];
        let name = |runs: &[Run], share| {
            let families = families(runs);
            let family = &families[0];
            let run = family.cheapest(share).map(|(run, _)| family.full_name(run));
            (run, family.cheapest_setting(share).map(|verdict| verdict.label))
        };
        let some = |name: &str| Some(name.to_owned());
        assert_eq!(name(&runs, 0.02), (some("a, quick"), some("slow")));
        assert_eq!(name(&runs, 0.06), (some("a, quick"), some("quick")));
        assert_eq!(name(&runs, 1e-4), (None, None));
        let families_of = families(&runs);
        let verdicts = families_of[0].verdicts();
        assert_eq!(verdicts[1].time_ratio, Some(3.0));
        assert_eq!(verdicts[0].worst("strength").map(|(line, missed)| (line.error < 0.0, missed)), Some((true, 1)));
        // A run that failed counts against its setting.
        runs[2].end = End::Failed("refused".into());
        assert_eq!(name(&runs, 0.02), (some("a, quick"), None));
    }
}
