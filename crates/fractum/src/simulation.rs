//! One run that can be driven step by step.

mod audit;
mod coarse;
mod crack_energy;
mod damaged;
mod drive;
mod end;
mod finish;
mod messages;
mod modes;
mod open;
mod origin;
mod whole;

use std::borrow::Cow;
use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use fractum_case::Case;
use fractum_case::build::BuiltScene;
use fractum_fem::cracks;
use fractum_fem::neighbours::SolidPart;
use fractum_output::checkpoint::{self, Header, Identity};
use fractum_output::log::Snapshot;
use fractum_output::number::{at_instant, mode_text};
use fractum_output::origin::Origin;
use fractum_output::summary::Summary;
use fractum_output::warning::Warning;
use fractum_prepare::Cache;
use fractum_scene::{
    EnergyKind, HeatState, PeriodicState, Scene, SceneState, StepError, SubcyclingState, Watch, periodic_state, ranks,
    watch_of,
};
use fractum_vtk::Compression;
use serde::{Deserialize, Serialize};

use crate::error::Failure;
use crate::output::record::{RecordState, Recorder};
use crate::output::series::index_of_max;
use crate::phases::{Part, Phases};
use crate::plan::Plan;
use crate::process::interrupt::{UnderWay, is_interrupted};
use crate::process::last_words::LastWords;
use crate::process::ranks::Ranks;
use crate::solver::{Measured, Solver, SolverState};
pub(crate) use damaged::Damaged;
use end::End;
use messages::Messages;
pub(crate) use open::{PASSES, begin_results, results_folder};
pub use origin::for_shell;
pub(crate) use origin::keep_case;
pub(crate) use origin::kept_hash;
pub(crate) use whole::{Measure, run_whole};

/// How a case is run.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// Results folder; `results/<folder of the case>/<case>` if none is given.
    pub output: Option<PathBuf>,
    /// Threads of [`run`](crate::run); all cores if none is given.
    pub threads: Option<usize>,
    /// Overrides of parameters.
    pub overrides: Vec<(String, String)>,
    /// Go on from the last checkpoint; only the end of the run may be another than it was.
    pub resume: bool,
    /// Replace results that the folder holds; without it they are an error.
    pub overwrite: bool,
    /// No plan and no progress line.
    pub quiet: bool,
    /// Warnings are errors: of the case before the run, else they end it.
    pub strict: bool,
    /// Where packings and beams of bonded bodies are kept.
    pub cache: Cache,
    /// A pass of a case that asks for an accuracy: it leaves `damaged.json`, and all but the first leave plan and warnings to their logs.
    pub pass: Option<usize>,
    /// A pass whose crack runs along lines of its mesh: about when its load is largest [s].
    pub line: Option<f64>,
}

impl Options {
    fn is_later_pass(&self) -> bool {
        self.pass.is_some_and(|pass| pass > 0)
    }
}

/// A run that ended by itself or was interrupted.
#[derive(Debug)]
pub struct Outcome {
    /// What `summary.json` says.
    pub summary: Summary,
    /// Results folder.
    pub folder: PathBuf,
    /// Name of the probe that measures the load: the first force, else the first moment.
    pub load: Option<String>,
}

/// A case under way: its scene, its solver and its results folder.
///
/// [`open`](Simulation::open), then [`step`](Simulation::step) and [`record`](Simulation::record) in turn until it
/// [is over](Simulation::is_over), then [`finish`](Simulation::finish). Parallel loops use the rayon pool that the
/// caller is in; results do not depend on its number of threads.
pub struct Simulation {
    case: Arc<Case>,
    scene: Scene,
    solver: Solver,
    /// What follows the present stage.
    later: VecDeque<(Case, BuiltScene)>,
    recorder: Recorder,
    /// Those that run the case together.
    ranks: Arc<Ranks>,
    /// Where this process writes.
    folder: PathBuf,
    about: About,
    messages: Messages,
    phases: Phases,
    started: Instant,
    saved: Option<Saved>,
    /// The instant that the last step measured, until its row is written.
    measured: Option<Measured>,
    end: Option<End>,
    /// A signal leaves the program the time to save the state.
    _under_way: (UnderWay, Option<LastWords>),
}

