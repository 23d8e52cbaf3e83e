//! The typed case: plain data in SI units, checked as far as the file alone allows.

mod body;
mod bonded;
mod boundary;
mod contact;
mod contact_pair;
mod excavation;
mod gas;
mod gauges;
mod heat;
mod interface;
mod line;
mod liquid;
mod loose;
mod material;
mod network;
mod output;
mod periodic;
mod plot;
mod ppv;
mod probe;
mod refine;
mod rigid;
mod scatter;
mod solver;
mod tie;
mod verify;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use fractum_output::expectation::Bound;
pub use fractum_pack::Sizes;
pub use fractum_prepare::{
    Amount, BondLawKind, BondStrength, Clump, InterfaceArea, Interfaces, ParticleSize, Rate, Region, Stream, Turn,
};
use fractum_scene::EnergyKind;

pub use body::{Body, BodyKind, SolidBody};
pub use bonded::{BondFailure, BondedBody, BondedShape, Bonds, FileContent, PackingSource};
pub use boundary::{
    Components, Detonation, InCracks, InSitu, Layer, Load, LoadKind, Motion, StressField, Support, SurfaceSupport,
};
pub use contact::ContactCoefficients;
pub use contact_pair::ContactPair;
pub use excavation::Excavation;
pub use gas::{Gas, GasHole, GasLaw, Preset};
pub use gauges::Gauges;
pub use heat::{Flows, Heat, HeatCondition, HeatKind, HeatScheme, Thermal};
pub use interface::{Interface, InterfaceFaces};
pub use line::CRACK_LINE;
pub use liquid::{Liquid, LiquidDrive, LiquidHole, LiquidInjection};
pub use loose::{CloudShape, LooseBody, LooseSource};
pub use material::{Beds, Damage, Material};
pub use network::{GrainsWithin, JointSource, Joints, Network};
pub use output::Output;
pub use periodic::{BoxServo, Periodic};
pub use plot::{Plot, PlotReference, PlotScale};
pub use ppv::{Ppv, Scaling, StationLine};
pub use probe::{Probe, load_of};
pub use refine::{RefineZone, Rows};
pub use rigid::{RigidBody, RigidShape, Servo, ServoArea, ServoForce};
pub use scatter::{Distribution, Reference, Scatter, Weibull};
pub use solver::{
    AskedAccuracy, Control, InitialOverlap, ModesOptions, Opening, Solver, SolverKind, StaticOptions, StopWhen,
    TimeStep,
};
pub use tie::Tie;
pub use verify::{NEIGHBOURS, Neighbour, Promise, Saying, Verify};

pub use super::measure::{ProbeExpression, ProbeInput, ProbeKind, Take};
pub use super::selection::{GroupUse, Selection};
use super::{Diagnostic, Dimension, Spanned};

/// A case, read and checked. What needs the mesh (group names, two or three dimensions) is checked by its user, with
/// the places kept here.
#[derive(Debug, Clone, PartialEq)]
pub struct Case {
    /// The input as it was read.
    pub source: CaseSource,
    /// The mesh, where a body needs one.
    pub mesh: Option<MeshSource>,
    /// Materials, in the order of the file.
    pub materials: Vec<Material>,
    /// Pairs of materials with coefficients of contact of their own, in the order of the file.
    pub contact_pairs: Vec<ContactPair>,
    /// Bodies, in the order of the file; at least one.
    pub bodies: Vec<Body>,
    /// Ties between bonded bodies and solids, in the order of the file.
    pub ties: Vec<Tie>,
    /// Interfaces between elements, in the order of the file.
    pub interfaces: Vec<Interface>,
    /// Supports, in the order of the file.
    pub supports: Vec<Support>,
    /// Loads, in the order of the file.
    pub loads: Vec<Load>,
    /// Stress of the solids before the run.
    pub in_situ: Option<InSitu>,
    /// Gas, heat and liquid.
    pub flows: Flows,
    /// The box through whose sides particles meet.
    pub periodic: Option<Box<Periodic>>,
    /// What leaves as the stage begins, where stages take something out.
    pub excavation: Option<Excavation>,
    /// Damping of the solids.
    pub damping: Damping,
    /// Time and its steps.
    pub solver: Solver,
    /// Probes, in the order of the file; expressions read earlier ones only.
    pub probes: Vec<Probe>,
    /// What is written, and how often.
    pub output: Output,
    /// Reference values.
    pub expect: Vec<Expect>,
    /// The same case with the solver, supports and loads of each later stage.
    pub later: Vec<Case>,
}

