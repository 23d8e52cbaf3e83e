//! One case, from its file to its results folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use fractum_io::case::model::{Case, Expect, ProbeKind};
use fractum_io::checkpoint::{self, Header, Identity};
use fractum_io::expectation::Expectation;
use fractum_io::fragments::{self, Fragment};
use fractum_io::log::{Progress, RunLog, Snapshot};
use fractum_io::summary::{self, Status, Summary, hash_text};
use fractum_io::{Compression, WriteError};
use fractum_scene::statics::StaticSolver;
use fractum_scene::{BondedBody, CountKind, EnergyKind, Phase, Scene, SceneState, StepError};
use serde::{Deserialize, Serialize};

use crate::cracks::{self, Columns};
use crate::error::Failure;
use crate::input::{Input, load};
use crate::plan::Plan;
use crate::quasi_static::{Quiet, StaticProgress};
use crate::record::{RecordState, Recorder, index_of_max};
use crate::report::{self, Notes};
use crate::tell;
use fractum_prepare::Cache;

/// How a case is run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Results folder; `results/<folder of the case>/<case>` if none is given.
    pub output: Option<PathBuf>,
    /// Threads; all cores if none is given.
    pub threads: Option<usize>,
    /// Overrides of parameters.
    pub overrides: Vec<(String, String)>,
    /// Go on from the last checkpoint.
    pub resume: bool,
    /// No plan and no progress line.
    pub quiet: bool,
    /// Where packings and beams of bonded bodies are kept.
    pub cache: Cache,
}

/// A run that ended by itself or was interrupted.
#[derive(Debug)]
pub struct Outcome {
    /// What `summary.json` says.
    pub summary: Summary,
    /// Results folder.
    pub folder: PathBuf,
    /// Whether an interrupted run left a state to go on from.
    pub resumable: bool,
}

/// Set by Ctrl-C and SIGTERM: the run saves its state after the present step and ends.
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Whether runs are asked to end.
pub(crate) fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Asks all runs of this process to save their state and end.
pub fn interrupt() {
    INTERRUPTED.store(true, Ordering::Relaxed);
}

/// The whole state of a run: what a checkpoint holds.
#[derive(Serialize, Deserialize)]
struct RunState {
    scene: SceneState,
    record: RecordState,
    /// Of runs at equilibrium only.
    statics: Option<StaticProgress>,
}

/// Runs the case at `path`.
///
/// # Errors
/// [`Failure`]: mistakes in the input, a run that stopped itself, a machine that failed.
pub fn run(path: &Path, options: &Options) -> Result<Outcome, Failure> {
    let mut pool = rayon::ThreadPoolBuilder::new();
    if let Some(threads) = options.threads {
        pool = pool.num_threads(threads);
    }
    let pool = pool.build()?;
    // Inside the pool, parallel loops start without a hand-over between threads.
    pool.install(|| run_in_pool(path, options, pool.current_num_threads()))
}

