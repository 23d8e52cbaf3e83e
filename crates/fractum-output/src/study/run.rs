//! What came of the runs of a study.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::expectation::{Comparison, Expectation};
use crate::number::or_null;
use crate::summary::{Status, Summary};

/// Name of the axis of case files.
pub const CASE: &str = "case";

/// Name of the axis of the labelled settings of a study file.
pub const SETTING: &str = "setting";

/// One run of a study: a line of its list.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planned {
    /// Name, and that of its results folder.
    pub name: String,
    /// The cases that it is compared with.
    pub family: String,
    /// Its case in a word, for tables.
    pub case_label: String,
    /// Label of what it sets together; empty where it has none.
    pub setting: String,
    /// Case file.
    pub case: PathBuf,
    /// Keys and values, as `--set` takes them.
    pub overrides: Vec<(String, String)>,
}

impl Planned {
    /// What sets it apart within its family: axis and value.
    pub fn coordinates(&self) -> impl Iterator<Item = (&str, &str)> {
        let labels = [(CASE, self.case_label.as_str()), (SETTING, self.setting.as_str())];
        let keys = self.overrides.iter().map(|(key, value)| (key.as_str(), value.trim_matches('"')));
        labels.into_iter().filter(|(_, label)| !label.is_empty()).chain(keys)
    }

    /// Its value on an axis of its family; empty where it has none. The last of several values counts, as on the command line.
    pub fn on(&self, axis: &str) -> &str {
        self.coordinates().filter(|(name, _)| *name == axis).last().map_or("", |(_, value)| value)
    }
}

/// A run of a study with its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// What was to be run.
    pub planned: Planned,
    /// Results folder, from the folder of the tables.
    pub folder: PathBuf,
    /// What came of it.
    pub end: End,
    /// Its summary, if it has left one.
    pub summary: Option<Box<Summary>>,
}

/// How a run of a study ended.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum End {
    /// It was not run, or was interrupted.
    #[default]
    Open,
    /// It reached its end.
    Finished(Box<Measured>),
    /// It was refused or stopped itself, and why.
    Failed(String),
}

/// What a finished run took and gave.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Mean length of the edges of the elements of solids, else mean diameter of the particles [m].
    #[serde(with = "or_null")]
    pub size: f64,
    /// Elements of solids.
    pub elements: u64,
    /// Particles of bonded and loose bodies.
    pub particles: u64,
    /// Steps done.
    pub steps: u64,
    /// Wall time of the whole run [s].
    #[serde(with = "or_null")]
    pub wall: f64,
    /// Time of the processor, summed over threads [s]; absent where the system does not tell it.
    pub processor: Option<f64>,
    /// The references of the case with their errors, and what is compared without a reference.
    pub expect: Vec<Expectation>,
}

impl Measured {
    /// Run time by which settings are compared [s]: that of the processor, which other programs disturb less, or else wall time.
    pub fn seconds(&self) -> f64 {
        self.processor.unwrap_or(self.wall)
    }

    /// The largest relative error of the references that have one; infinite for a value that is no number, none without such references.
    pub fn worst(&self) -> Option<f64> {
        let relative = self.expect.iter().filter(|line| line.comparison == Comparison::Relative);
        let errors = relative.map(|line| if line.error.is_finite() { line.error.abs() } else { f64::INFINITY });
        errors.reduce(f64::max)
    }

    /// Whether there are references and all are met, relative ones within `share` instead of their own tolerance.
    pub fn is_within(&self, share: f64) -> bool {
        self.references().next().is_some()
            && self.references().all(|line| match line.comparison {
                Comparison::Relative => line.error.abs() <= share,
                _ => line.pass,
            })
    }

    /// The lines that have a reference.
    pub fn references(&self) -> impl Iterator<Item = &Expectation> {
        self.expect.iter().filter(|line| line.comparison != Comparison::Nothing)
    }
}

impl Run {
    /// What it took and gave, if it reached its end.
    pub fn measured(&self) -> Option<&Measured> {
        match &self.end {
            End::Finished(measured) => Some(measured),
            End::Open | End::Failed(_) => None,
        }
    }

    /// As [`Planned::on`].
    pub fn on(&self, axis: &str) -> &str {
        self.planned.on(axis)
    }

    /// How it ended, in a word: that of its summary, `failed` where it was refused, `missing` where it has left nothing.
    pub fn status(&self) -> &'static str {
        match (&self.end, self.summary.as_ref().map(|summary| summary.status)) {
            (_, Some(Status::Stopped)) => "stopped",
            (End::Failed(_), _) => "failed",
            (End::Finished(_), _) => "completed",
            (End::Open, Some(Status::Interrupted)) => "interrupted",
            (End::Open, _) => "missing",
        }
    }
}
