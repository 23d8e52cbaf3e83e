//! `report.html`: a run on one page, for the eye and for the printer. It needs no other file and no script.

mod accuracy;
mod charts;
mod figure;
mod modes;
mod overlay;

use std::path::Path;

use fractum_scene::EnergyKind;
use maud::{DOCTYPE, Markup, PreEscaped, html};

pub use figure::ColourBar;

use crate::markup::head;
use crate::picture::Scale;
use crate::plot::{Chart, Level};
use charts::words;
use fractum_output::atomic;
use fractum_output::error::WriteError;
use fractum_output::fragments::Fragment;
use fractum_output::history::Table;
use fractum_output::log::duration;
use fractum_output::number::{grouped, instant_text, mode_text, percent, quantity, significant};
use fractum_output::summary::{Hashes, Status, Summary, Wall};
use fractum_output::warning::Warning;

/// Fragments listed; the file `fragments.csv` has them all.
const FRAGMENTS_LISTED: usize = 10;

/// Part of the largest value of a table below which a value is rounding.
const NOTHING: f64 = 1e-9;

/// Everything that the report shows. What is empty is left out.
#[derive(Clone, Debug, Default)]
pub struct ReportData {
    /// Title, status, probes, expectations, energies, counts and times.
    pub summary: Summary,
    /// The case, as the user calls it.
    pub case_file: String,
    /// The columns that the charts take their curves from; the first is the time.
    pub history: Table,
    /// Charts of probes, the load curve first.
    pub curves: Vec<Curve>,
    /// The energy ledger's columns.
    pub energy: Option<EnergyColumns>,
    /// Columns that count broken things: edges, bonds, removed elements, particles.
    pub cracks: Vec<String>,
    /// The pieces, largest first.
    pub fragments: Vec<Fragment>,
    /// Pictures of the body.
    pub pictures: Vec<Figure>,
    /// The movie of all frames as an APNG file's bytes.
    pub movie: Option<Vec<u8>>,
    /// Materials and settings: what and its value.
    pub inputs: Vec<(String, String)>,
    /// The plan, as `check` prints it.
    pub plan: String,
    /// Names and versions: program, compiler, machine, ...
    pub versions: Vec<(String, String)>,
}

/// A chart of columns of the history.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve {
    /// Title of the chart.
    pub title: String,
    /// Column of the abscissa: the time, or the displacement under the load.
    pub x: String,
    /// Columns of the ordinates, of one unit.
    pub y: Vec<String>,
    /// What they are together, as `force`.
    pub quantity: String,
    /// Whether the largest absolute value of the first ordinate is pointed out.
    pub mark_peak: bool,
    /// Values to compare with.
    pub levels: Vec<Level>,
    /// What the axes say; empty for the names of the columns, or the quantity.
    pub labels: [String; 2],
    /// Which axes are logarithmic.
    pub logarithmic: [bool; 2],
    /// Points to compare with, in the units of the columns, under their name.
    pub reference: Option<(String, Vec<[f64; 2]>)>,
}

/// Columns of the energy ledger.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnergyColumns {
    /// The external work.
    pub external: String,
    /// What it went into.
    pub parts: Vec<String>,
}

/// A picture with its title.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// What it shows, and when.
    pub title: String,
    /// The picture as a PNG file's bytes.
    pub png: Vec<u8>,
    /// What its colours mean.
    pub colours: Option<ColourBar>,
    /// Its scale, with width and height [pixels].
    pub scale: Option<(Scale, [usize; 2])>,
    /// Whether it is one of a strip over time.
    pub in_strip: bool,
    /// How displacements are drawn, behind the heading of a strip.
    pub magnified: String,
}

/// Writes the report at `path`.
///
/// # Errors
/// [`WriteError`].
pub fn write(path: &Path, data: &ReportData) -> Result<(), WriteError> {
    atomic::write(path, to_html(data).as_bytes())
}

