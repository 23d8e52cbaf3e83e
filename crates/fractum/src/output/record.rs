//! What a run leaves behind: history, fields, particles, pictures of numbers over time.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use fractum_case::build::PpvStations;
use fractum_case::model::{BodyKind, Case, Output, ProbeExpression, ProbeInput, ProbeKind, Take, load_of};
use fractum_output::atomic::{Group, Written};
use fractum_output::attenuation::{Attenuation, Station};
use fractum_output::columns::{HistoryColumns, Instant};
use fractum_output::fields::OutputField;
use fractum_output::frames::{BuiltGauges, Frame, FrameEntry, FrameWriter, GridLayout, PathFrames};
use fractum_output::history::History;
use fractum_output::summary::LargestOverlap;
use fractum_scene::{
    Counts, EnergyKind, PeakVelocity, Probe, ProbedScene, Scene, StationPlace, VelocityStation, Watched,
};
use fractum_vtk::{Collection, Cut};
use serde::{Deserialize, Serialize};

use crate::error::Failure;
use crate::output::columns::{Course, columns, no_probes};
use crate::output::fetch::{Fetch, fetch_together, points_of_probes};
use crate::output::series::{index_of_max, interpolate, is_due, next_index, slope_of_window, speed, time_mean};
use crate::process::ranks::Ranks;
use crate::solver::Measured;

/// How many elements and bonds are gone: as none comes back, equal numbers are the same ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Gone {
    /// Removed elements, with those that have left the domain.
    pub(crate) elements: usize,
    bonds: usize,
}

impl Gone {
    /// At present.
    pub(crate) fn at(scene: &Scene, counts: &Counts) -> Self {
        Gone { elements: counts.removed_elements + scene.left().elements, bonds: counts.broken_bonds }
    }
}

/// Where recording stands; part of every checkpoint.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct RecordState {
    /// Rows and frames written so far.
    rows: u64,
    frames: u64,
    history: Written,
    collection: Collection,
    path: PathFrames,
    /// Time of each row [s].
    pub(crate) times: Vec<f64>,
    /// Values of each probe that is a column, row by row.
    pub(crate) series: Vec<Vec<f64>>,
    /// Body, element and time [s] of the elements that rows have found removed.
    pub(crate) removed: Vec<(u32, u32, f64)>,
    /// Largest velocities so far, table by table and station by station.
    peaks: Vec<Vec<PeakVelocity>>,
    /// The largest overlap of a particle so far.
    overlap: Option<LargestOverlap>,
}

impl RecordState {
    /// Numbers rows and frames anew, for other times between them.
    pub(crate) fn count_anew(&mut self, output: &Output) {
        let next = |last: Option<f64>, every: f64| last.map_or(0, |time| next_index(time, every));
        self.rows = next(self.times.last().copied(), output.history_every);
        // Along a path frames are not counted by time, and may be listed by steps.
        let along_path = self.path.frames() > 0;
        let last = if along_path {
            self.times.last().copied()
        } else {
            self.collection.entries.last().map(|entry| entry.time)
        };
        self.frames = next(last, output.fields_every);
    }
}

/// Writes the results of a run while it goes.
pub(crate) struct Recorder {
    case: Arc<Case>,
    probes: Vec<Option<Box<dyn Probe>>>,
    ppv: Vec<PpvStations>,
    /// Results folder of the run, where frames go.
    results: PathBuf,
    history: History,
    writer: FrameWriter,
    state: RecordState,
    /// Elements of each body that are in the list of removed ones.
    noted: Vec<Vec<bool>>,
    grid: GridLayout,
    inputs: Vec<f64>,
    /// What has to be fetched for each probe.
    fetches: Vec<Fetch>,
    /// What was gone at the row before, for probes that see nothing else.
    gone: Option<Gone>,
    course: Course,
    /// Whether this process writes the results.
    writes: bool,
    /// What rows have before the values of probes.
    columns: HistoryColumns,
}

