//! What the tests record and users do not need: random scenes, the largest stable steps, and published tables of bonded bodies.
//!
//! ```sh
//! cargo run --release -p fractum-record -- stress --scenes 300 --seed 1 --threads 1
//! ```

#![forbid(unsafe_code)]

mod lab;
mod stress;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};
use fractum::{Failure, cache_of_user, tell};

/// Records of the tests: random scenes, stable steps, published tables of bonded bodies.
#[derive(Parser)]
#[command(version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Random scenes of every kind of body, run briefly, and what became of them.
    Stress {
        #[command(flatten)]
        settings: Settings,
        /// Random blasts only.
        #[arg(long)]
        blasts: bool,
        /// Number of random scenes.
        #[arg(long, default_value_t = 300)]
        scenes: usize,
        /// Number of the first scene: --first 785 --scenes 1 runs one scene again.
        #[arg(long, default_value_t = 0)]
        first: usize,
        /// Seed of the random scenes.
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// The largest stable step of every kind of scene.
    Steps {
        #[command(flatten)]
        settings: Settings,
        /// A steps.json of before, to tell what has changed.
        #[arg(long)]
        baseline: Option<PathBuf>,
    },
    #[command(flatten)]
    Lab(lab::LabCommand),
}

#[derive(Args)]
struct Settings {
    /// Folder for the record.
    #[arg(short, long, default_value = "results/record")]
    output: PathBuf,
    /// Threads; all cores by default.
    #[arg(long)]
    threads: Option<usize>,
}

impl Settings {
    fn all(self) -> stress::Settings {
        let Settings { output, threads } = self;
        stress::Settings { scenes: 0, first: 0, blasts: false, seed: 1, output, threads, cache: cache_of_user() }
    }
}

fn main() {
    let ended = match Arguments::parse().command {
        Command::Stress { settings, blasts, scenes, first, seed } => {
            random_scenes(&stress::Settings { scenes, first, blasts, seed, ..settings.all() })
        }
        Command::Steps { settings, baseline } => stable_steps(&settings.all(), baseline.as_deref()),
        Command::Lab(command) => lab::run(&command),
    };
    if let Err(failure) = ended {
        tell!("{failure}");
        std::process::exit(failure.exit_code() as i32);
    }
}

fn random_scenes(settings: &stress::Settings) -> Result<(), Failure> {
    let lines = stress::stress(settings)?;
    match lines.iter().filter(|line| line.end == stress::End::Silent).count() {
        0 => Ok(()),
        silent => Err(Failure::Unmet(format!("{silent} of {} scenes went wrong without a word", lines.len()))),
    }
}

fn stable_steps(settings: &stress::Settings, baseline: Option<&std::path::Path>) -> Result<(), Failure> {
    let limits = stress::steps(settings, baseline)?;
    match limits.iter().filter(|limit| !limit.holds()).count() {
        0 => Ok(()),
        unstable => {
            Err(Failure::Unmet(format!("{unstable} of {} scenes are unstable at the default step", limits.len())))
        }
    }
}
