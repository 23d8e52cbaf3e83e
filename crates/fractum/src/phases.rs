//! Wall time of the parts of a run.

use std::time::{Duration, Instant};

use fractum_scene::Phase;

/// Names of the parts in `summary.json`.
const NAMES: [&str; 6] = ["solid", "bonds", "contact", "motion", "transition", "output"];

/// A part of a run.
#[derive(Clone, Copy)]
pub(crate) enum Part {
    Solid,
    Bonds,
    Contact,
    Motion,
    Transition,
    Output,
}

impl From<Phase> for Part {
    fn from(phase: Phase) -> Self {
        match phase {
            Phase::Solid => Part::Solid,
            Phase::Bonds => Part::Bonds,
            Phase::Contact => Part::Contact,
            Phase::Motion => Part::Motion,
            Phase::Transition => Part::Transition,
        }
    }
}

/// How long each part of a run took so far.
#[derive(Default)]
pub(crate) struct Phases([Duration; NAMES.len()]);

impl Phases {
    /// Adds the time that `what` takes to a part.
    pub(crate) fn timed<T>(&mut self, part: Part, what: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = what();
        self.add(part, start.elapsed());
        result
    }

    pub(crate) fn add(&mut self, part: Part, time: Duration) {
        self.0[part as usize] += time;
    }

    /// Names and seconds.
    pub(crate) fn seconds(&self) -> impl Iterator<Item = (String, f64)> {
        NAMES.iter().zip(&self.0).map(|(name, time)| ((*name).to_owned(), time.as_secs_f64()))
    }
}
