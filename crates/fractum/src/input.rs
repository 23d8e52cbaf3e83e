//! From paths to a scene.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fractum_io::build::{BuiltScene, build_shared_scene, check_before_particles, doubts};
use fractum_io::case::model::MeshSource;
use fractum_io::case::{Case, Diagnostic, Diagnostics, read_case};
use fractum_io::memory;
use fractum_mesh::Mesh;
use fractum_parallel::Exchange;

use crate::columns;
use crate::course::Course;
use crate::error::Failure;
use crate::plots;
use fractum_prepare::{BondedBodies, BondedReport, Cache, Processes, check_memory, choose, facets, prepare_bodies};

/// A case with its mesh and the scene made of both.
pub struct Input {
    /// The case.
    pub case: Case,
    /// The mesh, in metres; empty where the case has none.
    pub mesh: Mesh,
    /// Hash of the mesh file; 0 where the case has none.
    pub mesh_hash: u128,
    /// The scene at t = 0.
    pub built: BuiltScene,
    /// The later stages: their case, with the scene at t = 0 that has their supports and loads.
    pub later: Vec<(Case, BuiltScene)>,
    /// What became of the bonded bodies.
    pub bonded: Vec<BondedReport>,
    /// What took how long to make ready.
    pub timings: Vec<String>,
    /// Which solver was chosen and why, where the case leaves it open.
    pub choice: Option<String>,
}

/// Reads a case and its mesh, makes its bonded bodies and builds the scene.
///
/// - `overrides`: pairs from `--set name=value`
/// - `cache`: where packings and beams are kept
///
/// # Errors
/// [`Failure::Input`] with everything that is wrong; [`Failure::Memory`].
pub fn load(path: &Path, overrides: &[(String, String)], cache: &Cache) -> Result<Input, Failure> {
    read(path, overrides, cache, Processes::default())?.build(None)
}

/// What the scene of a case is built from.
pub(crate) struct Source {
    case: Case,
    mesh: Mesh,
    mesh_hash: u128,
    made: BondedBodies,
}

/// Reads a case and its mesh and makes its bonded bodies.
///
/// - `processes`: those that run it together
///
/// # Errors
/// As [`load`].
pub(crate) fn read(
    path: &Path,
    overrides: &[(String, String)],
    cache: &Cache,
    processes: Processes,
) -> Result<Source, Failure> {
    let case = read_case(path, overrides)?;
    let (mesh, mesh_hash) = match &case.mesh {
        Some(source) => read_mesh(source, processes)?,
        None => (Mesh::default(), 0),
    };
    check_before_particles(&case, &mesh)?;
    plots::check(&case, &columns::possible_columns(&case))?;
    check_memory(&case, &mesh, processes)?;
    let made = prepare_bodies(&case, &mesh, cache)?;
    Ok(Source { case, mesh, mesh_hash, made })
}

impl Source {
    /// Builds the scene; of several ranks that share its solids all do it together.
    ///
    /// # Errors
    /// As [`load`]; the same on every rank.
    pub(crate) fn build(self, exchange: Option<&Arc<dyn Exchange>>) -> Result<Input, Failure> {
        let Source { case, mesh, mesh_hash, made } = self;
        let build = |case: &Case, prepared| build_shared_scene(case, &mesh, prepared, facets(case)?, exchange.cloned());
        let mut built = build(&case, made.prepared)?;
        let stage = |stage: &Case| Ok((stage.clone(), build(stage, Vec::new())?));
        let later = case.later.iter().map(stage).collect::<Result<Vec<_>, Diagnostics>>()?;
        for warning in later.iter().flat_map(|(_, built)| &built.warnings) {
            // What concerns the bodies is found with every stage.
            if !built.warnings.contains(warning) {
                built.warnings.push(warning.clone());
            }
        }
        built.warnings.extend(case.warnings().iter().cloned());
        built.warnings.extend(doubts(&case, &mesh));
        built.warnings.extend(made.warnings);
        let choice = choose(&case, &mut built);
        let course = Course::of(later.iter().map(|(_, built)| built).chain([&built]));
        plots::check(&case, &columns::columns(&case, &built.scene, course))?;
        Ok(Input { case, mesh, mesh_hash, built, later, bonded: made.reports, timings: made.timings, choice })
    }
}

/// The cache of packings and beams: the folder named by `FRACTUM_CACHE` (none if that is empty), else `fractum` among
/// the caches of the user.
pub fn cache_of_user() -> Cache {
    let folder = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
    if std::env::var_os("FRACTUM_CACHE").is_some() {
        return Cache::new(folder("FRACTUM_CACHE"));
    }
    let caches = folder("XDG_CACHE_HOME").or_else(|| folder("LOCALAPPDATA"));
    let caches = caches.or_else(|| folder("HOME").map(|home| home.join(".cache")));
    Cache::new(caches.map(|caches| caches.join("fractum")))
}

/// The mesh in metres, and the hash of its file.
fn read_mesh(source: &MeshSource, processes: Processes) -> Result<(Mesh, u128), Failure> {
    let file = &source.file;
    let fail = |found: String, remedy: &str| {
        Failure::Input(Diagnostics(vec![Diagnostic::error(&file.place, found).remedy(remedy)]))
    };
    // The file and the mesh that is read from it, which is about as large.
    let length = fs::metadata(&file.value).map_or(0, |known| known.len());
    memory::require(2 * length * processes.here as u64, format!("reading {}", file.value.display()))?;
    let bytes = fs::read(&file.value).map_err(|error| {
        let remedy = match error.kind() {
            std::io::ErrorKind::NotFound => "paths are taken from the folder of the case file",
            _ => "check the file and its permissions",
        };
        fail(format!("= \"{}\": cannot read the mesh: {error}", file.value.display()), remedy)
    })?;
    let mut mesh =
        fractum_mesh::read_mesh(&bytes).map_err(|error| fail(format!(": {}: {error}", file.value.display()), ""))?;
    if source.unit != 1.0 {
        mesh.nodes.iter_mut().for_each(|node| *node *= source.unit);
    }
    Ok((mesh, xxhash_rust::xxh3::xxh3_128(&bytes)))
}
