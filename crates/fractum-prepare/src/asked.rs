//! What is asked of bodies of particles: a shape or a file, a material, and how bonds are made.

use fractum_calibrate::Micro;
use fractum_dem::{ClumpShape, FractureCriterion, LocalBond};
use fractum_math::{Rotation, Vec3};
use fractum_pack::{Arrangement, Convention, Domain, Grading, Sizes};

/// A bonded body to be made.
#[derive(Clone, Debug)]
pub struct BondedRequest<'a> {
    /// Its name, for reports.
    pub name: &'a str,
    /// Where its particles come from.
    pub packing: PackingRequest<'a>,
    /// Mesh group of the solid that it takes the place of in part.
    pub replaces: Option<&'a str>,
    /// Law of its bonds.
    pub law: BondLawKind,
    /// Coordination of its bonds; `None` = chosen to suit Poisson's ratio.
    pub coordination: Option<f64>,
    /// How the coordination is counted.
    pub convention: Convention,
    /// See [`fractum_calibrate::Sample::stiffen_walls`].
    pub wall_stiffening: f64,
    /// What it is made of.
    pub material: BondedSubstance,
    /// Whether it is broken at rest.
    pub at_rest: bool,
}

/// Where the particles of a bonded body come from.
#[derive(Clone, Debug)]
pub enum PackingRequest<'a> {
    /// The bytes of a packing made before.
    File(&'a [u8]),
    /// Particles of a file.
    Particles {
        /// The file.
        file: ParticleFile<'a>,
        /// The shape that they fill; `None` = the box around them.
        shape: Option<Shape<'a>>,
        /// Gap below which two are joined [m]; `None` = the bonds of the file, or else those of the coordination.
        bond_gap: Option<f64>,
    },
    /// A shape to fill.
    Fill {
        /// The shape.
        shape: Shape<'a>,
        /// How many particles, or how large.
        size: ParticleSize,
        /// κ = (R_max − R_min)/R_mean of the radii, 0 to 1.
        dispersion: f64,
        /// Seed of the packing.
        seed: u64,
        /// How the particles lie.
        arrangement: Arrangement,
    },
}

/// A shape to fill with particles.
#[derive(Clone, Debug)]
pub enum Shape<'a> {
    /// One that needs no file.
    Plain(Domain),
    /// A mesh group: tetrahedra, or triangles that enclose a volume.
    Group(&'a str),
    /// The closed surface of an STL file.
    Stl {
        /// Content of the file.
        bytes: &'a [u8],
        /// Length of its unit [m].
        unit: f64,
    },
}

/// What a bonded body is made of.
#[derive(Clone, Copy, Debug)]
pub struct BondedSubstance {
    /// Mass density [kg/m³], > 0.
    pub density: f64,
    /// Young's modulus [Pa], > 0.
    pub young_modulus: f64,
    /// Poisson's ratio [-], between -1 and 0.5, both excluded.
    pub poisson_ratio: f64,
    /// Beams that are given; found by calibration otherwise.
    pub beams: Option<Micro>,
    /// Interfaces that are given.
    pub interfaces: Option<Interfaces>,
    /// When bonds break; they hold otherwise.
    pub strength: Option<BondStrength>,
    /// Faces of its cracks.
    pub faces: fractum_dem::CrackFaces,
}

/// Loose particles to be made.
#[derive(Clone, Copy, Debug)]
pub struct LooseRequest<'a> {
    /// Where they come from.
    pub source: LooseFill<'a>,
    /// Mass density [kg/m³], > 0.
    pub density: f64,
    /// Young's modulus [Pa], > 0.
    pub young_modulus: f64,
    /// What each of them is, where it is no single sphere.
    pub clump: Option<&'a Clump>,
    /// Thickness of plane discs [m]; none of spheres.
    pub thickness: Option<f64>,
    /// Axes along which space repeats with the edges of the box that they fill.
    pub repeats: [bool; 3],
}

