//! From the tree of values to the [`Case`].

mod bedding;
mod bodies;
mod bonded;
mod boundary;
mod contact_pairs;
mod detonation;
mod excavation;
mod expect;
mod firing;
mod fracture;
mod gas;
mod gauges;
mod heat;
mod in_situ;
mod inlet;
mod interface;
pub(crate) mod interfaces;
mod liquid;
mod loose;
mod materials;
mod names;
mod network;
mod output;
mod parameters;
mod periodic;
mod plots;
mod ppv;
mod probes;
mod rate;
mod ratios;
mod refine;
mod rigid;
mod scatter;
mod servo;
mod sizes;
mod solver;
mod stages;
mod table_file;
mod ties;
mod time_functions;
mod verify;

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use super::expression::parse_unit;
use super::keys::{describe, remove_unknown};
use super::model::{
    Body, BodyKind, BondedShape, Case, CaseSource, FileUnit, Flows, MeshSource, PackingSource, RigidShape, SolidGroup,
    Verify, WHOLE_MESH,
};
use super::reader::{Reader, Table};
use super::scale::Scale;
use super::tree::{self, Node, Value};
use super::unit::Dimension;
use super::{Diagnostic, Diagnostics, Place, Severity, Spanned, continued};

/// The version of the case format this reads.
const VERSION: u64 = 1;

/// Largest case file or table read [bytes].
const LARGEST: u64 = 64 << 20;

/// Reads a case file with `--set` overrides: names of parameters, or dotted keys such as `solver.end` and
/// `bodies[0].damage`.
///
/// # Errors
/// Everything found wrong, with warnings, in the order of the file. Mesh groups are not checked here.
pub fn read_case(path: &Path, overrides: &[(String, String)]) -> Result<Case, Diagnostics> {
    let file = path.display().to_string();
    let place = Place { file, line: 0, column: 0, key: String::new() };
    let fail = |message: String| Diagnostics(vec![Diagnostic::error(&place, message)]);
    if path.is_dir() {
        let remedy = "name the case file in it, such as case.toml";
        return Err(Diagnostics(vec![Diagnostic::error(&place, "is a folder").expected("a case file").remedy(remedy)]));
    }
    let bytes = read_file(path).map_err(&fail)?;
    if let Some(kind) = foreign(&bytes) {
        let note = Diagnostic::error(&place, format!("is {kind}")).expected("a case file");
        let remedy = "name a mesh as mesh.file of a case; fractum new writes cases to start from";
        return Err(Diagnostics(vec![note.remedy(remedy)]));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let good = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let line = good.iter().filter(|&&byte| byte == b'\n').count() + 1;
        fail(format!("line {line} is not UTF-8 text"))
    })?;
    parse_case(&text, path, overrides)
}

/// What a file is that is given as a case by mistake, by its first bytes.
fn foreign(bytes: &[u8]) -> Option<&'static str> {
    const KINDS: [(&[u8], &str); 9] = [
        (b"$MeshFormat", "a Gmsh mesh"),
        (b"$Comments", "a Gmsh mesh"),
        (b"<?xml", "an XML file, as those of VTK"),
        (b"<VTKFile", "a VTK file"),
        (b"# vtk", "a VTK file"),
        (b"*Heading", "an Abaqus input file"),
        (b"*HEADING", "an Abaqus input file"),
        (b"solid ", "an STL surface"),
        (b"\x89HDF", "an HDF5 file"),
    ];
    KINDS.iter().find(|(start, _)| bytes.starts_with(start)).map(|(_, kind)| *kind)
}

