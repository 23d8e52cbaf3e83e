//! `fractum movie`: the frames of a results folder as an animated picture.

use std::path::PathBuf;

use clap::Args;
use fractum::{ExitCode, Failure};

/// Pictures per second at most.
const FASTEST: u16 = 100;
/// Endings of the names of animated pictures.
#[cfg(feature = "report")]
const ENDINGS: [&str; 2] = ["png", "apng"];

#[derive(Args)]
pub(crate) struct MovieArguments {
    /// Results folder of a run.
    folder: PathBuf,
    /// File to write; movie.png in the results folder by default.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Pictures per second.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=i64::from(FASTEST)))]
    rate: u16,
    /// Width in pixels.
    #[arg(long, default_value_t = 800)]
    width: usize,
    /// Height in pixels.
    #[arg(long, default_value_t = 680)]
    height: usize,
    /// Let this natural vibration swing, of a run with solver.kind = "modes".
    #[arg(long)]
    mode: Option<usize>,
}

/// Writes the movie.
///
/// # Errors
/// A folder without frames, a size out of range, a disk that cannot be written to; a program without movies.
#[cfg(feature = "report")]
pub(crate) fn run(arguments: &MovieArguments) -> Result<ExitCode, Failure> {
    use fractum_output::number::quantity;
    let MovieArguments { folder, output, rate, width, height, mode } = arguments;
    let output = output.clone().unwrap_or_else(|| folder.join("movie.png"));
    let is_picture = |ending: &std::ffi::OsStr| ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known));
    if !output.extension().is_some_and(is_picture) {
        let found = format!("{}: the movie is an animated PNG; expected a name that ends with .png", output.display());
        return Err(Failure::input(found));
    }
    let settings = fractum::MovieSettings { width: *width, height: *height, rate: *rate, mode: *mode };
    let movie = fractum::movie(folder, &output, settings)?;
    let [low, high] = [movie.range.0, movie.range.1].map(|value| quantity(value, movie.unit));
    fractum::say!("{}: {} frames, colours are {} from {low} to {high}", output.display(), movie.frames, movie.label);
    Ok(ExitCode::Done)
}

/// Refuses to make one.
///
/// # Errors
/// Always.
#[cfg(not(feature = "report"))]
pub(crate) fn run(arguments: &MovieArguments) -> Result<ExitCode, Failure> {
    // What was asked for is of no use here.
    let MovieArguments { folder: _, output: _, rate: _, width: _, height: _, mode: _ } = arguments;
    Err(fractum::report::no_report())
}
