//! `fractum modes`: natural vibrations of the bodies of any case.

use std::path::PathBuf;

use clap::Args;
use fractum::{ExitCode, Failure, Options, Outcome, cache_of_user as cache, say};
use fractum_output::number::{percent, quantity};

use super::{assignment, thread_count};

#[derive(Args)]
pub(crate) struct ModesArguments {
    /// Case file; what it says of loads and of motion has no effect.
    case: PathBuf,
    /// Number of vibrations, the slowest ones.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..))]
    count: u16,
    /// Results folder; results/<folder>/<case>-modes by default.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Threads; all cores by default.
    #[arg(long, value_parser = thread_count)]
    threads: Option<usize>,
    /// Replace a value of [parameters].
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
    /// Replace the results that the folder holds.
    #[arg(long)]
    overwrite: bool,
    /// No plan.
    #[arg(long)]
    quiet: bool,
}

/// Finds the vibrations, leaves them in a folder and prints their table.
///
/// # Errors
/// As those of a run.
pub(crate) fn run(arguments: ModesArguments) -> Result<ExitCode, Failure> {
    let ModesArguments { case, count, output, threads, mut set, overwrite, quiet } = arguments;
    set.push(("solver.kind".to_owned(), "\"modes\"".to_owned()));
    set.push(("solver.count".to_owned(), count.to_string()));
    let output = output.unwrap_or_else(|| {
        let absolute = std::path::absolute(&case).unwrap_or_else(|_| case.clone());
        let name = |path: Option<&std::ffi::OsStr>| path.unwrap_or_default().to_string_lossy().into_owned();
        let folder = name(absolute.parent().and_then(std::path::Path::file_name));
        PathBuf::from("results").join(folder).join(format!("{}-modes", name(absolute.file_stem())))
    });
    let options = Options {
        output: Some(output),
        threads,
        overrides: set,
        resume: false,
        overwrite,
        quiet,
        strict: false,
        cache: cache(),
        ..Options::default()
    };
    let Outcome { summary, folder, .. } = fractum::run(&case, &options)?;
    let Some(found) = &summary.modes else { return Ok(ExitCode::Interrupted) };
    say!("{:>5} {:>14} {:>14}   {:>8} {:>8} {:>8}", "mode", "frequency", "period", "mass x", "mass y", "mass z");
    for (number, mode) in (1..).zip(&found.vibrations) {
        let [x, y, z] = mode.mass_share.map(percent);
        let (frequency, period) = (quantity(mode.frequency, "1/s"), quantity(1.0 / mode.frequency, "s"));
        say!("{number:>5} {frequency:>14} {period:>14}   {x:>8} {y:>8} {z:>8}");
    }
    say!("results in {}", folder.display());
    Ok(ExitCode::Done)
}
