//! Options that the packing, laboratory and calibration commands share.

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use fractum::Failure;
use fractum_case::{Choice, Dimension, parse_quantity, refuse_endless};
use fractum_output::log::Progress;
use fractum_pack::{
    ClosedSurface, Domain, PackError, PackProgress, PackSize, PackSpec, Packing, pack_and_tell, pack_certified,
    read_stl,
};

use super::mesh_file;

/// The shape to fill and the particles to fill it with.
#[derive(Args, Clone)]
pub(crate) struct ShapeArguments {
    /// A box with these edges, such as "2 mm, 2 mm, 2 mm".
    #[arg(long = "box", value_name = "X,Y,Z")]
    cuboid: Option<String>,
    /// A cylinder along x with this length and radius, such as "10 mm, 1 mm".
    #[arg(long, value_name = "LENGTH,RADIUS")]
    cylinder: Option<String>,
    /// A sphere with this radius.
    #[arg(long, value_name = "RADIUS")]
    sphere: Option<String>,
    /// A closed surface from an STL file.
    #[arg(long, value_name = "FILE")]
    stl: Option<PathBuf>,
    /// Length of one STL unit.
    #[arg(long, default_value = "1 mm", value_name = "LENGTH")]
    stl_unit: String,
    /// A closed group of a gmsh mesh: tetrahedra, or triangles that enclose a volume.
    #[arg(long, value_name = "FILE")]
    mesh: Option<PathBuf>,
    /// Name of the group; all tetrahedra without it.
    #[arg(long, value_name = "NAME", requires = "mesh")]
    group: Option<String>,
    /// Number of particles.
    #[arg(long, default_value_t = 10_000)]
    count: usize,
    /// Mean particle radius; the count follows.
    #[arg(long, value_name = "LENGTH")]
    radius: Option<String>,
    /// (R_max - R_min)/R_mean of the uniform radii.
    #[arg(long, default_value_t = 0.25)]
    dispersion: f64,
    /// Seed of the random generator.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Contacts per particle at which compaction stops.
    #[arg(long, default_value_t = 6.2)]
    contacts: f64,
    /// A packing made before; the other options on shape and particles are not used.
    #[arg(long, value_name = "FILE", conflicts_with_all = ["cuboid", "cylinder", "sphere", "stl", "mesh"])]
    packing: Option<PathBuf>,
}

/// A parser of the names that case files have for these values.
pub(crate) fn choice<T: Choice + Send + Sync>() -> impl TypedValueParser<Value = T> {
    let names = PossibleValuesParser::new(T::NAMES.iter().map(|(name, _)| *name));
    names.map(|text| T::NAMES.iter().find(|(name, _)| *name == text).unwrap_or(&T::NAMES[0]).1)
}

impl ShapeArguments {
    /// Makes the packing, or reads it.
    pub(crate) fn packing(&self) -> Result<Packing, Failure> {
        self.packing_by(pack_and_tell)
    }

    /// Makes a packing that passes its certificate where some seed gives one, or reads it.
    pub(crate) fn certified_packing(&self) -> Result<Packing, Failure> {
        self.packing_by(|spec, tell| Ok(pack_certified(spec, tell)?.0))
    }

    fn packing_by(
        &self,
        make: impl Fn(&PackSpec, &dyn Fn(PackProgress)) -> Result<Packing, PackError>,
    ) -> Result<Packing, Failure> {
        if let Some(file) = &self.packing {
            let wrong = |error| Failure::input(format!("{}: {error}", file.display()));
            return Packing::from_bytes(&read(file)?).map_err(wrong);
        }
        let size = match &self.radius {
            Some(radius) => PackSize::MeanRadius(length(radius)?),
            None => PackSize::Count(self.count),
        };
        let domain = self.domain()?;
        let spec = PackSpec { domain, size, dispersion: self.dispersion, seed: self.seed, coordination: self.contacts };
        let (progress, began) = (RefCell::new(Progress::on_stderr(false)), Instant::now());
        let made = make(&spec, &|at| progress.borrow_mut().prepare(&at.to_string(), began.elapsed()));
        progress.borrow_mut().clear();
        made.map_err(|error| Failure::input(error.to_string()))
    }

    fn domain(&self) -> Result<Domain, Failure> {
        let given = [
            self.cuboid.is_some(),
            self.cylinder.is_some(),
            self.sphere.is_some(),
            self.stl.is_some(),
            self.mesh.is_some(),
        ];
        if given.iter().filter(|&&g| g).count() > 1 {
            return Err(Failure::input("more than one shape; give one of --box, --cylinder, --sphere, --stl, --mesh"));
        }
        if let Some(text) = &self.cuboid {
            let [x, y, z] = lengths(text)?;
            return Ok(Domain::cuboid(x, y, z));
        }
        if let Some(text) = &self.cylinder {
            let [length, radius] = lengths(text)?;
            return Ok(Domain::cylinder(length, radius));
        }
        if let Some(text) = &self.sphere {
            return Ok(Domain::sphere(length(text)?));
        }
        if let Some(file) = &self.stl {
            let surface = read_stl(&read(file)?, length(&self.stl_unit)?);
            return surface
                .map(Domain::Surface)
                .map_err(|error| Failure::input(format!("{}: {error}", file.display())));
        }
        match &self.mesh {
            Some(file) => group_surface(file, self.group.as_deref()).map(Domain::Surface),
            None => {
                Err(Failure::input("no shape; give one of --box, --cylinder, --sphere, --stl, --mesh, or --packing"))
            }
        }
    }
}

/// The closed surface of a group.
fn group_surface(file: &Path, group: Option<&str>) -> Result<ClosedSurface, Failure> {
    let wrong = |what: String| Failure::input(format!("{}: {what}", file.display()));
    let mesh = mesh_file::read_one(file)?;
    if let Some(name) = group.filter(|name| mesh.group(name).is_empty()) {
        return Err(wrong(format!("no group \"{name}\"; groups here: {}", mesh.group_names().join(", "))));
    }
    fractum_prepare::group_surface(&mesh, group).map_err(|error| wrong(error.to_string()))
}

/// Reads a file.
pub(crate) fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    refuse_endless(file).map_err(|error| Failure::input(format!("{} {error}", file.display())))?;
    fs::read(file).map_err(|error| Failure::input(format!("{}: cannot read: {error}", file.display())))
}

/// Reads a length with its unit.
pub(crate) fn length(text: &str) -> Result<f64, Failure> {
    parse_quantity(text, Dimension::LENGTH).map_err(Failure::input)
}

/// Reads a pressure with its unit.
pub(crate) fn pressure(text: &str) -> Result<f64, Failure> {
    parse_quantity(text, Dimension::PRESSURE).map_err(Failure::input)
}

fn lengths<const N: usize>(text: &str) -> Result<[f64; N], Failure> {
    let values: Vec<f64> = text.split(',').map(|part| length(part.trim())).collect::<Result<_, _>>()?;
    <[f64; N]>::try_from(values)
        .map_err(|v| Failure::input(format!("\"{text}\": {} lengths; expected {N}, separated by commas", v.len())))
}
