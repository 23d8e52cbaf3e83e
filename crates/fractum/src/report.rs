//! The report of a results folder, made from the files in it: at the end of a run, or again later.

use std::fs;
use std::path::Path;

use fractum_io::fragments::Fragment;
use fractum_io::history::{self, Table};
use fractum_io::picture::ColourMap;
use fractum_io::report::{self, ColourBar, Curve, EnergyColumns, Figure, ReportData};
use fractum_io::summary::Summary;
use fractum_scene::EnergyKind;
use serde::{Deserialize, Serialize};

use crate::error::Failure;

/// File in the results folder with what the report needs beside summary, history and fragments.
const NOTES: &str = "pictures/notes.json";

/// What the report shows that no other file of the folder holds.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Notes {
    /// The case, as the user calls it.
    pub case_file: String,
    /// The plan.
    pub plan: String,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Pictures in the folder `pictures`.
    pub pictures: Vec<PictureNote>,
}

/// A picture in the folder `pictures`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct PictureNote {
    /// Name of the PNG file.
    pub file: String,
    /// What it shows, and when.
    pub title: String,
    /// Name of the field that its colours stand for.
    pub label: String,
    /// SI unit of the field.
    pub unit: String,
    /// Whether the colours are those of damage.
    pub damage: bool,
    /// Values at the ends of the colours.
    pub range: (f64, f64),
}

/// Keeps the notes of a run in its folder.
///
/// # Errors
/// [`Failure::Write`].
pub fn keep(folder: &Path, notes: &Notes) -> Result<(), Failure> {
    fractum_io::atomic::create_folder(&folder.join("pictures"))?;
    let text = serde_json::to_string_pretty(notes).unwrap_or_default();
    Ok(fractum_io::atomic::write(&folder.join(NOTES), text.as_bytes())?)
}

/// Writes `report.html` from the files of a results folder.
///
/// # Errors
/// [`Failure`] if the folder is not that of a finished run, or the page cannot be written.
pub fn write(folder: &Path) -> Result<(), Failure> {
    let missing = |name: &str, error: &dyn std::fmt::Display| {
        Failure::input(format!(
            "{}: no {name} to report on: {error}; name the results folder of a run",
            folder.display()
        ))
    };
    let summary = Summary::read(&folder.join("summary.json")).map_err(|e| missing("summary.json", &e))?;
    let history = history::read(&folder.join("history.csv")).map_err(|e| missing("history.csv", &e))?;
    let notes: Notes = match fs::read(folder.join(NOTES)) {
        Ok(bytes) => serde_json::from_slice(&bytes).map_err(|e| missing(NOTES, &e))?,
        Err(_) => Notes::default(),
    };
    let fragments = history::read(&folder.join("fragments.csv")).map(|table| fragments_of(&table)).unwrap_or_default();
    let pictures = notes.pictures.iter().filter_map(|note| figure(folder, note)).collect();
    let data = ReportData {
        curves: curves(&history),
        energy: Some(EnergyColumns {
            external: EnergyKind::External.name().into(),
            parts: EnergyKind::ALL.into_iter().filter(|kind| kind.sign() < 0).map(|kind| kind.name().into()).collect(),
        }),
        cracks: ["removed_elements", "particles", "broken_bonds"].map(String::from).into(),
        fragments,
        pictures,
        plan: notes.plan,
        warnings: notes.warnings,
        case_file: notes.case_file,
        versions: vec![
            ("fractum".into(), summary.fractum.clone()),
            ("platform".into(), format!("{} {}", std::env::consts::OS, std::env::consts::ARCH)),
        ],
        summary,
        history,
    };
    Ok(report::write(&folder.join("report.html"), &data)?)
}

fn figure(folder: &Path, note: &PictureNote) -> Option<Figure> {
    let png = fs::read(folder.join("pictures").join(&note.file)).ok()?;
    let map = if note.damage { ColourMap::Damage } else { ColourMap::Viridis };
    let colours = ColourBar { label: note.label.clone(), unit: note.unit.clone(), map, range: note.range };
    Some(Figure { title: note.title.clone(), png, colours: Some(colours) })
}

/// The load curve (first force against first displacement), then the probes over time, one chart per unit.
fn curves(history: &Table) -> Vec<Curve> {
    let names: Vec<&str> = history.columns.iter().map(|c| c.name.as_str()).collect();
    let probes = &history.columns[crate::record::count_ledger_columns(&names)..];
    let of_unit = |unit: &str| probes.iter().find(|c| c.unit == unit).map(|c| c.name.clone());
    let mut curves = Vec::new();
    if let (Some(load), Some(displacement)) = (of_unit("N"), of_unit("m")) {
        curves.push(Curve {
            title: format!("{load} against {displacement}"),
            x: displacement,
            y: vec![load],
            mark_peak: true,
            levels: Vec::new(),
        });
    }
    let mut units: Vec<&str> = Vec::new();
    for column in probes {
        if !units.contains(&column.unit.as_str()) {
            units.push(&column.unit);
        }
    }
    for unit in units {
        let y: Vec<String> = probes.iter().filter(|c| c.unit == unit).map(|c| c.name.clone()).collect();
        let title = if y.len() == 1 { y[0].clone() } else { format!("probes in {unit}") };
        curves.push(Curve { title, x: "time".into(), y, mark_peak: false, levels: Vec::new() });
    }
    curves
}

fn fragments_of(table: &Table) -> Vec<Fragment> {
    let rows = table.values.first().map_or(0, Vec::len);
    let value = |name: &str, row: usize| table.column(name).map_or(0.0, |(values, _)| values[row]);
    let vector = |prefix: &str, row: usize| ["x", "y", "z"].map(|axis| value(&format!("{prefix}{axis}"), row));
    (0..rows)
        .map(|row| Fragment {
            id: value("id", row) as u64,
            mass: value("mass", row),
            volume: value("volume", row),
            nodes: value("nodes", row) as u64,
            elements: value("elements", row) as u64,
            centroid: vector("", row),
            velocity: vector("velocity_", row),
            largest_extent: value("largest_extent", row),
            size: value("size", row),
        })
        .collect()
}