fn run_in_pool(path: &Path, options: &Options, threads: usize) -> Result<Outcome, Failure> {
    let started = Instant::now();
    let input = load(path, &options.overrides, &options.cache)?;
    let plan = Plan::new(&input);
    let Input { case, mesh_hash, built, timings, .. } = input;
    let folder = options.output.clone().unwrap_or_else(|| default_folder(path));
    let identity = Identity { program: program(), case_hash: case.hash(), mesh_hash };
    let mut scene = built.scene;

    let checkpoints = folder.join("checkpoint");
    if options.resume && built.bonded_statics.is_some() {
        let text = "runs of bonded bodies at rest keep no checkpoints; run without --resume";
        return Err(Failure::input(text));
    }
    // Prepared before anything is put back: a resumed run solves the same systems in the same order.
    let mut quiet = match &built.statics {
        Some(settings) => match StaticSolver::new(&scene, settings.clone()) {
            Ok(solver) => Some(Quiet::new(solver)),
            Err(error) => {
                return Err(Failure::input(format!("{error}; choose solver.linear_solver = \"iterative\"")));
            }
        },
        None => None,
    };
    let resumed = if options.resume { restore(&checkpoints, &identity, &mut scene, quiet.as_mut())? } else { None };
    if options.resume && resumed.is_none() {
        return Err(Failure::input(format!(
            "{}: no checkpoint to resume from; run without --resume",
            folder.display()
        )));
    }
    fractum_io::atomic::create_folder(&folder)?;
    fractum_io::atomic::create_folder(&folder.join("pictures"))?;
    let log_path = folder.join("run.log");
    let mut log = if resumed.is_some() { RunLog::resume(&log_path)? } else { RunLog::create(&log_path)? };
    if resumed.is_none() {
        discard_results(&folder)?;
    }
    log.line(format!("fractum {} on {threads} threads: {}", env!("CARGO_PKG_VERSION"), path.display()))?;
    log.line(&plan)?;
    timings.iter().try_for_each(|timing| log.line(timing))?;
    let mut progress = Progress::on_stderr(options.quiet);
    if !options.quiet {
        tell!("{plan}");
        tell!("results in {}", folder.display());
    }
    for warning in &built.warnings {
        progress.message(warning);
        log.line(warning)?;
    }

    let recorder = Recorder::open(&case, &scene, &built.probes, &built.file_order, &folder, resumed)?;
    let mut run = Run {
        case: &case,
        folder: &folder,
        identity,
        recorder,
        progress,
        log,
        started,
        saved: Instant::now(),
        warned: false,
        warnings: built.warnings.iter().map(ToString::to_string).collect(),
        phases: [Duration::ZERO; PHASES.len()],
    };
    // The one place where the kind of solver decides.
    let end = match (&mut quiet, &built.bonded_statics) {
        (Some(quiet), _) => run.equilibrate(&mut scene, quiet),
        (None, Some(settings)) => run.break_at_rest(&mut scene, *settings),
        (None, None) => run.advance(&mut scene),
    };
    let at_rest = built.bonded_statics.is_some() || quiet.as_ref().is_some_and(|quiet| !quiet.moves());
    let resumable = built.bonded_statics.is_none();
    run.conclude(scene, threads, end, &plan, at_rest).map(|outcome| Outcome { resumable, ..outcome })
}

/// Why the loop over the steps ended.
pub(crate) enum End {
    Finished,
    Interrupted,
    Failed(StepError),
}

/// Names of the phases in `summary.json`, and of the output beside them.
pub(crate) const PHASES: [&str; 6] = ["solid", "bonds", "contact", "motion", "transition", "output"];

/// A run under way.
pub(crate) struct Run<'a> {
    pub(crate) case: &'a Case,
    folder: &'a Path,
    identity: Identity,
    pub(crate) recorder: Recorder<'a>,
    pub(crate) progress: Progress<std::io::Stderr>,
    pub(crate) log: RunLog,
    pub(crate) started: Instant,
    pub(crate) saved: Instant,
    warned: bool,
    warnings: Vec<String>,
    phases: [Duration; PHASES.len()],
}

