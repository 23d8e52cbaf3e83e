//! What a run writes.

use fractum_output::fields::OutputFields;

use super::{Gauges, Plot, Ppv};

/// What is written, and how often.
#[derive(Debug, Clone, PartialEq)]
pub struct Output {
    /// What frames hold besides what they always do.
    pub fields: OutputFields,
    /// Time between frames in motion [s].
    pub fields_every: f64,
    /// Change of the load factor between frames of this stage, if it is at rest [s].
    pub fields_every_at_rest: f64,
    /// Whether the case gives the time between frames.
    pub gives_fields: bool,
    /// Files that solids and particles of a frame are cut into, from 1.
    pub frame_pieces: usize,
    /// Whether the run ends with a movie of its frames.
    pub movie: bool,
    /// Time between rows of the history [s].
    pub history_every: f64,
    /// Whether the case gives that time.
    pub gives_history: bool,
    /// Wall time between checkpoints [s].
    pub checkpoint_every: f64,
    /// Steps after each of which a checkpoint is saved as well, from 1.
    pub checkpoint_steps: Option<u64>,
    /// Share of its strength that an edge may have lost and still join a fragment, above 0 up to 1.
    pub joined_below: f64,
    /// Peak particle velocity against distance.
    pub ppv: Vec<Ppv>,
    /// Grids of places with displacement and strain.
    pub gauges: Vec<Gauges>,
    /// Charts of the user's own in the report.
    pub plots: Vec<Plot>,
}
