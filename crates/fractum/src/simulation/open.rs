//! From a case file to a simulation before its next step.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use fractum_case::{Case, Diagnostic, Diagnostics};
use fractum_fem::neighbours;
use fractum_output::WriteError;
use fractum_output::atomic::create_folder;
use fractum_output::checkpoint::{self, CheckpointError, Header, Identity, Loaded};
use fractum_output::frames::{GAUGES, Population};
use fractum_output::log::RunLog;
use fractum_output::notes::{PICTURES, STRIP_FILE};
use fractum_output::number::{at_instant, instant_text};
use fractum_output::warning::{Code, Warning};
use fractum_scene::{Scene, ranks, restore_periodic, restore_watch};

use super::messages::Messages;
use super::origin::{forget_case, keep_case, origin};
use super::{About, Options, RunState, Simulation};
use crate::error::Failure;
use crate::input::{Input, read};
use crate::output::columns::Course;
use crate::output::record::frame_layout;
use crate::output::record::{RecordState, Recorder};
use crate::phases::Phases;
use crate::plan::Plan;
use crate::process::interrupt::UnderWay;
use crate::process::ranks::Ranks;
use crate::solver::{Measured, Solver};
use crate::tell;
use crate::terminal::{Stream, Tone, toned};

impl Simulation {
    /// Reads a case, makes its bodies ready, and starts its results folder, or goes on from its last checkpoint.
    ///
    /// # Errors
    /// [`Failure`]: mistakes in the input, a folder that cannot be written, no checkpoint that fits.
    pub fn open(path: &Path, options: &Options) -> Result<Self, Failure> {
        Self::open_shared(path, options, Ranks::alone())
    }

    /// As [`Simulation::open`], as one of several ranks that make the same calls.
    ///
    /// # Errors
    /// As [`Simulation::open`]; [`Failure::Elsewhere`] where another rank tells what went wrong.
    pub fn open_shared(path: &Path, options: &Options, ranks: Ranks) -> Result<Self, Failure> {
        let started = Instant::now();
        let source = || {
            // Before anything is prepared, which may take long.
            results_folder(path, options)?;
            ranks.check(path, &options.overrides)?;
            read(path, &options.overrides, options.line, ranks.processes())
        };
        // What they do together waits until all have done what each does by itself.
        let source = ranks.together(source())?;
        let meshed = ranks.together(source.join(ranks.exchange()))?;
        let prepared =
            ranks.together(meshed.prepare(&options.cache, ranks.processes(), options.quiet || !ranks.leads()))?;
        let input = ranks.together(prepared.build(ranks.exchange()))?;
        Self::start_shared(input, path, options, started, ranks)
    }

    /// As [`Simulation::open`], of a case that [`load`] has read with the overrides of the options.
    ///
    /// - `started`: when the work began, from which the time of the run counts
    ///
    /// # Errors
    /// As [`Simulation::open`].
    pub fn start(input: Input, path: &Path, options: &Options, started: Instant) -> Result<Self, Failure> {
        Self::start_shared(input, path, options, started, Ranks::alone())
    }

    fn start_shared(
        input: Input,
        path: &Path,
        options: &Options,
        started: Instant,
        ranks: Ranks,
    ) -> Result<Self, Failure> {
        if let Some(asked) = input.case.asked_accuracy() {
            let note =
                Diagnostic::error(&asked.share.place, ": it takes several runs, which are not driven step by step");
            let note = note.remedy("run the case as a whole, or set it to 0");
            return Err(Failure::Input(Diagnostics(vec![note])));
        }
        let ranks = Arc::new(ranks);
        let results = results_folder(path, options)?;
        let find = || {
            let identity = identity(&input);
            options.resume.then(|| find_checkpoint(&results, &identity)).transpose()
        };
        // No rank writes before all have read.
        let loaded = ranks.together(find())?;
        let goes_on = ranks.together(loaded.as_ref().map(|loaded| goes_on(&input.case, loaded)).transpose())?;
        let begun = Self::begin(input, (path, options), (loaded, goes_on.as_deref()), started, Arc::clone(&ranks));
        let mut simulation = ranks.together(begun)?;
        let Simulation { scene, recorder, messages, .. } = &mut simulation;
        ranks.distribute(scene, |scene| recorder.watch_points(scene))?;
        ranks.share(scene).into_iter().try_for_each(|share| messages.log.line(share))?;
        if goes_on.is_none() && !simulation.solver.moves() && !simulation.solver.shows_modes() {
            // A path begins where nothing acts.
            let Simulation { recorder, scene, solver, case, .. } = &mut simulation;
            recorder.row(scene, Measured { time: 0.0, dt: 0.0, in_motion: false }, false)?;
            if solver.follows_path() {
                recorder.follow(scene, case.output.fields_every_at_rest)?;
            }
        }
        // What had ended by its curve stays ended.
        if let Some(why) = simulation.falls_below().filter(|_| goes_on.is_some()) {
            simulation.end_stage(why)?;
        }
        simulation.prepare_step()?;
        Ok(simulation)
    }