/// What is known of a run before its first step.
struct About {
    /// The results folder of all processes.
    results: PathBuf,
    identity: Identity,
    case_hash: u128,
    origin: Origin,
    plan: Plan,
    /// What reading the mesh changed in it.
    mesh: Vec<String>,
}

/// The last checkpoint of this run.
#[derive(Clone, Copy)]
struct Saved {
    at: Instant,
    step: u64,
    time: f64,
}

/// The whole state of a run: what a checkpoint holds.
#[derive(Serialize, Deserialize)]
struct RunState<'a> {
    /// End of the run when it was saved [s].
    end: f64,
    scene: SceneState,
    /// Files of parts that the processes have written of it; 0 where it is whole.
    parts: usize,
    /// These, once they are read.
    #[serde(skip)]
    solids: Vec<SolidPart>,
    heat: Option<HeatState>,
    subcycling: Option<SubcyclingState>,
    periodic: Option<PeriodicState>,
    noticed: Watch,
    /// What the steps so far have brought.
    warnings: Cow<'a, [Warning]>,
    record: Cow<'a, RecordState>,
    /// Stages that were still to come.
    later: usize,
    solver: SolverState,
}

impl Simulation {
    /// The case.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// The scene at the present instant: displacements, stresses, damage, particles, energies.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Present time [s]; the load parameter at rest.
    pub fn time(&self) -> f64 {
        self.scene.clock.time
    }

    /// Steps done.
    pub fn steps(&self) -> u64 {
        self.scene.clock.step
    }

    /// Results folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Times [s] and values of a probe that is a column of the history, row by row; none for an unknown name.
    pub fn probe(&self, name: &str) -> Option<(&[f64], &[f64])> {
        let index = self.case.probes.iter().position(|probe| probe.name.value == name)?;
        let record = self.recorder.state();
        Some((&record.times, &record.series[index]))
    }

    /// All warnings so far, those of the case and those of the steps.
    pub fn warnings(&self) -> &[Warning] {
        self.messages.warnings()
    }

    /// Whether the run is over: its end is reached, it was interrupted, or a step failed.
    pub fn is_over(&self) -> bool {
        self.end.is_some()
    }

    /// Brings the scene to the next instant or the next equilibrium; of no effect once the run is over.
    ///
    /// A step that fails ends the run; [`finish`](Simulation::finish) says why. The search for an equilibrium ends early
    /// by an interrupt, with the state before it saved.
    ///
    /// # Errors
    /// [`Failure`] where that state cannot be written.
    pub fn step(&mut self) -> Result<(), Failure> {
        if self.is_over() {
            return Ok(());
        }
        let measure = self.recorder.row_is_due(self.scene.clock.time);
        let before = self.solver.rests().then(|| (self.scene.state(), self.solver.state()));
        match (self.solver.step(&mut self.scene, measure, &mut self.phases), before) {
            (Ok(advance), _) => {
                self.recorder.watch(&self.scene);
                self.measured = advance.measured;
                self.messages.event = advance.event;
            }
            (Err(StepError::Interrupted { .. }), Some((scene, solver))) => {
                self.save_state(scene, 0, solver)?;
                self.end = Some(End::Interrupted);
            }
            (Err(error), before) => {
                // The equilibrium before the one that was not found; of motion the last checkpoint remains.
                before.map_or(Ok(()), |(scene, solver)| self.save_state(scene, 0, solver))?;
                self.end = Some(End::Failed(error));
            }
        }
        Ok(())
    }

    /// Writes what is due: the row of the instant that the step measured, a checkpoint, a frame of the fields; shows
    /// progress and notices an interrupt.
    ///
    /// # Errors
    /// [`Failure`] where something cannot be written.
    pub fn record(&mut self) -> Result<(), Failure> {
        self.audit_now_and_then()?;
        if let Some(measured) = self.measured.take() {
            // Of motion one more row follows at the end.
            let is_last = self.later.is_empty() && !self.solver.moves() && self.solver.is_finished(&self.scene);
            let Simulation { recorder, scene, phases, .. } = self;
            phases.timed(Part::Output, || recorder.row(scene, measured, is_last))?;
            self.audit_balance()?;
            if let Err(error) = self.scene.refuse_bands_without_fragments() {
                self.end = Some(End::Failed(error));
                return Ok(());
            }
            if let Some(why) = self.falls_below() {
                self.end_stage(why)?;
            }
        }
        if !self.is_over() && self.solver.follows_path() {
            let Simulation { recorder, scene, phases, case, .. } = self;
            phases.timed(Part::Output, || recorder.follow(scene, case.output.fields_every_at_rest))?;
        }
        self.messages.tell_event()?;
        self.recorder.check_frame()?;
        self.prepare_step()?;
        if !self.is_over() && !self.solver.shows_modes() && self.messages.progress.due(self.started.elapsed()) {
            self.messages.progress.show(&self.snapshot(), self.started.elapsed());
        }
        Ok(())
    }

