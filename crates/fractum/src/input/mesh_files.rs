//! The mesh of a case from its files: whole, or in parts that several processes read side by side.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use fractum_case::build::{
    SolidDivision, cannot_divide, cut_mesh, cut_network, divide, refine_bytes, refine_mesh, replicated_bodies,
};
use fractum_case::model::{MeshSource, SolidGroup, WHOLE_MESH};
use fractum_case::{Case, Diagnostic, Diagnostics, Place, Spanned, refuse_endless};
use fractum_math::Vec3;
use fractum_mesh::{Gathered, JoinError, Joint, Mesh, MeshError, WholeMesh, halved, joined, joined_bodies, scrambled};
use fractum_output::memory;
use fractum_output::number::quantity;
use fractum_output::warning::Code;
use fractum_parallel::{Exchange, gather};
use xxhash_rust::xxh3::xxh3_128;

use crate::error::Failure;
use crate::process::ranks::Processes;

/// What a process has read of the mesh of a case, in metres.
pub(crate) struct MeshFiles {
    /// That of the files that it has read; empty where the case has no mesh.
    mesh: Mesh,
    /// What is doubtful about it.
    warnings: Vec<Diagnostic>,
    /// Hashes of these files.
    hashes: Vec<u128>,
    /// Other processes have read other files.
    is_part: bool,
    /// Why every process has read all files of a mesh in parts.
    alike: Option<String>,
    processes: Processes,
}

/// The mesh of a case, and what this process has of it where several share it.
#[derive(Default)]
pub(crate) struct JoinedMesh {
    /// In metres; empty where the case has none.
    pub(crate) mesh: Mesh,
    /// Hash of its files; 0 where the case has none.
    pub(crate) hash: u128,
    /// What this process has of the solids, where none has all of them.
    pub(crate) division: Option<SolidDivision>,
    /// For the log: who has how much.
    pub(crate) notes: Vec<String>,
    /// What is doubtful about it.
    pub(crate) warnings: Vec<Diagnostic>,
}

impl MeshFiles {
    /// Reads the files of the mesh of a case that are for this process.
    ///
    /// # Errors
    /// [`Failure::Input`] for files that cannot be read; [`Failure::Memory`].
    pub(crate) fn read(case: &Case, processes: Processes) -> Result<Self, Failure> {
        let Some(source) = &case.mesh else {
            let (mesh, warnings, hashes) = Default::default();
            return Ok(MeshFiles { mesh, warnings, hashes, is_part: false, alike: None, processes });
        };
        let reason = source.parts.filter(|_| processes.all > 1).and_then(|_| cannot_divide(case));
        let is_part = source.parts.is_some() && processes.all > 1 && reason.is_none();
        let is_changed = source.scramble.is_some()
            || source.halvings > 0
            || source.join.is_some()
            || !source.refine.is_empty()
            || !source.network.is_empty();
        if is_part && is_changed {
            let remedy = "leave out mesh.parts, or write the mesh first and cut it then";
            return Err(fail(
                source,
                ": parts that several processes read are neither joined, refined, halved, scrambled nor cut by joints"
                    .to_owned(),
                remedy,
            ));
        }
        if is_part && let Some(interface) = case.interfaces.first() {
            let note = Diagnostic::error(&interface.place, "in a run of several processes");
            return Err(Failure::Input(Diagnostics(vec![note.expected("one process; threads are not limited")])));
        }
        let ReadFiles { mut mesh, hashes, warnings } =
            read_files(source, if is_part { processes } else { processes.alike() })?;
        cut_mesh(case, &mut mesh).map_err(Failure::Input)?;
        Ok(MeshFiles { mesh, warnings, hashes, is_part, alike: reason, processes })
    }