    /// A simulation whose scene no ranks share yet.
    ///
    /// - `source`: the case file, and how it is run
    /// - `saved`: the state to go on from, and that in words
    fn begin(
        input: Input,
        (path, options): (&Path, &Options),
        (loaded, goes_on): (Option<Loaded<RunState>>, Option<&str>),
        started: Instant,
        ranks: Arc<Ranks>,
    ) -> Result<Self, Failure> {
        let results = results_folder(path, options)?;
        let folder = ranks.folder(&results);
        let identity = identity(&input);
        let plan = Plan::new(&input);
        let Input { case, mesh, mesh_hash, built, later, timings, .. } = input;
        let about = About {
            results: results.clone(),
            identity,
            case_hash: case.hash(),
            origin: origin(&case, mesh_hash, options, &folder),
            plan,
            mesh: mesh.notices,
        };
        if !options.quiet && !options.is_later_pass() {
            tell_plan(&about.plan, goes_on, &folder);
        }
        // Prepared before anything is put back: a resumed run solves the same systems in the same order.
        let mut phases = Phases::default();
        let mut solver = Solver::new(&built.scene, &built, &mut phases)?;
        let course = Course::of(later.iter().map(|(_, built)| built).chain([&built]));
        let (mut scene, mut probes) = (built.scene, built.probes);
        let case = Arc::new(case);
        let (mut stage, mut later) = (Arc::clone(&case), VecDeque::from(later));
        // Stages that a resumed run has behind it.
        let left = loaded.as_ref().map_or(later.len(), |loaded| loaded.state.later);
        while later.len() > left
            && let Some((next, built)) = later.pop_front()
        {
            solver = Solver::new(&built.scene, &built, &mut phases)?;
            scene.begin_stage(built.scene, false);
            (stage, probes) = (Arc::new(next), built.probes);
        }
        // Rigid bodies are drawn from where they lie at the start.
        let grid = frame_layout(
            &scene,
            &built.file_order,
            built.gauges,
            &case,
            ranks.cut(&case.output, neighbours::is_divided(&scene.solid)),
        );
        let put_back = |loaded: Loaded<RunState>| put_back(loaded, &mut scene, &mut solver, &case);
        let earlier = loaded.as_ref().map_or(Vec::new(), |loaded| loaded.state.warnings.to_vec());
        let found = found(&built.warnings, loaded.as_ref(), options.strict)?;
        let resumed = loaded.map(put_back).transpose()?;
        let is_new = resumed.is_none();
        let leads = ranks.leads();
        let mut messages = Messages::new(open_folder(&folder, is_new || !leads)?, options, !leads);
        keep_case(&case, &folder, is_new)?;
        log_start(&mut messages.log, path, &about, goes_on)?;
        timings.iter().try_for_each(|timing| messages.log.line(timing))?;
        messages.begin(found, earlier)?;
        let place = ([folder.as_path(), results.as_path()], course, leads);
        let recorder = Recorder::open(case, &scene, probes, built.ppv, grid, place, resumed)?;
        let resume = Options { resume: true, overwrite: false, quiet: false, ..options.clone() };
        let last_words = ranks.last_words(&results, || resume.command("fractum", path, &results));
        Ok(Simulation {
            case: stage,
            scene,
            solver,
            later,
            recorder,
            ranks,
            folder,
            about,
            messages,
            phases,
            started,
            saved: None,
            measured: None,
            end: None,
            _under_way: (UnderWay::new(), last_words),
        })
    }
}

/// What a checkpoint of these inputs must be of.
fn identity(input: &Input) -> Identity {
    Identity { program: program(), case_hash: input.case.hash_but_end(), mesh_hash: input.mesh_hash }
}

/// Says on the terminal what will happen, and where results will be.
fn tell_plan(plan: &Plan, goes_on: Option<&str>, folder: &Path) {
    match Stream::Error.width() {
        Some(width) => tell!("{}", plan.wrapped(width, |topic| toned(topic, Tone::Name, Stream::Error))),
        None => tell!("{plan}"),
    }
    goes_on.iter().for_each(|text| tell!("{text}"));
    tell!("results in {}", folder.display());
}

