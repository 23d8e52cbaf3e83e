//! A study as tables: for the terminal and documents, `study.csv`, and `study.json`.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::compare::{Family, Varies, Verdict};
use super::run::{End, Measured, Run};
use crate::accuracy::{Accuracy, Pass};
use crate::expectation::{Comparison, Expectation};
use crate::history::quoted;
use crate::number::{percent, push_shortest, quantity, significant};

/// A table as people read it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Title; empty where the table stands alone.
    pub title: String,
    /// Names of the columns.
    pub header: Vec<String>,
    /// Cells, row by row.
    pub rows: Vec<Vec<String>>,
}

impl Table {
    /// The table in Markdown, with columns in line.
    pub fn to_markdown(&self) -> String {
        let width = |column: usize| {
            let cells = self.rows.iter().filter_map(|row| row.get(column)).chain(self.header.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0).max(3)
        };
        let widths: Vec<usize> = (0..self.header.len()).map(width).collect();
        let mut text = String::new();
        if !self.title.is_empty() {
            let _ = writeln!(text, "**{}**\n", self.title);
        }
        let mut line = |cells: &[String]| {
            for (cell, width) in cells.iter().zip(&widths) {
                let _ = write!(text, "| {cell}{} ", " ".repeat(width - cell.chars().count()));
            }
            text.push_str("|\n");
        };
        line(&self.header);
        line(&widths.iter().map(|width| "-".repeat(*width)).collect::<Vec<_>>());
        self.rows.iter().for_each(|row| line(row));
        text
    }
}

/// The passes of a case that asked for an accuracy.
pub fn of_passes(accuracy: &Accuracy) -> Table {
    let peak = format!("peak of {}", accuracy.load);
    let header = ["pass", "size", "size/l", "elements", "time", &peak, "end"].map(String::from).to_vec();
    let unit = accuracy.probes.get(&accuracy.load).map_or("", |estimate| estimate.unit.as_str());
    let row = |pass: &Pass| {
        vec![
            pass.name.clone(),
            quantity(pass.size, "m"),
            significant(pass.size / accuracy.length, 3),
            pass.elements.to_string(),
            format!("{} s", significant(pass.wall, 3)),
            pass.peaks.get(&accuracy.load).map_or_else(String::new, |peak| quantity(*peak, unit)),
            if pass.left_out.is_empty() { pass.end.clone() } else { pass.left_out.clone() },
        ]
    };
    Table { title: String::new(), header, rows: accuracy.passes.iter().map(row).collect() }
}

/// Its passes, and the peaks of its probes with their error bars, as text.
pub fn accuracy(accuracy: &Accuracy) -> String {
    let mut text = of_passes(accuracy).to_markdown();
    text.push('\n');
    for (name, estimate) in &accuracy.probes {
        let _ = writeln!(text, "- peak of {name}: {}", estimate.words());
    }
    text
}

/// Error and value of a reference, in one cell; `!` where it is missed.
fn cell(line: &Expectation) -> String {
    let missed = if line.pass { "" } else { " !" };
    match line.comparison {
        Comparison::Nothing if line.value.is_nan() => String::new(),
        Comparison::Relative => {
            // Rounding is no error.
            let error = if line.error.abs() < 1e-9 { 0.0 } else { line.error };
            let sign = if error > 0.0 { "+" } else { "" };
            format!("{}, {sign}{}{missed}", quantity(line.value, &line.unit), percent(error))
        }
        _ => format!("{}{missed}", quantity(line.value, &line.unit)),
    }
}

fn seconds(value: f64) -> String {
    format!("{} s", significant(value, 3))
}

fn column(name: &str) -> String {
    name.replace('_', " ").trim_start_matches("probes.").to_owned()
}

/// The quantities of a family that have a reference.
fn referenced<'a>(family: &Family<'a>) -> Vec<&'a str> {
    let mut names = family.quantities();
    let has = |name: &str, measured: &Measured| measured.references().any(|line| line.quantity == name);
    names.retain(|name| family.runs.iter().filter_map(|run| run.measured()).any(|measured| has(name, measured)));
    names
}

/// All runs of a family with their errors.
pub fn runs(family: &Family<'_>) -> Table {
    let quantities = family.quantities();
    let mut header: Vec<String> =
        family.axes.iter().map(|(axis, _)| axis.rsplit('.').next().unwrap_or(axis).to_owned()).collect();
    if header.is_empty() {
        header.push("case".into());
    }
    header.extend(["size", "run time"].map(String::from));
    header.extend(quantities.iter().map(|name| column(name)));
    let row = |run: &&Run| {
        let mut row: Vec<String> = family.axes.iter().map(|(axis, _)| run.on(axis).to_owned()).collect();
        if row.is_empty() {
            row.push(family.label.to_owned());
        }
        match &run.end {
            End::Finished(measured) => {
                row.extend([quantity(measured.size, "m"), seconds(measured.seconds())]);
                let found = |name| measured.expect.iter().find(|line| line.quantity == name);
                row.extend(quantities.iter().map(|name| found(*name).map_or(String::new(), cell)));
            }
            End::Failed(_) => row.extend(["", "failed"].map(String::from)),
            End::Open => row.extend(["", "not run"].map(String::from)),
        }
        row.resize(header.len(), String::new());
        row
    };
    let rows = family.runs.iter().map(row).collect();
    Table { title: family.label.to_owned(), header, rows }
}