    /// What is due before a step, unless the run is over.
    fn prepare_step(&mut self) -> Result<(), Failure> {
        if self.is_over() {
            return Ok(());
        }
        if self.solver.is_finished(&self.scene) {
            let why = self.last_step();
            self.end_stage(why)?;
        }
        if self.is_over() {
            return Ok(());
        }
        let every = Duration::try_from_secs_f64(self.case.output.checkpoint_every).unwrap_or(Duration::MAX);
        let step = self.scene.clock.step;
        let by_steps = self.case.output.checkpoint_steps.is_some_and(|steps| step.is_multiple_of(steps));
        let save_is_due =
            self.saved.is_none_or(|saved| saved.at.elapsed() >= every || (by_steps && saved.step != step));
        let [interrupted, save_is_due] = self.ranks.any([is_interrupted(), save_is_due]);
        if interrupted {
            self.save()?;
            self.end = Some(End::Interrupted);
            return Ok(());
        }
        if save_is_due {
            self.save()?;
        }
        let by_time = !self.solver.follows_path();
        let frame_is_due = match self.solver.shows_modes() {
            // Before the first one nothing is to be seen.
            true => self.scene.clock.step > 0,
            false => self.recorder.frame_is_due(self.scene.clock.time, by_time),
        };
        if frame_is_due {
            ranks::gather_all(&mut self.scene);
            let Simulation { recorder, scene, phases, .. } = self;
            phases.timed(Part::Output, || recorder.frame(scene))?;
        }
        Ok(())
    }

    /// Goes on with the next stage, if there is one.
    fn end_stage(&mut self, why: String) -> Result<(), Failure> {
        let Some((case, built)) = self.later.pop_front() else {
            self.end.get_or_insert(End::Finished(why));
            return Ok(());
        };
        let leaving = case.excavation.iter().flat_map(|excavation| &excavation.bodies);
        let leaving: String = leaving.map(|name| format!(", body \"{}\" leaves", name.value)).collect();
        let coming = case.excavation.iter().flat_map(|excavation| &excavation.installed);
        let coming: String = coming.map(|name| format!(", body \"{}\" comes in", name.value)).collect();
        let text = format!("{}: stage \"{}\"{leaving}{coming}", self.instant(self.time()), case.source.stage);
        self.messages.tell(&text)?;
        self.solver.effort().map_or(Ok(()), |effort| self.messages.log.line(effort))?;
        let was_moving = self.solver.moves();
        ranks::gather_all(&mut self.scene);
        // From the state at t = 0, as a resumed run does.
        self.solver = self.ranks.together(Solver::new(&built.scene, &built, &mut self.phases))?;
        self.scene.begin_stage(built.scene, was_moving);
        self.solver.take_over(&mut self.scene, was_moving);
        self.recorder.set_probes(built.probes);
        self.case = Arc::new(case);
        self.ranks.distribute(&mut self.scene, |scene| self.recorder.watch_points(scene))
    }

    /// An instant in words.
    fn instant(&self, time: f64) -> String {
        if self.solver.shows_modes() { mode_text(time) } else { at_instant(time, self.counts_load()) }
    }

    /// Whether instants are load factors: at rest, where no heat goes on with time.
    fn counts_load(&self) -> bool {
        self.solver.rests() && self.scene.heat().is_none()
    }

    /// Waits until the pieces of frames that all processes write are on the disk.
    fn finish_pieces(&mut self) -> Result<(), Failure> {
        if !self.recorder.shares_frames() {
            return Ok(());
        }
        let done = self.recorder.finish_frame();
        self.ranks.together(done)
    }