impl Run<'_> {
    fn advance(&mut self, scene: &mut Scene) -> Result<End, Failure> {
        let every = Duration::try_from_secs_f64(self.case.output.checkpoint_every).unwrap_or(Duration::MAX);
        while !scene.is_finished() {
            if is_interrupted() {
                self.save(scene, None)?;
                return Ok(End::Interrupted);
            }
            if self.saved.elapsed() >= every {
                self.save(scene, None)?;
            }
            let (time, dt) = (scene.clock.time, scene.clock.dt_after);
            if self.recorder.frame_is_due(time) {
                self.timed(PHASES.len() - 1, |run| run.recorder.frame(scene))?;
            }
            let row = self.recorder.row_is_due(time);
            if let Err(error) = self.step(scene, row) {
                return Ok(End::Failed(error));
            }
            if row {
                self.timed(PHASES.len() - 1, |run| run.recorder.row(scene, time, dt))?;
                self.warn_of_balance(scene)?;
                if self.falls_below() {
                    break;
                }
            }
            if self.progress.due(self.started.elapsed()) {
                self.progress.show(&self.snapshot(scene), self.started.elapsed());
            }
        }
        Ok(End::Finished)
    }

    pub(crate) fn timed<T>(&mut self, phase: usize, what: impl FnOnce(&mut Self) -> T) -> T {
        let start = Instant::now();
        let result = what(self);
        self.phases[phase] += start.elapsed();
        result
    }

    pub(crate) fn step(&mut self, scene: &mut Scene, measure: bool) -> Result<(), StepError> {
        let mut last = Instant::now();
        let phases = &mut self.phases;
        scene.step_observed(measure, |phase| {
            let now = Instant::now();
            let place = match phase {
                Phase::Solid => 0,
                Phase::Bonds => 1,
                Phase::Contact => 2,
                Phase::Motion => 3,
                Phase::Transition => 4,
            };
            phases[place] += now - last;
            last = now;
        })?;
        Ok(())
    }

    /// The early end that the case asks for.
    pub(crate) fn falls_below(&self) -> bool {
        let Some(stop) = &self.case.solver.stop_when else { return false };
        let record = self.recorder.state();
        let (values, time) = (&record.series[stop.probe], record.times.last().copied().unwrap_or(0.0));
        let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        largest > 0.0 && time >= stop.after && values.last().is_some_and(|&v| v < stop.below * largest)
    }

    pub(crate) fn warn_of_balance(&mut self, scene: &Scene) -> Result<(), Failure> {
        let relative = scene.ledger().relative_residual();
        if self.warned || relative <= self.case.solver.balance_warning {
            return Ok(());
        }
        self.warned = true;
        let text = format!(
            "warning: t = {:.4e} s: the energy balance is off by {relative:.1e} of the energy put in",
            scene.clock.time
        );
        self.progress.message(&text);
        self.log.line(&text)?;
        self.warnings.push(text);
        Ok(())
    }

    pub(crate) fn save(&mut self, scene: &Scene, statics: Option<StaticProgress>) -> Result<(), Failure> {
        let state = RunState { scene: scene.state(), record: self.recorder.sync()?, statics };
        let header = Header { identity: self.identity.clone(), step: scene.clock.step, time: scene.clock.time };
        let file = checkpoint::save(&self.folder.join("checkpoint"), &header, &state, Compression::Fast)?;
        self.log.line(format!("step {}: state saved in {}", scene.clock.step, file.display()))?;
        self.saved = Instant::now();
        Ok(())
    }

    pub(crate) fn snapshot(&self, scene: &Scene) -> Snapshot {
        let ledger = scene.ledger();
        let counts = scene.counts();
        Snapshot {
            step: scene.clock.step,
            time: scene.clock.time,
            end: self.case.solver.end,
            dt: scene.clock.dt_before,
            kinetic: ledger[EnergyKind::Kinetic],
            elastic: ledger[EnergyKind::Elastic],
            dissipated: ledger.spent(),
            balance_error: ledger.relative_residual(),
            broken_edges: counts.broken_edges as u64,
            broken_bonds: counts.broken_bonds as u64,
            particles: counts.particles as u64,
        }
    }

    /// Last frame, last row, summary and final names.
    fn conclude(
        mut self,
        mut scene: Scene,
        threads: usize,
        end: Result<End, Failure>,
        plan: &Plan,
        at_rest: bool,
    ) -> Result<Outcome, Failure> {
        let end = end?;
        let status = match &end {
            End::Finished => Status::Completed,
            End::Interrupted => Status::Interrupted,
            End::Failed(_) => Status::Stopped,
        };
        let state_hash = state_hash(&scene.state());
        let clock = scene.clock;
        if !matches!(end, End::Interrupted) {
            self.timed(PHASES.len() - 1, |run| run.recorder.frame(&scene))?;
        }
        if matches!(end, End::Finished) && !at_rest {
            // The forces and energies of the last instant: one more step, of which nothing else is kept.
            let (time, dt) = (clock.time, clock.dt_after);
            if self.step(&mut scene, true).is_ok() {
                self.recorder.row(&scene, time, dt)?;
            }
        }
        self.progress.finish(&self.snapshot(&scene), self.started.elapsed());
        let pieces = fragments_of(&scene);
        fragments::write(&self.folder.join("fragments.csv"), &pieces)?;
        self.write_cracks(&scene)?;
        let mut summary = self.summary(&scene, status, threads);
        summary.state_hash = hash_text(state_hash);
        summary.time = summary::Time { steps: clock.step, dt: clock.dt_before, dt_min: clock.dt_min, end: clock.time };
        summary.expect = self.case.expect.iter().map(|e| expectation(e, &summary)).collect();
        summary.write(&self.folder.join("summary.json"))?;
        self.log.line(format!("{}: {} steps, {:.2} s", status_text(status), clock.step, summary.wall.total))?;
        let notes = Notes {
            case_file: self.case.source.path.display().to_string(),
            plan: plan.to_string(),
            warnings: self.warnings,
            pictures: crate::gallery::draw(&scene, self.folder),
        };
        self.recorder.finish()?;
        report::keep(self.folder, &notes)?;
        report::write(self.folder)?;
        match end {
            End::Failed(error) => {
                self.log.line(&error)?;
                Err(Failure::Stopped { error, folder: self.folder.display().to_string() })
            }
            _ => Ok(Outcome { summary, folder: self.folder.to_owned(), resumable: true }),
        }
    }

    /// The bonds that broke, where some could.
    fn write_cracks(&self, scene: &Scene) -> Result<(), Failure> {
        let bodies = scene.bonded.bodies();
        if !bodies.iter().any(BondedBody::can_break) {
            return Ok(());
        }
        let all = bodies.iter().flat_map(|body| body.cracks().iter().map(|crack| (Some(body.name.as_str()), crack)));
        let columns = Columns { time: "time [s]", load: None };
        cracks::write_table(&self.folder.join("cracks.csv"), all.clone(), columns)?;
        let points: Vec<[f64; 3]> = scene.bonded.reference().iter().map(|x| (*x).into()).collect();
        cracks::write_lines(&self.folder.join("cracks.vtp"), &points, all.map(|(_, crack)| crack))
    }

    fn summary(&self, scene: &Scene, status: Status, threads: usize) -> Summary {
        let counts = scene.counts();
        let record = self.recorder.state();
        let mut probes = BTreeMap::new();
        for (index, probe) in self.case.probes.iter().enumerate() {
            let values = &record.series[index];
            let value = match &probe.kind {
                ProbeKind::Expression(expression) if expression.scalar => {
                    let value = self.recorder.scalar(expression);
                    let unit = probe.unit.clone();
                    summary::Probe { unit, r#final: value, max: value, min: value, time_of_max: f64::NAN }
                }
                _ => {
                    let extreme = |f: fn(f64, f64) -> f64| values.iter().copied().fold(f64::NAN, f);
                    summary::Probe {
                        unit: probe.unit.clone(),
                        r#final: values.last().copied().unwrap_or(f64::NAN),
                        max: extreme(f64::max),
                        min: extreme(f64::min),
                        time_of_max: index_of_max(values).map_or(f64::NAN, |i| record.times[i]),
                    }
                }
            };
            probes.insert(probe.name.value.clone(), value);
        }
        let phases = PHASES.iter().zip(&self.phases).map(|(name, d)| ((*name).to_owned(), d.as_secs_f64())).collect();
        Summary {
            fractum: env!("CARGO_PKG_VERSION").to_owned(),
            title: self.case.title.clone(),
            status,
            threads,
            case_hash: hash_text(self.identity.case_hash),
            probes,
            energy: scene.ledger().into(),
            counts: summary::Counts {
                nodes: counts.nodes as u64,
                elements: counts.elements as u64,
                removed_elements: counts.removed_elements as u64,
                particles: counts.particles as u64,
                bonds: counts.bonds as u64,
                broken_bonds: counts.broken_bonds as u64,
                broken_edges: counts.broken_edges as u64,
                fragments: scene.count(CountKind::Fragments) as u64,
            },
            fracture: scene.bonded.bodies().iter().filter(|body| body.can_break()).map(fracture_of).collect(),
            wall: summary::Wall { total: self.started.elapsed().as_secs_f64(), phases },
            ..Summary::default()
        }
    }
}