/// Begins the log with the program, what it was given, and the plan.
fn log_start(log: &mut RunLog, path: &Path, about: &About, goes_on: Option<&str>) -> Result<(), Failure> {
    let (version, threads) = (env!("CARGO_PKG_VERSION"), rayon::current_num_threads());
    log.line(format!("fractum {version} on {threads} threads: {}", path.display()))?;
    about.origin.lines().iter().try_for_each(|(name, value)| log.line(format!("{name}: {value}")))?;
    goes_on.iter().try_for_each(|text| log.line(text))?;
    Ok(log.line(&about.plan)?)
}

/// The newest checkpoint of this case.
fn find_checkpoint(folder: &Path, identity: &Identity) -> Result<Loaded<RunState<'static>>, Failure> {
    let states = folder.join("checkpoint");
    let complete = |header: &Header, state: RunState<'static>| {
        let solids = checkpoint::load_parts(&states, identity, header.step, state.parts)?;
        Ok(RunState { solids, ..state })
    };
    checkpoint::load_latest_with(&states, identity, complete)?.ok_or_else(|| {
        let text = format!("{}: no checkpoint to resume from; run without --resume", folder.display());
        Failure::input(text)
    })
}

/// What is to be warned of before the first step: what was found in the case, and states that were passed over.
///
/// # Errors
/// [`Failure::Input`] with the warnings of the case where these are errors.
fn found(warnings: &[Diagnostic], loaded: Option<&Loaded<RunState>>, strict: bool) -> Result<Vec<Warning>, Failure> {
    if strict && !warnings.is_empty() {
        return Err(Failure::Input(Diagnostics(warnings.to_vec()).as_errors()));
    }
    let passed_over = loaded.into_iter().flat_map(|loaded| &loaded.passed_over);
    let refused = passed_over.map(|refused| {
        Warning::new(Code::Checkpoint, "", refused.to_string()).remedy("the run goes on from the state before it")
    });
    Ok(warnings.iter().filter_map(Diagnostic::to_warning).chain(refused).collect())
}

/// Where a resumed run goes on, in words.
///
/// # Errors
/// [`Failure::Input`] where the case ends before that.
fn goes_on(case: &Case, loaded: &Loaded<RunState>) -> Result<String, Failure> {
    let (time, end) = (loaded.header.time, case.end());
    let at_rest = loaded.state.solver.rests() && case.flows.heat.is_none();
    let [reached, ends] = [time, end].map(|time| at_instant(time, at_rest));
    let [bare, before] = [end, loaded.state.end].map(|time| instant_text(time, at_rest));
    if end < time && end < loaded.state.end {
        let place = &case.later.last().unwrap_or(case).solver.end_place;
        let found = format!("= {bare}: the saved run has reached {reached}");
        let error = Diagnostic::error(place, found).remedy("choose a later end, or start again with --overwrite");
        return Err(Failure::Input(Diagnostics(vec![error])));
    }
    let was = if loaded.state.end == end { String::new() } else { format!(" instead of {before}") };
    Ok(format!("goes on from step {}, {reached}, to {ends}{was}", loaded.header.step))
}

/// Puts a saved state back into a scene and its solver; what was recorded by then.
///
/// # Errors
/// [`Failure::Input`] where a run with another end has another solver, or loads that the end decides; parts of another solid.
fn put_back(
    loaded: Loaded<RunState>,
    scene: &mut Scene,
    solver: &mut Solver,
    case: &Case,
) -> Result<RecordState, Failure> {
    let Loaded { state, path, .. } = loaded;
    let is_other = state.end != case.end();
    if is_other && !solver.may_go_on(&state.solver) {
        return Err(Failure::input(
            "another end of the run (solver.end) means another load or another solver here: a bonded body at rest is loaded \
             in proportion to it, and kind = \"auto\" chooses by it; restore the end, or start again with --overwrite",
        ));
    }
    let whole = if state.parts == 0 { Some(state.scene) } else { ranks::joined(scene, state.scene, &state.solids) };
    let damaged = || CheckpointError::Corrupt { path, what: "its parts are not those of this mesh".to_owned() };
    scene.restore(whole.ok_or_else(damaged)?);
    scene.restore_heat(state.heat);
    scene.restore_subcycling(state.subcycling);
    restore_periodic(scene, state.periodic);
    restore_watch(scene, state.noticed);
    solver.restore(scene, state.solver);
    let mut record = state.record.into_owned();
    if is_other {
        record.count_anew(&case.output);
    }
    Ok(record)
}