    /// Saves the state; where processes share solids, each writes what it has of them beside what the first one writes.
    fn save(&mut self) -> Result<(), Failure> {
        self.finish_pieces()?;
        self.recorder.join_overlaps(&self.ranks);
        let (scene, parts) = match ranks::state_in_parts(&mut self.scene) {
            Some((scene, part)) => {
                let written = self.save_part(&part);
                self.ranks.together(written)?;
                (Some(scene), self.ranks.processes().all)
            }
            None => {
                ranks::gather_all(&mut self.scene);
                (self.ranks.leads().then(|| self.scene.state()), 0)
            }
        };
        let clock = self.scene.clock;
        self.saved = Some(Saved { at: Instant::now(), step: clock.step, time: clock.time });
        let (scene, solver) = (scene.filter(|_| self.ranks.leads()), self.solver.state());
        scene.map_or(Ok(()), |scene| self.save_state(scene, parts, solver))
    }

    fn save_part(&mut self, part: &SolidPart) -> Result<(), Failure> {
        let clock = self.scene.clock;
        let header = Header { identity: self.about.identity.clone(), step: clock.step, time: clock.time };
        let (folder, process) = (self.about.results.join("checkpoint"), self.ranks.rank());
        let write = || checkpoint::save_part(&folder, &header, process, part, Compression::Fast);
        Ok(self.phases.timed(Part::Output, write)?)
    }

    /// - `parts`: files that have been written of it
    fn save_state(&mut self, scene: SceneState, parts: usize, solver: SolverState) -> Result<(), Failure> {
        let clock = scene.clock;
        let (end, later) = (self.end_of_run(), self.later.len());
        let (heat, subcycling) = (self.scene.heat_state(), self.scene.subcycling_state());
        let started = Instant::now();
        let record = self.recorder.sync()?;
        self.phases.add(Part::Output, started.elapsed());
        let state = RunState {
            end,
            scene,
            parts,
            solids: Vec::new(),
            heat,
            subcycling,
            periodic: periodic_state(&self.scene),
            noticed: watch_of(&self.scene),
            warnings: Cow::Borrowed(self.messages.of_steps()),
            record: Cow::Borrowed(record),
            later,
            solver,
        };
        let header = Header { identity: self.about.identity.clone(), step: clock.step, time: clock.time };
        let folder = self.folder.join("checkpoint");
        let write = || checkpoint::save(&folder, &header, &state, Compression::Fast);
        let file = self.phases.timed(Part::Output, write)?;
        self.messages.log.line(format!("step {}: state saved in {}", clock.step, file.display()))?;
        self.saved = Some(Saved { at: Instant::now(), step: clock.step, time: clock.time });
        Ok(())
    }

    /// End of the last stage [s].
    fn end_of_run(&self) -> f64 {
        self.later.back().map_or(&*self.case, |(case, _)| case).solver.end
    }

    fn snapshot(&self) -> Snapshot {
        let ledger = self.scene.ledger();
        let counts = self.scene.counts();
        let clock = self.scene.clock;
        Snapshot {
            step: clock.step,
            time: clock.time,
            end: self.case.solver.end,
            dt: clock.dt_before,
            kinetic: ledger[EnergyKind::Kinetic],
            elastic: ledger[EnergyKind::Elastic],
            dissipated: ledger.spent(),
            balance_error: ledger.relative_residual(),
            broken_edges: cracks::fracture(&self.scene.solid).broken_edges as u64,
            broken_bonds: counts.broken_bonds as u64,
            particles: counts.particles as u64,
            load: self.load().map(|(index, unit)| (self.load_and_peak(index), unit)),
            at_rest: self.counts_load(),
        }
    }

    /// Index and unit of the probe that measures the load, once it has a row.
    fn load(&self) -> Option<(usize, &'static str)> {
        self.recorder.load().filter(|&(index, _)| !self.recorder.state().series[index].is_empty())
    }

    /// When the load was largest [s], where a probe measures one.
    fn time_of_peak(&self) -> Option<f64> {
        let record = self.recorder.state();
        let values: Vec<f64> = record.series[self.load()?.0].iter().map(|value| value.abs()).collect();
        index_of_max(&values).map(|index| record.times[index])
    }

    /// Last value of a probe, and that of the largest absolute value.
    fn load_and_peak(&self, index: usize) -> [f64; 2] {
        let values = &self.recorder.state().series[index];
        let peak = values.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
        [values.last().copied().unwrap_or(0.0), peak]
    }
}
