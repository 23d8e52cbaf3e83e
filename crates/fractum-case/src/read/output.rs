//! `[output]`.

use fractum_output::fields::OutputFields;
use fractum_output::warning::Code;

use crate::Diagnostic;
use crate::model::{Output, Plot};
use crate::reader::Table;

/// Frames of fields where nothing is said; where a run has several stages, of those in motion, and of each at rest.
pub(super) const FRAMES: f64 = 50.0;
/// Rows of the history where nothing is said; of its stages in motion where a run has several.
pub(super) const ROWS: f64 = 1000.0;
/// Most files that a frame may be cut into.
const MOST_PIECES: u64 = 4096;
/// Wall time between checkpoints where nothing is said [s].
const CHECKPOINT: f64 = 600.0;
/// Wall time between checkpoints below which time of the scene was probably meant [s].
const OFTEN: f64 = 1.0;
/// Share of the strength lost at which an edge joins fragments no longer, where nothing is said.
const JOINED_BELOW: f64 = 0.95;

/// Reads what is written; `end` is that of the run, where it is known.
pub(super) fn read(root: &Table<'_>, end: Option<f64>, plots: Option<Vec<Plot>>) -> Option<Output> {
    let table = root.table_or_empty("output");
    let mut further = OutputFields::default();
    let mut pieces = 1;
    let mut steps = None;
    let mut every = |name: &'static str, longest: Option<f64>| {
        let inner = table.table(name)?;
        let every = inner.quantity("every").positive().spanned();
        let every = if name == "fields" {
            further = OutputFields::of(|field| inner.flag(field.key()).or(false));
            pieces = inner.integer("pieces").check(|count| (1..=MOST_PIECES).contains(count), "1 to 4096").or(1);
            every.given()
        } else if name == "checkpoint" {
            steps = inner.integer("steps").check(|&steps| steps > 0, "1 or more").given();
            if steps.is_some() { every.given() } else { every.required() }
        } else {
            every.required()
        };
        inner.finish("here");
        if let (Some(every), Some(longest)) = (&every, longest)
            && every.value > longest
        {
            let note = Diagnostic::warning(
                Code::OutputInterval,
                &every.place,
                format!("is longer than the run of {longest} s"),
            );
            table.reader.note(note);
        }
        if let Some(every) = every.as_ref().filter(|every| name == "checkpoint" && every.value < OFTEN) {
            let note =
                Diagnostic::warning(Code::OutputInterval, &every.place, "is time on the clock, not time of the scene");
            table
                .reader
                .note(note.remedy("take minutes, or leave it out: a run that always saves its state does little else"));
        }
        every.map(|every| every.value)
    };
    let fields = every("fields", end);
    let movie = table.flag("movie").or(false);
    let history = every("history", end);
    let checkpoint = every("checkpoint", None);
    let fragments = table.table_or_empty("fragments");
    let joined_below = fragments.quantity("joined_below").between(0.0, 1.0).or(JOINED_BELOW);
    fragments.finish("here");
    let ppv = super::ppv::read(&table);
    let gauges = super::gauges::read(&table);
    table.finish("here");
    let end = end?;
    Some(Output {
        fields: further,
        fields_every: fields.unwrap_or(end / FRAMES),
        fields_every_at_rest: fields.unwrap_or(end / FRAMES),
        gives_fields: fields.is_some(),
        frame_pieces: pieces as usize,
        movie,
        history_every: history.unwrap_or(end / ROWS),
        gives_history: history.is_some(),
        checkpoint_every: checkpoint.unwrap_or(CHECKPOINT),
        checkpoint_steps: steps,
        joined_below,
        ppv: ppv?,
        gauges: gauges?,
        plots: plots?,
    })
}
