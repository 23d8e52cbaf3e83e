//! Why a run is over.

use fractum_io::number::percent;
use fractum_io::summary::Status;
use fractum_io::warning::Warning;
use fractum_scene::StepError;

use super::Simulation;

/// Why a run is over.
pub(super) enum End {
    /// With the reason, in words.
    Finished(String),
    Interrupted,
    Failed(StepError),
    /// A strict run has met a warning.
    Strict(Warning),
}

impl End {
    /// Why the run is over, in words.
    pub(super) fn reason(&self) -> String {
        match self {
            End::Finished(why) => why.clone(),
            End::Interrupted => "interrupted".to_owned(),
            End::Failed(error) => error.to_string(),
            End::Strict(warning) => warning.to_string(),
        }
    }

    pub(super) fn status(&self) -> Status {
        match self {
            End::Finished(_) => Status::Completed,
            End::Interrupted => Status::Interrupted,
            End::Failed(_) | End::Strict(_) => Status::Stopped,
        }
    }
}

/// Share of the largest value below which a load that has fallen seldom rises above that again.
const SMALL_DROP: f64 = 0.5;

impl Simulation {
    /// Why there is no further step.
    pub(super) fn last_step(&self) -> String {
        let (time, end) = (self.time(), self.case.solver.end);
        match time >= end * (1.0 - 1e-9) {
            true => format!("{} is the end of the run", self.instant(end)),
            false => format!("last step at {}, before its end at {}", self.instant(time), self.instant(end)),
        }
    }

    /// The early end that the stage asks for, and why it is reached.
    pub(super) fn falls_below(&self) -> Option<String> {
        let stop = self.case.solver.stop_when.as_ref()?;
        let record = self.recorder.state();
        let (values, time) = (&record.series[stop.probe], record.times.last().copied().unwrap_or(0.0));
        let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let is_below = |value: &f64| *value < stop.below * largest;
        let rows_below = values.iter().rev().take_while(|value| is_below(value)).count();
        // Along a path the load factor may fall.
        let below = record.times.len().saturating_sub(rows_below);
        let lasting: f64 = record.times[below..].windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        if largest <= 0.0 || time < stop.after || rows_below == 0 || lasting < stop.lasting {
            return None;
        }
        let (name, part) = (&self.case.probes[stop.probe].name.value, percent(stop.below));
        let what = format!("{name} fell below {part} of its largest value at {}", self.instant(time));
        let small = stop.below > SMALL_DROP && stop.lasting == 0.0;
        let further = if small { "; whether it would rise again is not known (stop_when.lasting)" } else { "" };
        Some(format!("{what}{further}"))
    }
}
