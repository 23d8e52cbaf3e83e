//! Frames: what ParaView shows of one instant, a file per population.

use fractum_fem::{CrackSurface, Solid, fields, motion, neighbours};
use fractum_math::{Mat3, Sym3};
use fractum_scene::{GaugeGrid, Scene};
use fractum_vtk::{CellBlock, CellKind, Cut, Field, PendingFile, PolyCells, PolyData, UnstructuredGrid, Values};
use serde::{Deserialize, Serialize};

use crate::OutputError;
use crate::fields::{OutputField, OutputFields};
use crate::frames::contacts;
use crate::frames::cracks;
use crate::frames::frame_file::FrameFile;
use crate::frames::gas_cells;
use crate::frames::interfaces;
use crate::frames::particles::{ParticleFiles, tensor};
use crate::frames::population::Population;
use crate::frames::rigid_surface::RigidSurfaces;
use crate::frames::xyz;
use crate::number::push_shortest;

/// Folder of the tables in the results folder.
pub const GAUGES: &str = "gauges";

const HEAD: &str = "time [s],x [m],y [m],z [m],points,ux [m],uy [m],uz [m],exx,eyy,ezz,exy,eyz,ezx\n";

/// A grid of places with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct BuiltGauges {
    /// Name of its files.
    pub name: String,
    /// The grid, with a place at least.
    pub grid: GaugeGrid,
}

/// The files of one instant, not written yet.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Frame {
    /// Where it stands in the collection: time [s], or the step of a path that may turn back.
    pub instant: f64,
    /// Steps done.
    pub step: u64,
    parts: Vec<(Population, FrameFile)>,
    /// Tables of gauges under their names, and files under theirs with folder and ending.
    tables: Vec<(String, PendingFile)>,
}

/// A file of a frame.
pub struct FrameEntry {
    /// What it shows.
    pub population: Population,
    /// Name from the results folder.
    pub name: String,
    /// Its content, not written yet.
    pub file: PendingFile,
    /// Whether the collection names it; pieces are named by the file that lists them.
    pub is_listed: bool,
}

impl Frame {
    /// The frame of the present instant: of one of several processes its pieces, of the leading one also what is not cut.
    ///
    /// - `instant`: where it stands in the collection
    pub fn of(scene: &Scene, grid: &GridLayout, instant: f64) -> Result<Self, OutputError> {
        let mut parts = Vec::new();
        if !scene.solid.reference.is_empty() {
            parts.push((Population::Solid, solid_file(scene, grid)?));
        }
        if !scene.debris.is_empty() {
            parts.push((Population::Debris, particles_file(scene, grid.cut)?));
        }
        let ParticleFiles { bonded, loose, bonds } = ParticleFiles::of(scene, grid.cut)?;
        parts.extend(bonded.map(|file| (Population::Bonded, file)));
        parts.extend(loose.map(|file| (Population::Loose, file)));
        let (mut frame, mut whole) = (Frame { instant, step: scene.clock.step, parts, tables: Vec::new() }, Vec::new());
        if !grid.cut.is_leading() {
            return Ok(frame);
        }
        whole.extend(bonds.map(|file| (Population::Bonds, file)));
        if !grid.rigid.is_empty() {
            whole.push((Population::Rigid, grid.rigid.file(scene)?));
        }
        if let Some(gas) = scene.gas().filter(|gas| gas.cells().any(|cell| cell.element().is_some())) {
            whole.push((Population::Gas, gas_cells::file(scene, gas)?));
        }
        if !scene.interfaces().is_empty() {
            whole.push((Population::Interfaces, interfaces::file(scene)?));
        }
        if grid.further.has(OutputField::Contacts) {
            whole.extend(contacts::file(scene)?.map(|file| (Population::Contacts, file)));
        }
        let crack = CrackSurface::of(&scene.solid);
        if !crack.facets.is_empty() {
            whole.push((Population::Cracks, cracks::facets_file(&scene.solid, &crack, None)?));
        }
        frame.parts.extend(whole.into_iter().map(|(population, file)| (population, FrameFile::Whole(file))));
        let table = |gauges: &BuiltGauges| (gauges.name.clone(), gauge_table(scene, &gauges.grid));
        frame.tables = grid.gauges.iter().map(table).collect();
        if grid.further.has(OutputField::Xyz) {
            frame.tables.extend(xyz::file(scene).map(|file| (xyz::FILES.to_owned(), file)));
        }
        Ok(frame)
    }