/// The input of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct CaseSource {
    /// Path of the case file as given.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Title; empty where none was given.
    pub title: String,
    /// `--set` pairs, in order.
    pub overrides: Vec<(String, String)>,
    /// Files that it reads besides the mesh, as written there, with their contents.
    pub tables: Vec<(String, Vec<u8>)>,
    /// Values of `[parameters]` in SI, after overrides, with their units.
    pub parameters: BTreeMap<String, (f64, String)>,
    /// Name of the stage that the case is; empty where there is one only.
    pub stage: String,
    /// How `fractum verify` takes this case.
    pub verify: Verify,
    pub(super) hash_but_end: u128,
    pub(super) warnings: Vec<Diagnostic>,
}

/// Group that is all of the mesh, for a body without a `group`.
pub const WHOLE_MESH: &str = "whole mesh";

/// Unit of the lengths in a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FileUnit {
    /// Its length [m].
    pub length: f64,
    /// Whether the case names it: then nobody forgot it.
    pub is_named: bool,
}

/// Where the mesh comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct MeshSource {
    /// Path, relative paths taken from the folder of the case file.
    pub file: Spanned<PathBuf>,
    /// Number of files that hold a part of the mesh each, see [`MeshSource::files`]; none where one holds it whole.
    pub parts: Option<usize>,
    /// Unit of its coordinates.
    pub unit: FileUnit,
    /// Whether a body is all of it: it then has the group [`WHOLE_MESH`].
    pub is_one_body: bool,
    /// Solids whose coincident nodes become one, before anything else is done with the mesh.
    pub join: Option<Spanned<Vec<SolidGroup>>>,
    /// How often all edges are halved.
    pub halvings: u32,
    /// Random moves of inner nodes: share of the shortest edge [-], and seed.
    pub scramble: Option<(f64, u64)>,
    /// Where elements become smaller, before all edges are halved.
    pub refine: Vec<RefineZone>,
    /// Joints and grains, cut after that.
    pub network: Network,
}

/// A solid body by its name, with the group of its elements.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SolidGroup {
    /// Name of the body.
    pub body: String,
    /// Its group.
    pub group: String,
}

impl MeshSource {
    /// The files to read.
    pub fn files(&self) -> Vec<PathBuf> {
        let file = &self.file.value;
        self.parts.map_or_else(|| vec![file.clone()], |parts| part_files(file, parts))
    }
}

/// The files of a mesh in parts, with numbers before the ending: `rock.msh` in two parts is `rock_1.msh` and `rock_2.msh`. A single part is the file
/// itself.
pub fn part_files(file: &Path, parts: usize) -> Vec<PathBuf> {
    if parts == 1 {
        return vec![file.to_owned()];
    }
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let ending = file.extension().map_or_else(String::new, |ending| format!(".{}", ending.to_string_lossy()));
    (1..=parts).map(|part| file.with_file_name(format!("{stem}_{part}{ending}"))).collect()
}

/// Damping of solids and particles; all zero by default.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Damping {
    /// Local non-viscous damping: fraction of the unbalanced force [-], 0..1.
    pub local: f64,
    /// Mass-proportional [1/s], ≥ 0.
    pub mass: f64,
    /// Stiffness-proportional [s], ≥ 0.
    pub stiffness: f64,
    /// Linear bulk viscosity [-], ≥ 0.
    pub bulk_linear: f64,
    /// Quadratic bulk viscosity [-], ≥ 0.
    pub bulk_quadratic: f64,
    /// φ of the scheme of Tchamwa and Wielgosz on bodies of particles [-], 1..2.
    pub tchamwa_wielgosz: Option<f64>,
}

/// A reference value of the case.
#[derive(Debug, Clone, PartialEq)]
pub struct Expect {
    /// Probe name (a column of the history gives its last value), or a dotted path into `summary.json`.
    pub quantity: Spanned<String>,
    /// SI unit, as printed; `1` for a pure number.
    pub unit: String,
    /// What it should be.
    pub bound: Bound,
    /// Where the reference comes from.
    pub source: String,
    /// Remark, may be empty.
    pub note: String,
    /// What it promises of the neighbours of the case.
    pub promise: Promise,
}

