//! A program without report, pictures and movies: it says so where one is asked for, and draws nothing at the end of a run.

use std::path::Path;

use fractum_output::atomic::Group;
use fractum_output::notes::PictureNote;
use fractum_output::study::compare::Family;
use fractum_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::error::Failure;
use crate::tell;

/// Files of a study.
pub(crate) const STUDY_FILES: &str = "study.md, study.csv and study.json";

/// That this program draws nothing.
pub fn no_report() -> Failure {
    Failure::input(NO_REPORT)
}

const NO_REPORT: &str = "this program was built without reports, pictures and movies; build it with its feature report, which is on by default";

/// Refuses to write `report.html`.
///
/// # Errors
/// Always.
pub fn write(_: &Path) -> Result<(), Failure> {
    Err(no_report())
}

/// Tells that a run ends without `report.html`.
pub(crate) fn add(_: &Path, _: &mut Group) -> Result<(), Failure> {
    tell!("{NO_REPORT}");
    Ok(())
}

/// What is seen of the solids: nothing.
#[derive(Serialize, Deserialize)]
pub(crate) struct Skin;

impl Skin {
    pub(crate) fn of(_: &Scene) -> Self {
        Skin
    }

    pub(crate) fn joined(_: Vec<Skin>) -> Self {
        Skin
    }
}

/// Pictures of the last instant: none.
pub(crate) fn draw(_: &Scene, _: Skin, _: &Path, _: &str, _: &mut Group) -> Vec<PictureNote> {
    Vec::new()
}

/// Pictures over time: none.
pub(crate) fn strip(_: &Path, _: Option<f64>, _: &dyn Fn(f64) -> String, _: &mut Group) -> Vec<PictureNote> {
    Vec::new()
}

/// The movie of a run: none.
///
/// # Errors
/// Always.
pub(crate) fn add_movie(_: &Path, _: Option<usize>, _: &mut Group) -> Result<(), Failure> {
    Err(no_report())
}

/// Pixels of the movie.
pub(crate) fn pixels_of_movie(_: f64) -> f64 {
    0.0
}

/// Pixels of the pictures of the last instant.
pub(crate) fn pixels_at_end(_: &Scene) -> f64 {
    0.0
}

/// Pixels of the pictures over time.
pub(crate) fn pixels_over_time(_: f64) -> f64 {
    0.0
}

/// The page of a study: none.
pub(crate) fn write_study(_: &str, _: &[Family<'_>], _: Option<f64>, _: &Path) -> Result<(), Failure> {
    Ok(())
}