    /// Takes the tables out, as those of frame `number`: name from the results folder, and file.
    pub fn take_tables(&mut self, number: u64) -> Vec<(String, PendingFile)> {
        let tables = std::mem::take(&mut self.tables).into_iter();
        let numbered = |name: String| match name.rsplit_once('.') {
            Some((stem, ending)) => format!("{stem}-{number:05}.{ending}"),
            None => format!("{GAUGES}/{name}-{number:05}.csv"),
        };
        tables.map(|(name, file)| (numbered(name), file)).collect()
    }

    /// The files, as those of frame `number`; a file that lists pieces comes behind them.
    pub fn files(self, number: u64) -> Vec<FrameEntry> {
        let mut files = Vec::new();
        for (population, file) in self.parts {
            let (stem, folder, ending) = (population.stem(number), population.folder(), population.ending());
            let mut add = |name: String, file, is_listed| {
                files.push(FrameEntry { population, name: format!("{folder}/{name}"), file, is_listed });
            };
            match file {
                FrameFile::Whole(file) => add(format!("{stem}.{ending}"), file, true),
                FrameFile::Cut(mut pieces) => {
                    let is_leading = pieces.files.first().is_some_and(|(piece, _)| *piece == 0);
                    for (piece, file) in std::mem::take(&mut pieces.files) {
                        add(pieces.name(&stem, piece), file, false);
                    }
                    if is_leading {
                        add(format!("{stem}.p{ending}"), pieces.index(&stem), true);
                    }
                }
            }
        }
        files
    }
}

/// What stays the same in all frames: the mesh of the solids in the order of the file, the surfaces of rigid bodies, and gauges.
pub struct GridLayout {
    /// Nodes in the order of the file; where no process has all elements those of the elements that this one tells of.
    file_order: Vec<u32>,
    /// Their numbers in the order of all nodes, in that case.
    numbers: Vec<i32>,
    /// Place of each node in `file_order`.
    place: Vec<u32>,
    /// Cells of each body.
    kinds: Vec<CellKind>,
    /// Number of the material of each body in the case, from 0.
    materials: Vec<i32>,
    rigid: RigidSurfaces,
    gauges: Vec<BuiltGauges>,
    further: OutputFields,
    cut: Cut,
}

impl GridLayout {
    /// Whether frames have pieces, of which every process writes some.
    pub fn is_cut(&self) -> bool {
        self.cut.count > 1
    }

    /// What frames of this scene have in common.
    ///
    /// - `materials`: number of the material of each solid body, from 0
    /// - `further`: the fields that the case asks for
    /// - `cut`: which pieces of solids and particles this process writes
    pub fn new(
        scene: &Scene,
        file_order: &[u32],
        gauges: Vec<BuiltGauges>,
        materials: Vec<i32>,
        further: OutputFields,
        cut: Cut,
    ) -> Self {
        let solid = &scene.solid;
        let (file_order, numbers) = match neighbours::is_divided(solid) {
            true => told_nodes(solid, file_order),
            false => (file_order.to_vec(), Vec::new()),
        };
        let mut place = vec![0u32; solid.reference.len()];
        for (file, &node) in (0..).zip(&file_order) {
            place[node as usize] = file;
        }
        let kind = |body: usize| match solid.body(body).shape.node_count() {
            4 => CellKind::Tetrahedron,
            _ => CellKind::Triangle,
        };
        let kinds = (0..solid.body_count()).map(kind).collect();
        GridLayout {
            file_order,
            numbers,
            place,
            kinds,
            materials,
            rigid: RigidSurfaces::new(scene),
            gauges,
            further,
            cut,
        }
    }
}

/// Nodes of the elements that this process tells of, in the order of the file, with their numbers in that.
fn told_nodes(solid: &Solid, file_order: &[u32]) -> (Vec<u32>, Vec<i32>) {
    let mut is_owned = vec![false; file_order.len()];
    for body in 0..solid.body_count() {
        let elements = solid.body(body).elements.iter().enumerate().filter(|(e, _)| solid.owns(body, *e as u32));
        elements.flat_map(|(_, nodes)| nodes).for_each(|&node| is_owned[node as usize] = true);
    }
    let told = file_order.iter().zip(0..).filter(|(node, _)| is_owned[**node as usize]);
    told.map(|(&node, number)| (node, number)).unzip()
}

