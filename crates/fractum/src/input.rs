//! From paths to a scene.

use std::fs;
use std::path::Path;

use fractum_io::assemble::{Assembly, assemble};
use fractum_io::case::{Case, Diagnostic, Diagnostics, read_case};
use fractum_mesh::{Mesh, read_msh};

use crate::error::Failure;

/// A case with its mesh and the scene made of both.
pub struct Input {
    /// The case.
    pub case: Case,
    /// The mesh, in metres.
    pub mesh: Mesh,
    /// Hash of the mesh file.
    pub mesh_hash: u128,
    /// The scene at t = 0.
    pub assembly: Assembly,
}

/// Reads a case and its mesh and builds the scene.
///
/// - `overrides`: pairs from `--set name=value`
///
/// # Errors
/// [`Failure::Input`] with everything that is wrong.
pub fn load(path: &Path, overrides: &[(String, String)]) -> Result<Input, Failure> {
    let case = read_case(path, overrides)?;
    let file = &case.mesh.file;
    let fail = |found: String, remedy: &str| {
        Failure::Input(Diagnostics(vec![Diagnostic::error(&file.place, found).remedy(remedy)]))
    };
    let bytes = fs::read(&file.value).map_err(|error| {
        let remedy = match error.kind() {
            std::io::ErrorKind::NotFound => "paths are taken from the folder of the case file",
            _ => "check the file and its permissions",
        };
        fail(format!("= \"{}\": cannot read the mesh: {error}", file.value.display()), remedy)
    })?;
    let mut mesh = read_msh(&bytes).map_err(|error| fail(format!(": {}: {error}", file.value.display()), ""))?;
    if case.mesh.unit != 1.0 {
        mesh.nodes.iter_mut().for_each(|node| *node *= case.mesh.unit);
    }
    let mesh_hash = xxhash_rust::xxh3::xxh3_128(&bytes);
    let assembly = assemble(&case, &mesh)?;
    Ok(Input { case, mesh, mesh_hash, assembly })
}