    /// Makes one mesh of what all processes have read, and gives each what it needs of the solids. All processes must call it.
    ///
    /// # Errors
    /// [`Failure::Input`] for parts that do not fit together.
    pub(crate) fn join(self, case: &Case, exchange: Option<&Arc<dyn Exchange>>) -> Result<JoinedMesh, Failure> {
        let MeshFiles { mesh, warnings, hashes, is_part, alike, processes } = self;
        let Some(source) = &case.mesh else { return Ok(JoinedMesh::default()) };
        let whole = |mesh, hashes: &[u128], alike: Option<String>| {
            let note = alike.map(|reason| format!("every process has the whole mesh, because of {reason}"));
            JoinedMesh { mesh, hash: hash(hashes), division: None, notes: note.into_iter().collect(), warnings }
        };
        let Some(exchange) = exchange.filter(|_| is_part) else { return Ok(whole(mesh, &hashes, alike)) };
        let hashes = gather(&**exchange, &hashes).concat();
        let mesh = joined_of_all(mesh, &**exchange).map_err(|error| misfit(source, &error))?;
        match divide(case, mesh, &**exchange) {
            Ok((mesh, division)) => {
                let (own, all) = (mesh.tetrahedra.len(), mesh.tetrahedron_count());
                let notes = std::iter::once(format!("this process has {own} of the {all} tetrahedra of the mesh"));
                let notes = notes.chain(replicated_bodies(case)).collect();
                Ok(JoinedMesh { mesh, hash: hash(&hashes), division: Some(division), notes, warnings: Vec::new() })
            }
            Err(reason) => Ok(whole(read_files(source, processes.alike())?.mesh, &hashes, Some(reason))),
        }
    }
}

/// Hash of the files of the mesh of a case, which are not read as a mesh; 0 where it has none.
///
/// # Errors
/// [`Failure::Input`] for a file that cannot be read.
pub(crate) fn mesh_hash(case: &Case) -> Result<u128, Failure> {
    let Some(source) = &case.mesh else { return Ok(0) };
    let hash_of = |file: PathBuf| Ok(xxh3_128(gathered(source, &file)?.bytes()));
    let hashes = source.files().into_iter().map(hash_of);
    Ok(hash(&hashes.collect::<Result<Vec<_>, Failure>>()?))
}

/// The mesh of a case in metres, joined, moved, refined, halved and with its joints and grains as the case says; interfaces are not cut yet. And what is doubtful.
///
/// # Errors
/// [`Failure::Input`] for a case without a mesh, and for what cannot be read or cut.
pub fn mesh_of_case(case: &Case) -> Result<(Mesh, Vec<Diagnostic>), Failure> {
    let Some(source) = &case.mesh else {
        return Err(Failure::input(format!("{}: this case has no mesh", case.source.path.display())));
    };
    let read = read_files(source, Processes::default())?;
    Ok((read.mesh, read.warnings))
}

/// One hash of several; that of one file is its own.
fn hash(hashes: &[u128]) -> u128 {
    match hashes {
        [one] => *one,
        all => xxh3_128(&all.iter().flat_map(|hash| hash.to_le_bytes()).collect::<Vec<u8>>()),
    }
}

/// The mesh of some files in metres, with their hashes and what is doubtful.
struct ReadFiles {
    mesh: Mesh,
    hashes: Vec<u128>,
    warnings: Vec<Diagnostic>,
}

/// Reads the files of a process among several: those that follow each other.
fn read_files(source: &MeshSource, processes: Processes) -> Result<ReadFiles, Failure> {
    let files = source.files();
    let own = processes.own(files.len());
    let (mut meshes, mut hashes) = (Vec::new(), Vec::new());
    for file in &files[own] {
        let (mesh, hash) = read_file(source, file, processes)?;
        meshes.push(mesh);
        hashes.push(hash);
    }
    let mut mesh = match source.parts {
        Some(_) => joined(&meshes).map_err(|error| misfit(source, &error))?,
        None => meshes.pop().unwrap_or_default(),
    };
    if source.unit.length != 1.0 {
        mesh.nodes.iter_mut().for_each(|node| *node *= source.unit.length);
    }
    let mut warnings = source.join.as_ref().map_or_else(Vec::new, |join| join_solids(&mut mesh, join));
    if let Some((share, seed)) = source.scramble {
        mesh = scrambled(&mesh, share, seed);
    }
    if !source.refine.is_empty() {
        let bytes = refine_bytes(&source.refine, &mesh) * processes.here as u64;
        memory::require(bytes, "refining the mesh (mesh.refine)".to_owned())?;
        warnings.extend(refine_mesh(&source.refine, &mut mesh).map_err(Failure::Input)?);
    }
    for _ in 0..source.halvings {
        let bytes = 8 * 100 * mesh.element_count() as u64 * processes.here as u64;
        memory::require(bytes, "halving the edges of the mesh".to_owned())?;
        mesh = halved(&mesh);
    }
    warnings.extend(cut_network(&source.network, &mut mesh).map_err(Failure::Input)?);
    Ok(ReadFiles { mesh, hashes, warnings })
}