impl Recorder {
    /// Starts recording, or goes on where `resumed` stood.
    ///
    /// - `folder`, `results`: where this process writes its history, and where the frames of all go
    /// - `writes`: whether this process writes the results; else its rows go to a history of its own, and of frames it writes
    ///   no more than its pieces
    pub(crate) fn open(
        case: Arc<Case>,
        scene: &Scene,
        probes: Vec<Option<Box<dyn Probe>>>,
        ppv: Vec<PpvStations>,
        grid: GridLayout,
        ([folder, results], course, writes): ([&Path; 2], Course, bool),
        resumed: Option<RecordState>,
    ) -> Result<Self, Failure> {
        let before_probes = no_probes(&case, scene, course);
        let columns = columns(&case, scene, course);
        let path = folder.join("history.csv");
        let (history, state) = match resumed {
            Some(state) if writes => (History::resume(&path, &columns, state.history)?, state),
            Some(state) => (History::create(&path, &columns)?, state),
            None => {
                let series = vec![Vec::new(); case.probes.len()];
                let peaks = ppv.iter().map(|of| vec![PeakVelocity::default(); of.stations.len()]).collect();
                (History::create(&path, &columns)?, RecordState { series, peaks, ..RecordState::default() })
            }
        };
        let elements = |body: usize| vec![false; scene.solid.alive(body).len()];
        let mut noted: Vec<Vec<bool>> = (0..scene.solid.body_count()).map(elements).collect();
        state.removed.iter().for_each(|&(body, element, _)| noted[body as usize][element as usize] = true);
        fractum_output::atomic::create_folder(&results.join("fields"))?;
        Ok(Recorder {
            case,
            probes,
            ppv,
            results: results.to_owned(),
            history,
            writer: FrameWriter::default(),
            grid,
            state,
            noted,
            inputs: Vec::new(),
            fetches: Vec::new(),
            gone: None,
            course,
            writes,
            columns: before_probes,
        })
    }

    /// The probes of a further stage, whose supports are others.
    pub(crate) fn set_probes(&mut self, probes: Vec<Option<Box<dyn Probe>>>) {
        (self.probes, self.gone) = (probes, None);
    }

    /// Takes over the velocities of the last step where they are the largest so far.
    pub(crate) fn watch(&mut self, scene: &Scene) {
        for (of, peaks) in self.ppv.iter().zip(&mut self.state.peaks) {
            for (station, peak) in of.stations.iter().zip(peaks) {
                station.watch(&scene.solid, &scene.clock, peak);
            }
        }
    }

    /// Nodes and particles that every process follows: stations are looked at in every step, supports in rows and frames, and some few
    /// points in rows. Finds what probes look at beside them.
    pub(crate) fn watch_points(&mut self, scene: &Scene) -> Watched {
        let (mut watched, fetches) = points_of_probes(&self.probes, scene);
        self.fetches = fetches;
        let stations =
            self.ppv.iter().flat_map(|of| &of.stations).flat_map(|station| &station.places).map(|own| own.node);
        watched.nodes.extend(stations);
        if self.case.output.fields.has(OutputField::Reaction) {
            let held =
                |held: &[u8]| (0..).zip(held).filter(|(_, held)| **held != 0).map(|(i, _)| i).collect::<Vec<u32>>();
            watched.nodes.extend(held(scene.supports().held()));
            watched.particles.extend(held(scene.bonded.supports().held()));
        }
        watched
    }

    /// Largest velocities against distance, with their laws.
    ///
    /// - `end`: when the run has ended [s]
    pub(crate) fn attenuations(&self, end: f64) -> Vec<Attenuation> {
        let station = |of: &VelocityStation, peak: &PeakVelocity, scale: f64| {
            let StationPlace { place, distance, .. } = of.places[peak.place as usize];
            let (velocity, time) = (peak.velocity, peak.time);
            Station { place: place.into(), distance, scaled_distance: distance / scale, velocity, time }
        };
        let table = |(of, peaks): (&PpvStations, &Vec<PeakVelocity>)| {
            let stations = of.stations.iter().zip(peaks).map(|(own, peak)| station(own, peak, of.scale));
            Attenuation::new(&of.name, of.unit, stations.collect(), end)
        };
        self.ppv.iter().zip(&self.state.peaks).map(table).collect()
    }

    /// Whether a row of the history is due at `time`.
    pub(crate) fn row_is_due(&self, time: f64) -> bool {
        is_due(time, self.state.rows, self.case.output.history_every)
    }

    /// Whether a frame of the fields is due: by time in motion, by progress along the path in a run at rest.
    pub(crate) fn frame_is_due(&self, time: f64, by_time: bool) -> bool {
        if by_time {
            return is_due(time, self.state.frames, self.case.output.fields_every);
        }
        self.state.path.frame_is_due()
    }

    /// The largest overlap of a particle so far.
    pub(crate) fn largest_overlap(&self) -> Option<&LargestOverlap> {
        self.state.overlap.as_ref()
    }

    pub(crate) fn set_largest_overlap(&mut self, found: LargestOverlap) {
        self.state.overlap = Some(found);
    }

    /// Takes the largest overlap that any process has found. All processes must call it.
    pub(crate) fn join_overlaps(&mut self, ranks: &Ranks) {
        let found = ranks.gather(self.state.overlap.take()).into_iter().flatten();
        self.state.overlap = found.reduce(|most, next| if next.share > most.share { next } else { most });
    }

