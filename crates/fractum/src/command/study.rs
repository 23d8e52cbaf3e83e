//! `fractum study`: many runs, done here or one by one by other programs, and what they came to side by side.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};
use fractum::study::{Folders, Settings, collect, find, run_all, run_one, write_list};
use fractum::{ExitCode, Failure, Options, say, tell};
use fractum_case::study::plan::{Study, Variation, is_list, parse_share, plan};
use fractum_case::study::quantity::Quantity;
use fractum_output::summary::Status;

use super::{assignment, cache, thread_count};

#[derive(Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct StudyArguments {
    #[command(subcommand)]
    step: Option<Step>,
    /// Case file, a study file with several cases and settings, or a list of runs (CSV).
    #[arg(required = true)]
    case: Option<PathBuf>,
    #[command(flatten)]
    varied: Varied,
    #[command(flatten)]
    compared: Compared,
    /// Folder for runs, tables and page; results/study/<folder>/<file> by default, for a list the list without its ending.
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

/// What the runs differ in.
#[derive(Args)]
struct Varied {
    /// Vary a parameter or key over values; several are combined.
    #[arg(long = "vary", value_name = "KEY=A,B,C", value_parser = Variation::parse)]
    vary: Vec<Variation>,
    /// Replace a parameter or key in all runs.
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
}

/// How the runs are compared.
#[derive(Args)]
struct Compared {
    /// Compare a probe (load: its last value), its peak (max(load)) or an expression; NAME=EXPRESSION names the column.
    #[arg(long = "compare", value_name = "QUANTITY", value_parser = Quantity::parse)]
    compare: Vec<Quantity>,
    /// Find the cheapest setting within this error, such as "2 %".
    #[arg(long, value_name = "ERROR", value_parser = parse_share)]
    within: Option<f64>,
}

/// The steps of a study that other programs take: job schedulers, workflow programs.
#[derive(Subcommand)]
enum Step {
    /// Write the list of runs: a line for every combination of the varied values.
    List {
        /// Case file, or a study file.
        case: PathBuf,
        #[command(flatten)]
        varied: Varied,
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
    /// Compare the results of all runs of a list: tables, page, and every number in one CSV file.
    Collect {
        /// The list.
        list: PathBuf,
        /// Folder of all results; by default the list without its ending.
        #[arg(long)]
        results: Option<PathBuf>,
        #[command(flatten)]
        compared: Compared,
        /// Every number of all runs; summary.csv in the folder of all results by default.
        #[arg(short, long)]
        output: Option<PathBuf>,
    },
}

pub(crate) fn run(arguments: StudyArguments) -> Result<ExitCode, Failure> {
    let settings = |jobs, threads, anew| {
        let options = Options { threads: Some(threads), quiet: true, cache: cache(), ..Options::default() };
        Settings { jobs, anew, options }
    };
    match arguments.step {
        None => {}
        Some(Step::List { case, varied: Varied { vary, set }, output }) => return list(&case, &vary, &set, &output),
        Some(Step::Run { list, run, output, threads, anew }) => {
            let (runs, folders) = (read(&list)?.runs, Folders::of_list(&list, output));
            let status = run_one(find(&runs, &run)?, &folders, &settings(1, threads, anew))?;
            return Ok(if status == Status::Interrupted { interrupted() } else { ExitCode::Done });
        }
        Some(Step::Collect { list, results, compared, output }) => {
            let (study, folders) = (compared.of(read(&list)?), Folders::of_list(&list, results));
            let (runs, text) = collect(&study, &folders, output.as_deref())?;
            let finished = runs.iter().filter(|run| run.measured().is_some()).count();
            say!("{finished} of {} runs have finished\n\n{text}", runs.len());
            return Ok(ExitCode::Done);
        }
    }
    let Some(case) = arguments.case else { return Err(Failure::input("which case?")) };
    let study = arguments.compared.of(plan(&case, &arguments.varied.set, &arguments.varied.vary)?);
    let folders = match arguments.output {
        output if is_list(&case) => Folders::of_list(&case, output),
        output => {
            let folders = Folders::of_study(&output.unwrap_or_else(|| default_folder(&case)));
            write_list(&study.runs, &folders.tables.join("runs.csv"))?;
            folders
        }
    };
    let ended = if arguments.only_tables {
        Ok(())
    } else {
        run_all(&study.runs, &folders, &settings(arguments.jobs, arguments.threads, arguments.anew))
    };
    let (runs, text) = collect(&study, &folders, None)?;
    say!("{text}");
    match ended {
        Err(Failure::Interrupted) => Ok(interrupted()),
        Ok(()) if !arguments.only_tables && runs.iter().all(|run| run.measured().is_none()) => {
            Err(Failure::input(format!("none of {} runs has finished", runs.len())))
        }
        ended => ended.map(|()| ExitCode::Done),
    }
}

impl Compared {
    /// The study, compared like this; what it says itself stays where nothing is asked for.
    fn of(self, study: Study) -> Study {
        let compare = if self.compare.is_empty() { study.compare } else { self.compare };
        Study { within: self.within.or(study.within), compare, ..study }
    }
}

/// Reads a list, whatever its ending.
fn read(path: &Path) -> Result<Study, Failure> {
    Ok(fractum_case::study::plan::of_list(path)?)
}

fn interrupted() -> ExitCode {
    tell!("interrupted; state saved, the same command goes on");
    ExitCode::Interrupted
}

/// `cases/notched-beam/tilt-10.toml` → `results/study/notched-beam/tilt-10`.
fn default_folder(case: &Path) -> PathBuf {
    let absolute = std::path::absolute(case).unwrap_or_else(|_| case.to_owned());
    let folder = absolute.parent().and_then(Path::file_name).unwrap_or_default();
    Path::new("results/study").join(folder).join(absolute.file_stem().unwrap_or_default())
}

fn list(case: &Path, vary: &[Variation], set: &[(String, String)], output: &Path) -> Result<ExitCode, Failure> {
    let mut runs = plan(case, set, vary)?.runs;
    // Numbers, as the arrays of job schedulers have them.
    let digits = runs.len().to_string().len();
    runs.iter_mut().zip(1..).for_each(|(run, number)| run.name = format!("{number:0digits$}"));
    write_list(&runs, output)?;
    say!("{} runs in {}; each is done by: fractum study run {} NUMBER", runs.len(), output.display(), output.display());
    Ok(ExitCode::Done)
}