/// Rigid grains of several spheres in the place of single ones: each fills the sphere around its centre of mass whose radius is asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Clump {
    /// Its spheres.
    pub shape: ClumpShape,
    /// How the grains are turned from the frame of the shape.
    pub turn: Turn,
}

/// How grains are turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// Each by chance, of this seed.
    ByChance(u64),
    /// All of them alike.
    By(Rotation),
}

/// What is taken of a file of particles.
#[derive(Clone, Copy, Debug)]
pub struct ParticleFile<'a> {
    /// Content of the file.
    pub bytes: &'a [u8],
    /// Length of its unit [m].
    pub unit: f64,
    /// Its unit of velocity [m/s]; `None` = velocities and spins are not taken.
    pub velocity_unit: Option<f64>,
    /// Frame of a file that has several, from 0 on; `None` = the last one.
    pub frame: Option<u64>,
    /// Type, or species, of the particles that are taken; `None` = all.
    pub species: Option<&'a str>,
}

/// Where loose particles come from.
#[derive(Clone, Copy, Debug)]
pub enum LooseFill<'a> {
    /// One particle.
    Single {
        /// Its centre [m].
        centre: Vec3,
        /// Its radius [m], > 0.
        radius: f64,
    },
    /// A file of particles.
    File(ParticleFile<'a>),
    /// A cloud that fills a region loosely: no two touch.
    Cloud {
        /// The region.
        region: &'a Region,
        /// Mean radius [m], > 0.
        radius: f64,
        /// (R_max − R_min)/R_mean of the radii, 0 to 1.
        dispersion: f64,
        /// So many, more densely where that is needed; `None` = as many as there is room for.
        count: Option<u64>,
        /// Seed of radii and places.
        seed: u64,
    },
    /// A cloud of given sizes at random places: no two touch.
    Graded {
        /// The shape.
        filled: Filled<'a>,
        /// Sizes of its particles.
        grading: &'a Grading,
        /// How many.
        amount: Amount,
        /// Seed of sizes and places.
        seed: u64,
    },
    /// Particles that come into the run as time goes on.
    Stream(&'a Stream),
}

/// What a cloud of given sizes fills.
#[derive(Clone, Copy, Debug)]
pub enum Filled<'a> {
    /// A region of space.
    Region(&'a Region),
    /// A mesh group: tetrahedra, or triangles that enclose a volume.
    Group(&'a str),
    /// The closed surface of an STL file.
    Stl {
        /// Content of the file.
        bytes: &'a [u8],
        /// Length of its unit [m].
        unit: f64,
    },
}

/// Particles that come into a run as time goes on, at random places of a region.
#[derive(Clone, Debug, PartialEq)]
pub struct Stream {
    /// The region.
    pub region: Region,
    /// Their sizes.
    pub sizes: Sizes,
    /// How many come in a time.
    pub rate: Rate,
    /// When the first ones begin to come [s].
    pub from: f64,
    /// None are due later [s]; `None` where their number ends the stream.
    pub until: Option<f64>,
    /// At most so many; `None` where the time ends the stream.
    pub most: Option<u64>,
    /// Seed of sizes and places.
    pub seed: u64,
}

/// How much comes in a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rate {
    /// A mass [kg/s], > 0.
    Mass(f64),
    /// A number of particles [1/s], > 0.
    Number(f64),
}

impl Stream {
    /// Volume of particles in a time [m³/s], of a density [kg/m³].
    pub fn volume_rate(&self, density: f64) -> f64 {
        match self.rate {
            Rate::Mass(rate) => rate / density,
            Rate::Number(rate) => rate * self.sizes.mean_volume(),
        }
    }

    /// About how many particles come, of a density [kg/m³].
    pub fn count(&self, density: f64) -> f64 {
        let lasts = self.until.map_or(f64::INFINITY, |until| until - self.from);
        let of_rate = self.volume_rate(density) / self.sizes.mean_volume() * lasts;
        of_rate.min(self.most.map_or(f64::INFINITY, |most| most as f64))
    }
}

/// How much of a cloud of given sizes there is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Amount {
    /// So many particles.
    Count(u64),
    /// Volume of the particles over that of the region, of discs area over area.
    Fraction(f64),
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

/// When the bonds of a material break.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BondStrength {
    /// The criterion with the strengths that are given.
    pub criterion: FractureCriterion,
    /// Tensile strength of the material [Pa], > 0, to which the criterion's own strengths are found; `None` = those are given.
    pub tensile_strength: Option<f64>,
    /// Strength in compression as it is given [Pa]; `None` = the criterion has its usual one, if any.
    pub compressive_strength: Option<f64>,
    /// Whether the stress of particles at walls is that of the wall.
    pub at_walls: bool,
}

