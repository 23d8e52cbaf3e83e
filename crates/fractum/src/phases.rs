//! Wall time of the parts of a run.

use std::time::{Duration, Instant};

use fractum_scene::Phase;

/// Names of the parts in `summary.json`.
const NAMES: [&str; 11] =
    ["solid", "subcycling", "heat", "bonds", "fracture", "contact", "ties", "gas", "motion", "transition", "output"];

/// A part of a run.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Part {
    Solid,
    Subcycling,
    Heat,
    Bonds,
    Fracture,
    Contact,
    Ties,
    Gas,
    Motion,
    Transition,
    Output,
}

impl Part {
    /// As `summary.json` has it.
    pub(crate) fn name(self) -> &'static str {
        NAMES[self as usize]
    }
}

impl From<Phase> for Part {
    fn from(phase: Phase) -> Self {
        match phase {
            Phase::Solid => Part::Solid,
            Phase::Subcycling => Part::Subcycling,
            Phase::Heat => Part::Heat,
            Phase::Bonds => Part::Bonds,
            Phase::Fracture => Part::Fracture,
            Phase::Contact => Part::Contact,
            Phase::Ties => Part::Ties,
            Phase::Gas => Part::Gas,
            Phase::Motion => Part::Motion,
            Phase::Transition => Part::Transition,
        }
    }
}

/// How long each part of a run took so far; nothing of a part that has not run.
#[derive(Default)]
pub(crate) struct Phases([Option<Duration>; NAMES.len()]);

impl Phases {
    /// Adds the time that `what` takes to a part.
    pub(crate) fn timed<T>(&mut self, part: Part, what: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = what();
        self.add(part, start.elapsed());
        result
    }

    pub(crate) fn add(&mut self, part: Part, time: Duration) {
        *self.0[part as usize].get_or_insert_default() += time;
    }

    /// Names and seconds of the parts that have run.
    pub(crate) fn seconds(&self) -> impl Iterator<Item = (String, f64)> {
        NAMES.iter().zip(&self.0).filter_map(|(name, time)| Some(((*name).to_owned(), time.as_ref()?.as_secs_f64())))
    }
}