/// Paths of `summary.json` that a reference value may name, besides `probes.NAME.(final|max|min|time_of_max)`.
pub fn summary_quantities() -> impl Iterator<Item = (String, Dimension)> {
    let energies = EnergyKind::ALL.into_iter().map(|kind| (format!("energy.{}", kind.name()), Dimension::ENERGY));
    energies.chain(SUMMARY_QUANTITIES.iter().map(|(path, dimension)| ((*path).to_owned(), *dimension)))
}

const SUMMARY_QUANTITIES: &[(&str, Dimension)] = &[
    ("energy.residual_max_relative", Dimension::NONE),
    ("counts.nodes", Dimension::NONE),
    ("counts.elements", Dimension::NONE),
    ("counts.removed_elements", Dimension::NONE),
    ("counts.crushed_elements", Dimension::NONE),
    ("counts.broken_edges", Dimension::NONE),
    ("counts.damaged_edges", Dimension::NONE),
    ("counts.particles", Dimension::NONE),
    ("counts.entered_particles", Dimension::NONE),
    ("counts.waiting_particles", Dimension::NONE),
    ("counts.most_waiting_particles", Dimension::NONE),
    ("counts.left_pieces", Dimension::NONE),
    ("counts.contacts", Dimension::NONE),
    ("counts.bonds", Dimension::NONE),
    ("counts.broken_bonds", Dimension::NONE),
    ("counts.fragments", Dimension::NONE),
    ("fragment_sizes.p20", Dimension::LENGTH),
    ("fragment_sizes.p50", Dimension::LENGTH),
    ("fragment_sizes.p80", Dimension::LENGTH),
    ("time.steps", Dimension::NONE),
    ("time.dt", Dimension::TIME),
    ("time.dt_min", Dimension::TIME),
    ("time.end", Dimension::TIME),
];

impl Case {
    /// The accuracy that it or one of its stages asks for; the last one where several do.
    pub fn asked_accuracy(&self) -> Option<&AskedAccuracy> {
        let stages = std::iter::once(self).chain(&self.later);
        stages.filter_map(|stage| stage.solver.accuracy.as_ref()).next_back()
    }

    /// Whether rock may be crushed in it: a pressure pulse, or gas, on a solid in motion.
    pub fn is_blast(&self) -> bool {
        let pulse =
            |load: &Load| matches!(&load.kind, LoadKind::Pressure { pressure, .. } if pressure.value.is_pulse());
        self.solver.kind == SolverKind::Explicit && (self.flows.gas.is_some() || self.loads.iter().any(pulse))
    }

    /// Whether its loose particles are plane discs.
    pub fn has_discs(&self) -> bool {
        let is_disc = |body: &Body| matches!(&body.kind, BodyKind::Particles(own) if own.thickness.is_some());
        self.bodies.iter().any(is_disc)
    }

    /// Whether a stage takes bodies out or puts some in.
    pub fn excavates(&self) -> bool {
        self.excavation.is_some()
    }

    /// Whether it is the only stage, or the first one of those that take bodies out or put some in.
    pub fn is_first_stage(&self) -> bool {
        self.excavation.is_none() || !self.later.is_empty()
    }