/// Reads a case from its text. `path` stands in messages, and its folder is where other files are looked for.
///
/// # Errors
/// As [`read_case`].
pub fn parse_case(text: &str, path: &Path, overrides: &[(String, String)]) -> Result<Case, Diagnostics> {
    let file = path.display().to_string();
    let mut root = tree::parse(text, &file).map_err(|errors| sorted(errors, &file))?;
    let mut reader = Reader::new(path.parent().unwrap_or(Path::new("")).to_path_buf(), describe);
    for (name, value) in overrides {
        let node = tree::parse_override(name, value);
        if let Err(error) = override_value(&mut root, name, node) {
            reader.note(*error);
        }
    }
    reader.scale = Scale(verify::scale(&root));
    remove_unknown(&mut root, "", &mut |unknown| reader.note_unknown(unknown));

    let source = CaseSource {
        path: path.to_path_buf(),
        text: text.to_string(),
        title: String::new(),
        overrides: overrides.to_vec(),
        tables: Vec::new(),
        parameters: BTreeMap::new(),
        stage: String::new(),
        verify: Verify::default(),
        hash_but_end: continued::hash(&root),
        warnings: Vec::new(),
    };
    let mut cases = Vec::new();
    for (stage, mut tree) in stages::split(&reader, root) {
        remove_unknown(&mut tree, "", &mut |unknown| reader.note_unknown(unknown));
        reader.is_later_stage.set(!cases.is_empty());
        cases.push(case(&reader, &tree, source.clone(), stage));
    }
    let case = stages::joined(&reader, cases);
    parameters::report_unused(&reader);
    let tables = reader.tables.take();
    let diagnostics = reader.into_diagnostics();
    let wrong = diagnostics.iter().any(|diagnostic| diagnostic.severity == Severity::Error);
    let diagnostics = sorted(diagnostics, &file);
    match case {
        Some(mut case) if !wrong => {
            case.source.tables = tables;
            case.source.warnings = diagnostics.0;
            Ok(case)
        }
        _ => Err(diagnostics),
    }
}

/// Replaces a parameter, which must be there, the value at a dotted key, or a whole table by another one.
fn override_value(root: &mut Node, name: &str, node: Node) -> Result<(), Box<Diagnostic>> {
    if name.contains('.') {
        let parameter = name.strip_prefix("parameters.").unwrap_or_default();
        return if parameter.is_empty() { tree::set(root, name, node) } else { override_value(root, parameter, node) };
    }
    let declared = parameters::declared(root);
    if declared.iter().any(|known| known == name) {
        return tree::set(root, &format!("parameters.{name}"), node);
    }
    if matches!(node.value, tree::Value::Table(_)) {
        return tree::set(root, name, node);
    }
    let error = Diagnostic::error(&node.place, "is not a parameter of this case");
    Err(Box::new(match super::nearest(name, declared.iter().map(String::as_str)) {
        Some(near) => error.remedy(format!("did you mean {near}?")),
        None if declared.is_empty() => error.remedy("it declares none; keys are set by their path, such as solver.end"),
        None => error.remedy(format!("parameters here: {}", declared.join(", "))),
    }))
}

/// Errors and warnings in the order of the file, the command line first, each once; of very many the first, with a count
/// of the others.
fn sorted(mut diagnostics: Vec<Diagnostic>, file: &str) -> Diagnostics {
    let rank = |diagnostic: &Diagnostic| {
        let place = diagnostic.place.as_ref();
        place.map(|place| (place.file == file, place.line, place.column))
    };
    diagnostics.sort_by_key(rank);
    diagnostics.dedup();
    Diagnostics::of_many(diagnostics)
}

/// Reads every part, so that all mistakes are found; gives the case where none is missing.
fn case(reader: &Reader, root: &Node, source: CaseSource, stage: String) -> Option<Case> {
    let table = Table::new(reader, root, "");
    let version = table.integer("fractum").check(|version| *version == VERSION, "1, the version this program reads");
    let version = version.required();
    let title = table.text("title").or(String::new());
    let parameters = parameters::read(&table);
    let materials = materials::read(&table);
    let bodies = bodies::read(&table, &materials);
    let contact_pairs = contact_pairs::read(&table, &materials);
    let ties = ties::read(&table, bodies.as_deref());
    let interfaces = interfaces::read(&table);
    let mesh = mesh(&table, bodies.as_deref());
    let supports = boundary::supports(&table);
    let loads = boundary::loads(&table);
    let in_situ = in_situ::read(&table, bodies.as_deref());
    let excavation = excavation::read(&table);
    let damping = solver::damping(&table, bodies.as_deref(), !stage.is_empty());
    let probes = probes::read(&table);
    let solver = solver::read(&table, &probes.list, bodies.as_deref());
    if stage.is_empty() {
        solver::tell_at_rest(&table, solver.as_ref());
    }
    solver::refuse_accuracy(&table, solver.as_ref(), bodies.as_deref(), &materials);
    let gas = gas::read(&table, solver.as_ref(), !stage.is_empty());
    let heat = heat::read(&table, solver.as_ref(), !stage.is_empty());
    let liquid = liquid::read(&table);
    let periodic = periodic::read(&table);
    let plots = plots::read(&table, &probes);
    let output = output::read(&table, solver.as_ref().map(|solver| solver.end), plots);
    let expect = expect::read(&table, &probes);
    let around = verify::Around {
        root,
        materials: &materials,
        bodies: bodies.as_deref(),
        solver: solver.as_ref(),
        mesh: mesh.as_ref().and_then(Option::as_ref),
        staged: !stage.is_empty(),
    };
    let verify = verify::read(&table, &around, expect.as_deref());
    table.finish("here");
    version?;
    let source = CaseSource { parameters, stage, verify, title, ..source };
    Some(Case {
        source,
        mesh: mesh?,
        materials: materials.into_iter().map(|(_, material)| material).collect::<Option<_>>()?,
        contact_pairs: contact_pairs?,
        bodies: bodies?,
        ties: ties?,
        interfaces: interfaces?,
        supports: supports?,
        loads: loads?,
        in_situ: in_situ?,
        flows: Flows { gas: gas?, heat: heat?, liquid: liquid? },
        periodic: periodic?.map(Box::new),
        excavation: excavation?,
        damping,
        solver: solver?,
        probes: probes.list.into_iter().map(|probe| probe.probe).collect::<Option<_>>()?,
        output: output?,
        expect: expect?,
        later: Vec::new(),
    })
}

