//! `fractum mesh info`, `fractum mesh joints`, `fractum mesh refine` and `fractum mesh convert`.

use std::path::{Path, PathBuf};

use clap::Subcommand;
use fractum::{ExitCode, Failure, mesh_of_case, say};
use fractum_case::read_case;

use super::mesh_file::{Target, read, write};
use super::mesh_info::{self, Demand};
use super::mesh_refine::{self, RefineArguments};

#[derive(Subcommand)]
pub(crate) enum MeshCommand {
    /// Count elements, list the groups, lengths of edges and quality, and say what to mend.
    Info {
        /// Gmsh (.msh, 2.2 or 4.1), Abaqus (.inp) or VTK (.vtu).
        file: PathBuf,
        /// The mesh is in so many files, PART_1.msh and so on: those of Gmsh's partitions.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
        parts: Option<u32>,
        /// Case whose materials say how short edges must be, in the unit that it gives the mesh.
        #[arg(long)]
        case: Option<PathBuf>,
    },
    /// Cut the joints and grains of a case into its mesh, say what was made of them, and write the mesh.
    Joints {
        /// Case file with mesh.joints or mesh.grains.
        case: PathBuf,
        /// File to write, in the unit m: .msh (4.1, binary) or .vtu.
        #[arg(short, long)]
        output: Option<PathBuf>,
        /// Replace a value of [parameters].
        #[arg(long = "set", value_name = "NAME=VALUE", value_parser = super::assignment)]
        set: Vec<(String, String)>,
    },
    /// Cut the elements of a zone into smaller ones, say what was made of them, and write the mesh.
    #[command(after_help = super::help::REFINE)]
    Refine(RefineArguments),
    /// Write a mesh in another format: Gmsh (.msh), or VTK for ParaView (.vtu).
    Convert {
        /// Gmsh (.msh, 2.2 or 4.1), Abaqus (.inp) or VTK (.vtu).
        file: PathBuf,
        /// File to write; its ending is the format.
        output: PathBuf,
        /// The mesh is in so many files, PART_1.msh and so on, which become one.
        #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
        parts: Option<u32>,
        /// Version and encoding of a .msh; msh41-binary if absent.
        #[arg(long, value_enum)]
        to: Option<Target>,
    },
}

/// - `json`: the information as one JSON value
pub(crate) fn execute(command: MeshCommand, json: bool) -> Result<ExitCode, Failure> {
    match command {
        MeshCommand::Info { file, parts, case } => {
            let mesh = read(&file, parts)?;
            let demand = case.map(|case| read_case(&case, &[])).transpose()?.map(|case| Demand::of(&case));
            if json {
                say!("{}", mesh_info::json(&file, &mesh, demand.as_ref()));
            } else {
                say!("{}", mesh_info::text(&file, &mesh, demand.as_ref()));
            }
        }
        MeshCommand::Joints { case, output, set } => joints(&case, output.as_deref(), &set)?,
        MeshCommand::Refine(arguments) => mesh_refine::run(&arguments)?,
        MeshCommand::Convert { file, output, parts, to } => write(|| read(&file, parts), &output, to)?,
    }
    Ok(ExitCode::Done)
}

fn joints(case: &Path, output: Option<&Path>, set: &[(String, String)]) -> Result<(), Failure> {
    let case = read_case(case, set)?;
    if case.mesh.as_ref().is_none_or(|mesh| mesh.network.is_empty()) {
        let path = case.source.path.display();
        return Err(Failure::input(format!(
            "{path}: this case has neither mesh.joints nor mesh.grains; fractum explain mesh.joints"
        )));
    }
    let (mesh, warnings) = mesh_of_case(&case)?;
    mesh.notices.iter().for_each(|notice| say!("{notice}"));
    warnings.iter().for_each(|warning| say!("{warning}"));
    let Some(output) = output else { return Ok(()) };
    write(|| Ok(mesh), output, None)
}