/// Regions that a cloud can fill.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Region {
    /// A box with faces normal to the axes.
    Box {
        /// Lower corner [m].
        point: Vec3,
        /// Edges [m], > 0.
        size: Vec3,
    },
    /// A circular cylinder.
    Cylinder {
        /// Centre of the face where it begins [m].
        point: Vec3,
        /// Unit vector along it.
        axis: Vec3,
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
    /// A rectangle in the xy-plane, for discs.
    Rectangle {
        /// Lower corner [m].
        point: Vec3,
        /// Edges [m], > 0, and 0 along z.
        size: Vec3,
    },
    /// A circle in the xy-plane, for discs.
    Circle {
        /// Centre [m].
        point: Vec3,
        /// Radius [m], > 0.
        radius: f64,
    },
}

impl Region {
    /// Area of a plane region [m²].
    pub fn area(&self) -> Option<f64> {
        match self {
            Region::Rectangle { .. } | Region::Circle { .. } => Some(self.volume()),
            _ => None,
        }
    }

    /// Volume [m³]; of plane regions the area [m²].
    pub fn volume(&self) -> f64 {
        match self {
            Region::Box { size, .. } => size.product(),
            Region::Cylinder { length, radius, .. } => std::f64::consts::PI * radius * radius * length,
            Region::Sphere { radius, .. } => fractum_math::sphere_volume(*radius),
            Region::Rectangle { size, .. } => size.x * size.y,
            Region::Circle { radius, .. } => std::f64::consts::PI * radius * radius,
        }
    }
}

/// Particles of given sizes in a volume [m³], or discs in an area [m²], at least one.
pub fn graded_count(volume: f64, grading: &Grading, amount: Amount) -> f64 {
    match amount {
        Amount::Count(count) => count as f64,
        Amount::Fraction(share) => (share * volume / grading.mean_volume()).round().max(1.0),
    }
}

/// Why a body cannot be made.
#[derive(Clone, Debug)]
pub struct Fault {
    /// What of the request it is about.
    pub at: At,
    /// What is wrong.
    pub found: String,
    /// What was expected; empty where `found` says it.
    pub expected: &'static str,
    /// What to do; empty where that is plain.
    pub remedy: &'static str,
}

impl Fault {
    pub(crate) fn new(at: At, found: impl ToString) -> Self {
        Fault { at, found: found.to_string(), expected: "", remedy: "" }
    }

    pub(crate) fn remedy(self, remedy: &'static str) -> Self {
        Fault { remedy, ..self }
    }
}

/// What of a request a fault is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    /// The body as a whole.
    Body,
    /// Its material.
    Material,
    /// The coordination of its bonds.
    Coordination,
    /// The shape or region to fill.
    Shape,
    /// The mesh group or the file of the shape.
    Source,
    /// The content of the file of particles.
    File,
    /// The size or the number of particles.
    Size,
    /// How many particles come in a time.
    Rate,
    /// The solid that it takes the place of.
    Replaced,
}

/// A doubt about a body that can be made.
#[derive(Clone, Debug)]
pub struct Doubt {
    /// Code of the warning.
    pub code: fractum_output::warning::Code,
    /// What is doubtful.
    pub found: String,
    /// What to do.
    pub remedy: &'static str,
}
