//! Curves and pictures of the runs of a study, side by side.

use std::path::Path;

use fractum_output::history;
use fractum_output::study::compare::{Family, Varies};
use fractum_output::study::run::Run;

use crate::folder::load_curve;
use crate::plot::{Axis, Chart, Series, Style};
use crate::study::Exhibits;

/// What the results folders of finished runs show.
pub fn of(families: &[Family<'_>], output: &Path) -> Exhibits {
    let mut exhibits = Exhibits::default();
    for family in families {
        for run in family.runs.iter().filter(|run| run.measured().is_some()) {
            let title = format!("{}: {}", family.label, family.full_name(run));
            let path = |name: &str| run.folder.join(name);
            let address = |name: &str| path(name).to_string_lossy().replace('\\', "/");
            let picture = "pictures/damage.png";
            if output.join(path(picture)).is_file() {
                exhibits.pictures.push((title.clone(), address(picture)));
            }
            if output.join(path("report.html")).is_file() {
                exhibits.reports.push((title, address("report.html")));
            }
        }
        exhibits.curves.extend(curves(family, output));
    }
    exhibits
}

/// The load curves of a family: a chart for each case, with a line for each setting.
fn curves(family: &Family<'_>, output: &Path) -> Vec<Chart> {
    let mut charts: Vec<(String, Chart)> = Vec::new();
    for run in family.runs.iter().filter(|run| run.measured().is_some()) {
        let Some((series, x, y)) = curve(run, output) else { continue };
        let one_setting = family.verdicts().len() < 2;
        let shared = if one_setting { String::new() } else { family.name(run, &[Varies::Case]) };
        let name = if one_setting { family.full_name(run) } else { family.name(run, &[Varies::Setting, Varies::Seed]) };
        let series = Series { name, ..series };
        match charts.iter_mut().find(|(case, chart)| *case == shared && chart.x == x && chart.y == y) {
            Some((_, chart)) => chart.series.push(series),
            None => {
                let title =
                    if shared.is_empty() { family.label.to_owned() } else { format!("{}: {shared}", family.label) };
                charts.push((shared, Chart { title, x, y, series: vec![series], ..Chart::default() }));
            }
        }
    }
    charts.into_iter().map(|(_, chart)| chart).collect()
}

/// The load curve of a run with its axes.
fn curve(run: &Run, output: &Path) -> Option<(Series, Axis, Axis)> {
    let history = history::read(&output.join(&run.folder).join("history.csv")).ok()?;
    let curve = load_curve(&history)?;
    let (x, x_unit) = history.column(&curve.x)?;
    let (y, y_unit) = history.column(curve.y.first()?)?;
    let words = |name: &str| name.replace('_', " ");
    let axes = (Axis::new(words(&curve.x), x_unit), Axis::new(words(&curve.y[0]), y_unit).from_zero());
    Some((Series::new("", x.to_vec(), y.to_vec(), Style::Line), axes.0, axes.1))
}