/// Settings of all families over all their cases: the worst of each reference, how many runs miss it, and the run time.
pub fn settings(families: &[Family<'_>]) -> Vec<Table> {
    families.iter().filter_map(settings_of).collect()
}

fn settings_of(family: &Family<'_>) -> Option<Table> {
    let verdicts = family.verdicts();
    // Settings with a run each stand in the table of runs.
    let several = verdicts.iter().any(|verdict| verdict.finished.len() + verdict.unfinished > 1);
    if verdicts.len() < 2 || !several {
        return None;
    }
    let quantities = referenced(family);
    let mut header: Vec<String> = ["setting", "runs"].map(String::from).into();
    header.extend(quantities.iter().map(|name| format!("{}, worst", column(name))));
    header.extend(["references met", "run time"].map(String::from));
    let first = verdicts.first().map(|verdict| verdict.label.clone()).unwrap_or_default();
    header.push(format!("over {first}"));
    let row = |verdict: &Verdict<'_>| {
        let done = verdict.finished.len();
        let runs =
            if verdict.unfinished > 0 { format!("{done} of {}", done + verdict.unfinished) } else { done.to_string() };
        let mut row = vec![verdict.label.clone(), runs];
        let worst = |name: &&str| verdict.worst(name).map_or(String::new(), |(line, _)| cell(line));
        row.extend(quantities.iter().map(worst));
        let (met, of) = verdict
            .measured()
            .flat_map(Measured::references)
            .fold((0, 0), |(met, of), line| (met + usize::from(line.pass), of + 1));
        row.extend([format!("{met} of {of}"), seconds(verdict.seconds())]);
        row.push(verdict.time_ratio.map_or(String::new(), |ratio| significant(ratio, 3)));
        row
    };
    Some(Table { title: family.label.to_owned(), header, rows: verdicts.iter().map(row).collect() })
}

