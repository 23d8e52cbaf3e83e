//! From paths to a scene.

mod memory;
mod mesh_files;

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use fractum_case::build::{BuiltScene, build_shared_scene, check_before_particles, doubts};
use fractum_case::prepare::{MadeBodies, facets, prepare_bodies};
use fractum_case::{Case, Diagnostics, read_case};
use fractum_mesh::Mesh;
use fractum_output::log::Progress;
use fractum_parallel::Exchange;
use fractum_prepare::{BondedReport, Cache};

use crate::error::Failure;
use crate::input::mesh_files::{JoinedMesh, MeshFiles};
use crate::output::columns;
use crate::output::columns::Course;
use crate::plots;
use crate::process::ranks::Processes;
use crate::solver::choice::choose;
use crate::terminal::Stream;
use memory::check_memory;
pub(crate) use mesh_files::mesh_hash;
pub use mesh_files::{gather_mesh, mesh_of_case};

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
    /// Bodies whose particles come from files, and what was read of these.
    pub reads: Vec<(String, String)>,
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
    let processes = Processes::default();
    // For who waits at a terminal; no part of what a program reads.
    let quiet = Stream::Error.width().is_none();
    read(path, overrides, None, processes)?.join(None)?.prepare(cache, processes, quiet)?.build(None)
}

/// A case with what this process has read of its mesh.
pub(crate) struct Source {
    case: Case,
    mesh: MeshFiles,
}

/// Reads a case and the files of its mesh that are for this process.
///
/// - `line`: about when the load is largest [s], where the crack runs along a line of the mesh, see [`Case::run_along_line`]
/// - `processes`: those that run it together
///
/// # Errors
/// As [`load`].
pub(crate) fn read(
    path: &Path,
    overrides: &[(String, String)],
    line: Option<f64>,
    processes: Processes,
) -> Result<Source, Failure> {
    let mut case = read_case(path, overrides)?;
    if let Some(peak) = line {
        case.run_along_line(peak);
    }
    let mesh = MeshFiles::read(&case, processes)?;
    Ok(Source { case, mesh })
}

impl Source {
    /// Makes one mesh of what was read; several processes do it together.
    ///
    /// # Errors
    /// As [`load`]; where all of them look at the same, the same on every rank.
    pub(crate) fn join(self, exchange: Option<&Arc<dyn Exchange>>) -> Result<Meshed, Failure> {
        let Source { case, mesh } = self;
        let mesh = mesh.join(&case, exchange)?;
        Ok(Meshed { case, mesh })
    }
}

/// A case with its mesh.
pub(crate) struct Meshed {
    case: Case,
    mesh: JoinedMesh,
}

impl Meshed {
    /// Checks what can be checked without the scene, and makes the bonded bodies.
    ///
    /// - `cache`: where packings and beams are kept; `quiet`: without a line that tells what is being done
    ///
    /// # Errors
    /// As [`load`].
    pub(crate) fn prepare(self, cache: &Cache, processes: Processes, quiet: bool) -> Result<Prepared, Failure> {
        let Meshed { case, mesh } = self;
        check_before_particles(&case, &mesh.mesh)?;
        plots::check(&case, &columns::possible_columns(&case))?;
        check_memory(&case, &mesh.mesh, processes)?;
        let (progress, began) = (RefCell::new(Progress::on_stderr(quiet)), Instant::now());
        let tell = |doing: &str| progress.borrow_mut().prepare(doing, began.elapsed());
        let made = prepare_bodies(&case, &mesh.mesh, cache, &tell);
        progress.borrow_mut().clear();
        let made = made?;
        Ok(Prepared { case, mesh, made })
    }
}

/// What the scene of a case is built from.
pub(crate) struct Prepared {
    case: Case,
    mesh: JoinedMesh,
    made: MadeBodies,
}

impl Prepared {
    /// Builds the scene; of several ranks that share its solids all do it together.
    ///
    /// # Errors
    /// As [`load`]; the same on every rank.
    pub(crate) fn build(self, exchange: Option<&Arc<dyn Exchange>>) -> Result<Input, Failure> {
        let Prepared { case, mesh: JoinedMesh { mesh, hash: mesh_hash, division, notes, warnings }, made } = self;
        let build = |case: &Case, prepared| {
            build_shared_scene(case, &mesh, prepared, facets(case)?, (exchange.cloned(), division.as_ref()))
        };
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
        built.warnings.extend(warnings);
        built.warnings.extend(doubts(&case, &mesh));
        built.warnings.extend(made.warnings);
        let choice = choose(&case, &mut built);
        let course = Course::of(later.iter().map(|(_, built)| built).chain([&built]));
        plots::check(&case, &columns::columns(&case, &built.scene, course))?;
        let timings = notes.into_iter().chain(made.timings).collect();
        Ok(Input { case, mesh, mesh_hash, built, later, bonded: made.reports, reads: made.reads, timings, choice })
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
