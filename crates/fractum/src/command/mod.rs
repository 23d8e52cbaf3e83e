//! The commands: arguments in, exit code out.

mod calibrate;
mod help;
mod lab;
mod lab_break;
#[cfg(feature = "report")]
mod lab_pictures;
mod manual;
mod material;
mod mesh;
mod mesh_file;
mod mesh_info;
mod mesh_refine;
mod mesh_vtu;
mod modes;
mod movie;
mod new;
mod pack;
mod ranks;
mod shape;
mod study;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use fractum::cache_of_user as cache;
use fractum::terminal::{Stream, Tone, toned};
use fractum::{ExitCode, Failure, Options, Outcome, Ranks, say, tell};
use fractum_case::{Diagnostics, KeyDoc};
use fractum_output::summary::{Fracture, Probe, Status};

/// Fracture of solids: finite elements with damage, discrete elements, and the transition between them.
#[derive(Parser)]
#[command(version, about, after_help = help::PROGRAM)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// How errors are written to stderr, and the answer of `mesh info` to stdout.
    #[arg(long, global = true, value_enum, default_value = "text")]
    format: Format,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// One line each.
    Text,
    /// One JSON value each.
    Json,
}

#[derive(Subcommand)]
enum Command {
    /// Run a case and leave its results in a folder.
    #[command(after_help = help::RUN)]
    Run(RunArguments),
    /// Find every mistake of a case and show the plan.
    #[command(after_help = help::CHECK)]
    Check {
        /// Case file.
        case: PathBuf,
        /// Replace a value of [parameters].
        #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
        set: Vec<(String, String)>,
        /// Take warnings for errors.
        #[arg(long)]
        strict: bool,
    },
    /// Write a case that runs as it stands, with its mesh, into a folder.
    #[command(after_help = help::NEW)]
    New {
        /// Template; without one, the list of templates.
        template: Option<String>,
        /// Folder to write into; the name of the template if not given.
        folder: Option<PathBuf>,
    },
    /// Run the gallery against its references and print the table of errors and run times.
    Verify {
        /// Only cases whose path contains one of these.
        names: Vec<String>,
        /// Only the quick set.
        #[arg(long)]
        quick: bool,
        /// Folder with the cases.
        #[arg(long, default_value = "cases")]
        cases: PathBuf,
        /// Folder for results, verify.json and verify.md.
        #[arg(short, long, default_value = "results/verify")]
        output: PathBuf,
        /// Cases of the gallery at the same time; with --threads 1 one per core is fastest.
        #[arg(long, default_value_t = 1, value_parser = thread_count)]
        jobs: usize,
        /// Threads per case; all cores by default.
        #[arg(long, value_parser = thread_count)]
        threads: Option<usize>,
        /// The neighbours of every case, such as another seed or Poisson's ratio, instead of the cases themselves.
        #[arg(long)]
        neighbours: bool,
        /// Only the neighbours for which a reference is promised to hold.
        #[arg(long, requires = "neighbours")]
        promised: bool,
        /// A command of `record`, the program of the tests.
        #[arg(long, hide = true)]
        stress: bool,
    },
    /// Run a case with varied values, here or one by one on a cluster, and compare the results.
    #[command(visible_alias = "sweep")]
    Study(Box<study::StudyArguments>),
    /// Look at a mesh, or write it in another format.
    Mesh {
        #[command(subcommand)]
        command: mesh::MeshCommand,
    },
    /// Write the report of a results folder again.
    Report {
        /// Results folder of a run.
        folder: PathBuf,
    },
    /// Write the frames of a results folder as an animated picture (APNG), which browsers play.
    #[command(after_help = help::MOVIE)]
    Movie(movie::MovieArguments),
    /// Find the natural vibrations of the bodies of a case: frequencies, shapes, and the mass that each moves.
    #[command(after_help = help::MODES)]
    Modes(Box<modes::ModesArguments>),
    /// Fill a shape with particles and certify the packing.
    Pack(Box<pack::PackArguments>),
    /// Test bonded packings in the virtual laboratory.
    Lab {
        #[command(subcommand)]
        command: lab::LabCommand,
    },
    /// Find the bonds that give a material its elastic constants.
    Calibrate(Box<calibrate::CalibrateArguments>),
    /// Propose the numbers of a material, with their ranges and sources, and what they ask of a mesh.
    #[command(after_help = help::MATERIAL)]
    Material(Box<material::MaterialArguments>),
    /// Print the JSON schema of the case file.
    Schema,
    /// Explain a key of the case file, such as bodies.formulation.
    Explain {
        /// Dotted path of the key; without one, all keys.
        key: Option<String>,
    },
    /// Print the completions of a shell.
    #[command(after_help = help::COMPLETIONS)]
    Completions {
        /// The shell.
        shell: clap_complete::Shell,
    },
    /// Print the manual page, or write those of all commands into a folder.
    #[command(after_help = help::MAN)]
    Man {
        /// Folder for the pages.
        folder: Option<PathBuf>,
    },
}