/// Makes coincident nodes of solids one, and tells where.
fn join_solids(mesh: &mut Mesh, solids: &Spanned<Vec<SolidGroup>>) -> Vec<Diagnostic> {
    let groups: Vec<&str> = solids.value.iter().map(|solid| solid.group.as_str()).collect();
    let (joined, joints) = joined_bodies(mesh, &groups);
    *mesh = joined;
    let name = |body: usize| format!("\"{}\"", solids.value[body].body);
    let place = |at: Vec3| format!("({})", [at.x, at.y, at.z].map(|x| quantity(x, "m")).join(", "));
    if joints.is_empty() {
        let names: Vec<String> = (0..groups.len()).map(name).collect();
        let found = format!(": no face of {} has its nodes in the same places as one of another", names.join(", "));
        let note = Diagnostic::warning(Code::NoEffect, &solids.place, found);
        let remedy = "leave it out where the mesh has common nodes, else mesh both sides of a face alike";
        return vec![note.remedy(remedy)];
    }
    let mut warnings = Vec::new();
    for Joint { bodies: [first, second], nodes, faces, at, apart } in joints {
        let (names, sides) = (
            format!("{} and {}", name(first), name(second)),
            if mesh.tetrahedra.is_empty() { "edges" } else { "faces" },
        );
        let joined = format!("{names} joined at {nodes} nodes of {faces} {sides}, such as that at {}", place(at));
        mesh.notices.push(joined);
        if let Some((count, at)) = apart {
            let found = format!(
                ": {names} lie upon each other beside the {faces} {sides} on which they are joined, and do not conform there ({count} places, such as {})",
                place(at)
            );
            let note = Diagnostic::warning(Code::CoincidentNodes, &solids.place, found);
            warnings.push(note.remedy("mesh both sides of the whole face alike"));
        }
    }
    warnings
}

fn bytes_of(source: &MeshSource, file: &Path) -> Result<Vec<u8>, Failure> {
    refuse_endless(file).map_err(|error| fail(source, format!("= \"{}\" {error}", file.display()), ""))?;
    fs::read(file).map_err(|error| {
        let remedy = match error.kind() {
            std::io::ErrorKind::NotFound if source.parts.is_some() => {
                "mesh.parts = N needs NAME_1.msh to NAME_N.msh beside each other, as Gmsh writes with -part N -part_split"
            }
            std::io::ErrorKind::NotFound => "paths are taken from the folder of the case file",
            _ => "check the file and its permissions",
        };
        fail(source, format!("= \"{}\": cannot read the mesh: {error}", file.display()), remedy)
    })
}

fn read_file(source: &MeshSource, file: &Path, processes: Processes) -> Result<(Mesh, u128), Failure> {
    refuse_endless(file).map_err(|error| fail(source, format!("= \"{}\" {error}", file.display()), ""))?;
    // The file and the mesh that is read from it, which is about as large.
    let length = fs::metadata(file).map_or(0, |known| known.len());
    memory::require(2 * length * processes.here as u64, format!("reading {}", file.display()))?;
    let gathered = gathered(source, file)?;
    let cut = fractum_mesh::partitions(gathered.bytes());
    if let (Some(cut), Some(parts)) = (cut.filter(|_| source.parts > Some(1)), source.parts)
        && cut != parts
    {
        let found = format!("= {parts}: {} is of a mesh that was cut into {cut} parts", file.display());
        let place = Place { key: "mesh.parts".to_owned(), ..source.file.place.clone() };
        let error = Diagnostic::error(&place, found).remedy(format!("set parts = {cut}, or save all parts at once"));
        return Err(Failure::Input(Diagnostics(vec![error])));
    }
    let mut mesh = gathered.read().map_err(|error| unreadable(source, file, &error))?;
    if source.is_one_body {
        mesh.add_group_of_all(WHOLE_MESH);
    }
    Ok((mesh, xxh3_128(gathered.bytes())))
}

