//! The report, pictures and movies, drawn.

use std::path::Path;

use fractum_output::atomic::{self, Group};
use fractum_output::notes::MOVIE;
use fractum_output::study::compare::Family;
pub(crate) use fractum_report::gallery::{Skin, draw, expected_pixels as pixels_at_end};
pub(crate) use fractum_report::movie::expected_pixels as pixels_of_movie;
use fractum_report::movie::{Movie, MovieSettings};
pub(crate) use fractum_report::strip::{expected_pixels as pixels_over_time, strip};
use fractum_report::{exhibits, folder, study};

use crate::error::Failure;

/// Files of a study.
pub(crate) const STUDY_FILES: &str = "study.md, study.csv, study.json, study.svg and study.html";

/// Writes `report.html` from the files of a results folder.
///
/// # Errors
/// [`Failure`] if the folder is not that of a finished run, or the page cannot be written.
pub fn write(folder: &Path) -> Result<(), Failure> {
    Ok(folder::write(folder)?)
}

/// Adds `report.html` to the files of a results folder that have no names yet.
///
/// # Errors
/// As [`write`].
pub(crate) fn add(folder: &Path, files: &mut Group) -> Result<(), Failure> {
    Ok(folder::add(folder, files)?)
}

/// Writes the frames of a results folder as an animated PNG, which browsers and picture viewers play.
///
/// # Errors
/// [`Failure::Input`] for a folder without frames or a size out of range; [`Failure::Write`].
pub fn movie(folder: &Path, output: &Path, settings: MovieSettings) -> Result<Movie, Failure> {
    Ok(fractum_report::movie::movie(folder, output, settings)?)
}

/// Adds the movie of a run to the files of its folder, whose frames are written.
///
/// - `mode`: the natural vibration that swings, if it shows these
///
/// # Errors
/// [`Failure::Input`] for frames that cannot be drawn.
pub(crate) fn add_movie(folder: &Path, mode: Option<usize>, files: &mut Group) -> Result<(), Failure> {
    let (_, bytes) = fractum_report::movie::film(folder, MovieSettings { mode, ..MovieSettings::default() })?;
    files.add(&folder.join(MOVIE), &bytes);
    Ok(())
}

/// Writes the page and the chart of a study.
///
/// # Errors
/// A disk that cannot be written to.
pub(crate) fn write_study(
    title: &str,
    families: &[Family<'_>],
    within: Option<f64>,
    output: &Path,
) -> Result<(), Failure> {
    let exhibits = exhibits::of(families, output);
    atomic::write(&output.join("study.svg"), study::to_svg(&study::price(families)).as_bytes())?;
    atomic::write(&output.join("study.html"), study::to_html(title, families, within, &exhibits).as_bytes())?;
    Ok(())
}