    /// What has been recorded.
    pub(crate) fn state(&self) -> &RecordState {
        &self.state
    }

    /// Adds a row for the instant that the last step measured.
    ///
    /// - `is_last`: whether it is the last row of the run, which measures all
    pub(crate) fn row(&mut self, scene: &mut Scene, measured: Measured, is_last: bool) -> Result<(), Failure> {
        let Measured { time, dt, in_motion } = measured;
        let counts = scene.counts();
        let instant = Instant { scene, ledger: scene.ledger(), counts: &counts, time, dt, moves: in_motion };
        let mut row = self.columns.values(&instant);
        let before = self.state.times.last().copied();
        let is_held =
            |every: f64| !is_last && before.is_some_and(|before| !is_due(time, next_index(before, every), every));
        self.state.times.push(time);
        let gone = Gone::at(scene, &counts);
        // Interfaces part without anything that leaves.
        let as_before = self.gone.replace(gone) == Some(gone) && scene.interfaces().is_empty();
        let case = Arc::clone(&self.case);
        let is_known = |index: usize, probe: &dyn Probe| match case.probes[index].every {
            Some(every) => is_held(every),
            None => as_before && probe.is_of_separation(),
        };
        let all = (0..).zip(&self.probes).filter_map(|(index, probe)| Some((index, probe.as_deref()?)));
        let due: Vec<(usize, &dyn Probe)> = all.filter(|(index, probe)| !is_known(*index, *probe)).collect();
        let of_due = || due.iter().filter_map(|(index, _)| self.fetches.get(*index));
        let contacts = of_due().any(|fetch| fetch.contacts);
        fetch_together(of_due(), scene);
        let counts = if contacts { scene.counts() } else { counts };
        let probed = ProbedScene::with_counts(scene, counts);
        for index in 0..case.probes.len() {
            let value = match (&case.probes[index].kind, &self.probes[index]) {
                (_, Some(probe)) if is_known(index, &**probe) => {
                    self.state.series[index].last().copied().unwrap_or(f64::NAN)
                }
                (_, Some(probe)) => probe.value(&probed),
                (ProbeKind::Expression(expression), None) if !expression.scalar => self.expression(expression),
                _ => continue,
            };
            self.state.series[index].push(value);
            row.push(value);
        }
        // Those that have left the domain are noted with the rest, and not counted.
        if gone.elements > self.state.removed.len() {
            self.note_removed(scene, time);
        }
        self.history.record(&row)?;
        self.state.rows = next_index(time, self.case.output.history_every);
        Ok(())
    }

    /// Notes the elements that have been removed since the row before.
    fn note_removed(&mut self, scene: &Scene, time: f64) {
        for (body, noted) in self.noted.iter_mut().enumerate() {
            for (element, (noted, alive)) in noted.iter_mut().zip(scene.solid.alive(body)).enumerate() {
                if !*alive && !std::mem::replace(noted, true) {
                    self.state.removed.push((body as u32, element as u32, time));
                }
            }
        }
    }

    /// Value of an expression of probes with what has been recorded so far.
    fn expression(&mut self, expression: &ProbeExpression) -> f64 {
        let mut inputs = std::mem::take(&mut self.inputs);
        inputs.clear();
        inputs.extend(expression.inputs.iter().map(|input| match *input {
            ProbeInput::Time => self.state.times.last().copied().unwrap_or(0.0),
            ProbeInput::Probe { probe, take } => self.taken(probe, take),
        }));
        let value = expression.value(&inputs);
        self.inputs = inputs;
        value
    }

    fn taken(&self, probe: usize, take: Take) -> f64 {
        let (times, values) = (&self.state.times, &self.state.series[probe]);
        if let ProbeKind::Expression(expression) = &self.case.probes[probe].kind
            && expression.scalar
        {
            return self.scalar(expression);
        }
        let last = || values.last().copied().unwrap_or(f64::NAN);
        match take {
            Take::Current | Take::Final => last(),
            Take::Max => values.iter().copied().fold(f64::NAN, f64::max),
            Take::Min => values.iter().copied().fold(f64::NAN, f64::min),
            Take::AbsMax => values.iter().map(|v| v.abs()).fold(f64::NAN, f64::max),
            Take::TimeOfMax => times[index_of_max(values).unwrap_or(0)],
            Take::Mean => time_mean(times, values),
            Take::Speed => speed(times, values),
            Take::At(time) => interpolate(times, values, time),
            Take::Slope(window) => slope_of_window(times, values, window),
        }
    }

    /// Value of an expression that reduces histories.
    pub(crate) fn scalar(&self, expression: &ProbeExpression) -> f64 {
        let inputs: Vec<f64> = expression
            .inputs
            .iter()
            .map(|input| match *input {
                ProbeInput::Time => self.state.times.last().copied().unwrap_or(0.0),
                ProbeInput::Probe { probe, take } => self.taken(probe, take),
            })
            .collect();
        expression.value(&inputs)
    }

