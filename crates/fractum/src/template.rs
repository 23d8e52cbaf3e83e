//! Templates: a folder with a case that runs as it stands, its mesh, and a geometry from which Gmsh makes meshes of other sizes.

mod meshes;

use std::path::PathBuf;

use fractum_case::nearest;
use fractum_mesh::{Mesh, MshFormat, write_msh};
use fractum_output::atomic;

use crate::error::Failure;

/// A case to start from.
struct Template {
    name: &'static str,
    what: &'static str,
    case: &'static str,
    /// What makes the mesh; none of bodies that fractum packs.
    mesh: Option<fn() -> Mesh>,
    /// The geometry by which Gmsh makes such a mesh.
    geometry: &'static str,
    /// The study of it; empty where a single run is meant.
    study: &'static str,
}

/// A template from its folder below `templates`.
macro_rules! template {
    ($name:literal, $what:literal, case alone) => {
        Template {
            name: $name,
            what: $what,
            case: include_str!(concat!("../templates/", $name, "/case.toml")),
            mesh: None,
            geometry: "",
            study: "",
        }
    };
    ($name:literal, $what:literal, $mesh:path, study) => {
        Template {
            study: include_str!(concat!("../templates/", $name, "/study.toml")),
            ..template!($name, $what, $mesh)
        }
    };
    ($name:literal, $what:literal, $mesh:path) => {
        template!($name, $what, $mesh, as $name)
    };
    // The shape of another template.
    ($name:literal, $what:literal, $mesh:path, as $shape:literal) => {
        Template {
            mesh: Some($mesh),
            geometry: include_str!(concat!("../templates/", $shape, "/part.geo")),
            ..template!($name, $what, case alone)
        }
    };
}

const TEMPLATES: [Template; 17] = [
    template!("plate", "plate with two holes pulled apart at rest; triangles", meshes::plate),
    template!("bracket", "L-shaped bracket bent at rest until it cracks; tetrahedra", meshes::bracket),
    template!("brazilian", "disc of rock split between platens at rest; triangles", meshes::brazilian),
    template!("beam", "notched beam in three-point bending at rest; triangles", meshes::beam),
    template!(
        "aggregate",
        "notched beam of mortar with stiffer grains, bent at rest; triangles, an interface",
        meshes::aggregate
    ),
    template!("bonded-ucs", "cylinder of bonded particles crushed at rest; no mesh", case alone),
    template!("triaxial", "cylinder of bonded particles crushed under confinement in motion; no mesh", case alone),
    template!("impact", "steel ball that hits a concrete slab; tetrahedra in motion, fragments", meshes::impact),
    template!("quench", "hot ceramic plate in cold water; triangles in motion, heat", meshes::quench),
    template!("shear", "rock joint sheared under pressure at rest; triangles, an interface", meshes::shear),
    template!(
        "tile",
        "mortar tile on its edges, pressed by a stamp until it cracks; tetrahedra in motion",
        meshes::tile
    ),
    template!(
        "split-bar",
        "rock between the bars of a Hopkinson test; triangles in motion, interfaces",
        meshes::split_bar
    ),
    template!("blast", "pressure pulse in a blast hole below a free face; triangles in motion", meshes::blast),
    template!("bench", "blast hole below a free face in jointed rock; triangles in motion, interfaces", meshes::blast, as "blast"),
    template!("tunnel", "blast hole beside a tunnel in stressed rock; triangles in motion", meshes::tunnel),
    template!("hopper", "loose grains that flow out of a hopper; particles, walls of facets", meshes::hopper),
    template!("study", "brittle bar with random flaws, pulled apart with twelve seeds; a study", meshes::study, study),
];

/// What a template has become.
#[derive(Debug)]
pub struct Written {
    /// What it is, in a line.
    pub what: &'static str,
    /// The case.
    pub case: PathBuf,
    /// The study of it, where that is meant to be run.
    pub study: Option<PathBuf>,
}

/// Names of the templates, each with what it is.
pub fn all() -> impl Iterator<Item = (&'static str, &'static str)> {
    TEMPLATES.iter().map(|template| (template.name, template.what))
}

/// Writes a template into a folder.
///
/// - `folder`: that of its name, if absent
/// - `overwrite`: whether files of its names that are there are replaced
///
/// # Errors
/// [`Failure::Input`] for an unknown name, and for a folder that has one of the files; [`Failure::Write`].
pub fn write(name: &str, folder: Option<PathBuf>, overwrite: bool) -> Result<Written, Failure> {
    let Some(template) = TEMPLATES.iter().find(|template| template.name == name) else {
        let names = || all().map(|(name, _)| name);
        let hint = nearest(name, names()).map_or(";".to_owned(), |near| format!("; did you mean {near}?"));
        let names: Vec<&str> = names().collect();
        return Err(Failure::input(format!("no template \"{name}\"{hint} templates: {}", names.join(", "))));
    };
    let folder = folder.unwrap_or_else(|| PathBuf::from(name));
    let mut files: Vec<(&str, Vec<u8>)> = vec![("case.toml", template.case.into())];
    if let Some(make) = template.mesh {
        let mut mesh = Vec::new();
        write_msh(&make(), MshFormat::V4_1Ascii, &mut mesh).map_err(|error| Failure::input(error.to_string()))?;
        files.extend([("part.msh", mesh), ("part.geo", template.geometry.into())]);
    }
    if !template.study.is_empty() {
        files.push(("study.toml", template.study.into()));
    }
    if let Some((file, _)) = files.iter().find(|(file, _)| !overwrite && folder.join(file).exists()) {
        let path = folder.join(file);
        return Err(Failure::input(format!("{}: exists already; name another folder", path.display())));
    }
    atomic::create_folder(&folder)?;
    for (file, bytes) in files {
        atomic::write(&folder.join(file), &bytes)?;
    }
    let study = (!template.study.is_empty()).then(|| folder.join("study.toml"));
    Ok(Written { what: template.what, case: folder.join("case.toml"), study })
}
