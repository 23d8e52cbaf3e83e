//! What a run leaves behind: history, fields, particles, pictures of numbers over time.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use fractum_io::Compression;
use fractum_io::atomic::Written;
use fractum_io::attenuation::{Attenuation, Station};
use fractum_io::build::PpvStations;
use fractum_io::case::model::{Case, Output, ProbeExpression, ProbeInput, ProbeKind, Take};
use fractum_io::history::{Column, History};
use fractum_io::vtk::{
    CellBlock, CellKind, Collection, Field, FrameWriter, PendingFile, PolyCells, PolyData, UnstructuredGrid, Values,
};
use fractum_scene::statics::NoEquilibrium;
use fractum_scene::{EnergyKind, EnergyRole, PeakVelocity, ProbedScene, Scene, VelocityStation};
use serde::{Deserialize, Serialize};

use crate::cracks;
use crate::error::Failure;
use crate::gas_cells;
use crate::left;
use crate::record_bonded as bonds;
use crate::series::{index_of_max, interpolate, slope_of_window, speed, time_mean};

/// Columns of the history before the probes: name and unit.
fn ledger_columns(bonded: bool) -> Vec<(&'static str, &'static str)> {
    let mut columns = vec![("time", "s"), ("dt", "s")];
    columns.extend(balance().map(|kind| (kind.name(), "J")));
    columns.extend([("residual", "J"), ("removed_elements", "1"), ("particles", "1")]);
    if bonded {
        columns.extend(parts_of_bonds().map(|kind| (kind.name(), "J")));
        columns.push(("broken_bonds", "1"));
    }
    columns
}

/// Entries of the ledger that count in its balance.
fn balance() -> impl Iterator<Item = EnergyKind> {
    EnergyKind::ALL.into_iter().filter(|kind| kind.sign() != 0)
}

fn parts_of_bonds() -> impl Iterator<Item = EnergyKind> {
    EnergyKind::ALL.into_iter().filter(|kind| kind.role() == EnergyRole::PartOfBonds)
}

/// Further column where equilibrium may give way to motion: 1 while the scene moves.
const IN_MOTION: (&str, &str) = ("in_motion", "1");

/// How many columns of a history, which these names begin, belong to the ledger and not to probes.
pub(crate) fn count_ledger_columns(names: &[&str]) -> usize {
    let known = ledger_columns(true);
    let count = names.iter().zip(known).take_while(|(name, (column, _))| *name == column).count();
    let count = if names.get(count) == Some(&left::COLUMNS[0].0) { count + left::COLUMNS.len() } else { count };
    count + usize::from(names.get(count) == Some(&IN_MOTION.0))
}

/// Where recording stands; part of every checkpoint.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct RecordState {
    /// Rows and frames written so far.
    rows: u64,
    frames: u64,
    history: Written,
    collection: Vec<(f64, u32, String, String)>,
    /// Time of each row [s].
    pub(crate) times: Vec<f64>,
    /// Values of each probe that is a column, row by row.
    pub(crate) series: Vec<Vec<f64>>,
    /// Largest velocities so far, table by table and station by station.
    peaks: Vec<Vec<PeakVelocity>>,
}

impl RecordState {
    /// Numbers rows and frames anew, for other times between them.
    pub(crate) fn count_anew(&mut self, output: &Output) {
        let next = |last: Option<f64>, every: f64| last.map_or(0, |time| next_index(time, every));
        self.rows = next(self.times.last().copied(), output.history_every);
        self.frames = next(self.collection.last().map(|entry| entry.0), output.fields_every);
    }
}

/// Writes the results of a run while it goes.
pub(crate) struct Recorder {
    case: Arc<Case>,
    probes: Vec<Option<fractum_scene::Probe>>,
    ppv: Vec<PpvStations>,
    folder: PathBuf,
    history: History,
    collection: Collection,
    writer: FrameWriter,
    state: RecordState,
    grid: GridLayout,
    inputs: Vec<f64>,
    /// Whether rows tell rest from motion.
    tells_motion: bool,
}