    /// Doubtful choices that do not keep the case from running.
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.source.warnings
    }

    /// Splits the name of a set of particles, `BODY` or `BODY.SET`, into the index of its body and the set.
    pub fn particle_group<'g>(&self, group: &'g str) -> Option<(usize, Option<&'g str>)> {
        let bonded = |name: &str| {
            let particles = |kind: &BodyKind| matches!(kind, BodyKind::Bonded(_) | BodyKind::Particles(_));
            let of = |body: &Body| body.name.value == name && particles(&body.kind);
            self.bodies.iter().position(of)
        };
        let whole = bonded(group).map(|body| (body, None));
        whole.or_else(|| {
            let (name, set) = group.split_once('.')?;
            bonded(name).map(|body| (body, Some(set)))
        })
    }

    /// Whether particles come in as time goes on.
    pub fn has_inlets(&self) -> bool {
        let has_inlet = |own: &LooseBody| matches!(own.source, LooseSource::Inlet { .. });
        self.bodies.iter().any(|body| matches!(&body.kind, BodyKind::Particles(own) if has_inlet(own)))
    }

    /// Number among the rigid bodies of the one with this name.
    pub fn tool(&self, name: &str) -> Option<usize> {
        let mut rigid = self.bodies.iter().filter(|body| matches!(body.kind, BodyKind::Rigid(_)));
        rigid.position(|body| body.name.value == name)
    }

    /// Every mesh group the case names, with its use, in the order of bodies, supports, loads, probes. Names of
    /// bodies of particles and of rigid bodies are not among them.
    pub fn groups_used(&self) -> Vec<(&Spanned<String>, GroupUse)> {
        let bodies = self.bodies.iter().filter_map(|body| match &body.kind {
            BodyKind::Solid(solid) => Some((&solid.group, GroupUse::Body)),
            BodyKind::Bonded(bonded) => match &bonded.packing {
                PackingSource::Shape { shape: Spanned { value: BondedShape::Group(group), .. }, .. } => {
                    Some((group, GroupUse::Filled))
                }
                _ => None,
            },
            BodyKind::Rigid(rigid) => match &rigid.shape {
                RigidShape::Group { group, .. } => Some((group, GroupUse::Tool)),
                _ => None,
            },
            BodyKind::Particles(loose) => loose.group().map(|group| (group, GroupUse::Filled)),
        });
        let is_body = |name: &str| self.bodies.iter().any(|body| body.name.value == name);
        let ties = self.ties.iter().map(|tie| (&tie.solid, GroupUse::Facets));
        let ties = ties.filter(move |(group, _)| !is_body(&group.value));
        let supports = self.supports.iter().filter_map(|support| support.on.group.as_ref());
        let supports = supports.map(|group| (group, GroupUse::Support));
        let loads = self.loads.iter().filter_map(|load| load.kind.on());
        let loads = loads.filter_map(|(on, group_use)| on.group.as_ref().map(|group| (group, group_use)));
        let in_situ = self.in_situ.iter().flat_map(|own| &own.groups).map(|group| (group, GroupUse::Facets));
        let Flows { gas, heat, liquid } = &self.flows;
        let injections = liquid.iter().flat_map(|liquid| &liquid.injections).filter_map(|own| own.on.group.as_ref());
        let injections = injections.map(|group| (group, GroupUse::ProbeNodes));
        let of_liquid = liquid.iter().flat_map(|liquid| &liquid.holes).map(|hole| &hole.on);
        let holes = gas.iter().flat_map(|gas| &gas.holes).map(|hole| &hole.on).chain(of_liquid);
        let holes = holes.filter_map(|on| on.group.as_ref());
        let holes = holes.map(|group| (group, GroupUse::Facets));
        let heated = heat.iter().flat_map(|heat| &heat.conditions);
        let heated = heated.filter_map(|own| Some((own.on.group.as_ref()?, own.kind.group_use())));
        let probes = self.probes.iter().filter_map(|probe| probe.kind.group());
        let stations = self.output.ppv.iter().flat_map(|ppv| ppv.groups.iter().chain([&ppv.hole]));
        let stations = stations.map(|group| (group, GroupUse::ProbeNodes));
        let gauges = self.output.gauges.iter().filter_map(|gauges| gauges.on.group.as_ref());
        let gauges = gauges.map(|group| (group, GroupUse::ProbeNodes));
        let opening = self.solver.statics.as_ref().and_then(|statics| statics.opening.as_ref());
        let openings = opening.into_iter().flat_map(|o| [&o.group, &o.against]).map(|g| (g, GroupUse::ProbeNodes));
        let of_mesh =
            |group: &&Spanned<String>| self.particle_group(&group.value).is_none() && self.tool(&group.value).is_none();
        let named = supports.chain(loads).chain(holes).chain(heated).chain(injections).chain(probes).chain(gauges);
        let named = named.filter(|(group, _)| of_mesh(group));
        bodies.chain(ties).chain(named).chain(in_situ).chain(openings).chain(stations).collect()
    }
}
