//! Bonded bodies: particles that fill a shape, joined by beams.

use fractum_dem::InterfaceFailure;
use fractum_dem::criterion::EndMoments;
use fractum_math::Vec3;
use fractum_pack::{Arrangement, Convention, Domain};
use fractum_prepare::{BondLawKind, BondStrength, Micro, ParticleSize};

use super::{FileUnit, Scatter};
use crate::choice::choice;
use crate::{Field, Spanned};

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
    /// Share by which bonds are stiffer for each of their particles that touches a wall.
    pub wall_stiffening: f64,
    /// Sets of its particles by name, each with a condition on the position.
    pub groups: Vec<(Spanned<String>, Field)>,
    /// Initial velocity [m/s] along x, y, z; `None` = at rest.
    pub initial_velocity: [Option<Spanned<Field>>; 3],
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
    /// Particles of a file.
    Particles {
        /// The file.
        file: FileContent,
        /// Unit of its lengths.
        unit: FileUnit,
        /// Its frame, from 0 on; `None` = the last one.
        frame: Option<u64>,
        /// Type of the particles that are taken; `None` = all.
        species: Option<String>,
        /// The shape that they fill; `None` = the box around them.
        shape: Option<Spanned<BondedShape>>,
        /// Gap below which two are joined [m].
        bond_gap: Option<f64>,
    },
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

choice!(BondLawKind { "cohesive-beam" => CohesiveBeam, "local" => Local, "local-nonlocal" => LocalNonlocal });

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
    /// The beams themselves.
    pub beams: Micro,
}

/// When the bonds of a material break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondFailure {
    /// The criterion and the strengths of the case.
    pub strength: BondStrength,
    /// Weibull's scatter of the strength of particles.
    pub scatter: Option<Scatter>,
}

choice!(EndMoments { "mean" => Mean, "largest" => Largest });
