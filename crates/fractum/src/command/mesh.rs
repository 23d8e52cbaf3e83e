//! `fractum mesh info` and `fractum mesh convert`.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use clap::{Subcommand, ValueEnum};
use fractum::{ExitCode, Failure, say};
use fractum_io::case::printable;
use fractum_mesh::{Group, Mesh, MshFormat, read_msh, write_msh};
use serde_json::{Value, json};

#[derive(Subcommand)]
pub(crate) enum MeshCommand {
    /// Count elements, list the groups and judge the quality.
    Info {
        /// MSH 2.2 or 4.1, text or binary.
        file: PathBuf,
    },
    /// Write a mesh in another format.
    Convert {
        /// MSH 2.2 or 4.1, text or binary.
        file: PathBuf,
        /// File to write.
        output: PathBuf,
        /// Format of the output.
        #[arg(long, value_enum, default_value = "msh41-binary")]
        to: Target,
    },
}

#[derive(Clone, Copy, ValueEnum)]
pub(crate) enum Target {
    Msh22,
    Msh22Binary,
    Msh41,
    Msh41Binary,
}

impl From<Target> for MshFormat {
    fn from(target: Target) -> Self {
        match target {
            Target::Msh22 => MshFormat::V2_2Ascii,
            Target::Msh22Binary => MshFormat::V2_2Binary,
            Target::Msh41 => MshFormat::V4_1Ascii,
            Target::Msh41Binary => MshFormat::V4_1Binary,
        }
    }
}

/// - `json`: the information as one JSON value
pub(crate) fn execute(command: MeshCommand, json: bool) -> Result<ExitCode, Failure> {
    match command {
        MeshCommand::Info { file } if json => say!("{}", json_info(&file, &read(&file)?)),
        MeshCommand::Info { file } => info(&file, &read(&file)?),
        MeshCommand::Convert { file, output, to } => {
            let mesh = read(&file)?;
            fractum_io::atomic::write_with(&output, |out| write_msh(&mesh, to.into(), out))?;
        }
    }
    Ok(ExitCode::Done)
}

fn read(file: &Path) -> Result<Mesh, Failure> {
    let bytes =
        fs::read(file).map_err(|error| Failure::input(format!("{}: cannot read the mesh: {error}", file.display())))?;
    read_msh(&bytes).map_err(|error| Failure::input(format!("{}: {error}", file.display())))
}

/// Kinds of elements with their numbers.
fn element_counts(mesh: &Mesh) -> [(&'static str, usize); 5] {
    [
        ("points", mesh.points.len()),
        ("lines", mesh.lines.len()),
        ("triangles", mesh.triangles.len()),
        ("quadrilaterals", mesh.quads.len()),
        ("tetrahedra", mesh.tetrahedra.len()),
    ]
}

fn json_info(file: &Path, mesh: &Mesh) -> Value {
    let (low, high) = mesh.bounding_box();
    let group = |group: &Group| json!({ "name": group.name, "dimension": group.dimension, "tag": group.tag, "elements": group.element_count() });
    json!({
        "file": file.display().to_string(),
        "nodes": mesh.nodes.len(),
        "elements": BTreeMap::from(element_counts(mesh)),
        "lower": low.as_slice(),
        "upper": high.as_slice(),
        "groups": mesh.groups.iter().map(group).collect::<Vec<_>>(),
        "notices": mesh.notices,
    })
}

/// Names of groups come from the mesh: no terminal must obey them.
fn info(file: &Path, mesh: &Mesh) {
    say!("{}: {} nodes", printable(&file.display().to_string()), mesh.nodes.len());
    for (name, count) in element_counts(mesh).iter().filter(|(_, count)| *count > 0) {
        say!("  {count:>9} {name}");
    }
    let (low, high) = mesh.bounding_box();
    say!("  x {:e} .. {:e}, y {:e} .. {:e}, z {:e} .. {:e}", low.x, high.x, low.y, high.y, low.z, high.z);
    for group in &mesh.groups {
        say!(
            "  group \"{}\" (dimension {}, tag {}): {} elements",
            printable(&group.name),
            group.dimension,
            group.tag,
            group.element_count()
        );
    }
    for notice in &mesh.notices {
        say!("  {}", printable(&notice.to_string()));
    }
}