/// Files that a mesh may be in: more than Gmsh makes parts for any machine.
const MOST_PARTS: u64 = 65_536;

/// The mesh, which must be there where a body is made of it, and has no effect where none is.
fn mesh(root: &Table<'_>, bodies: Option<&[Body]>) -> Option<Option<MeshSource>> {
    let meshed = |body: &Body| match &body.kind {
        BodyKind::Solid(_) => true,
        BodyKind::Bonded(bonded) => matches!(
            &bonded.packing,
            PackingSource::Shape { shape, .. } if matches!(shape.value, BondedShape::Group(_))
        ),
        BodyKind::Rigid(rigid) => matches!(rigid.shape, RigidShape::Group { .. }),
        BodyKind::Particles(loose) => loose.group().is_some(),
    };
    let bonded = |body: &Body| matches!(body.kind, BodyKind::Bonded(_) | BodyKind::Particles(_));
    if bodies.is_none() && root.has("bodies") && !root.has("mesh") {
        return Some(None); // whether it is needed is not known
    }
    let rigid = |body: &Body| matches!(body.kind, BodyKind::Rigid(_));
    let needed = bodies.is_none_or(|bodies| bodies.iter().any(meshed) || !bodies.iter().any(bonded));
    if bodies.is_some_and(|bodies| !bodies.is_empty() && bodies.iter().all(|body| rigid(body) && !meshed(body))) {
        let place = root.place_of("bodies");
        let alone = Diagnostic::error(&place, ": all are rigid, and rigid bodies do not touch each other");
        root.reader.note(alone.expected("a solid, bonded or particles body that they meet"));
        return None;
    }
    if !needed {
        root.refuse("mesh", "where no body is made of a mesh group");
        return Some(None);
    }
    let table = root.table_or_empty("mesh");
    let file = table.text("file").spanned().required();
    let unit = file_unit(&table).unwrap_or_else(|| metres(root.reader));
    let halvings = table.integer("halvings").check(|count| *count <= 6, "0 to 6").or(0) as u32;
    let scramble = table.table("scramble").map(|table| {
        let share = table.quantity("share").check(|share| *share > 0.0 && *share <= 0.5, "above 0 and at most 0.5");
        let (share, seed) = (share.required(), table.integer("seed").or(1));
        table.finish("here");
        share.map(|share| (share, seed))
    });
    let join = join(&table, bodies);
    let parts = table
        .has("parts")
        .then(|| table.integer("parts").check(|count| (1..=MOST_PARTS).contains(count), "1 to 65536").or(1) as usize);
    let refine = refine::read(&table);
    let network = network::read(&table, unit.length);
    table.finish("here");
    let Spanned { value, place } = file?;
    let file = Spanned::new(table_path(root.reader, &value), place);
    let scramble = match scramble {
        Some(None) => return None,
        known => known.flatten(),
    };
    let whole = |body: &Body| matches!(&body.kind, BodyKind::Solid(solid) if solid.group.value == WHOLE_MESH);
    let is_one_body = bodies.is_some_and(|bodies| bodies.iter().any(whole));
    let (join, refine, network) = (join?, refine?, network?);
    Some(Some(MeshSource { file, parts, unit, is_one_body, join, halvings, scramble, refine, network }))
}

