//! `study.html` and `study.svg`: run time beside error, and the curves and pictures of all runs side by side.

use fractum_output::study::compare::{Family, Varies};
use fractum_output::study::table::{self, Table};
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::markup::head;
use crate::plot::{Axis, Chart, Series, Style};

/// What the page shows beside the runs themselves.
#[derive(Clone, Debug, Default)]
pub struct Exhibits {
    /// Curves of runs, a chart per case.
    pub curves: Vec<Chart>,
    /// Pictures: title and path from the folder of the page.
    pub pictures: Vec<(String, String)>,
    /// Reports of single runs: title and path from the folder of the page.
    pub reports: Vec<(String, String)>,
}

/// Run time against the largest relative error, a chart per family, a series per setting.
pub fn price(families: &[Family<'_>]) -> Vec<Chart> {
    families.iter().filter_map(price_of).collect()
}

fn price_of(family: &Family<'_>) -> Option<Chart> {
    let x = Axis::new("run time", "s").logarithmic();
    let y = Axis::new("largest relative error [%]", "-").logarithmic();
    let mut chart = Chart { title: format!("{}: run time and error", family.label), x, y, ..Chart::default() };
    for verdict in family.verdicts() {
        let points = verdict.measured().filter_map(|run| Some((run.seconds(), 100.0 * run.worst()?)));
        let (times, errors): (Vec<f64>, Vec<f64>) = points.unzip();
        if !times.is_empty() {
            chart.series.push(Series::new(verdict.label.clone(), times, errors, Style::Points));
        }
    }
    (!chart.series.is_empty()).then_some(chart)
}

/// Charts one below the other in one picture.
pub fn to_svg(charts: &[Chart]) -> String {
    const SIZE: [usize; 2] = [640, 340];
    let height = SIZE[1] * charts.len().max(1);
    let mut svg = format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {height}\">\n", SIZE[0]);
    svg += "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n";
    for (index, chart) in charts.iter().enumerate() {
        let place = format!("<svg y=\"{}\" width=\"{}\" height=\"{}\" ", SIZE[1] * index, SIZE[0], SIZE[1]);
        svg += &chart.to_svg().replacen("<svg ", &place, 1);
    }
    svg + "</svg>\n"
}

/// The page.
pub fn to_html(title: &str, families: &[Family<'_>], within: Option<f64>, exhibits: &Exhibits) -> String {
    let title = if title.is_empty() { "Study" } else { title };
    let runs = families.iter().map(|family| family.runs.len()).sum::<usize>();
    let finished = families.iter().flat_map(|family| &family.runs).filter(|run| run.measured().is_some()).count();
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            (head(title))
            body {
                header {
                    h1 { (title) }
                    p { (finished) " of " (runs) " runs have finished · run time is processor time where the system tells it · fractum " (env!("CARGO_PKG_VERSION")) }
                }
                (list("Findings", &table::findings(families, within)))
                (tables("Settings over all cases", &table::settings(families)))
                (charts("Run time and error", &price(families)))
                (charts("Curves", &exhibits.curves))
                (pictures(&exhibits.pictures))
                (tables("Runs", &families.iter().map(table::runs).collect::<Vec<_>>()))
                (list("Runs that failed", &table::failures(families)))
                @if !exhibits.reports.is_empty() {
                    section { h2 { "Reports of the runs" } ul { @for (name, path) in &exhibits.reports { li { a href=(path) { (name) } } } } }
                }
                (axes(families))
            }
        }
    };
    page.into_string()
}

fn list(title: &str, lines: &[String]) -> Markup {
    html! { @if !lines.is_empty() { section { h2 { (title) } ul { @for line in lines { li { (line) } } } } } }
}

fn charts(title: &str, charts: &[Chart]) -> Markup {
    html! {
        @if !charts.is_empty() {
            section { h2 { (title) } div.grid { @for chart in charts { figure { (PreEscaped(chart.to_svg())) } } } }
        }
    }
}

fn tables(title: &str, tables: &[Table]) -> Markup {
    html! {
        @if !tables.is_empty() {
            section {
                h2 { (title) }
                @for Table { title, header, rows } in tables {
                    h3 { (title) }
                    div.scroll { table {
                        tr { @for name in header { th { (name) } } }
                        @for row in rows { tr { @for cell in row { td { (cell) } } } }
                    } }
                }
                p.source { "! means that a reference is missed." }
            }
        }
    }
}

fn pictures(pictures: &[(String, String)]) -> Markup {
    html! {
        @if !pictures.is_empty() {
            section {
                h2 { "Damage at the end" }
                div.grid { @for (title, path) in pictures { figure { figcaption { (title) } img src=(path) alt=(title) loading="lazy"; } } }
            }
        }
    }
}

/// What was varied, for whoever finds the page later.
fn axes(families: &[Family<'_>]) -> Markup {
    let word = |varies: &Varies| match varies {
        Varies::Case => "case or size",
        Varies::Seed => "seed",
        Varies::Setting => "setting",
    };
    html! {
        section.keep {
            h2 { "What was varied" }
            table {
                @for family in families { @for (axis, varies) in &family.axes {
                    tr { td { (family.label) } td { (axis) } td { (word(varies)) } }
                } }
            }
        }
    }
}