#[derive(Args)]
struct RunArguments {
    /// Case file.
    case: PathBuf,
    /// Results folder; results/<folder>/<case> by default.
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Threads; all cores by default. Results do not depend on it.
    #[arg(long, value_parser = thread_count)]
    threads: Option<usize>,
    /// Replace a value of [parameters].
    #[arg(long = "set", value_name = "NAME=VALUE", value_parser = assignment)]
    set: Vec<(String, String)>,
    /// Go on from the last checkpoint in the results folder; the end of the run (solver.end) may be another.
    #[arg(long)]
    resume: bool,
    /// Replace the results that the folder holds.
    #[arg(long, conflicts_with = "resume")]
    overwrite: bool,
    /// No plan and no progress line.
    #[arg(long)]
    quiet: bool,
    /// Take warnings for errors: those of the case refuse it, those of the run end it.
    #[arg(long)]
    strict: bool,
}

/// More threads than this help nobody, and starve the machine.
const MOST_THREADS: usize = 1024;

fn thread_count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=MOST_THREADS).contains(&count) => Ok(count),
        _ => Err(format!("expected a whole number from 1 to {MOST_THREADS}")),
    }
}

fn assignment(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("expected NAME=VALUE, such as --set velocity=\"2 mm/s\"")?;
    Ok((name.trim().to_owned(), value.trim().to_owned()))
}

/// Carries a command out; what went wrong is on stderr.
pub(crate) fn execute(arguments: Arguments) -> ExitCode {
    let json = arguments.format == Format::Json;
    let result = match arguments.command {
        Command::Run(run) => ranks::run_case(run, json),
        Command::Check { case, set, strict } => check(&case, &set, strict),
        Command::New { template, folder } => new::new(template.as_deref(), folder),
        Command::Verify { stress: true, .. } => Err(Failure::input(
            "random scenes are a matter of the tests: cargo run --release -p fractum-record -- stress",
        )),
        Command::Verify { names, quick, cases, output, jobs, threads, neighbours, promised, .. } => {
            let selection = fractum::verify::Selection { cases, names, quick, output, jobs, threads, cache: cache() };
            if neighbours { run_neighbours(&selection, promised) } else { run_gallery(&selection) }
        }
        Command::Study(arguments) => study::run(*arguments),
        Command::Mesh { command } => mesh::execute(command, json),
        Command::Report { folder } => fractum::report::write(&folder).map(|()| ExitCode::Done),
        Command::Movie(arguments) => movie::run(&arguments),
        Command::Modes(arguments) => modes::run(*arguments),
        Command::Pack(arguments) => pack::run(&arguments),
        Command::Lab { command } => lab::run(&command),
        Command::Calibrate(arguments) => calibrate::run(&arguments),
        Command::Material(arguments) => material::run(&arguments),
        Command::Schema => {
            say!("{}", serde_json::to_string_pretty(&fractum_case::schema()).unwrap_or_default());
            Ok(ExitCode::Done)
        }
        Command::Explain { key } => explain(key.as_deref()),
        Command::Completions { shell } => Ok(manual::completions(shell)),
        Command::Man { folder } => manual::manual(folder.as_deref()),
    };
    result.unwrap_or_else(|failure| {
        report(&failure, json);
        failure.exit_code()
    })
}

