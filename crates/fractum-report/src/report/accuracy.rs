//! Passes on several meshes and error bars in the report.

use fractum_output::accuracy::{Accuracy, Pass};
use fractum_output::number::{percent, quantity, significant};
use fractum_output::study::table::of_passes;
use fractum_output::summary::Summary;
use maud::{Markup, PreEscaped, html};

use crate::plot::{Axis, Chart, Level, Series, Style};

/// The passes, the peaks with their bars, and the peaks of the load by size.
pub(super) fn passes(summary: &Summary) -> Markup {
    let Some(found) = &summary.accuracy else { return html! {} };
    let table = of_passes(found);
    html! {
        section {
            h2 { "Accuracy" }
            p {
                "Peaks on an endlessly fine mesh, from the passes below; " (significant(10.0 * found.confidence, 2)) " of 10 bars of the load and of its multiples hold the truth, and others tell how the passes scatter. Asked for: "
                (percent(found.asked)) " of " (found.load) ". The curves and pictures of this page are those of the finest pass."
            }
            div.scroll { table {
                tr { th { "Peak" } th.number { "Value" } }
                @for (name, estimate) in &found.probes { tr { td { (name) } td.number { (estimate.words()) } } }
            } }
            div.scroll { table {
                tr { @for name in &table.header { th { (name) } } }
                @for row in &table.rows { tr { @for cell in row { td { (cell) } } } }
            } }
            p {
                "Size is that of the elements where damage came; l = " (quantity(found.length, "m")) ": 1/l = 1/zone + 1/extent, of the process zone and the smallest extent of the body."
            }
            @if let Some(chart) = chart(found) { div.grid { figure { (PreEscaped(chart.to_svg())) } } }
        }
    }
}

/// Peaks of the load by the size of elements.
fn chart(found: &Accuracy) -> Option<Chart> {
    let estimate = found.probes.get(&found.load)?;
    let series = |name: &str, counts: bool| {
        let shown = |pass: &&Pass| pass.left_out.is_empty() == counts && pass.size.is_finite();
        let passes: Vec<&Pass> = found.passes.iter().skip(1).filter(shown).collect();
        let x = passes.iter().map(|pass| pass.size / found.length).collect();
        let y = passes.iter().map(|pass| pass.peaks.get(&found.load).copied().unwrap_or(f64::NAN)).collect();
        Series::new(name, x, y, Style::Points)
    };
    let level = |label: &str, value: f64| Level { label: label.to_owned(), value };
    Some(Chart {
        title: format!("Peak of {} by size of elements", found.load),
        x: Axis::new("size over l", "-").from_zero(),
        y: Axis::new("peak", &estimate.unit),
        series: vec![series("passes", true), series("left out", false)]
            .into_iter()
            .filter(|own| !own.x.is_empty())
            .collect(),
        levels: vec![
            level("estimate", estimate.value),
            level("bar", estimate.value - estimate.half),
            level("bar", estimate.value + estimate.half),
        ],
        ..Chart::default()
    })
}
