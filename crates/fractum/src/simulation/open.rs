//! From a case file to a simulation before its next step.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use fractum_io::WriteError;
use fractum_io::atomic::create_folder;
use fractum_io::checkpoint::{self, Identity, Loaded};
use fractum_io::log::RunLog;

use super::messages::Messages;
use super::{Options, RunState, Simulation};
use crate::error::Failure;
use crate::input::{Input, load};
use crate::interrupt::UnderWay;
use crate::phases::Phases;
use crate::plan::Plan;
use crate::record::Recorder;
use crate::solver::Solver;
use crate::tell;
use crate::terminal::{Stream, Tone, toned};

impl Simulation {
    /// Reads a case, makes its bodies ready, and starts its results folder, or goes on from its last checkpoint.
    ///
    /// # Errors
    /// [`Failure`]: mistakes in the input, a folder that cannot be written, no checkpoint that fits.
    pub fn open(path: &Path, options: &Options) -> Result<Self, Failure> {
        let started = Instant::now();
        let input = load(path, &options.overrides, &options.cache)?;
        Self::start(input, path, options, started)
    }

    /// As [`Simulation::open`], of a case that [`load`] has read with the overrides of the options.
    ///
    /// - `started`: when the work began, from which the time of the run counts
    ///
    /// # Errors
    /// As [`Simulation::open`].
    pub fn start(input: Input, path: &Path, options: &Options, started: Instant) -> Result<Self, Failure> {
        let plan = Plan::new(&input);
        let Input { case, mesh_hash, built, later, timings, .. } = input;
        let folder = options.output.clone().unwrap_or_else(|| default_folder(path));
        let identity = Identity { program: program(), case_hash: case.hash(), mesh_hash };
        let loaded = if options.resume { Some(find_checkpoint(&folder, &identity)?) } else { None };
        if !options.quiet {
            match Stream::Error.width() {
                Some(width) => tell!("{}", plan.wrapped(width, |topic| toned(topic, Tone::Name, Stream::Error))),
                None => tell!("{plan}"),
            }
            tell!("results in {}", folder.display());
        }
        // Prepared before anything is put back: a resumed run solves the same systems in the same order.
        let mut phases = Phases::default();
        let mut solver = Solver::new(&built.scene, &built, &mut phases)?;
        let (mut scene, mut probes) = (built.scene, built.probes);
        let case = Arc::new(case);
        let (mut stage, mut later) = (Arc::clone(&case), VecDeque::from(later));
        // Stages that a resumed run has behind it.
        let left = loaded.as_ref().map_or(later.len(), |loaded| loaded.state.later);
        while later.len() > left
            && let Some((next, built)) = later.pop_front()
        {
            solver = Solver::new(&built.scene, &built, &mut phases)?;
            scene.begin_stage(built.scene);
            (stage, probes) = (Arc::new(next), built.probes);
        }
        let resumed = loaded.map(|Loaded { state, .. }| {
            scene.restore(state.scene);
            solver.restore(&mut scene, state.solver);
            state.record
        });
        let mut messages = Messages::new(open_folder(&folder, resumed.is_none())?, options.quiet);
        let threads = rayon::current_num_threads();
        let version = env!("CARGO_PKG_VERSION");
        messages.log.line(format!("fractum {version} on {threads} threads: {}", path.display()))?;
        messages.log.line(&plan)?;
        timings.iter().try_for_each(|timing| messages.log.line(timing))?;
        built.warnings.iter().try_for_each(|warning| messages.warn(warning.to_string()))?;
        let recorder = Recorder::open(case, &scene, probes, built.ppv, &built.file_order, &folder, resumed)?;
        let mut simulation = Simulation {
            case: stage,
            scene,
            solver,
            later,
            recorder,
            folder,
            identity,
            plan,
            messages,
            phases,
            started,
            saved: None,
            measured: None,
            end: None,
            _under_way: UnderWay::new(),
        };
        simulation.prepare_step()?;
        Ok(simulation)
    }
}

/// The newest checkpoint of this case.
fn find_checkpoint(folder: &Path, identity: &Identity) -> Result<Loaded<RunState>, Failure> {
    let Some(loaded) = checkpoint::load_latest::<RunState>(&folder.join("checkpoint"), identity)? else {
        let text = format!("{}: no checkpoint to resume from; run without --resume", folder.display());
        return Err(Failure::input(text));
    };
    for refused in &loaded.passed_over {
        tell!("warning: {refused}");
    }
    Ok(loaded)
}

/// Makes the results folder and opens its log.
///
/// - `anew`: without the results of an earlier run
fn open_folder(folder: &Path, anew: bool) -> Result<RunLog, Failure> {
    create_folder(folder)?;
    create_folder(&folder.join("pictures"))?;
    let path = folder.join("run.log");
    if !anew {
        return Ok(RunLog::resume(&path)?);
    }
    // The log is locked first: the results of a run under way stay as they are.
    let log = RunLog::create(&path)?;
    discard_results(folder)?;
    Ok(log)
}

/// A run that starts anew leaves nothing of an earlier one that could be taken for its own: no state to resume from, no
/// frames. Files of other kinds in these folders are the user's, and stay.
fn discard_results(folder: &Path) -> Result<(), Failure> {
    let checkpoints = folder.join("checkpoint");
    match std::fs::remove_dir_all(&checkpoints) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => {
            return Err(WriteError::new(&checkpoints, error).into());
        }
        _ => {}
    }
    for frames in ["fields", "particles", "bonds"] {
        let Ok(entries) = std::fs::read_dir(folder.join(frames)) else { continue };
        for path in entries.flatten().map(|entry| entry.path()) {
            if path.extension().is_some_and(|e| e == "vtu" || e == "vtp") {
                std::fs::remove_file(&path).map_err(|error| WriteError::new(&path, error))?;
            }
        }
    }
    Ok(())
}

/// Version of the program as far as the layout of its state goes.
fn program() -> String {
    format!("fractum {}", env!("CARGO_PKG_VERSION"))
}

/// `cases/brazilian-concrete/coarse.toml` → `results/brazilian-concrete/coarse`.
fn default_folder(case: &Path) -> PathBuf {
    let absolute = std::path::absolute(case).unwrap_or_else(|_| case.to_owned());
    let folder = absolute.parent().and_then(Path::file_name).unwrap_or_default();
    let name = absolute.file_stem().unwrap_or_default();
    Path::new("results").join(folder).join(name)
}