fn run_gallery(selection: &fractum::verify::Selection) -> Result<ExitCode, Failure> {
    let lines = fractum::verify::verify(selection)?;
    match lines.iter().filter(|line| !line.expectation.pass).count() {
        0 => Ok(ExitCode::Done),
        failed => Err(Failure::Unmet(format!("{failed} of {} references are not met", lines.len()))),
    }
}

fn run_neighbours(selection: &fractum::verify::Selection, only_promised: bool) -> Result<ExitCode, Failure> {
    let rows = fractum::verify::neighbours::neighbours(selection, only_promised)?;
    match rows.iter().filter(|row| row.end == fractum_output::beside::End::Fails).count() {
        0 => Ok(ExitCode::Done),
        failed => Err(Failure::Unmet(format!("{failed} references do not hold beside their case"))),
    }
}

fn report(failure: &Failure, json: bool) {
    if matches!(failure, Failure::Elsewhere(_)) {
        return; // The process that failed tells why.
    }
    if !json {
        let text = failure.to_string();
        text.lines().for_each(|line| tell!("{}", with_place(line, Tone::Wrong, Stream::Error)));
        return;
    }
    match failure {
        Failure::Input(diagnostics) => {
            for diagnostic in &diagnostics.0 {
                tell!("{}", serde_json::to_string(diagnostic).unwrap_or_default());
            }
        }
        other => tell!(
            "{}",
            serde_json::json!({ "severity": "error", "place": null, "found": other.to_string(), "expected": "", "remedy": "" })
        ),
    }
}