/// The mesh of the solids as VTK wants it, in the order of the file.
struct GridLayout {
    file_order: Vec<u32>,
    /// Connectivity of each body in the order of `file_order`.
    bodies: Vec<(CellKind, Vec<u32>)>,
}

impl GridLayout {
    fn new(scene: &Scene, file_order: &[u32]) -> Self {
        let mut place = vec![0u32; file_order.len()];
        for (file, &node) in (0..).zip(file_order) {
            place[node as usize] = file;
        }
        let bodies = (0..scene.solid.body_count())
            .map(|body| {
                let body = scene.solid.body(body);
                let corners = body.shape.node_count();
                let kind = if corners == 4 { CellKind::Tetrahedron } else { CellKind::Triangle };
                let nodes = body.elements.iter().flat_map(|e| &e[..corners]).map(|&n| place[n as usize]).collect();
                (kind, nodes)
            })
            .collect();
        GridLayout { file_order: file_order.to_vec(), bodies }
    }
}

impl Recorder {
    /// Starts recording, or goes on where `resumed` stood.
    pub(crate) fn open(
        case: Arc<Case>,
        scene: &Scene,
        probes: Vec<Option<fractum_scene::Probe>>,
        ppv: Vec<PpvStations>,
        file_order: &[u32],
        folder: &Path,
        resumed: Option<RecordState>,
    ) -> Result<Self, Failure> {
        let hands_over = case.solver.statics.as_ref().is_some_and(|s| s.no_equilibrium == NoEquilibrium::Motion);
        let tells_motion = hands_over || !case.later.is_empty();
        let columns: Vec<Column> = ledger_columns(!scene.bonded.is_empty())
            .into_iter()
            .chain(scene.domain().into_iter().flat_map(|_| left::COLUMNS))
            .chain(tells_motion.then_some(IN_MOTION))
            .map(|(name, unit)| Column::new(name, unit))
            .collect();
        let of_probes = case.probes.iter().filter(|p| !p.is_scalar()).map(|p| {
            // A probe may be called like a column of the ledger: no two columns have one name.
            let taken = columns.iter().any(|column| column.name == p.name.value);
            let name = if taken { format!("probe.{}", p.name.value) } else { p.name.value.clone() };
            Column::new(name, p.unit.clone())
        });
        let columns: Vec<Column> = columns.iter().cloned().chain(of_probes).collect();
        let path = folder.join("history.csv");
        let (history, state) = match resumed {
            Some(state) => (History::resume(&path, &columns, state.history)?, state),
            None => {
                let series = vec![Vec::new(); case.probes.len()];
                let peaks = ppv.iter().map(|of| vec![PeakVelocity::default(); of.stations.len()]).collect();
                (History::create(&path, &columns)?, RecordState { series, peaks, ..RecordState::default() })
            }
        };
        let mut collection = Collection::default();
        for (time, part, name, file) in &state.collection {
            collection.push(*time, *part, name.clone(), file.clone());
        }
        fractum_io::atomic::create_folder(&folder.join("fields"))?;
        Ok(Recorder {
            case,
            probes,
            ppv,
            folder: folder.to_owned(),
            history,
            collection,
            writer: FrameWriter::default(),
            grid: GridLayout::new(scene, file_order),
            state,
            inputs: Vec::new(),
            tells_motion,
        })
    }

    /// The probes of a further stage, whose supports are others.
    pub(crate) fn set_probes(&mut self, probes: Vec<Option<fractum_scene::Probe>>) {
        self.probes = probes;
    }

    /// Takes over the velocities of the last step where they are the largest so far.
    pub(crate) fn watch(&mut self, scene: &Scene) {
        for (of, peaks) in self.ppv.iter().zip(&mut self.state.peaks) {
            for (station, peak) in of.stations.iter().zip(peaks) {
                station.watch(&scene.solid, &scene.clock, peak);
            }
        }
    }

