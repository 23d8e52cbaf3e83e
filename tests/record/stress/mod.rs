//! `record stress`: random scenes of every kind of body, run briefly, and what became of them.
//!
//! A scene may end in three honest ways: with a balance of energy within 1e-3, with a warning of the balance, or stopped with
//! a reason. Everything else is a silent failure: a balance that is off without a warning, a number that is none, energy that
//! dissipation gave back.

pub(crate) mod blast;
pub(crate) mod draw;
pub(crate) mod scenes;
mod situations;
mod steps;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::Instant;

use fractum_mesh::{Mesh, MshFormat, write_msh};
use fractum_output::atomic;
use fractum_prepare::Cache;
use serde::Serialize;
use serde_json::Value;

use blast::{BLAST, blast};
use draw::Draw;
use fractum::Failure;
use fractum::say;
use fractum::{Options, Outcome, run};
use scenes::{KINDS, RandomScene, scene};
pub(crate) use steps::steps;

/// Relative residual of the energy balance below which a run is good.
const GOOD_RESIDUAL: f64 = 1e-3;

/// What is drawn, and where results go.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    /// Number of scenes.
    pub(crate) scenes: usize,
    /// Number of the first of them.
    pub(crate) first: usize,
    /// Blasts only, instead of scenes of every kind.
    pub(crate) blasts: bool,
    /// Seed of all of them.
    pub(crate) seed: u64,
    /// Folder for `stress.json` and the cases that did not end well.
    pub(crate) output: PathBuf,
    /// Threads per case; all cores if none is given.
    pub(crate) threads: Option<usize>,
    /// Where packings and beams of bonded bodies are kept.
    pub(crate) cache: Cache,
}

/// How a scene ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum End {
    /// Completed, balance within 1e-3.
    Good,
    /// Completed with a warning.
    Warned,
    /// Stopped itself with a reason.
    Stopped,
    /// Refused before its first step.
    Refused,
    /// Wrong without a word.
    Silent,
}

/// One scene of `stress.json`.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Line {
    /// Number; with the seed it gives the scene again.
    pub(crate) scene: usize,
    /// Kind of scene.
    pub(crate) kind: &'static str,
    /// How it ended.
    pub(crate) end: End,
    /// Largest relative residual; null where it did not complete.
    pub(crate) residual: Option<f64>,
    /// What was said, or what is wrong.
    pub(crate) words: String,
    /// Wall time [s].
    pub(crate) seconds: f64,
}

/// Runs the scenes and prints the table by kind; `stress.json` is written anew after each scene, so that a run that is ended
/// early leaves what it has. Cases that did not end well are kept beside it.
///
/// # Errors
/// [`Failure::Write`] if a file cannot be written.
pub(crate) fn stress(settings: &Settings) -> Result<Vec<Line>, Failure> {
    atomic::create_folder(&settings.output)?;
    let file = settings.output.join("stress.json");
    let mut lines = Vec::new();
    for number in settings.first..settings.first.saturating_add(settings.scenes) {
        let folder = settings.output.join(format!("scene-{}-{number}", settings.seed));
        let scene = if settings.blasts {
            blast(&mut Draw::new(settings.seed, number as u64))
        } else {
            scene(settings.seed, number)
        };
        write_case(&scene, &folder)?;
        let started = Instant::now();
        let (end, residual, words) = judge(&folder, settings);
        let line =
            Line { scene: number, kind: scene.kind, end, residual, words, seconds: started.elapsed().as_secs_f64() };
        if line.end == End::Good {
            // A folder that stays is no harm.
            let _ = fs::remove_dir_all(&folder);
        } else {
            say!("{} ({}): {:?}: {}", folder.join("case.toml").display(), line.kind, line.end, line.words);
        }
        lines.push(line);
        atomic::write(&file, &serde_json::to_vec_pretty(&lines).unwrap_or_default())?;
    }
    print_table(&lines);
    say!("{}", file.display());
    Ok(lines)
}

fn write_case(scene: &RandomScene, folder: &Path) -> Result<(), Failure> {
    atomic::create_folder(folder)?;
    atomic::write(&folder.join("case.toml"), scene.case.as_bytes())?;
    scene.mesh.as_ref().map_or(Ok(()), |mesh| write_mesh(mesh, folder))
}

