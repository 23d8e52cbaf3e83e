//! Scenes built from cases on meshes made here: what names, groups and conditions become.

mod about_axis;
mod axisymmetric;
mod bedding;
mod blast;
mod contact_force;
mod detonation;
mod doubts;
mod gas;
mod heat;
mod liquid;
mod network;
mod notches;
mod refine;
mod selection;
mod sides;
mod weibull;

use std::path::Path;

use fractum_case::build::{BuiltScene, build_scene};
use fractum_case::parse_case;
use fractum_mesh::{Mesh, MshFormat, read_msh, write_msh};

/// The scene of a case on a mesh that went through a file.
fn build(case: &str, mesh: &Mesh) -> BuiltScene {
    let case = parse_case(case, Path::new("case.toml"), &[]).unwrap_or_else(|errors| panic!("{errors}"));
    let mut bytes = Vec::new();
    write_msh(mesh, MshFormat::V4_1Binary, &mut bytes).unwrap();
    let mesh = read_msh(&bytes).unwrap();
    build_scene(&case, &mesh, Vec::new(), Vec::new()).unwrap_or_else(|errors| panic!("{errors}"))
}