/// The results folder of a run.
///
/// # Errors
/// [`Failure::Input`] where it holds results or a state that the run would replace unasked.
pub(crate) fn results_folder(case: &Path, options: &Options) -> Result<PathBuf, Failure> {
    let folder = options.output.clone().unwrap_or_else(|| default_folder(case));
    if options.resume || options.overwrite {
        return Ok(folder);
    }
    if !holds_results(&folder) {
        return Ok(folder);
    }
    Err(Failure::input(format!(
        "{}: holds the results of another run; --resume continues it, --overwrite replaces it, -o names another folder",
        folder.display()
    )))
}

/// Folder of the passes of a case that asks for an accuracy, in that of its results.
pub(crate) const PASSES: &str = "passes";

/// Whether a folder holds results of a run, or a state to go on from.
fn holds_results(folder: &Path) -> bool {
    let results = ["summary.json", "history.csv"].iter().any(|name| folder.join(name).is_file());
    results || folder.join(PASSES).is_dir() || checkpoint::is_there(&folder.join("checkpoint"))
}

/// Makes the results folder without the results of an earlier run, and opens its log.
///
/// # Errors
/// [`Failure::Write`].
pub(crate) fn begin_results(folder: &Path) -> Result<RunLog, Failure> {
    create_folder(folder)?;
    let path = folder.join("run.log");
    // A run that was killed early has left no more than its log and some pictures and frames.
    let held = path.is_file() || holds_results(folder);
    // The log is locked first: the results of a run under way stay as they are.
    let log = RunLog::create(&path)?;
    if held {
        discard_results(folder)?;
    }
    Ok(log)
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
    let log = begin_results(folder)?;
    let passes = folder.join(PASSES);
    if passes.is_dir() {
        std::fs::remove_dir_all(&passes).map_err(|error| WriteError::new(&passes, error))?;
    }
    Ok(log)
}

/// Files of a run, beside its frames, its pictures, its states and the text of its case.
const RESULTS: [&str; 14] = [
    "accuracy.md",
    "summary.json",
    "history.csv",
    "fields.pvd",
    "fragments.csv",
    "cracks.csv",
    "cracks.vtp",
    "cracks-solids.csv",
    "cracks-solids.vtp",
    "ppv.csv",
    "modes.csv",
    "report.html",
    "movie.png",
    "pictures/notes.json",
];

/// A run that starts anew leaves nothing of an earlier one that could be taken for its own: no state to resume from, no
/// frames, no pictures, no case. Other files in these folders are the user's, and stay.
fn discard_results(folder: &Path) -> Result<(), Failure> {
    checkpoint::discard(&folder.join("checkpoint"))?;
    let pictures = PICTURES.map(|name| folder.join("pictures").join(name));
    let files = RESULTS.map(|name| folder.join(name)).into_iter().chain(pictures);
    for path in files.filter(|path| path.is_file()) {
        std::fs::remove_file(&path).map_err(|error| WriteError::new(&path, error))?;
    }
    let endings = [".vtu", ".vtp", ".pvtu", ".pvtp", ".xyz"];
    let frames = Population::ALL.iter().flat_map(|population| endings.map(|end| (population.folder(), "", end)));
    for (name, start, end) in frames.chain([("pictures", STRIP_FILE, ".png"), (GAUGES, "", ".csv")]) {
        let Ok(entries) = std::fs::read_dir(folder.join(name)) else { continue };
        for path in entries.flatten().map(|entry| entry.path()) {
            let own = path.file_name().and_then(|own| own.to_str());
            if own.is_some_and(|own| own.starts_with(start) && is_numbered(own, end)) {
                std::fs::remove_file(&path).map_err(|error| WriteError::new(&path, error))?;
            }
        }
    }
    forget_case(folder)
}

/// Whether a file is called as those of a frame, `STEM-00012.vtu`, or of a piece of one, `STEM-00012-0003.vtu`.
fn is_numbered(name: &str, ending: &str) -> bool {
    let Some(stem) = name.strip_suffix(ending) else { return false };
    let of_piece = || without_number(stem, 4).and_then(|frame| without_number(frame, 5));
    without_number(stem, 5).or_else(of_piece).is_some()
}

/// What stands before a hyphen and a number of at least so many digits, at the end of a name.
fn without_number(name: &str, digits: usize) -> Option<&str> {
    let (stem, number) = name.rsplit_once('-')?;
    (number.len() >= digits && number.bytes().all(|digit| digit.is_ascii_digit())).then_some(stem)
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
