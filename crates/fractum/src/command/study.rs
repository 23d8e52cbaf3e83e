//! `fractum study`: many runs, and run time beside error.

use std::path::{Path, PathBuf};

use clap::Args;
use fractum::study::{Settings, study};
use fractum::{ExitCode, Failure, tell};
use fractum_case::study::plan::{Variation, parse_share, plan};

use super::{assignment, cache, thread_count};

#[derive(Args)]
pub(crate) struct StudyArguments {
    /// Case file, or a study file with several cases and settings.
    case: PathBuf,
    /// Vary a parameter or key over values; several are combined.
    #[arg(long = "vary", value_name = "KEY=A,B,C", value_parser = Variation::parse)]
    vary: Vec<Variation>,
    /// Replace a parameter or key in all runs.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
    /// Find the cheapest setting within this error, such as "2 %".
    #[arg(long, value_name = "ERROR", value_parser = parse_share)]
    within: Option<f64>,
    /// Folder for runs, tables and page; results/study/<folder>/<file> by default.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Runs at the same time.
    #[arg(long, default_value_t = 1, value_parser = thread_count)]
    jobs: usize,
    /// Threads per run. Results do not depend on it, run times do.
    #[arg(long, default_value_t = 1, value_parser = thread_count)]
    threads: usize,
    /// Run anew what has finished before.
    #[arg(long)]
    anew: bool,
    /// Run nothing; write the tables of what has finished.
    #[arg(long, conflicts_with = "anew")]
    only_tables: bool,
}

pub(crate) fn run(arguments: StudyArguments) -> Result<ExitCode, Failure> {
    let mut planned = plan(&arguments.case, &arguments.set, &arguments.vary)?;
    planned.within = arguments.within.or(planned.within);
    let settings = Settings {
        output: arguments.output.unwrap_or_else(|| default_folder(&arguments.case)),
        jobs: arguments.jobs,
        threads: arguments.threads,
        anew: arguments.anew,
        only_tables: arguments.only_tables,
        cache: cache(),
    };
    match study(&planned, &settings) {
        Err(Failure::Interrupted) => {
            tell!("interrupted; the same command goes on with what has not finished");
            Ok(ExitCode::Interrupted)
        }
        ended => ended.map(|_| ExitCode::Done),
    }
}

/// `cases/notched-beam/tilt-10.toml` → `results/study/notched-beam/tilt-10`.
fn default_folder(case: &Path) -> PathBuf {
    let absolute = std::path::absolute(case).unwrap_or_else(|_| case.to_owned());
    let folder = absolute.parent().and_then(Path::file_name).unwrap_or_default();
    Path::new("results/study").join(folder).join(absolute.file_stem().unwrap_or_default())
}