/// - `ranks`: this process among those that run the case together
fn run_case(run: RunArguments, ranks: Ranks) -> Result<ExitCode, Failure> {
    let leads = ranks.leads();
    let options = Options {
        output: run.output,
        threads: run.threads,
        overrides: run.set,
        resume: run.resume,
        overwrite: run.overwrite,
        quiet: run.quiet || !leads,
        strict: run.strict,
        cache: cache(),
        ..Options::default()
    };
    let Outcome { summary, folder, load } = fractum::run_shared(&run.case, &options, ranks)?;
    if !leads {
        return Ok(if summary.status == Status::Interrupted { ExitCode::Interrupted } else { ExitCode::Done });
    }
    if summary.status == Status::Interrupted {
        let program =
            std::env::args_os().next().map_or_else(|| "fractum".into(), |name| name.to_string_lossy().into_owned());
        let resume = Options { resume: true, overwrite: false, ..options };
        tell!("interrupted; state saved, go on with: {}", resume.command(&program, &run.case, &folder));
        return Ok(ExitCode::Interrupted);
    }
    if !run.quiet {
        for (name, probe) in &summary.probes {
            say!("{name:<28} {}", fractum_output::number::quantity(probe.r#final, &probe.unit));
        }
        for body in &summary.fracture {
            say!("{:<28} {}", body.body, fracture_text(body, summary.time.at_rest));
        }
        for expect in &summary.expect {
            let (verdict, tone) =
                if expect.pass { ("as expected", Tone::Good) } else { ("NOT as expected", Tone::Wrong) };
            let verdict = toned(verdict, tone, Stream::Out);
            let value = fractum_output::number::quantity(expect.value, &expect.unit);
            say!("{:<28} {value}, {verdict}: {} ({})", expect.quantity, expect.required(), expect.source);
        }
        if let Some((name, probe)) = load.as_ref().and_then(|name| summary.probes.get_key_value(name)) {
            say!("{:<28} {}", "peak", peak_text(name, probe, summary.time.at_rest));
        }
        if let Some(accuracy) = &summary.accuracy {
            say!("\n{}", fractum_output::study::table::accuracy(accuracy));
        }
        say!("{:<28} {}", "end", summary.time.reason);
        say!("results in {}", folder.display());
    }
    Ok(ExitCode::Done)
}

/// The largest absolute value of the load, in words.
///
/// - `at_rest`: whether instants are load factors
fn peak_text(name: &str, probe: &Probe, at_rest: bool) -> String {
    use fractum_output::number::{at_instant, quantity};
    if probe.min.abs() > probe.max.abs() {
        return format!("{name} {}", quantity(probe.min, &probe.unit));
    }
    format!("{name} {} at {}", quantity(probe.max, &probe.unit), at_instant(probe.time_of_max, at_rest))
}

/// What became of the bonds of a body, in words.
///
/// - `at_rest`: whether instants are load factors
fn fracture_text(body: &Fracture, at_rest: bool) -> String {
    use fractum_output::number::{at_instant, grouped, quantity};
    if body.broken_bonds > 0 {
        let (first, area) = (at_instant(body.first_break, at_rest), quantity(body.crack_area, "m^2"));
        let bonds = grouped(&body.broken_bonds.to_string());
        return format!("{bonds} bonds broke (crack area {area}), the first at {first}");
    }
    match body.largest_at {
        Some([x, y, z]) => format!(
            "no bond broke; the largest load was {:.1} % of the strength, at ({x:.3e}, {y:.3e}, {z:.3e}) m, {}",
            100.0 * body.largest_ratio,
            at_instant(body.largest_time, at_rest)
        ),
        None => "no bond broke: nothing bore any load".to_owned(),
    }
}

/// A message with its place in the case file in the tone of what it says.
fn with_place(line: &str, tone: Tone, stream: Stream) -> String {
    match line.split_once(": ") {
        Some((place, rest)) => format!("{}: {rest}", toned(place, tone, stream)),
        None => toned(line, tone, stream),
    }
}

fn check(case: &std::path::Path, set: &[(String, String)], strict: bool) -> Result<ExitCode, Failure> {
    let (plan, warnings) = fractum::plan::checked(case, set, &cache())?;
    match Stream::Out.width() {
        Some(width) => say!("{}", plan.wrapped(width, |topic| toned(topic, Tone::Name, Stream::Out))),
        None => say!("{plan}"),
    }
    if strict && !warnings.is_empty() {
        return Err(Failure::Input(Diagnostics(warnings).as_errors()));
    }
    for warning in &warnings {
        say!("{}", with_place(&warning.to_string(), Tone::Doubt, Stream::Out));
    }
    Ok(ExitCode::Done)
}

fn explain(key: Option<&str>) -> Result<ExitCode, Failure> {
    let Some(key) = key else {
        for doc in fractum_case::keys() {
            say!("{:<40} {}", doc.path, doc.doc);
        }
        return Ok(ExitCode::Done);
    };
    match fractum_case::explain(key) {
        Ok(doc) => {
            let kind = |doc: &KeyDoc| match doc.default {
                "" => doc.kind.label(),
                default => format!("{}, default: {default}", doc.kind.label()),
            };
            say!("{}\n  {}\n  type: {}", doc.path, doc.doc, kind(doc));
            let below = format!("{}.", doc.path);
            let own = |key: &&KeyDoc| key.path.strip_prefix(&below).is_some_and(|name| !name.contains('.'));
            for key in fractum_case::keys().iter().filter(own) {
                say!("\n{}\n  {}\n  type: {}", key.path, key.doc, kind(key));
            }
            Ok(ExitCode::Done)
        }
        Err(Some(near)) => Err(Failure::input(format!("no key \"{key}\"; did you mean \"{near}\"?"))),
        Err(None) => Err(Failure::input(format!("no key \"{key}\"; fractum explain lists all of them"))),
    }
}
