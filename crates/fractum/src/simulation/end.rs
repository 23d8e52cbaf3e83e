//! Why a run is over.

use fractum_case::model::StopWhen;
use fractum_output::number::percent;
use fractum_output::summary::Status;
use fractum_output::warning::Warning;
use fractum_scene::StepError;
use fractum_scene::statics::modes_of;

use super::Simulation;
use crate::output::series::index_of_max;

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

impl Simulation {
    /// Why there is no further step.
    pub(super) fn last_step(&self) -> String {
        if let Some(found) = modes_of(&self.scene) {
            return format!("{} natural vibrations were found", found.modes.len());
        }
        let (time, end) = (self.time(), self.case.solver.end);
        match time >= end * (1.0 - 1e-9) {
            true => format!("{} is the end of the run", self.instant(end)),
            false => {
                let why = if self.solver.has_used_up_its_steps() { ": solver.max_steps allows no more" } else { "" };
                format!("last step at {}, before its end at {}{why}", self.instant(time), self.instant(end))
            }
        }
    }

    /// The early end that the stage asks for, and why it is reached.
    pub(super) fn falls_below(&self) -> Option<String> {
        let stop = self.case.solver.stop_when.as_ref()?;
        let record = self.recorder.state();
        let (values, time) = (&record.series[stop.probe], record.times.last().copied().unwrap_or(0.0));
        let drop = Drop::of(&record.times, values, stop.below)?;
        let is_over = match stop.lasting {
            Some(lasting) => drop.lasting >= lasting,
            None => drop.is_deep || drop.lasting >= StopWhen::SHARE * drop.until_peak,
        };
        if time < stop.after || !is_over {
            return None;
        }
        let (name, part) = (&self.case.probes[stop.probe].name.value, percent(stop.below));
        let what = format!("{name} fell below {part} of its largest value at {}", self.instant(time));
        let small = !drop.is_deep && stop.lasting == Some(0.0);
        let further = if small { "; whether it would rise again is not known (stop_when.lasting)" } else { "" };
        Some(format!("{what}{further}"))
    }
}

/// The last values of a curve that have fallen below a fraction of its largest value.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drop {
    /// Time since the first of them [s].
    lasting: f64,
    /// Time from the start to the largest value [s].
    until_peak: f64,
    /// Whether the last value is below [`StopWhen::DEEP`].
    is_deep: bool,
}

impl Drop {
    fn of(times: &[f64], values: &[f64], below: f64) -> Option<Self> {
        let peak = index_of_max(values)?;
        let largest = values[peak];
        let count = values.iter().rev().take_while(|value| **value < below * largest).count();
        if largest <= 0.0 || count == 0 {
            return None;
        }
        // Along a path the load factor may fall.
        let way = |times: &[f64]| times.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
        let first = values.len() - count;
        let is_deep = values[values.len() - 1] < StopWhen::DEEP * largest;
        Some(Drop { lasting: way(&times[first..]), until_peak: way(&times[..=peak]), is_deep })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drop_is_judged_by_its_depth_and_by_the_way_to_the_peak() {
        let times: Vec<f64> = (0..10).map(f64::from).collect();
        let of = |values: &[f64], below: f64| Drop::of(&times[..values.len()], values, below);
        let drop = |lasting, until_peak, is_deep| Some(Drop { lasting, until_peak, is_deep });
        assert_eq!(of(&[0.0, 1.0, 2.0, 1.5], 0.8), drop(0.0, 2.0, false));
        assert_eq!(of(&[0.0, 1.0, 2.0, 1.5, 1.5, 1.4], 0.8), drop(2.0, 2.0, false));
        assert_eq!(of(&[0.0, 1.0, 2.0, 1.5, 0.9], 0.8), drop(1.0, 2.0, true));
        // A curve that has risen again has not fallen; nor has one that was never above zero, or that is empty.
        assert_eq!(of(&[0.0, 1.0, 2.0, 1.5, 1.7], 0.8), None);
        assert_eq!(of(&[-1.0, -2.0], 0.8), None);
        assert_eq!(of(&[], 0.8), None);
        // Along a path that turns back.
        assert_eq!(Drop::of(&[0.0, 2.0, 1.5, 1.0], &[0.0, 3.0, 2.0, 1.6], 0.7), drop(0.5, 2.0, false));
    }
}
