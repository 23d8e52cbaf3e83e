//! `fractum sweep`: a list of runs that other programs start, and one table of their results.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use fractum::study::sweep::{collect, find, results_folder, run_one};
use fractum::{ExitCode, Failure, Options, say, tell};
use fractum_case::study::list::{of_study, to_csv};
use fractum_case::study::plan::{Variation, plan};
use fractum_output::atomic;
use fractum_output::summary::Status;

use super::{assignment, cache, thread_count};

#[derive(Subcommand)]
pub(crate) enum SweepCommand {
    /// Write the list: a line for every combination of the varied values.
    List {
        /// Case file, or a study file.
        case: PathBuf,
        /// Vary a parameter or key over values; several are combined.
        #[arg(long = "vary", value_name = "KEY=A,B,C", value_parser = Variation::parse)]
        vary: Vec<Variation>,
        /// Replace a parameter or key in all runs.
        #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
        set: Vec<(String, String)>,
        /// The list.
        #[arg(short, long, default_value = "runs.csv")]
        output: PathBuf,
    },
    /// Do one run of a list; one that has finished is not done again, one that was interrupted goes on.
    Run {
        /// The list.
        list: PathBuf,
        /// Name of the run, or its number from 1.
        run: String,
        /// Folder of all results; by default the list without its ending.
        #[arg(short, long)]
        output: Option<PathBuf>,
        /// Threads.
        #[arg(long, default_value_t = 1, value_parser = thread_count)]
        threads: usize,
        /// From the start in any case.
        #[arg(long)]
        anew: bool,
    },
    /// Write the summaries of all runs into one CSV file.
    Collect {
        /// The list.
        list: PathBuf,
        /// Folder of all results; by default the list without its ending.
        #[arg(long)]
        results: Option<PathBuf>,
        /// The table; summary.csv in the folder of all results by default.
        #[arg(short, long)]
        output: Option<PathBuf>,
    },
}

pub(crate) fn run(command: SweepCommand) -> Result<ExitCode, Failure> {
    match command {
        SweepCommand::List { case, vary, set, output } => list(&case, &vary, &set, &output),
        SweepCommand::Run { list, run, output, threads, anew } => {
            let listed = find(&list, &run)?;
            let folder = output.unwrap_or_else(|| results_folder(&list));
            let options = Options { threads: Some(threads), quiet: true, cache: cache(), ..Options::default() };
            Ok(match run_one(&listed, &folder, &options, anew)? {
                Status::Interrupted => {
                    tell!("interrupted; state saved, the same command goes on");
                    ExitCode::Interrupted
                }
                _ => ExitCode::Done,
            })
        }
        SweepCommand::Collect { list, results, output } => {
            let results = results.unwrap_or_else(|| results_folder(&list));
            let table = output.unwrap_or_else(|| results.join("summary.csv"));
            let (finished, all) = collect(&list, &results, &table)?;
            say!("{finished} of {all} runs have finished; table in {}", table.display());
            Ok(ExitCode::Done)
        }
    }
}

fn list(case: &Path, vary: &[Variation], set: &[(String, String)], output: &Path) -> Result<ExitCode, Failure> {
    let mut runs = of_study(&plan(case, set, vary)?);
    let folder = output.parent().unwrap_or(Path::new(""));
    if !folder.as_os_str().is_empty() {
        // Paths count from the folder of the list.
        for run in &mut runs {
            run.case = std::path::absolute(&run.case).unwrap_or_else(|_| run.case.clone());
        }
        atomic::create_folder(folder)?;
    }
    atomic::write(output, to_csv(&runs).as_bytes())?;
    say!("{} runs in {}; each is done by: fractum sweep run {} NUMBER", runs.len(), output.display(), output.display());
    Ok(ExitCode::Done)
}