    /// Largest velocities against distance, with their laws.
    pub(crate) fn attenuations(&self) -> Vec<Attenuation> {
        let station = |of: &VelocityStation, peak: &PeakVelocity, scale: f64| Station {
            place: of.place.into(),
            distance: of.distance,
            scaled_distance: of.distance / scale,
            velocity: peak.velocity,
            time: peak.time,
        };
        let table = |(of, peaks): (&PpvStations, &Vec<PeakVelocity>)| {
            let stations = of.stations.iter().zip(peaks).map(|(own, peak)| station(own, peak, of.scale));
            Attenuation::new(&of.name, of.unit, stations.collect())
        };
        self.ppv.iter().zip(&self.state.peaks).map(table).collect()
    }

    /// Whether a row of the history is due at `time`.
    pub(crate) fn row_is_due(&self, time: f64) -> bool {
        is_due(time, self.state.rows, self.case.output.history_every)
    }

    /// Whether a frame of the fields is due at `time`.
    pub(crate) fn frame_is_due(&self, time: f64) -> bool {
        is_due(time, self.state.frames, self.case.output.fields_every)
    }

    /// What has been recorded.
    pub(crate) fn state(&self) -> &RecordState {
        &self.state
    }

    /// Adds a row for the instant `time` that the last step measured.
    ///
    /// - `in_motion`: whether the scene moved then; written where the case may be at rest and in motion
    pub(crate) fn row(&mut self, scene: &Scene, time: f64, dt: f64, in_motion: bool) -> Result<(), Failure> {
        let ledger = scene.ledger();
        let probed = ProbedScene::new(scene);
        let counts = probed.counts();
        let mut row = vec![time, dt];
        row.extend(balance().map(|kind| ledger[kind]));
        row.extend([ledger.residual(), counts.removed_elements as f64, counts.particles as f64]);
        if !scene.bonded.is_empty() {
            row.extend(parts_of_bonds().map(|kind| ledger[kind]));
            row.push(counts.broken_bonds as f64);
        }
        row.extend(scene.domain().into_iter().flat_map(|_| left::values(scene.left())));
        row.extend(self.tells_motion.then_some(f64::from(u8::from(in_motion))));
        self.state.times.push(time);
        let case = Arc::clone(&self.case);
        for index in 0..case.probes.len() {
            let value = match (&case.probes[index].kind, &self.probes[index]) {
                (_, Some(probe)) => probe.value(&probed),
                (ProbeKind::Expression(expression), None) if !expression.scalar => self.expression(expression),
                _ => continue,
            };
            self.state.series[index].push(value);
            row.push(value);
        }
        self.history.record(&row)?;
        self.state.rows = next_index(time, self.case.output.history_every);
        Ok(())
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

    /// Begins to write the fields of the present instant, and its particles.
    pub(crate) fn frame(&mut self, scene: &Scene) -> Result<(), Failure> {
        let time = scene.clock.time;
        let mut files = Vec::new();
        if !scene.solid.reference.is_empty() {
            let name = format!("fields/solid-{:05}.vtu", self.state.frames);
            files.push(self.solid_file(scene, &self.folder.join(&name))?);
            self.add_to_collection(time, 0, "solid", name);
        }
        if !scene.debris.is_empty() {
            fractum_io::atomic::create_folder(&self.folder.join("particles"))?;
            let name = format!("particles/particles-{:05}.vtp", self.state.frames);
            files.push(particles_file(scene, &self.folder.join(&name))?);
            self.add_to_collection(time, 1, "particles", name);
        }
        if !scene.bonded.is_empty() {
            fractum_io::atomic::create_folder(&self.folder.join("particles"))?;
            fractum_io::atomic::create_folder(&self.folder.join("bonds"))?;
            let name = format!("particles/bonded-{:05}.vtp", self.state.frames);
            files.push(bonds::particles_file(scene, &self.folder.join(&name))?);
            self.add_to_collection(time, 2, "bonded particles", name);
            let name = format!("bonds/bonds-{:05}.vtp", self.state.frames);
            files.push(bonds::bonds_file(scene, &self.folder.join(&name))?);
            self.add_to_collection(time, 3, "bonds", name);
        }
        if let Some(gas) = scene.gas().filter(|gas| gas.cells().nth(gas.hole_count()).is_some()) {
            fractum_io::atomic::create_folder(&self.folder.join("gas"))?;
            let name = format!("gas/gas-{:05}.vtu", self.state.frames);
            files.push(gas_cells::file(&self.folder.join(&name), scene, gas)?);
            self.add_to_collection(time, 5, "gas", name);
        }
        let crack = scene.solid.crack_surface();
        if !crack.facets.is_empty() {
            fractum_io::atomic::create_folder(&self.folder.join("cracks"))?;
            let name = format!("cracks/cracks-{:05}.vtp", self.state.frames);
            files.push(cracks::facets_file(&self.folder.join(&name), &scene.solid, &crack)?);
            self.add_to_collection(time, 4, "cracks", name);
        }
        files.push(self.collection.pending(&self.folder.join("fields.pvd")));
        self.writer.begin(files)?;
        self.state.frames = next_index(time, self.case.output.fields_every);
        Ok(())
    }

    fn add_to_collection(&mut self, time: f64, part: u32, name: &str, file: String) {
        self.collection.push(time, part, name, file.clone());
        self.state.collection.push((time, part, name.to_owned(), file));
    }

    fn solid_file(&self, scene: &Scene, path: &Path) -> Result<PendingFile, Failure> {
        let (solid, order) = (&scene.solid, &self.grid.file_order);
        let attached = scene.attached_nodes();
        let nodal =
            |of: &dyn Fn(usize) -> [f64; 3]| -> Vec<[f64; 3]> { order.iter().map(|&n| of(n as usize)).collect() };
        let points = nodal(&|n| solid.reference[n].into());
        let displacement = nodal(&|n| solid.displacement_from_start(n).into());
        let velocity: Vec<[f32; 3]> =
            order.iter().map(|&n| solid.velocity[n as usize].map(|v| v as f32).into()).collect();
        let held: Vec<u8> = order.iter().map(|&n| u8::from(attached[n as usize])).collect();
        // Seven digits are plenty for looking at stress, and halve what is compressed and written.
        let (mut stress, mut first, mut damage): (Vec<[f32; 6]>, Vec<f32>, Vec<f32>) = Default::default();
        let (mut cells, mut bodies, mut phase) = (Vec::new(), Vec::new(), Vec::<f32>::new());
        for (body, (kind, nodes)) in self.grid.bodies.iter().enumerate() {
            let corners = kind.nodes();
            let mut kept = Vec::with_capacity(nodes.len());
            let phases = solid.element_phase(body);
            for (element, (s, d)) in solid.element_fields(body).into_iter().enumerate() {
                if solid.alive(body)[element] {
                    kept.extend_from_slice(&nodes[corners * element..corners * (element + 1)]);
                    first.push(s.principal_values()[0] as f32);
                    stress.push(s.0.map(|s| s as f32));
                    damage.push(d as f32);
                    phase.push(phases.as_ref().map_or(0.0, |phases| phases[element] as f32));
                    bodies.push(body as i32);
                }
            }
            cells.push((*kind, kept));
        }
        let cells: Vec<CellBlock> = cells.iter().map(|(kind, nodes)| CellBlock { kind: *kind, nodes }).collect();
        let mut cell_data = vec![
            Field { name: "stress", components: 6, values: Values::F32(stress.as_flattened()) },
            Field { name: "first_principal_stress", components: 1, values: Values::F32(&first) },
            Field { name: "damage", components: 1, values: Values::F32(&damage) },
            Field::integer("body", &bodies),
        ];
        if solid.has_phase_fields() {
            cell_data.push(Field { name: "d", components: 1, values: Values::F32(&phase) });
        }
        let grid = UnstructuredGrid {
            points: &points,
            cells: &cells,
            point_data: &[
                Field::vector("displacement", &displacement),
                Field { name: "velocity", components: 3, values: Values::F32(velocity.as_flattened()) },
                Field::flag("attached", &held),
            ],
            cell_data: &cell_data,
            time: Some(scene.clock.time),
        };
        grid.pending(path, Compression::Fast).map_err(|e| Failure::Output(e.into()))
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
    pub(crate) fn sync(&mut self) -> Result<RecordState, Failure> {
        self.finish_frame()?;
        self.state.history = self.history.sync()?;
        Ok(self.state.clone())
    }

    /// Gives the history its final name.
    pub(crate) fn finish(self) -> Result<RecordState, Failure> {
        self.history.finish()?;
        Ok(self.state)
    }
}

/// Particles as vertices with their radius.
fn particles_file(scene: &Scene, path: &Path) -> Result<PendingFile, Failure> {
    let (solid, debris) = (&scene.solid, &scene.debris);
    let state = debris.state();
    let of = |f: &dyn Fn(usize) -> [f64; 3]| -> Vec<[f64; 3]> { state.nodes.iter().map(|&n| f(n as usize)).collect() };
    let points = of(&|n| solid.position(n).into());
    let velocity = of(&|n| solid.velocity[n].into());
    let radius: Vec<f64> = state.nodes.iter().map(|&n| debris.radius(n)).collect();
    let mass: Vec<f64> = state.nodes.iter().map(|&n| solid.mass[n as usize]).collect();
    let attached: Vec<u8> = state.attached.iter().map(|&a| u8::from(a)).collect();
    let spin: Vec<[f64; 3]> = state.spin.iter().map(|&s| s.into()).collect();
    let thickness: Vec<f64> = state.nodes.iter().map(|&n| debris.thickness(n)).collect();
    let mut point_data = vec![
        Field::scalar("radius", &radius),
        Field::scalar("mass", &mass),
        Field::vector("velocity", &velocity),
        Field { name: "spin", components: 3, values: Values::F64(spin.as_flattened()) },
        Field::flag("attached", &attached),
    ];
    if thickness.iter().any(|&t| t > 0.0) {
        point_data.push(Field::scalar("thickness", &thickness));
    }
    let data = PolyData {
        points: &points,
        cells: PolyCells::Points,
        point_data: &point_data,
        cell_data: &[],
        time: Some(scene.clock.time),
    };
    data.pending(path, Compression::Fast).map_err(|e| Failure::Output(e.into()))
}

/// Whether output number `index` of those every `interval` is due at `time`.
fn is_due(time: f64, index: u64, interval: f64) -> bool {
    time >= interval * index as f64 * (1.0 - 1e-12)
}

/// The first output after `time`.
fn next_index(time: f64, interval: f64) -> u64 {
    (time / interval * (1.0 + 1e-12)).floor() as u64 + 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_energy_that_a_scene_can_write_is_a_column() {
        let columns = ledger_columns(true);
        assert!(EnergyKind::ALL.into_iter().all(|kind| columns.contains(&(kind.name(), "J"))), "{columns:?}");
        let names: Vec<&str> = columns.iter().map(|(name, _)| *name).chain(["load"]).collect();
        assert_eq!(count_ledger_columns(&names), columns.len());
        let unbonded = ledger_columns(false);
        let names: Vec<&str> = unbonded.iter().map(|(name, _)| *name).chain([IN_MOTION.0, "load"]).collect();
        assert_eq!(count_ledger_columns(&names), unbonded.len() + 1);
        let left = left::COLUMNS.iter().map(|(name, _)| *name);
        let names: Vec<&str> = unbonded.iter().map(|(name, _)| *name).chain(left).chain(["load"]).collect();
        assert_eq!(count_ledger_columns(&names), unbonded.len() + left::COLUMNS.len());
    }
}