/// Restores the newest checkpoint of this case into the scene.
fn restore(
    folder: &Path,
    identity: &Identity,
    scene: &mut Scene,
    quiet: Option<&mut Quiet>,
) -> Result<Option<RecordState>, Failure> {
    let Some(loaded) = checkpoint::load_latest::<RunState>(folder, identity)? else { return Ok(None) };
    for refused in &loaded.passed_over {
        tell!("warning: {refused}");
    }
    scene.restore(loaded.state.scene);
    if let (Some(quiet), Some(progress)) = (quiet, loaded.state.statics) {
        quiet.restore(scene, progress);
    }
    Ok(Some(loaded.state.record))
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

/// Hash of everything that changes in a scene.
fn state_hash(state: &SceneState) -> u128 {
    let bytes = postcard::to_stdvec(state).unwrap_or_default();
    xxhash_rust::xxh3::xxh3_128(&bytes)
}

/// `cases/brazilian-concrete/coarse.toml` → `results/brazilian-concrete/coarse`.
fn default_folder(case: &Path) -> PathBuf {
    let absolute = std::path::absolute(case).unwrap_or_else(|_| case.to_owned());
    let folder = absolute.parent().and_then(Path::file_name).unwrap_or_default();
    let name = absolute.file_stem().unwrap_or_default();
    Path::new("results").join(folder).join(name)
}

fn status_text(status: Status) -> &'static str {
    match status {
        Status::Completed => "completed",
        Status::Stopped => "stopped",
        Status::Interrupted => "interrupted",
    }
}