/// The report's text.
pub fn to_html(data: &ReportData) -> String {
    let ReportData { summary, history, .. } = data;
    let mut figures: Vec<Chart> = data.curves.iter().filter_map(|curve| charts::curve(history, curve)).collect();
    figures.extend(data.energy.as_ref().and_then(|columns| charts::energy(history, columns)));
    figures.extend(charts::cracks(history, &data.cracks));
    figures.extend(charts::attenuations(&summary.breakage.ppv));
    figures.extend(charts::passing(&data.fragments, summary.breakage.fragment_sizes.as_ref()));
    figures.extend(charts::fragment_sizes(&data.fragments));
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            (head(&summary.title))
            body {
                (heading(data))
                (warnings(&data.summary.warnings))
                (expectations(summary))
                (accuracy::passes(summary))
                (pictures(&data.pictures))
                (strip(&data.pictures, data.movie.as_deref()))
                @if !figures.is_empty() {
                    section {
                        h2 { "Curves" }
                        div.grid { @for chart in &figures { figure { (PreEscaped(chart.to_svg())) } } }
                    }
                }
                (modes::vibrations(summary))
                (probes(summary))
                (fragments(&data.fragments))
                (energies(summary, &data.history))
                (wall(summary))
                (inputs(&data.inputs))
                @if !data.plan.is_empty() { section { h2 { "Plan" } pre { (data.plan.trim_end()) } } }
                (origin(data))
            }
        }
    };
    page.into_string()
}

fn heading(data: &ReportData) -> Markup {
    let Summary { title, status, threads, time, wall, fractum, .. } = &data.summary;
    let status = match status {
        Status::Completed => "completed",
        Status::Stopped => "stopped",
        Status::Interrupted => "interrupted",
    };
    html! {
        header {
            h1 { (if title.is_empty() { "Untitled" } else { title }) }
            p {
                span class={ "status " (status) } { (status) }
                @if !data.case_file.is_empty() { (data.case_file) " · " }
                @if let Some(found) = &data.summary.modes {
                    (found.vibrations.len()) " natural vibrations · "
                } @else {
                    (instant_text(time.end, time.at_rest)) @if time.at_rest { " after " } @else { " simulated in " }
                    (grouped(&time.steps.to_string())) " steps · "
                }
                (duration(wall.total)) " on " (threads) @if *threads == 1 { " thread" } @else { " threads" }
                " · fractum " (fractum)
            }
            @if !time.reason.is_empty() { p { "End: " (time.reason) } }
        }
    }
}

fn warnings(warnings: &[Warning]) -> Markup {
    html! {
        @if !warnings.is_empty() {
            section.warnings { strong { "Warnings" } ul { @for warning in warnings { li { (warning.to_string()) } } } }
        }
    }
}

fn expectations(summary: &Summary) -> Markup {
    html! {
        @if !summary.expect.is_empty() {
            section.keep {
                h2 { "Comparison with references" }
                div.scroll { table {
                    tr {
                        th { "Quantity" } th.number { "Result" } th.number { "Expected" } th.number { "Off by" }
                        th { "" } th { "Source" }
                    }
                    @for line in &summary.expect {
                        tr {
                            td { (words(&line.quantity)) }
                            td.number { (quantity(line.value, &line.unit)) }
                            td.number { (line.required()) }
                            td.number { (line.off()) }
                            td { span class={ "verdict " (if line.pass { "pass" } else { "fail" }) } {
                                (if line.pass { "pass" } else { "fail" })
                            } }
                            td.source { (line.source) }
                        }
                    }
                } }
            }
        }
    }
}

fn pictures(pictures: &[Figure]) -> Markup {
    html! {
        @if pictures.iter().any(|picture| !picture.in_strip) {
            section {
                h2 { "Pictures" }
                div.grid {
                    @for Figure { title, png, colours, scale, .. } in pictures.iter().filter(|picture| !picture.in_strip) {
                        figure {
                            figcaption { (title) }
                            div.picture {
                                img src=(figure::data_address(png)) alt=(title);
                                @if let Some((scale, size)) = scale { (PreEscaped(overlay::to_svg(scale, *size))) }
                            }
                            @if let Some(bar) = colours { div.bar { (PreEscaped(bar.to_svg())) } }
                        }
                    }
                }
            }
        }
    }
}

