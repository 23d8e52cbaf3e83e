//! `fractum mesh info` and `fractum mesh convert`.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Subcommand, ValueEnum};
use fractum::{ExitCode, Failure, say};
use fractum_mesh::{Mesh, MshFormat, read_msh, write_msh};

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

pub(crate) fn execute(command: MeshCommand) -> Result<ExitCode, Failure> {
    match command {
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

fn info(file: &Path, mesh: &Mesh) {
    say!("{}: {} nodes", file.display(), mesh.nodes.len());
    let kinds = [
        ("points", mesh.points.len()),
        ("lines", mesh.lines.len()),
        ("triangles", mesh.triangles.len()),
        ("quadrilaterals", mesh.quads.len()),
        ("tetrahedra", mesh.tetrahedra.len()),
    ];
    for (name, count) in kinds.iter().filter(|(_, count)| *count > 0) {
        say!("  {count:>9} {name}");
    }
    let (low, high) = mesh.bounding_box();
    say!("  x {:e} .. {:e}, y {:e} .. {:e}, z {:e} .. {:e}", low.x, high.x, low.y, high.y, low.z, high.z);
    for group in &mesh.groups {
        say!(
            "  group \"{}\" (dimension {}, tag {}): {} elements",
            group.name,
            group.dimension,
            group.tag,
            group.element_count()
        );
    }
    for notice in &mesh.notices {
        say!("  {notice}");
    }
}