/// A file of the mesh with those that it names.
fn gathered(source: &MeshSource, file: &Path) -> Result<Gathered, Failure> {
    gather_mesh(file, bytes_of(source, file)?).map_err(|error| unreadable(source, file, &error))
}

/// Puts the files that a mesh file names in their places; their paths are taken from its folder.
///
/// - `bytes`: those of the file itself
///
/// # Errors
/// As [`Gathered::new`].
pub fn gather_mesh(file: &Path, bytes: Vec<u8>) -> Result<Gathered, MeshError> {
    let folder = file.parent().unwrap_or(Path::new(""));
    Gathered::new(bytes, |name| {
        let further = folder.join(name.replace('\\', "/"));
        refuse_endless(&further).map_err(|error| format!("it {error}"))?;
        fs::read(&further).map_err(|error| error.to_string())
    })
}

fn unreadable(source: &MeshSource, file: &Path, error: &MeshError) -> Failure {
    fail(source, format!(": {}: {error}", file.display()), "")
}

fn fail(source: &MeshSource, found: String, remedy: &str) -> Failure {
    Failure::Input(Diagnostics(vec![Diagnostic::error(&source.file.place, found).remedy(remedy)]))
}

fn misfit(source: &MeshSource, error: &JoinError) -> Failure {
    fail(source, format!(": {}: {error}", source.file.value.display()), "save all parts at once")
}

/// The mesh of all processes, of whose tetrahedra each keeps those that it has read.
fn joined_of_all(mut own: Mesh, exchange: &dyn Exchange) -> Result<Mesh, JoinError> {
    let nodes_of_groups: Vec<(u8, i32, usize, Vec<u32>)> = own
        .groups
        .iter()
        .map(|group| (group.dimension, group.tag, group.tetrahedra.len(), own.group_nodes_of_tetrahedra(group)))
        .collect();
    let tetrahedra = std::mem::take(&mut own.tetrahedra);
    let tags = std::mem::take(&mut own.tetrahedron_tags);
    let members: Vec<Vec<u32>> = own.groups.iter_mut().map(|group| std::mem::take(&mut group.tetrahedra)).collect();
    let counts = gather(exchange, &tetrahedra.len());
    let skeletons = gather(exchange, &own);
    let mut mesh = joined(&skeletons)?;
    let number = |skeleton: &Mesh, node: u32| {
        let found = mesh.node_tags.binary_search(&skeleton.node_tags[node as usize]);
        found.expect("the nodes of all parts") as u32
    };
    let in_mesh = |element: [u32; 4]| element.map(|node| number(&own, node));
    let mut whole = WholeMesh { tetrahedra: counts.iter().sum(), groups: vec![(0, Vec::new()); mesh.groups.len()] };
    for (skeleton, groups) in skeletons.iter().zip(gather(exchange, &nodes_of_groups)) {
        for (dimension, tag, count, nodes) in groups {
            let index = mesh.groups.iter().position(|group| (group.dimension, group.tag) == (dimension, tag));
            let known = &mut whole.groups[index.expect("the groups of all parts")];
            known.0 += count;
            known.1.extend(nodes.into_iter().map(|node| number(skeleton, node)));
        }
    }
    for (_, nodes) in &mut whole.groups {
        nodes.sort_unstable();
        nodes.dedup();
    }
    let tetrahedra = tetrahedra.into_iter().map(in_mesh).collect();
    for (group, members) in own.groups.iter().zip(members) {
        let known = mesh.groups.iter_mut().find(|known| (known.dimension, known.tag) == (group.dimension, group.tag));
        known.expect("the groups of all parts").tetrahedra = members;
    }
    let mut mesh = Mesh { tetrahedra, tetrahedron_tags: tags, whole: Some(Box::new(whole)), ..mesh };
    mesh.note_empty_groups();
    Ok(mesh)
}