/// The body at some instants, in the colours of one range, and as a movie in the same colours.
fn strip(pictures: &[Figure], movie: Option<&[u8]>) -> Markup {
    let strip: Vec<&Figure> = pictures.iter().filter(|picture| picture.in_strip).collect();
    html! {
        @if !strip.is_empty() || movie.is_some() {
            section {
                h2 { "Over time" (strip.first().map_or("", |first| &first.magnified)) }
                @if let Some(movie) = movie {
                    figure.movie { img src=(figure::data_address(movie)) alt="movie of all frames"; }
                }
                div.strip {
                    @for Figure { title, png, .. } in &strip {
                        figure { figcaption { (title) } img src=(figure::data_address(png)) alt=(title); }
                    }
                }
                @if let Some(bar) = strip.iter().find_map(|figure| figure.colours.as_ref()) {
                    div.bar { (PreEscaped(bar.to_svg())) }
                }
            }
        }
    }
}

fn inputs(inputs: &[(String, String)]) -> Markup {
    html! {
        @if !inputs.is_empty() {
            section.keep {
                h2 { "Inputs" }
                table { @for (what, value) in inputs { tr { td { (what) } td { (value) } } } }
            }
        }
    }
}

/// A value that is nothing beside a larger one, as zero.
fn or_zero(value: f64, beside: f64) -> f64 {
    if value.abs() < NOTHING * beside.abs() { 0.0 } else { value }
}