fn write_mesh(mesh: &Mesh, folder: &Path) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    // Writing to memory does not fail.
    let _ = write_msh(mesh, MshFormat::V4_1Binary, &mut bytes);
    Ok(atomic::write(&folder.join("mesh.msh"), &bytes)?)
}

/// Runs a case; how it ended, its residual, and what there is to say.
fn judge(folder: &Path, settings: &Settings) -> (End, Option<f64>, String) {
    let results = folder.join("results");
    let options = Options {
        output: Some(results.clone()),
        threads: settings.threads,
        quiet: true,
        strict: false,
        overwrite: true,
        cache: settings.cache.clone(),
        ..Options::default()
    };
    match catch_unwind(AssertUnwindSafe(|| run(&folder.join("case.toml"), &options))) {
        Err(_) => (End::Silent, None, "the program panicked".into()),
        Ok(Err(failure @ Failure::Input(_))) => (End::Refused, None, failure.to_string()),
        Ok(Err(failure)) => (End::Stopped, None, failure.to_string()),
        Ok(Ok(outcome)) => {
            let log = fs::read_to_string(results.join("run.log")).unwrap_or_default();
            let warning = log.lines().find(|line| line.contains("warning: ")).map(str::to_owned);
            completed(&outcome, warning)
        }
    }
}

/// Judges a run that came to its end.
fn completed(outcome: &Outcome, warning: Option<String>) -> (End, Option<f64>, String) {
    let energy = serde_json::to_value(&outcome.summary).map(|summary| summary["energy"].clone()).unwrap_or_default();
    let of = |name: &str| energy.get(name).and_then(Value::as_f64);
    let residual = of("residual_max_relative");
    let missing = energy.as_object().is_none_or(|all| all.is_empty() || all.values().any(|v| v.as_f64().is_none()));
    if missing {
        return (End::Silent, residual, format!("an energy is no number: {energy}"));
    }
    let largest =
        energy.as_object().into_iter().flatten().filter_map(|(_, v)| v.as_f64()).fold(0.0, |m: f64, v| m.max(v.abs()));
    let gains = ["damage", "friction", "damping", "kinetic"].into_iter().find(|name| of(name) < Some(-1e-6 * largest));
    if let Some(name) = gains {
        return (End::Silent, residual, format!("{name} energy is negative: {:e} J", of(name).unwrap_or(f64::NAN)));
    }
    match (residual.is_some_and(|r| r < GOOD_RESIDUAL), warning) {
        (true, warning) => (End::Good, residual, warning.unwrap_or_default()),
        (false, Some(warning)) => (End::Warned, residual, warning),
        (false, None) => {
            (End::Silent, residual, format!("residual {:e} without a warning", residual.unwrap_or(f64::NAN)))
        }
    }
}

fn print_table(lines: &[Line]) {
    let header =
        ["kind", "scenes", "residual < 1e-3", "warned", "stopped", "refused", "silent failures", "largest", "seconds"];
    let print = |cells: [String; 9]| {
        let [kind, rest @ ..] = cells;
        say!("{kind:<16}{}", rest.map(|cell| format!("{cell:>17}")).concat());
    };
    print(header.map(str::to_owned));
    let drawn = |kind: &&str| *kind == "all" || lines.iter().any(|line| line.kind == *kind);
    for kind in KINDS.into_iter().chain([BLAST, "all"]).filter(drawn) {
        let of: Vec<&Line> = lines.iter().filter(|line| line.kind == kind || kind == "all").collect();
        let count = |end: End| of.iter().filter(|line| line.end == end).count().to_string();
        let seconds: f64 = of.iter().map(|line| line.seconds).sum();
        let largest = of.iter().filter_map(|line| line.residual).fold(0.0, f64::max);
        let [good, warned, stopped, refused, silent] =
            [End::Good, End::Warned, End::Stopped, End::Refused, End::Silent].map(count);
        let [largest, seconds] = [format!("{largest:.1e}"), format!("{seconds:.1}")];
        print([kind.into(), of.len().to_string(), good, warned, stopped, refused, silent, largest, seconds]);
    }
}

#[cfg(test)]
mod tests;