/// What became of the bonds of a body.
fn fracture_of(body: &BondedBody) -> summary::Fracture {
    let closest = body.closest();
    summary::Fracture {
        body: body.name.clone(),
        broken_bonds: body.broken() as u64,
        first_break: body.cracks().first().map_or(f64::NAN, |crack| crack.time),
        crack_area: body.cracks().iter().map(|crack| crack.area).sum(),
        largest_ratio: closest.map_or(f64::NAN, |c| c.ratio),
        largest_at: closest.map(|c| c.place.into()),
        largest_time: closest.map_or(f64::NAN, |c| c.time),
    }
}

fn fragments_of(scene: &Scene) -> Vec<Fragment> {
    scene
        .fragments()
        .into_iter()
        .zip(1..)
        .map(|(piece, id)| Fragment {
            id,
            mass: piece.mass,
            volume: piece.volume,
            nodes: piece.nodes.len() as u64,
            elements: piece.elements as u64,
            centroid: piece.centroid.into(),
            velocity: piece.velocity.into(),
            largest_extent: piece.extent(),
        })
        .collect()
}

/// Holds a value of the summary against its reference.
fn expectation(expect: &Expect, summary: &Summary) -> Expectation {
    let name = &expect.quantity.value;
    let value = match summary.probes.get(name) {
        Some(probe) => probe.r#final,
        None => summary_value(summary, name),
    };
    Expectation::hold(name, &expect.unit, value, expect.bound, &expect.source)
}

/// A number of the summary by its dotted path, such as `energy.residual_max_relative`.
fn summary_value(summary: &Summary, path: &str) -> f64 {
    let json = serde_json::to_value(summary).unwrap_or_default();
    path.split('.').try_fold(&json, |value, key| value.get(key)).and_then(serde_json::Value::as_f64).unwrap_or(f64::NAN)
}