/// Sentences on orders of convergence, scatter, and the cheapest within `within`.
pub fn findings(families: &[Family<'_>], within: Option<f64>) -> Vec<String> {
    let mut lines = Vec::new();
    for family in families {
        let of = |label: &str| {
            if label == family.label { label.to_owned() } else { format!("{}, {label}", family.label) }
        };
        for order in family.orders() {
            let (label, name, power) = (of(&order.label), column(&order.quantity), significant(order.order, 2));
            let falls = format!("falls with size to the power {power}");
            let falls = if order.order > 0.0 { &falls } else { "does not fall with size" };
            lines.push(format!("{label}: the error of {name} {falls}, from {} sizes", order.sizes));
        }
        for scatter in family.scatters() {
            let [mean, deviation] = [scatter.mean, scatter.deviation].map(|value| quantity(value, &scatter.unit));
            let (label, name) = (of(&scatter.label), column(&scatter.quantity));
            lines.push(format!(
                "{label}: {name} {mean} with a standard deviation of {deviation} over {} seeds",
                scatter.seeds
            ));
        }
        if let Some(share) = within.filter(|_| !referenced(family).is_empty()) {
            lines.extend(cheapest(family, share));
        }
    }
    lines
}

fn cheapest(family: &Family<'_>, share: f64) -> Vec<String> {
    // References may all be absolute ones or limits, of which no share can be asked.
    let relative = family.runs.iter().filter_map(|run| run.measured()).any(|measured| measured.worst().is_some());
    let (goal, met, others) = if relative {
        let percent = percent(share);
        (percent.clone(), format!("is within {percent}"), " and meets all other references")
    } else {
        ("all references".into(), "meets all references".into(), "")
    };
    let Some((run, measured)) = family.cheapest(share) else {
        return vec![format!("{}: no run {met}{others}", family.label)];
    };
    let mut lines = vec![format!(
        "{}: for {goal} take {}, it costs {}",
        family.label,
        family.name_for_any_seed(run),
        seconds(measured.seconds())
    )];
    if settings_of(family).is_some() {
        lines.push(match family.cheapest_setting(share) {
            Some(verdict) => format!(
                "{}: for {goal} in all {} cases take {}, it costs {}",
                family.label,
                verdict.finished.len(),
                verdict.label,
                seconds(verdict.seconds())
            ),
            None => format!("{}: no setting {met} in all cases", family.label),
        });
    }
    lines
}

/// Runs that failed, and why.
pub fn failures(families: &[Family<'_>]) -> Vec<String> {
    let runs = families.iter().flat_map(|family| family.runs.iter().map(move |run| (family, run)));
    let failed = runs.filter_map(|(family, run)| match &run.end {
        End::Failed(why) => Some(format!("{}, {}: {why}", family.label, family.full_name(run))),
        End::Open | End::Finished(_) => None,
    });
    failed.collect()
}

/// `study.csv`: a line per run and reference, numbers in SI.
pub fn to_csv(runs: &[Run]) -> String {
    let mut text = String::from(
        "family,run,status,folder,size [m],elements,particles,steps,wall [s],processor [s],quantity,unit,value,reference,comparison,error,tolerance,pass\n",
    );
    for run in runs {
        let words = run.planned.coordinates().map(|(axis, value)| format!("{axis}={value}"));
        let name = words.collect::<Vec<_>>().join("; ");
        let status = status(&run.end);
        let folder = run.folder.display().to_string();
        let start = [&run.planned.family, &name, status, &folder].map(quoted).join(",");
        let Some(measured) = run.measured() else {
            let _ = writeln!(text, "{start}{}", ",".repeat(14));
            continue;
        };
        let counts = format!("{},{},{}", measured.elements, measured.particles, measured.steps);
        let processor = measured.processor.map(shortest).unwrap_or_default();
        let start = format!("{start},{},{counts},{},{processor}", shortest(measured.size), shortest(measured.wall));
        if measured.expect.is_empty() {
            let _ = writeln!(text, "{start}{}", ",".repeat(8));
        }
        for line in &measured.expect {
            let [value, reference, error, tolerance] =
                [line.value, line.reference, line.error, line.tolerance].map(shortest);
            let comparison = format!("{:?}", line.comparison).to_lowercase();
            let [name, unit] = [&line.quantity, &line.unit].map(|cell| quoted(cell));
            let _ = writeln!(
                text,
                "{start},{name},{unit},{value},{reference},{comparison},{error},{tolerance},{}",
                line.pass
            );
        }
    }
    text
}

fn shortest(value: f64) -> String {
    let mut text = String::new();
    push_shortest(&mut text, value);
    text
}

fn status(end: &End) -> &'static str {
    match end {
        End::Open => "open",
        End::Finished(_) => "finished",
        End::Failed(_) => "failed",
    }
}

/// `study.json`: runs, settings, orders, scatter.
pub fn to_json(title: &str, families: &[Family<'_>], within: Option<f64>) -> String {
    let number = |value: f64| if value.is_finite() { json!(value) } else { Value::Null };
    let run = |run: &&Run| {
        let at: serde_json::Map<String, Value> =
            run.planned.coordinates().map(|(axis, value)| (axis.to_owned(), json!(value))).collect();
        let why = if let End::Failed(why) = &run.end { json!(why) } else { Value::Null };
        let case = run.planned.case.display().to_string();
        json!({ "at": at, "case": case, "set": run.planned.overrides, "folder": run.folder, "status": status(&run.end), "reason": why, "result": run.measured() })
    };
    let family = |family: &Family<'_>| {
        let axes: Vec<Value> = family
            .axes
            .iter()
            .map(|(axis, varies)| {
                let varies = match varies {
                    Varies::Case => "case",
                    Varies::Seed => "seed",
                    Varies::Setting => "setting",
                };
                json!({ "axis": axis, "varies": varies })
            })
            .collect();
        let settings: Vec<Value> = family.verdicts().iter().map(|verdict| {
            json!({ "setting": verdict.label, "finished": verdict.finished.len(), "unfinished": verdict.unfinished, "seconds": number(verdict.seconds()), "time_ratio": verdict.time_ratio })
        }).collect();
        let orders: Vec<Value> = family.orders().iter().map(|order| {
            json!({ "runs": order.label, "quantity": order.quantity, "order": number(order.order), "sizes": order.sizes })
        }).collect();
        let scatters: Vec<Value> = family.scatters().iter().map(|scatter| {
            json!({ "runs": scatter.label, "quantity": scatter.quantity, "unit": scatter.unit, "mean": number(scatter.mean), "deviation": number(scatter.deviation), "seeds": scatter.seeds })
        }).collect();
        let runs: Vec<Value> = family.runs.iter().map(run).collect();
        json!({ "family": family.label, "axes": axes, "runs": runs, "settings": settings, "orders": orders, "scatters": scatters })
    };
    let study = json!({
        "title": title,
        "within": within,
        "families": families.iter().map(family).collect::<Vec<_>>(),
        "findings": findings(families, within),
    });
    // Cannot fail: the keys are strings and nothing but memory is written to.
    serde_json::to_string_pretty(&study).unwrap_or_default() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_in_line() {
        let words = |cells: [&str; 2]| cells.map(String::from).to_vec();
        let table = Table { title: String::new(), header: words(["a", "µ"]), rows: vec![words(["long cell", "1"])] };
        assert_eq!(table.to_markdown(), "| a         | µ   |\n| --------- | --- |\n| long cell | 1   |\n");
    }
}