fn probes(summary: &Summary) -> Markup {
    html! {
        @if !summary.probes.is_empty() {
            section.keep {
                h2 { "Probes" }
                div.scroll { table {
                    tr {
                        th { "Probe" } th.number { "Largest" } th.number { "at" } th.number { "Smallest" }
                        th.number { "At the end" }
                    }
                    @for (name, probe) in &summary.probes {
                        @let size = probe.max.abs().max(probe.min.abs());
                        @let shown = |value: f64| quantity(or_zero(value, size), &probe.unit);
                        tr {
                            td { (words(name)) }
                            td.number { (shown(probe.max)) }
                            td.number { (instant(summary, probe.time_of_max)) }
                            td.number { (shown(probe.min)) }
                            td.number { (shown(probe.r#final)) }
                        }
                    }
                } }
            }
        }
    }
}

/// An instant of a run, in words.
fn instant(summary: &Summary, time: f64) -> String {
    if summary.modes.is_some() && time.is_finite() { mode_text(time) } else { instant_text(time, summary.time.at_rest) }
}

fn fragments(fragments: &[Fragment]) -> Markup {
    html! {
        @if fragments.len() > 1 {
            section.keep {
                h2 { "Fragments" }
                @if fragments.len() > FRAGMENTS_LISTED {
                    p { (grouped(&fragments.len().to_string())) " pieces; the first " (FRAGMENTS_LISTED) ", all in fragments.csv:" }
                }
                div.scroll { table {
                    tr {
                        th.number { "Piece" } th.number { "Mass" } th.number { "Volume" } th.number { "Size" } th.number { "Extent" }
                        th.number { "Elements" } th.number { "Nodes" } th.number { "Speed" }
                    }
                    @for piece in fragments.iter().take(FRAGMENTS_LISTED) {
                        @let speed = piece.velocity.iter().map(|v| v * v).sum::<f64>().sqrt();
                        tr {
                            td.number { (piece.id) }
                            td.number { (quantity(piece.mass, "kg")) }
                            td.number { (quantity(piece.volume, "m^3")) }
                            td.number { (quantity(piece.size, "m")) }
                            td.number { (quantity(piece.largest_extent, "m")) }
                            td.number { (grouped(&piece.elements.to_string())) }
                            td.number { (grouped(&piece.nodes.to_string())) }
                            td.number { (quantity(speed, "m/s")) }
                        }
                    }
                } }
            }
        }
    }
}

fn energies(summary: &Summary, history: &Table) -> Markup {
    let energy = &summary.energy;
    let counts = &summary.counts;
    let stored = charts::elastic_at_start(history);
    // The work of the loads stands even when it is zero; other zeros are what is not part of the run.
    let ledger = EnergyKind::ALL.map(|kind| (kind, energy.entries[kind as usize]));
    let largest = ledger.iter().map(|(_, value)| value.abs()).fold(0.0, f64::max);
    let ledger = ledger.map(|(kind, value)| (kind, or_zero(value, largest)));
    let ledger = ledger.iter().filter(|(kind, value)| *value != 0.0 || *kind == EnergyKind::External);
    let sizes = [
        ("Nodes", counts.nodes),
        ("Elements", counts.elements),
        ("Removed elements", counts.removed_elements),
        ("Crushed elements", counts.crushed_elements),
        ("Broken edges", counts.broken_edges),
        ("Particles", counts.particles),
        ("Particles that came in", counts.entered_particles),
        ("Particles that wait", counts.waiting_particles),
        ("Pieces that left", counts.left_pieces),
        ("Bonds", counts.bonds),
        ("Broken bonds", counts.broken_bonds),
        ("Fragments", counts.fragments),
    ];
    html! {
        div.grid {
            section.keep {
                h2 { "Energy at the end" }
                table {
                    @for (kind, value) in ledger {
                        tr { td { (kind.label()) } td.number { (quantity(*value, "J")) } }
                        @if *kind == EnergyKind::Elastic && stored > 0.0 {
                            tr { td { "Elastic: stored at the start" } td.number { (quantity(stored, "J")) } }
                        }
                    }
                    tr { td { "Largest imbalance" } td.number { (percent(energy.residual_max_relative)) " of the work" } }
                }
            }
            section.keep {
                h2 { "Sizes" }
                table {
                    @for (name, count) in sizes.iter().filter(|(_, count)| *count > 0) {
                        tr { td { (name) } td.number { (grouped(&count.to_string())) } }
                    }
                    // At rest the load factor has steps of its own.
                    @if !summary.time.at_rest {
                        tr { td { "Last time step" } td.number { (quantity(summary.time.dt, "s")) } }
                        tr { td { "Smallest time step" } td.number { (quantity(summary.time.dt_min, "s")) } }
                    }
                }
            }
        }
    }
}

fn wall(summary: &Summary) -> Markup {
    let Wall { total, phases } = &summary.wall;
    let measured: f64 = phases.values().sum();
    let mut phases: Vec<(&str, f64)> = phases.iter().map(|(name, &seconds)| (name.as_str(), seconds)).collect();
    phases.push(("setting up and other", total - measured));
    // Slowest first; what takes no time to speak of is left out.
    phases.retain(|(_, seconds)| *seconds > 1e-3 * measured);
    phases.sort_by(|a, b| b.1.total_cmp(&a.1));
    let largest = phases.first().map_or(0.0, |(_, seconds)| *seconds);
    html! {
        @if largest > 0.0 {
            section.keep {
                h2 { "Run time" }
                table {
                    @for (name, seconds) in &phases {
                        tr {
                            td { (words(name)) }
                            td.number { (significant(*seconds, 3)) " s" }
                            td style="width: 70%" {
                                div.phase style={ "width: " (format!("{:.1}", 100.0 * seconds / largest)) "%" } {}
                            }
                        }
                    }
                    tr { td { strong { "total" } } td.number { (significant(*total, 3)) " s" } td {} }
                }
            }
        }
    }
}

fn origin(data: &ReportData) -> Markup {
    let Summary { hashes: Hashes { case_hash, state_hash }, .. } = &data.summary;
    html! {
        section.keep {
            h2 { "Origin" }
            table {
                @for (name, version) in &data.versions { tr { td { (name) } td { (version) } } }
                @for (name, hash) in [("Hash of the case", case_hash), ("Hash of the final state", state_hash)] {
                    @if !hash.is_empty() { tr { td { (name) } td.hash { (hash) } } }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_output::expectation::{Bound, Expectation};
    use fractum_output::history::Column;
    use fractum_output::summary::Probe;
    use fractum_output::warning::Code;

    fn example() -> ReportData {
        let mut data = ReportData {
            case_file: "cases/brazilian.toml".into(),
            history: Table {
                columns: vec![Column::new("time", "s"), Column::new("load", "N"), Column::new("broken_edges", "-")],
                values: vec![vec![0.0, 1e-4, 2e-4], vec![0.0, 3000.0, 100.0], vec![0.0, 0.0, 40.0]],
            },
            curves: vec![Curve {
                title: "Load".into(),
                x: "time".into(),
                y: vec!["load".into()],
                mark_peak: true,
                ..Curve::default()
            }],
            cracks: vec!["broken_edges".into()],
            pictures: vec![Figure { title: "At the end".into(), png: b"not looked at".to_vec(), ..Figure::default() }],
            plan: "bodies: <disc>".into(),
            ..ReportData::default()
        };
        data.summary.title = "Disc <split>".into();
        data.summary.warnings.push(Warning::new(Code::CoarseMesh, "", "element 5 & 6 are large"));
        let bound = |value, tolerance, relative| Bound::Near { value, tolerance, relative };
        let [strength, imbalance] = [bound(10_000.0, 500.0, Some(0.05)), bound(0.0, 1.0, None)];
        data.summary.expect.push(Expectation::hold("strength", "Pa", 10_200.0, strength, "a paper"));
        data.summary.expect.push(Expectation::hold("imbalance", "N", 3.0, imbalance, "equilibrium"));
        data.summary.probes.insert("load".into(), Probe { unit: "N".into(), max: 3000.0, ..Probe::default() });
        data
    }

    #[test]
    fn everything_given_is_on_the_page_and_stays_text() {
        let html = to_html(&example());
        for part in [
            "<h1>Disc &lt;split&gt;</h1>",
            "class=\"status completed\"",
            "element 5 &amp; 6 are large",
            "10.2 kPa",
            "2 %",
            "class=\"verdict pass\"",
            "class=\"verdict fail\"",
            "± 1 N",
            "data:image/png;base64,bm90",
            "load [kN]",
            ">3 kN</text>",
            "Crack growth",
            "bodies: &lt;disc&gt;",
        ] {
            assert!(html.contains(part), "{part} is missing");
        }
        assert!(!html.contains("NaN"));
    }

    #[test]
    fn the_page_needs_no_other_file_and_no_script() {
        let html = to_html(&example());
        for foreign in ["<script", "<link", "@import", "url(", "src=\"http", "href="] {
            assert!(!html.contains(foreign), "{foreign}");
        }
    }

    #[test]
    fn an_empty_run_makes_a_page_without_empty_sections() {
        let html = to_html(&ReportData::default());
        assert!(html.contains("Untitled") && html.ends_with("</html>"));
        for section in
            ["Warnings", "Comparison with references", "Pictures", "Curves", "Probes", "Fragments</h2>", "Plan"]
        {
            assert!(!html.contains(section), "{section}");
        }
    }

    #[test]
    fn open_and_closed_tags_match() {
        let html = to_html(&example());
        for tag in ["section", "table", "tr", "td", "div", "figure", "svg", "text", "span", "p", "h2"] {
            let open = html.matches(&format!("<{tag}>")).count() + html.matches(&format!("<{tag} ")).count();
            assert_eq!(open, html.matches(&format!("</{tag}>")).count(), "{tag}");
        }
    }
}