/// The solids whose coincident nodes become one: nothing where none are joined.
fn join(table: &Table<'_>, bodies: Option<&[Body]>) -> Option<Option<Spanned<Vec<SolidGroup>>>> {
    let Some(node) = table.node("join") else { return Some(None) };
    let solids = bodies.into_iter().flatten().filter_map(|body| match &body.kind {
        BodyKind::Solid(solid) => Some(SolidGroup { body: body.name.value.clone(), group: solid.group.value.clone() }),
        _ => None,
    });
    let solids: Vec<SolidGroup> = solids.collect();
    let named = match &node.value {
        Value::Flag(false) => return Some(None),
        Value::Flag(true) => return Some(Some(Spanned::new(solids, node.place.clone()))),
        Value::Array(_) => names::read(table, "join", "solid bodies")?,
        _ => {
            table
                .reader
                .note(Diagnostic::error(&node.place, node.found()).expected(super::KeyKind::AllOrNames.expected()));
            return None;
        }
    };
    if named.len() < 2 {
        let note = Diagnostic::error(&node.place, node.found());
        table.reader.note(note.expected("two bodies at least"));
        return None;
    }
    // Which bodies there are is not known.
    let Some(_) = bodies else { return Some(None) };
    let find = |name: &Spanned<String>| {
        let found = solids.iter().find(|solid| solid.body == name.value).cloned();
        if found.is_none() {
            let note = Diagnostic::error(&name.place, format!("= \"{}\" is no solid body", name.value));
            let known = solids.iter().map(|solid| solid.body.as_str());
            table.reader.note(table.reader.suggest(note, &name.value, known, "there are"));
        }
        found
    };
    let found = named.iter().map(find).collect::<Vec<_>>().into_iter().collect::<Option<Vec<_>>>()?;
    Some(Some(Spanned::new(found, node.place.clone())))
}

fn table_path(reader: &Reader, file: &str) -> std::path::PathBuf {
    reader.folder.join(file)
}

/// The size in SI of a unit that must have this dimension; `None` where absent or wrong.
fn unit(table: &Table<'_>, name: &'static str, dimension: Dimension) -> Option<f64> {
    let read = table.read(name, |node| {
        let Value::Text(text) = &node.value else {
            table.reader.note(Diagnostic::error(&node.place, node.found()).expected("a unit in quotes"));
            return None;
        };
        let unit = parse_unit(text).map_err(|error| table.reader.note_expression(node, error)).ok()?;
        if unit.dimension != dimension {
            let note =
                Diagnostic::error(&node.place, format!("{}, a unit of {}", node.found(), unit.dimension.phrase()));
            table.reader.note(note.expected(format!("a unit of {}, such as \"{dimension}\"", dimension.phrase())));
            return None;
        }
        Some(unit.size() * table.reader.scale.of(dimension))
    });
    read.given()
}

/// The unit of lengths that a body or the mesh names for its file; `None` where absent or wrong.
fn file_unit(table: &Table<'_>) -> Option<FileUnit> {
    unit(table, "unit", Dimension::LENGTH).map(|length| FileUnit { length, is_named: true })
}

/// What lengths in files are where nothing is said.
fn metres(reader: &Reader) -> FileUnit {
    FileUnit { length: reader.scale.of(Dimension::LENGTH), is_named: false }
}

/// Refuses what may never end: devices and pipes.
///
/// # Errors
/// What keeps it from being read, in words that follow its name.
pub fn refuse_endless(path: &Path) -> Result<(), String> {
    let kind = fs::metadata(path).map(|known| known.file_type());
    match kind.is_ok_and(|kind| !kind.is_file() && !kind.is_dir()) {
        true => Err("is a device or a pipe, which may never end; name a file".to_owned()),
        false => Ok(()),
    }
}

/// Contents of a file of reasonable size, or what keeps them from being read.
fn read_file(path: &Path) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    refuse_endless(path)?;
    let file = File::open(path).map_err(|error| format!("cannot be opened: {error}"))?;
    file.take(LARGEST + 1).read_to_end(&mut bytes).map_err(|error| format!("cannot be read: {error}"))?;
    if bytes.len() as u64 > LARGEST {
        return Err(format!("is larger than {} MiB", LARGEST >> 20));
    }
    Ok(bytes)
}
