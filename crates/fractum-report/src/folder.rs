//! The report of a results folder, made from the files in it: at the end of a run, or again later.

use std::fs;
use std::path::{Path, PathBuf};

use fractum_output::atomic::Group;
use fractum_output::columns::HistoryColumns;
use fractum_output::history::{self, Column, Table};
use fractum_output::notes::{MOVIE, NOTES, Notes, PictureNote, PlotNote};
use fractum_output::number::quantity;
use fractum_output::summary::Summary;
use fractum_output::{ReadError, fragments};
use fractum_scene::EnergyKind;

use crate::error::ReportError;
use crate::picture::{ColourMap, Scale};
use crate::plot::Level;
use crate::report::{self, ColourBar, Curve, EnergyColumns, Figure, ReportData};

/// Writes `report.html` from the files of a results folder.
///
/// # Errors
/// [`ReportError`] if the folder is not that of a finished run, or the page cannot be written.
pub fn write(folder: &Path) -> Result<(), ReportError> {
    let mut files = Group::default();
    add(folder, &mut files)?;
    Ok(files.finish()?)
}

/// Adds `report.html` to the files of a results folder that have no names yet, from these and from what the folder holds.
///
/// # Errors
/// As [`write`].
pub fn add(folder: &Path, files: &mut Group) -> Result<(), ReportError> {
    let page = page(folder, |name| files.place_of(&folder.join(name)))?;
    files.add(&folder.join("report.html"), page.as_bytes());
    Ok(())
}

