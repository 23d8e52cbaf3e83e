//! The charts of the report, from the columns of the history.

use fractum_output::attenuation::Attenuation;
use fractum_output::fragments::Fragment;
use fractum_output::history::Table;
use fractum_output::number::{quantity, reading_unit, significant};
use fractum_output::summary::FragmentSizes;
use fractum_scene::EnergyKind;

use super::{Curve, EnergyColumns};
use crate::plot::{Axis, Chart, Level, Mark, Series, Style, stacked};

/// One colour for each energy, the same in every report, in the order of the list of energies.
const ENERGY_COLOURS: [&str; 26] = [
    "#111111", "#2166a5", "#2e8b57", "#5fb08a", "#86c5a5", "#aad8c0", "#b2303c", "#d6761c", "#7b5aa6", "#2a98a8",
    "#8a6d3b", "#6b7280", "#9ab53a", "#c06090", "#404080", "#e0b030", "#a0522d", "#708090", "#c0c020", "#004d40",
    "#ff8a65", "#5d4037", "#90a4ae", "#7cb342", "#e91e63", "#3949ab",
];

/// The colour of an energy by the name of its column.
fn colour_of_energy(column: &str) -> Option<&'static str> {
    EnergyKind::ALL
        .into_iter()
        .find(|kind| kind.name() == column)
        .map(|kind| ENERGY_COLOURS[kind as usize % ENERGY_COLOURS.len()])
}

/// The column called `name`, as an axis with that name in words, and its values.
fn axis(history: &Table, name: &str) -> Option<(Axis, Vec<f64>)> {
    let (values, unit) = history.column(name)?;
    let (unit, size) = reading_unit(unit);
    Some((Axis::new(words(name), unit), values.iter().map(|value| value / size).collect()))
}

/// The time axis: the first column.
fn time(history: &Table) -> Option<(Axis, Vec<f64>)> {
    axis(history, &history.columns.first()?.name)
}

/// `broken_edges` as `broken edges`; of a probe that is called like another column its own name.
pub(super) fn words(name: &str) -> String {
    name.strip_prefix("probe.").unwrap_or(name).replace('_', " ")
}

/// A chart of `curve`; `None` if a column is missing.
pub(super) fn curve(history: &Table, curve: &Curve) -> Option<Chart> {
    let (x, abscissae) = axis(history, &curve.x)?;
    let mut columns = Vec::new();
    for name in &curve.y {
        columns.push((name, axis(history, name)?));
    }
    let (first_name, (first, _)) = columns.first()?;
    let label = if columns.len() == 1 { first.label.clone() } else { curve.quantity.clone() };
    let y = Axis::new(label, first.unit.clone());
    // Sizes of the units that people read.
    let [of_x, of_y] =
        [&curve.x, first_name].map(|name| history.column(name).map_or(1.0, |(_, unit)| reading_unit(unit).1));
    let levels = curve.levels.iter().map(|level| Level { value: level.value / of_y, ..level.clone() }).collect();
    let mut chart = Chart {
        title: curve.title.clone(),
        x: labelled(x, &curve.labels[0], curve.logarithmic[0]),
        y: Axis { from_zero: first.unit != "K", ..labelled(y, &curve.labels[1], curve.logarithmic[1]) },
        levels,
        ..Chart::default()
    };
    if curve.mark_peak {
        chart.marks.extend(columns.first().and_then(|(_, (axis, values))| peak(&abscissae, values, &axis.unit)));
    }
    for (name, (_, values)) in columns {
        chart.series.push(Series::new(words(name), abscissae.clone(), values, Style::Line));
    }
    if let Some((name, points)) = &curve.reference {
        let along = |axis: usize, size: f64| points.iter().map(|point| point[axis] / size).collect();
        chart.series.push(Series::new(name, along(0, of_x), along(1, of_y), Style::Points));
    }
    Some(chart)
}

/// The axis with another label, unless that is empty, and of another kind.
fn labelled(axis: Axis, label: &str, logarithmic: bool) -> Axis {
    let label = if label.is_empty() { axis.label.clone() } else { label.to_owned() };
    Axis { label, logarithmic, ..axis }
}

/// The point of the largest absolute value.
fn peak(x: &[f64], y: &[f64], unit: &str) -> Option<Mark> {
    let finite = x.iter().zip(y).filter(|(x, y)| x.is_finite() && y.is_finite());
    // The first of equals, as the summary's time of the maximum.
    let (&x, &y) = finite.reduce(|best, next| if next.1.abs() > best.1.abs() { next } else { best })?;
    Some(Mark { label: quantity(y, unit), x, y })
}

