//! Mesh files that commands read and write.

use std::fs;
use std::path::Path;

use clap::ValueEnum;
use fractum::{Failure, gather_mesh};
use fractum_case::model::part_files;
use fractum_case::refuse_endless;
use fractum_mesh::{Mesh, MshFormat, joined, write_msh};

use super::mesh_vtu;

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

/// Writes a mesh in the format that the ending of a file says.
pub(super) fn write(
    mesh: impl FnOnce() -> Result<Mesh, Failure>,
    output: &Path,
    to: Option<Target>,
) -> Result<(), Failure> {
    let wrong = |text: &str| Err(Failure::input(format!("{}: {text}", output.display())));
    let ending = output.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    match (ending.as_str(), to) {
        ("msh", to) => {
            let mut mesh = mesh()?;
            if matches!(to, Some(Target::Msh22 | Target::Msh22Binary)) && mesh.highest_tag() > i32::MAX as u64 {
                mesh.number();
            }
            let format = to.unwrap_or(Target::Msh41Binary).into();
            Ok(fractum_output::atomic::write_with(output, |out| write_msh(&mesh, format, out))?)
        }
        ("vtu", None) => Ok(fractum_output::atomic::write(output, &mesh_vtu::bytes(&mesh()?)?)?),
        ("vtu", Some(_)) => wrong("--to is for files that end in .msh; leave it out"),
        _ => wrong(
            "ends in neither .msh nor .vtu, the formats that are written; for others write a .msh with --to msh22, then: \
             meshio convert part.msh part.ENDING",
        ),
    }
}

/// - `parts`: how many files it is in, where that is not one
pub(super) fn read(file: &Path, parts: Option<u32>) -> Result<Mesh, Failure> {
    let Some(parts) = parts else { return read_one(file) };
    let files = part_files(file, parts as usize);
    let meshes = files.iter().map(|file| read_one(file)).collect::<Result<Vec<_>, _>>()?;
    joined(&meshes).map_err(|error| Failure::input(format!("{}: {error}", file.display())))
}

pub(super) fn read_one(file: &Path) -> Result<Mesh, Failure> {
    refuse_endless(file).map_err(|error| Failure::input(format!("{} {error}", file.display())))?;
    let bytes =
        fs::read(file).map_err(|error| Failure::input(format!("{}: cannot read the mesh: {error}", file.display())))?;
    let mesh = gather_mesh(file, bytes).and_then(|gathered| gathered.read());
    mesh.map_err(|error| Failure::input(format!("{}: {error}", file.display())))
}