/// The elements that are left, with displacement, velocity, stress and damage.
fn solid_file(scene: &Scene, layout: &GridLayout) -> Result<FrameFile, OutputError> {
    let (solid, order) = (&scene.solid, &layout.file_order);
    let attached = scene.attached_nodes();
    let nodal = |of: &dyn Fn(usize) -> [f64; 3]| -> Vec<[f64; 3]> { order.iter().map(|&n| of(n as usize)).collect() };
    let points = nodal(&|n| solid.reference[n].into());
    let displacement = nodal(&|n| solid.displacement_from_start(n).into());
    let velocity: Vec<[f32; 3]> = order.iter().map(|&n| single(solid.velocity[n as usize].into())).collect();
    let held: Vec<u8> = order.iter().map(|&n| u8::from(attached[n as usize])).collect();
    let mut point_data = vec![
        Field::vector("displacement", &displacement),
        vector("velocity", &velocity),
        Field::flag("attached", &held),
    ];
    let wanted: Vec<Array> = layout.further.iter().flat_map(|field| of_nodes(field, scene, order)).collect();
    point_data.extend(wanted.iter().map(Array::field));
    let temperature: Option<Vec<f64>> =
        scene.heat().map(|heat| order.iter().map(|&n| heat.of_nodes()[n as usize]).collect());
    point_data.extend(temperature.as_ref().map(|temperature| Field::scalar("temperature", temperature)));
    let elements = ElementFields::of(scene, layout);
    let cells: Vec<CellBlock> = elements.cells.iter().map(|(kind, nodes)| CellBlock { kind: *kind, nodes }).collect();
    let grid = UnstructuredGrid {
        points: &points,
        cells: &cells,
        point_data: &point_data,
        cell_data: &elements.fields(),
        time: Some(scene.clock.time),
    };
    FrameFile::of_grid(&grid, layout.cut, &layout.numbers)
}

/// Values of a field that the case asks for, by points or by cells.
struct Array {
    name: &'static str,
    components: usize,
    values: Owned,
}

enum Owned {
    F32(Vec<f32>),
    I32(Vec<i32>),
}

impl Array {
    /// Numbers in single precision.
    fn new<const N: usize>(name: &'static str, values: impl Iterator<Item = [f64; N]>) -> Self {
        Array { name, components: N, values: Owned::F32(values.flatten().map(|value| value as f32).collect()) }
    }

    /// Whole numbers.
    fn integers(name: &'static str, values: impl Iterator<Item = i32>) -> Self {
        Array { name, components: 1, values: Owned::I32(values.collect()) }
    }

    fn field(&self) -> Field<'_> {
        let values = match &self.values {
            Owned::F32(values) => Values::F32(values),
            Owned::I32(values) => Values::I32(values),
        };
        Field { name: self.name, components: self.components, values }
    }
}

/// A field that the case asks for at the nodes `order`; nothing where it is one of elements.
fn of_nodes(field: OutputField, scene: &Scene, order: &[u32]) -> Vec<Array> {
    let nodes = || order.iter().map(|&node| node as usize);
    match field {
        OutputField::Principal | OutputField::Strain => Vec::new(),
        OutputField::Reaction => {
            let reactions = scene.node_reactions();
            vec![Array::new("reaction", nodes().map(|node| <[f64; 3]>::from(reactions[node])))]
        }
        OutputField::Fragment => {
            let fragments = scene.fragment_of_nodes();
            vec![Array::integers("fragment", nodes().map(|node| fragments[node]))]
        }
        OutputField::Xyz | OutputField::Contacts => Vec::new(),
    }
}

/// A field that the case asks for in the elements that are left, body after body; nothing where it is one of nodes.
///
/// - `stresses`: of these elements [Pa]
fn of_elements(field: OutputField, solid: &Solid, stresses: &[Sym3]) -> Vec<Array> {
    match field {
        OutputField::Principal => {
            let eigen: Vec<([f64; 3], Mat3)> = stresses.iter().map(|stress| stress.eigen()).collect();
            let values = Array::new("principal_stresses", eigen.iter().map(|(values, _)| *values));
            let names = ["principal_direction_1", "principal_direction_2", "principal_direction_3"];
            let direction = |(axis, name)| {
                Array::new(name, eigen.iter().map(move |(_, axes)| <[f64; 3]>::from(axes.column(axis).into_owned())))
            };
            [values].into_iter().chain((0..).zip(names).map(direction)).collect()
        }
        OutputField::Strain => {
            let strains = (0..solid.body_count()).flat_map(|body| fields::owned_strains(solid, body));
            vec![Array::new("strain", strains.map(|strain| strain.0))]
        }
        OutputField::Reaction | OutputField::Fragment => Vec::new(),
        OutputField::Xyz | OutputField::Contacts => Vec::new(),
    }
}

/// What is known of the elements that are left, body after body. Seven digits are plenty for looking at it, and halve what is
/// compressed and written.
#[derive(Default)]
struct ElementFields {
    cells: Vec<(CellKind, Vec<u32>)>,
    stress: Vec<[f32; 6]>,
    first: Vec<f32>,
    von_mises: Vec<f32>,
    damage: Vec<f32>,
    phase: Vec<f32>,
    body: Vec<i32>,
    material: Vec<i32>,
    /// Those that the case asks for.
    further: Vec<Array>,
}