    /// Begins to write a frame of the present instant; before it that of the peak, where no frame has shown it.
    pub(crate) fn frame(&mut self, scene: &Scene) -> Result<(), Failure> {
        if !self.writes && !self.shares_frames() {
            self.state.frames = next_index(scene.clock.time, self.case.output.fields_every);
            return Ok(());
        }
        let frame = self.frame_of(scene)?;
        let peak = self.state.path.unseen_peak().filter(|peak| peak.step < frame.step);
        for frame in peak.into_iter().chain([frame]) {
            self.write(frame)?;
        }
        self.state.frames = next_index(scene.clock.time, self.case.output.fields_every);
        Ok(())
    }

    /// Follows a run at rest after a step: how far it has come, and whether its load is the largest so far.
    ///
    /// - `every`: change of the load factor between frames [s]
    pub(crate) fn follow(&mut self, scene: &Scene, every: f64) -> Result<(), Failure> {
        let ledger = scene.ledger();
        let [elastic, spent] = [ledger[EnergyKind::Elastic], ledger.spent()];
        self.state.path.advance(scene.clock.time, spent, elastic, every);
        let load = self.load().map_or(Some(elastic), |(load, _)| self.state.series[load].last().copied());
        if self.state.path.is_peak(load.unwrap_or(0.0).abs()) && !self.state.path.frame_is_due() {
            let frame = self.frame_of(scene)?;
            self.state.path.keep_peak(frame);
        }
        Ok(())
    }

    /// Index and unit of the probe that measures the load.
    pub(crate) fn load(&self) -> Option<(usize, &'static str)> {
        load_of(&self.case.probes)
    }

    /// Whether processes write pieces of one frame.
    pub(crate) fn shares_frames(&self) -> bool {
        self.grid.is_cut()
    }

    fn frame_of(&self, scene: &Scene) -> Result<Frame, Failure> {
        let instant = if self.course.turns_back { scene.clock.step as f64 } else { scene.clock.time };
        Ok(Frame::of(scene, &self.grid, instant)?)
    }

    fn write(&mut self, mut frame: Frame) -> Result<(), Failure> {
        let number = if self.course.rests { self.state.path.frames() } else { self.state.frames };
        let (mut files, instant) = (Vec::new(), frame.instant);
        for (name, file) in frame.take_tables(number) {
            let path = self.results.join(&name);
            path.parent().map_or(Ok(()), fractum_output::atomic::create_folder)?;
            files.push((path, file));
        }
        for FrameEntry { population, name, file, is_listed } in frame.files(number) {
            fractum_output::atomic::create_folder(&self.results.join(population.folder()))?;
            files.push((self.results.join(&name), file));
            if is_listed {
                self.state.collection.push(instant, population.number(), population.name(), name);
            }
        }
        if self.writes {
            files.push((self.results.join("fields.pvd"), self.state.collection.pending()));
        }
        if self.course.rests {
            self.state.path.begin_frame();
        }
        Ok(self.writer.begin(files)?)
    }

    /// The error of the last frame, where it could not be written.
    pub(crate) fn check_frame(&mut self) -> Result<(), Failure> {
        Ok(self.writer.check()?)
    }

    /// Waits for the last frame.
    pub(crate) fn finish_frame(&mut self) -> Result<(), Failure> {
        Ok(self.writer.finish()?)
    }

    /// Brings the rows and the last frame to the disk; the state that a checkpoint keeps.
    pub(crate) fn sync(&mut self) -> Result<&RecordState, Failure> {
        self.finish_frame()?;
        self.state.history = self.history.sync()?;
        Ok(&self.state)
    }

    /// Gives the history its final name with other files of the end.
    pub(crate) fn finish(self, files: &mut Group) {
        self.history.finish_in(files);
    }
}

/// What the frames of a run have in common.
///
/// - `cut`: which pieces of solids and particles this process writes
pub(crate) fn frame_layout(
    scene: &Scene,
    file_order: &[u32],
    gauges: Vec<BuiltGauges>,
    case: &Case,
    cut: Cut,
) -> GridLayout {
    let material = |body: usize| {
        let name = &scene.solid.body(body).name;
        let own = case.bodies.iter().find(|of_case| of_case.name.value == *name);
        own.map_or(-1, |body| if let BodyKind::Solid(solid) = &body.kind { solid.material as i32 } else { -1 })
    };
    let materials = (0..scene.solid.body_count()).map(material).collect();
    GridLayout::new(scene, file_order, gauges, materials, case.output.fields, cut)
}
