//! The charts of the report, from the columns of the history.

use super::{Curve, EnergyColumns};
use crate::number::quantity;
use crate::output::fragments::Fragment;
use crate::output::history::Table;
use crate::output::plot::{Axis, Chart, Mark, Series, Style, stacked};

/// The column called `name`, as an axis with that name in words, and its values.
fn axis(history: &Table, name: &str) -> Option<(Axis, Vec<f64>)> {
    let (values, unit) = history.column(name)?;
    Some((Axis::new(words(name), unit), values.to_vec()))
}

/// The time axis: the first column.
fn time(history: &Table) -> Option<(Axis, Vec<f64>)> {
    axis(history, &history.columns.first()?.name)
}

/// `broken_edges` as `broken edges`.
pub(super) fn words(name: &str) -> String {
    name.replace('_', " ")
}

/// A chart of `curve`; `None` if a column is missing.
pub(super) fn curve(history: &Table, curve: &Curve) -> Option<Chart> {
    let (x, abscissae) = axis(history, &curve.x)?;
    let mut columns = Vec::new();
    for name in &curve.y {
        columns.push((name, axis(history, name)?));
    }
    let (_, (first, _)) = columns.first()?;
    let label = if columns.len() == 1 { first.label.clone() } else { curve.title.clone() };
    let y = Axis::new(label, first.unit.clone()).from_zero();
    let mut chart = Chart { title: curve.title.clone(), x, y, levels: curve.levels.clone(), ..Chart::default() };
    if curve.mark_peak {
        chart.marks.extend(columns.first().and_then(|(_, (axis, values))| peak(&abscissae, values, &axis.unit)));
    }
    for (name, (_, values)) in columns {
        chart.series.push(Series::new(words(name), abscissae.clone(), values, Style::Line));
    }
    Some(chart)
}

/// The point of the largest absolute value.
fn peak(x: &[f64], y: &[f64], unit: &str) -> Option<Mark> {
    let finite = x.iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite());
    // The first of equals, as the summary's time of the maximum.
    let (&x, &y) = finite.reduce(|best, next| if next.1.abs() > best.1.abs() { next } else { best })?;
    Some(Mark { label: quantity(y, unit), x, y })
}

/// The energy ledger over time: what the work went into, on top of each other, and the work as a line above. Where a
/// part is negative, lines.
pub(super) fn energy(history: &Table, columns: &EnergyColumns) -> Option<Chart> {
    let (x, times) = time(history)?;
    let (work, unit) = history.column(&columns.external)?;
    let mut parts: Vec<(String, &[f64])> = Vec::new();
    for name in &columns.parts {
        let values = history.column(name)?.0;
        // What never was there does not fill the legend.
        if values.iter().any(|&value| value != 0.0) {
            parts.push((words(name), values));
        }
    }
    let largest = parts.iter().flat_map(|(_, values)| *values).fold(0.0, |a: f64, &b| a.max(b.abs()));
    let negative = parts.iter().flat_map(|(_, values)| *values).any(|&value| value < -0.01 * largest);
    let mut chart = Chart { title: "Energy".into(), x, y: Axis::new("energy", unit).from_zero(), ..Chart::default() };
    chart.series = if negative {
        parts.iter().map(|(name, values)| Series::new(name, times.clone(), values.to_vec(), Style::Line)).collect()
    } else {
        let parts: Vec<(&str, &[f64])> = parts.iter().map(|(name, values)| (name.as_str(), *values)).collect();
        stacked(&times, &parts)
    };
    chart.series.push(Series::new(words(&columns.external), times, work.to_vec(), Style::Outline));
    Some(chart)
}

/// Numbers of broken things over time.
pub(super) fn cracks(history: &Table, columns: &[String]) -> Option<Chart> {
    let (x, times) = time(history)?;
    let mut chart =
        Chart { title: "Crack growth".into(), x, y: Axis::new("number", "-").from_zero(), ..Chart::default() };
    for name in columns {
        let (values, _) = history.column(name)?;
        chart.series.push(Series::new(words(name), times.clone(), values.to_vec(), Style::Line));
    }
    if let [only] = &chart.series[..] {
        chart.y.label = only.name.clone();
    }
    (!chart.series.is_empty()).then_some(chart)
}