/// Elastic energy in the first row [J], of bodies that are under stress before the run.
pub(super) fn elastic_at_start(history: &Table) -> f64 {
    let values = history.column(EnergyKind::Elastic.name()).map_or(&[][..], |(values, _)| values);
    values.first().copied().filter(|value| *value > 0.0).unwrap_or(0.0)
}

/// The energy ledger over time: what the work went into, on top of each other, and the work as a line above. Where a
/// part is negative, lines. None where there is no energy, as in heat alone.
pub(super) fn energy(history: &Table, columns: &EnergyColumns) -> Option<Chart> {
    let (x, times) = time(history)?;
    let (work, unit) = history.column(&columns.external)?;
    let mut parts: Vec<(String, &[f64])> = Vec::new();
    // What stress before the run has stored would hide all that follows.
    let stored = elastic_at_start(history);
    let elastic = EnergyKind::Elastic.name();
    let column = history.column(elastic).map_or(&[][..], |(values, _)| values);
    let since: Vec<f64> = column.iter().map(|value| value - stored).collect();
    let title = if stored > 0.0 {
        format!("Energy, without {} that was stored at the start", quantity(stored, unit))
    } else {
        "Energy".to_owned()
    };
    for name in &columns.parts {
        let values = if name == elastic { &since } else { history.column(name)?.0 };
        // What never was there does not fill the legend.
        if values.iter().any(|&value| value != 0.0) {
            parts.push((words(name), values));
        }
    }
    if parts.is_empty() && work.iter().all(|&value| value == 0.0) {
        return None;
    }
    let largest = parts.iter().flat_map(|(_, values)| *values).fold(0.0, |a: f64, &b| a.max(b.abs()));
    let negative = parts.iter().flat_map(|(_, values)| *values).any(|&value| value < -0.01 * largest);
    let mut chart = Chart { title, x, y: Axis::new("energy", unit).from_zero(), ..Chart::default() };
    chart.series = if negative {
        parts.iter().map(|(name, values)| Series::new(name, times.clone(), values.to_vec(), Style::Line)).collect()
    } else {
        let parts: Vec<(&str, &[f64])> = parts.iter().map(|(name, values)| (name.as_str(), *values)).collect();
        stacked(&times, &parts)
    };
    for series in &mut chart.series {
        let column = columns.parts.iter().find(|name| words(name) == series.name);
        series.colour = column.and_then(|name| colour_of_energy(name));
    }
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

/// Share of the mass in pieces of at most a size, with the sizes of a fifth, half and four fifths; `None` for fewer than
/// two pieces.
pub(super) fn passing(fragments: &[Fragment], sizes: Option<&FragmentSizes>) -> Option<Chart> {
    let but = if fragments.iter().any(|piece| piece.stays) { ", without what boundaries hold" } else { "" };
    let title = format!("Size distribution of the fragments{but}");
    let free = fragments.iter().filter(|piece| !piece.stays);
    let mut pieces: Vec<(f64, f64)> = free.map(|piece| (piece.size, piece.mass)).collect();
    pieces.retain(|(size, mass)| size.is_finite() && *size > 0.0 && *mass > 0.0);
    if pieces.len() < 2 {
        return None;
    }
    pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = pieces.iter().map(|piece| piece.1).sum();
    let (mut x, mut y, mut passed) = (vec![pieces[0].0], vec![0.0], 0.0);
    for (size, mass) in pieces {
        passed += mass;
        x.push(size);
        y.push(100.0 * passed / all);
    }
    let marks = sizes.map_or_else(Vec::new, |sizes| {
        let mark = |(name, share, size): (&str, f64, f64)| Mark {
            label: format!("{name} {}", quantity(size, "m")),
            x: size,
            y: share,
        };
        [("P20", 20.0, sizes.p20), ("P50", 50.0, sizes.p50), ("P80", 80.0, sizes.p80)].map(mark).into()
    });
    Some(Chart {
        title,
        x: Axis::new("size: diameter of equal volume, in the plane of equal area", "m").logarithmic(),
        y: Axis::new("mass passing [%]", "-").from_zero(),
        series: vec![Series::new("passing", x, y, Style::Step)],
        marks,
        ..Chart::default()
    })
}

/// Largest velocities against scaled distance with their power laws, one chart per unit of distance.
pub(super) fn attenuations(lines: &[Attenuation]) -> Vec<Chart> {
    let mut units: Vec<&str> = Vec::new();
    for line in lines {
        if !units.contains(&line.unit.as_str()) {
            units.push(&line.unit);
        }
    }
    let chart = |unit: &&str| {
        let (label, unit) = match *unit {
            "-" => ("distance over the radius of the hole", "-"),
            "m/kg^(1/2)" => ("scaled distance R/√Q [m/kg^½]", "-"),
            "m/kg^(1/3)" => ("scaled distance R/∛Q [m/kg^⅓]", "-"),
            other => ("scaled distance", other),
        };
        Chart {
            title: "Peak particle velocity".into(),
            x: Axis::new(label, unit).logarithmic(),
            y: Axis::new("peak particle velocity", "m/s").logarithmic(),
            ..Chart::default()
        }
    };
    let mut charts: Vec<Chart> = units.iter().map(chart).collect();
    for line in lines {
        let chart = &mut charts[units.iter().position(|unit| *unit == line.unit).unwrap_or(0)];
        let distances: Vec<f64> = line.stations.iter().map(|station| station.scaled_distance).collect();
        let velocities = line.stations.iter().map(|station| station.velocity).collect();
        chart.series.push(Series::new(words(&line.name), distances.clone(), velocities, Style::Points));
        if line.exponent.is_finite() {
            let [factor, exponent] = [line.intercept, -line.exponent].map(|value| significant(value, 3));
            let law = format!("{factor} m/s · s^{exponent} (r² = {})", significant(line.r_squared, 3));
            let values = distances.iter().map(|distance| line.velocity(*distance)).collect();
            chart.series.push(Series::new(law, distances, values, Style::Line));
        }
    }
    charts
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_output::history::Column;

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
    fn energy_that_was_stored_at_the_start_is_told_apart() {
        let mut history = history();
        history.columns[2].name = "external".into();
        history.values[3] = vec![1e6, 1e6 + 1.5, 1e6 + 1.0];
        let columns = EnergyColumns { external: "external".into(), parts: vec!["elastic".into(), "damage".into()] };
        let chart = energy(&history, &columns).unwrap();
        assert_eq!(chart.title, "Energy, without 1 MJ that was stored at the start");
        let top = chart.series.iter().flat_map(|series| &series.y).fold(0.0, |a: f64, &b| a.max(b));
        assert!(top <= 3.0, "{top}");
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
    fn an_energy_has_one_colour_in_every_report() {
        let columns = |parts: &[&str]| EnergyColumns {
            external: "work".into(),
            parts: parts.iter().map(|part| part.to_string()).collect(),
        };
        let of = |chart: &Chart, name: &str| chart.series.iter().find(|series| series.name == name).unwrap().colour;
        let both = energy(&history(), &columns(&["elastic", "damage"])).unwrap();
        let alone = energy(&history(), &columns(&["damage"])).unwrap();
        assert_eq!(of(&both, "damage"), of(&alone, "damage"));
        assert_eq!(of(&alone, "damage"), Some("#b2303c"));
        let mut all = ENERGY_COLOURS.to_vec();
        all.sort_unstable();
        all.dedup();
        assert!(all.len() == ENERGY_COLOURS.len() && all.len() >= EnergyKind::COUNT);
    }

    #[test]
    fn the_share_that_passes_rises_to_all_of_the_mass() {
        let piece = |size, mass| Fragment { size, mass, ..Fragment::default() };
        assert_eq!(passing(&[piece(0.1, 1.0)], None), None);
        let sizes = FragmentSizes { p20: 0.02, p50: 0.1, p80: 0.1 };
        let chart = passing(&[piece(0.1, 3.0), piece(0.01, 0.5), piece(0.02, 0.5)], Some(&sizes)).unwrap();
        assert_eq!(chart.series[0].x, [0.01, 0.01, 0.02, 0.1]);
        assert_eq!(chart.series[0].y, [0.0, 12.5, 25.0, 100.0]);
        let marks: Vec<&str> = chart.marks.iter().map(|mark| mark.label.as_str()).collect();
        assert_eq!(marks, ["P20 20 mm", "P50 100 mm", "P80 100 mm"]);
    }

    #[test]
    fn velocities_have_one_chart_per_unit_of_distance() {
        use fractum_output::attenuation::Station;
        let line = |name: &str, unit: &str, moves: f64| {
            let station = |i: u32| Station {
                scaled_distance: f64::from(i),
                velocity: moves / f64::from(i * i),
                ..Station::default()
            };
            Attenuation::new(name, unit, (1..5).map(station).collect(), 1.0)
        };
        let lines = [line("east", "-", 2.0), line("north", "-", 0.0), line("far", "m/kg^(1/2)", 1.0)];
        let charts = attenuations(&lines);
        let names: Vec<&str> = charts[0].series.iter().map(|series| series.name.as_str()).collect();
        assert_eq!(names, ["east", "2 m/s · s^-2 (r² = 1)", "north"]);
        assert_eq!((charts.len(), charts[1].series.len()), (2, 2));
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