/// The page of a results folder.
///
/// - `place`: where a file of the folder lies
fn page(folder: &Path, place: impl Fn(&str) -> PathBuf) -> Result<String, ReportError> {
    let missing = |name: &str, error: &dyn std::fmt::Display| {
        ReportError::Input(format!(
            "{}: no {name} to report on: {error}; name the results folder of a run",
            folder.display()
        ))
    };
    let summary = Summary::read(&place("summary.json")).map_err(|e| missing("summary.json", &e))?;
    let history = history::read(&place("history.csv")).map_err(|e| missing("history.csv", &e))?;
    let history = fractum_output::columns::ordered(history);
    let notes: Notes = match fs::read(place(NOTES)) {
        Ok(bytes) => serde_json::from_slice(&bytes).map_err(|e| missing(NOTES, &e))?,
        Err(_) => Notes::default(),
    };
    let fragments = match fragments::read(&place("fragments.csv")) {
        Err(ReadError::Refused { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => Vec::new(),
        read => read.map_err(|e| missing("fragments.csv", &e))?,
    };
    let movie = if notes.movie { fs::read(place(MOVIE)).ok() } else { None };
    let pictures = notes.pictures.iter().filter_map(|note| figure(&place, note)).collect();
    // Bonds are columns where there are some; what never changed, as the particles of a bonded body, says nothing.
    let grows = |name: &String| history.column(name).is_some_and(|(values, _)| values.iter().any(|n| *n != values[0]));
    let cracks =
        ["removed_elements", "particles", "broken_bonds"].map(String::from).into_iter().filter(grows).collect();
    let mut curves: Vec<Curve> = notes.plots.iter().map(|plot| own(plot, &history, &summary)).collect();
    let load = load_curve(&history).filter(|load| !curves.iter().any(|own| is_load_curve(own, load, &history)));
    curves.extend(load);
    curves.extend(over_time(&history));
    let data = ReportData {
        curves,
        energy: Some(EnergyColumns {
            external: EnergyKind::External.name().into(),
            parts: EnergyKind::ALL.into_iter().filter(|kind| kind.sign() < 0).map(|kind| kind.name().into()).collect(),
        }),
        cracks,
        fragments,
        pictures,
        movie,
        inputs: notes.inputs,
        plan: notes.plan,
        case_file: notes.case_file,
        versions: [
            ("fractum", summary.fractum.clone()),
            ("platform", format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ]
        .into_iter()
        .chain(summary.origin.lines())
        .map(|(name, value)| (name.to_owned(), value))
        .collect(),
        summary,
        history,
    };
    Ok(report::to_html(&data))
}

fn figure(place: impl Fn(&str) -> PathBuf, note: &PictureNote) -> Option<Figure> {
    let png = fs::read(place(&format!("pictures/{}", note.file))).ok()?;
    let map = if note.damage { ColourMap::Damage } else { ColourMap::Viridis };
    let colours = ColourBar { label: note.label.clone(), unit: note.unit.clone(), map, range: note.range };
    let scale = note.pixels_per_metre.map(|pixels_per_metre| (Scale { pixels_per_metre, axes: note.axes }, note.size));
    let PictureNote { title, magnified, in_strip, .. } = note.clone();
    Some(Figure { title, png, colours: Some(colours), scale, in_strip, magnified })
}

/// The columns of probes.
fn probes(history: &Table) -> &[Column] {
    let names: Vec<&str> = history.columns.iter().map(|c| c.name.as_str()).collect();
    &history.columns[HistoryColumns::count(&names)..]
}

/// The chart of a plot of the user's own. A probe that is one number is a level.
fn own(plot: &PlotNote, history: &Table, summary: &Summary) -> Curve {
    let column = |name: &String| {
        // A probe that is called like another column has a column of another name, or none if it is one number.
        let of_probe = format!("probe.{name}");
        let is_own = |column: &&Column| [name, &of_probe].contains(&&column.name);
        let own = || probes(history).iter().find(is_own).map(|column| column.name.clone());
        let other = || history.column(name).map(|_| name.clone());
        if summary.probes.contains_key(name) { own() } else { other() }
    };
    let is_column = |name: &&String| column(name).is_some();
    let level = |name: &String| {
        let probe = summary.probes.get(name)?;
        let label = format!("{}: {}", name.replace('_', " "), quantity(probe.r#final, &probe.unit));
        Some(Level { label, value: probe.r#final })
    };
    let y: Vec<String> = plot.y.iter().filter_map(column).collect();
    let unit = y.first().and_then(|name| history.column(name)).map_or("-", |(_, unit)| unit);
    let names = plot.y.iter().filter(is_column).map(|name| name.replace('_', " "));
    let made = || format!("{} against {}", names.collect::<Vec<_>>().join(", "), plot.x.replace('_', " "));
    Curve {
        title: if plot.title.is_empty() { made() } else { plot.title.clone() },
        x: column(&plot.x).unwrap_or_default(),
        quantity: quantity_of(unit).0,
        levels: plot.y.iter().filter(|name| !is_column(name)).filter_map(level).collect(),
        labels: plot.labels.clone(),
        logarithmic: plot.logarithmic,
        reference: plot.reference.clone(),
        // As that of the load curve, whose place it takes.
        mark_peak: y.len() == 1 && unit == "N" && plot.reference.is_none(),
        y,
    }
}

/// The first force against the first displacement.
pub fn load_curve(history: &Table) -> Option<Curve> {
    let of_unit = |unit: &str| probes(history).iter().find(|c| c.unit == unit).map(|c| c.name.clone());
    let (load, displacement) = (of_unit("N")?, of_unit("m")?);
    let title = format!("{load} against {displacement}").replace('_', " ");
    Some(Curve { title, x: displacement, y: vec![load], mark_peak: true, ..Curve::default() })
}

/// Whether a plot of the user's own has the load of the load curve against a length.
fn is_load_curve(own: &Curve, load: &Curve, history: &Table) -> bool {
    let of_length = history.column(&own.x).is_some_and(|(_, unit)| unit == "m");
    of_length && own.y == load.y
}

/// The probes over time, one chart per unit.
fn over_time(history: &Table) -> Vec<Curve> {
    let probes = probes(history);
    let mut curves: Vec<Curve> = Vec::new();
    let mut units: Vec<&str> = Vec::new();
    for column in probes {
        if !units.contains(&column.unit.as_str()) {
            units.push(&column.unit);
        }
    }
    for unit in units {
        let names = probes.iter().filter(|c| c.unit == unit).map(|c| c.name.clone()).collect();
        for y in of_like_size(names, |name| largest(history, name)) {
            let (one, several) = quantity_of(unit);
            let title = match &y[..] {
                [only] => only.strip_prefix("probe.").unwrap_or(only).replace('_', " "),
                _ => several,
            };
            let x = history.columns[0].name.clone();
            curves.push(Curve { title, x, y, quantity: one, ..Curve::default() });
        }
    }
    curves
}

/// What a unit measures, one and several of them.
fn quantity_of(unit: &str) -> (String, String) {
    let (one, several) = match unit {
        "N" => ("force", "Forces"),
        "N*m" | "N m" => ("moment", "Moments"),
        "m" => ("length", "Displacements and lengths"),
        "m/s" => ("velocity", "Velocities"),
        "m/s^2" => ("acceleration", "Accelerations"),
        "m^2" => ("area", "Areas"),
        "m^3" => ("volume", "Volumes"),
        "Pa" => ("stress", "Stresses and pressures"),
        "J" => ("energy", "Energies"),
        "J/m^2" => ("energy per area", "Energies per area"),
        "kg" => ("mass", "Masses"),
        "s" => ("time", "Times"),
        "rad" => ("angle", "Angles"),
        "rad/s" => ("angular velocity", "Angular velocities"),
        "K" => ("temperature", "Temperatures"),
        "1" | "-" | "" => ("value", "Numbers and ratios"),
        other => return ("value".to_owned(), format!("Values in {other}")),
    };
    (one.to_owned(), several.to_owned())
}

/// Largest absolute value of a column.
fn largest(history: &Table, name: &str) -> f64 {
    let values = history.column(name).map_or(&[][..], |(values, _)| values);
    values.iter().map(|value| value.abs()).fold(0.0, f64::max)
}

/// Ratio of the largest values of two curves beyond which the smaller one lies flat on the axis.
const FLAT: f64 = 8.0;

/// Names in sets that one axis can show, in the order of their first members; what is zero goes with any.
fn of_like_size(names: Vec<String>, largest: impl Fn(&str) -> f64) -> Vec<Vec<String>> {
    let mut sets: Vec<(f64, f64, Vec<String>)> = Vec::new();
    for name in names {
        let size = largest(&name);
        let fits = |(low, high, _): &&mut (f64, f64, Vec<String>)| {
            size == 0.0 || *high == 0.0 || (size <= FLAT * *low && *high <= FLAT * size)
        };
        match sets.iter_mut().find(fits) {
            Some((low, high, set)) => {
                (*low, *high) = if size == 0.0 { (*low, *high) } else { (low.min(size), high.max(size)) };
                set.push(name);
            }
            None => sets.push((if size == 0.0 { f64::INFINITY } else { size }, size, vec![name])),
        }
    }
    sets.into_iter().map(|(_, _, set)| set).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn titles_name_quantities() {
        let column = |name: &str, unit: &str| Column::new(name, unit);
        let table = |columns: Vec<Column>| Table { values: vec![vec![1.0, 2.0]; columns.len()], columns };
        let titles = |table: Table| over_time(&table).into_iter().map(|curve| curve.title).collect::<Vec<_>>();
        assert_eq!(titles(table(vec![column("top", "N"), column("base", "N")])), ["Forces"]);
        assert_eq!(titles(table(vec![column("tip_angle", "rad")])), ["tip angle"]);
        assert_eq!(titles(table(vec![column("a", "1"), column("b", "1")])), ["Numbers and ratios"]);
    }

    #[test]
    fn curves_that_an_axis_would_hide_have_a_chart_of_their_own() {
        let sizes =
            [("length", 2.6), ("longest", 0.07), ("P50", 0.1), ("crushed", 0.003), ("none", 0.0), ("cracks", 1.0)];
        let names = sizes.iter().map(|(name, _)| (*name).to_owned()).collect();
        let sets = of_like_size(names, |name| sizes.iter().find(|size| size.0 == name).unwrap().1);
        assert_eq!(sets, [vec!["length", "none", "cracks"], vec!["longest", "P50"], vec!["crushed"]]);
        let zeros = of_like_size(vec!["a".into(), "b".into(), "c".into()], |name| if name == "c" { 5.0 } else { 0.0 });
        assert_eq!(zeros, [vec!["a", "b", "c"]]);
    }
}