/// How many pieces are at least so large; `None` for fewer than two.
pub(super) fn fragment_sizes(fragments: &[Fragment]) -> Option<Chart> {
    let sizes = fragments.iter().map(|fragment| fragment.largest_extent);
    let mut sizes: Vec<f64> = sizes.filter(|size| size.is_finite() && *size > 0.0).collect();
    if sizes.len() < 2 {
        return None;
    }
    sizes.sort_by(f64::total_cmp);
    let numbers: Vec<f64> = (1..=sizes.len()).rev().map(|number| number as f64).collect();
    // A number holds up to its piece's size, so the steps are drawn from the largest down.
    let backwards = |values: Vec<f64>| values.into_iter().rev().collect();
    let series = vec![Series::new("pieces", backwards(sizes), backwards(numbers), Style::Step)];
    let x = Axis::new("size: largest extent of a piece", "m").logarithmic();
    let y = Axis::new("pieces of at least that size", "-").logarithmic();
    Some(Chart { title: "Fragment sizes".into(), x, y, series, ..Chart::default() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::history::Column;

    fn history() -> Table {
        let columns =
            [("time", "s"), ("load", "N"), ("work", "J"), ("elastic", "J"), ("damage", "J"), ("friction", "J")];
        Table {
            columns: columns.iter().map(|(name, unit)| Column::new(*name, *unit)).collect(),
            values: vec![
                vec![0.0, 1.0, 2.0],
                vec![0.0, -5.0, f64::NAN],
                vec![0.0, 2.0, 3.0],
                vec![0.0, 1.5, 1.0],
                vec![0.0, 0.5, 2.0],
                vec![0.0; 3],
            ],
        }
    }

    #[test]
    fn the_peak_is_the_largest_absolute_value() {
        let wanted = Curve { x: "time".into(), y: vec!["load".into()], mark_peak: true, ..Curve::default() };
        let chart = curve(&history(), &wanted).unwrap();
        assert_eq!(chart.marks, [Mark { label: "-5 N".into(), x: 1.0, y: -5.0 }]);
    }

    #[test]
    fn a_missing_column_makes_no_chart() {
        let wanted = Curve { x: "time".into(), y: vec!["absent".into()], ..Curve::default() };
        assert_eq!(curve(&history(), &wanted), None);
        assert_eq!(cracks(&history(), &["absent".into()]), None);
        assert_eq!(cracks(&Table::default(), &[]), None);
    }

    #[test]
    fn energy_is_stacked_unless_a_part_is_negative() {
        let columns = |parts: &[&str]| EnergyColumns {
            external: "work".into(),
            parts: parts.iter().map(|part| part.to_string()).collect(),
        };
        let chart = energy(&history(), &columns(&["elastic", "damage", "friction"])).unwrap();
        let names: Vec<&str> = chart.series.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["damage", "elastic", "work"]);
        assert_eq!(chart.series[0].y, [0.0, 2.0, 3.0]);
        let chart = energy(&history(), &columns(&["elastic", "load"])).unwrap();
        assert!(chart.series.iter().all(|series| series.style != Style::Area));
    }

    #[test]
    fn fragment_sizes_count_the_pieces_from_the_largest_down() {
        let piece = |size| Fragment { largest_extent: size, ..Fragment::default() };
        assert_eq!(fragment_sizes(&[piece(0.1)]), None);
        let chart = fragment_sizes(&[piece(0.1), piece(0.01), piece(0.0), piece(0.02)]).unwrap();
        assert_eq!(chart.series[0].x, [0.1, 0.02, 0.01]);
        assert_eq!(chart.series[0].y, [1.0, 2.0, 3.0]);
    }
}