impl ElementFields {
    fn of(scene: &Scene, grid: &GridLayout) -> Self {
        let solid = &scene.solid;
        let phase_field = motion::has_phase_fields(solid);
        let mut fields = ElementFields::default();
        let mut stresses = Vec::new();
        for (body, kind) in grid.kinds.iter().enumerate() {
            let (corners, nodes) = (kind.nodes(), &solid.body(body).elements);
            let mut kept = Vec::new();
            let phases = motion::element_phase(solid, body);
            for (element, (stress, damage)) in
                fields::owned_elements(solid, body).into_iter().zip(fields::owned_fields(solid, body))
            {
                let element = element as usize;
                kept.extend(nodes[element][..corners].iter().map(|&node| grid.place[node as usize]));
                fields.add_stress(stress);
                stresses.extend(grid.further.has(OutputField::Principal).then_some(stress));
                fields.damage.push(damage as f32);
                fields.phase.extend(phase_field.then(|| phases.as_ref().map_or(0.0, |phases| phases[element] as f32)));
                fields.body.push(body as i32);
                fields.material.push(grid.materials[body]);
            }
            fields.cells.push((*kind, kept));
        }
        fields.further = grid.further.iter().flat_map(|field| of_elements(field, solid, &stresses)).collect();
        fields
    }

    fn add_stress(&mut self, stress: Sym3) {
        self.stress.push(stress.0.map(|s| s as f32));
        self.von_mises.push((3.0 * stress.j2()).sqrt() as f32);
        self.first.push(stress.principal_values()[0] as f32);
    }

    fn fields(&self) -> Vec<Field<'_>> {
        let mut fields = vec![
            tensor("stress", &self.stress),
            scalar("first_principal_stress", &self.first),
            scalar("von_mises_stress", &self.von_mises),
            scalar("damage", &self.damage),
            Field::integer("body", &self.body),
            Field::integer("material", &self.material),
        ];
        fields.extend(self.further.iter().map(Array::field));
        if !self.phase.is_empty() {
            fields.push(scalar("d", &self.phase));
        }
        fields
    }
}

fn single(vector: [f64; 3]) -> [f32; 3] {
    vector.map(|component| component as f32)
}

fn scalar<'a>(name: &'a str, values: &'a [f32]) -> Field<'a> {
    Field { name, components: 1, values: Values::F32(values) }
}

fn vector<'a>(name: &'a str, values: &'a [[f32; 3]]) -> Field<'a> {
    Field { name, components: 3, values: Values::F32(values.as_flattened()) }
}

/// Discrete elements as vertices with their radius.
fn particles_file(scene: &Scene, cut: Cut) -> Result<FrameFile, OutputError> {
    let (solid, debris) = (&scene.solid, &scene.debris);
    let state = debris.state();
    let of = |f: &dyn Fn(usize) -> [f64; 3]| -> Vec<[f64; 3]> { state.nodes.iter().map(|&n| f(n as usize)).collect() };
    let points = of(&|n| solid.reference[n].into());
    let displacement = of(&|n| solid.displacement_from_start(n).into());
    let velocity = of(&|n| solid.velocity[n].into());
    let radius: Vec<f64> = state.nodes.iter().map(|&n| debris.radius(n)).collect();
    let mass: Vec<f64> = state.nodes.iter().map(|&n| solid.mass[n as usize]).collect();
    let attached: Vec<u8> = state.attached.iter().map(|&a| u8::from(a)).collect();
    let spin: Vec<[f64; 3]> = state.spin.iter().map(|&s| s.into()).collect();
    let thickness: Vec<f64> = state.nodes.iter().map(|&n| debris.thickness(n)).collect();
    let mut point_data = vec![
        Field::scalar("radius", &radius),
        Field::scalar("mass", &mass),
        Field::vector("displacement", &displacement),
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
    FrameFile::of_points(&data, cut)
}

/// The table of the present instant, a line per place.
fn gauge_table(scene: &Scene, grid: &GaugeGrid) -> PendingFile {
    let mut text = String::from(HEAD);
    for reading in grid.readings(scene) {
        push_shortest(&mut text, scene.clock.time);
        let points = [reading.points as f64];
        for value in reading.place.iter().chain(&points).chain(&reading.displacement).chain(&reading.strain) {
            text.push(',');
            push_shortest(&mut text, *value);
        }
        text.push('\n');
    }
    PendingFile::of_text(text)
}
