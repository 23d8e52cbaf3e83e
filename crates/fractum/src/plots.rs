//! Plots of the user's own: whether a run has their columns, and what its report keeps of them.

use fractum_case::model::{Case, Plot};
use fractum_case::{Diagnostic, Diagnostics, Spanned};
use fractum_output::history::Column;
use fractum_output::notes::PlotNote;

/// The plots of a case.
pub(crate) fn notes(case: &Case) -> Vec<PlotNote> {
    let note = |plot: &Plot| PlotNote {
        title: plot.title.clone(),
        x: plot.x.value.clone(),
        y: plot.y.iter().map(|name| name.value.clone()).collect(),
        labels: plot.labels.clone(),
        logarithmic: plot.scale.logarithmic(),
        reference: plot.reference.as_ref().map(|own| (own.name.clone(), own.points.clone())),
    };
    case.output.plots.iter().map(note).collect()
}

/// Finds columns that a run does not have, as those of heat without heat.
///
/// # Errors
/// Each of them, with its place and the columns that there are.
pub(crate) fn check(case: &Case, columns: &[Column]) -> Result<(), Diagnostics> {
    let is_there = |name: &&Spanned<String>| {
        let is_probe = case.probes.iter().any(|probe| probe.name.value == name.value);
        is_probe || columns.iter().any(|column| column.name == name.value)
    };
    let missing = |name: &Spanned<String>| {
        let names: Vec<&str> = columns.iter().map(|column| column.name.as_str()).collect();
        let found = format!("= \"{}\", a column that the history of this run does not have", name.value);
        Diagnostic::error(&name.place, found).remedy(format!("it has {}", names.join(", ")))
    };
    let names = case.output.plots.iter().flat_map(|plot| plot.y.iter().chain([&plot.x]));
    let missing: Vec<Diagnostic> = names.filter(|name| !is_there(name)).map(missing).collect();
    if missing.is_empty() { Ok(()) } else { Err(Diagnostics(missing)) }
}
