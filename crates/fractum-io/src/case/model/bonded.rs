//! Bonded bodies: particles that fill a shape, joined by beams.

use fractum_dem::criterion::EndMoments;
use fractum_dem::{InterfaceFailure, LocalBond};
use fractum_math::Vec3;
use fractum_pack::{Arrangement, Convention, Domain};

use super::Scatter;
use crate::case::choice::choice;
use crate::case::{Field, Spanned};

/// Particles joined by bonds that are made to stand for one material.
#[derive(Debug, Clone, PartialEq)]
pub struct BondedBody {
    /// Index into `Case::materials`.
    pub material: usize,
    /// Where its particles come from.
    pub packing: PackingSource,
    /// Solid body whose elements wholly within the shape it takes the place of; it fills the region that they leave, and
    /// is tied to the rest.
    pub replaces: Option<Spanned<String>>,
    /// Law of its bonds.
    pub law: BondLawKind,
    /// Coordination of its bonds; `None` = chosen to suit Poisson's ratio. That of the material's `bonds`, where it has
    /// them.
    pub coordination: Option<Spanned<f64>>,
    /// How the coordination is counted.
    pub convention: Convention,
    /// Sets of its particles by name, each with a condition on the position.
    pub groups: Vec<(Spanned<String>, Field)>,
    /// Initial velocity [m/s] along x, y, z; `None` = at rest.
    pub initial_velocity: [Option<Field>; 3],
}

impl BondedBody {
    /// Names of the sets of its particles at the walls; unknown for a packing made before, and for mesh groups, whose walls
    /// are those of a box or a cylinder where they are one.
    pub fn wall_names(&self) -> Option<&'static [&'static str]> {
        let PackingSource::Shape { shape, .. } = &self.packing else { return None };
        Some(match shape.value {
            BondedShape::Group(_) => return None,
            _ if self.replaces.is_some() => return None,
            BondedShape::Box { .. } => Domain::BOX_WALLS,
            BondedShape::Cylinder { .. } => Domain::CYLINDER_WALLS,
            BondedShape::Sphere { .. } => Domain::SPHERE_WALLS,
            BondedShape::Stl { .. } => Domain::SURFACE_WALLS,
        })
    }
}

/// Where the particles of a bonded body come from.
#[derive(Debug, Clone, PartialEq)]
pub enum PackingSource {
    /// A packing made before.
    File(FileContent),
    /// A shape to fill.
    Shape {
        /// The shape, with its place.
        shape: Spanned<BondedShape>,
        /// How many particles, or how large.
        size: Spanned<ParticleSize>,
        /// κ = (R_max − R_min)/R_mean of the radii, 0 to 1.
        dispersion: f64,
        /// Seed of the packing.
        seed: u64,
        /// How the particles lie.
        arrangement: Arrangement,
    },
}

/// A file that the case names, with what is in it.
#[derive(Debug, Clone, PartialEq)]
pub struct FileContent {
    /// Its name as written.
    pub name: Spanned<String>,
    /// Its contents.
    pub bytes: Vec<u8>,
}

/// Shapes that particles can fill.
#[derive(Debug, Clone, PartialEq)]
pub enum BondedShape {
    /// A box with faces normal to the axes.
    Box {
        /// Lower corner [m].
        point: Vec3,
        /// Edges [m], > 0.
        size: Vec3,
    },
    /// A circular cylinder along x.
    Cylinder {
        /// Centre of its face at the lower x [m].
        point: Vec3,
        /// Length [m], > 0.
        length: f64,
        /// Radius [m], > 0.
        radius: f64,
    },
    /// A sphere.
    Sphere {
        /// Centre [m].
        point: Vec3,
        /// Radius [m], > 0.
        radius: f64,
    },
    /// A mesh group: tetrahedra, or triangles that enclose a volume.
    Group(Spanned<String>),
    /// The closed surface of an STL file.
    Stl {
        /// The file.
        file: FileContent,
        /// Length of its unit [m].
        unit: f64,
    },
}

/// How the particle size is chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ParticleSize {
    /// By the number of particles.
    Count(u64),
    /// By their mean radius [m], > 0.
    Radius(f64),
}

/// Laws of bonds.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum BondLawKind {
    /// Cohesive beams, calibrated on the packing.
    #[default]
    CohesiveBeam,
    /// Interfaces of the local constitutive law, whose numbers are those of the material.
    Local,
    /// The same, beside the mean strain of particles, which follows Hooke's law.
    LocalNonlocal,
}

choice!(BondLawKind { "cohesive-beam" => CohesiveBeam, "local" => Local, "local-nonlocal" => LocalNonlocal });

/// Interfaces between the particles of a material.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interfaces {
    /// Areas of the interfaces.
    pub area: InterfaceArea,
    /// Their law, with the elasticity of the material.
    pub law: LocalBond,
}

/// Factor α on the area π min(r)² of an interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InterfaceArea {
    /// By the number of neighbours, so that the cells of the particles fill the body (Oñate et al. 2017, eq. 25).
    Cells,
    /// 40 P/N for all, with porosity P and mean number of neighbours N.
    Porosity,
    /// Given.
    Factor(f64),
}

choice!(InterfaceFailure { "uncoupled" => Uncoupled, "coupled" => Coupled });

choice!(Arrangement { "random" => Random, "cartesian" => Cartesian, "staggered" => Staggered });

choice!(Convention { "interior" => Interior, "all" => All });

/// Beams of a material, as `fractum calibrate` writes them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bonds {
    /// Coordination they hold for.
    pub coordination: f64,
    /// How it is counted.
    pub convention: Convention,
    /// Beam radius over mean particle radius [-], > 0.
    pub radius_ratio: f64,
    /// Young's modulus of the beams [Pa], > 0.
    pub young_modulus: f64,
}

/// When the bonds of a material break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondFailure {
    /// The criterion with the strengths of the case.
    pub criterion: fractum_dem::FractureCriterion,
    /// Tensile strength of the material [Pa], > 0, to which the criterion's own strengths are found; `None` = the case gives
    /// those.
    pub tensile_strength: Option<f64>,
    /// Strength in compression as the case gives it [Pa]; `None` = the criterion has its usual one, if any.
    pub compressive_strength: Option<f64>,
    /// Weibull's scatter of the strength of particles.
    pub scatter: Option<Scatter>,
}

choice!(EndMoments { "mean" => Mean, "largest" => Largest });
