//! Bonded bodies of a case made ready: packed or read, bonded, calibrated.

mod interfaces;
mod strengths;

use std::time::Instant;

use fractum_calibrate::{Beams, BondedMaterial, CalibrateError, Micro, Sample, prepare, suitable_coordination};
use fractum_dem::CrackFaces;
use fractum_io::build::PreparedBody;
use fractum_io::case::model::{
    BodyKind, BondLawKind, BondedBody, BondedShape, Case, Material, PackingSource, ParticleSize,
};
use fractum_io::case::{Diagnostic, Diagnostics, Place, Spanned};
use fractum_io::warning::Code;
use fractum_mesh::{Mesh, topology};
use fractum_pack::{
    Arrangement, Certificate, ClosedSurface, Convention, Domain, PackError, PackProgress, PackSize, PackSpec, Packing,
    pack_certified, read_stl, regular,
};
use fractum_scene::BondFracture;
use serde::Serialize;

use crate::cache::{Cache, key};
use crate::region::{Region, region};
pub use interfaces::InterfaceReport;
pub use strengths::FoundStrengths;

/// Contacts per particle at which compaction stops.
const CONTACTS: f64 = 6.2;

/// What to do about a packing that misses its targets.
const REFUSED: &str = "fractum pack shows the whole certificate, and with --keep it writes a packing that the key packing takes all the same";

/// Where something came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// Made now.
    Made,
    /// Made in an earlier run and kept.
    Cached,
    /// Given by the user.
    Given,
}

/// What became of a bonded body.
#[derive(Clone, Debug)]
pub struct BondedReport {
    /// Name of the body.
    pub name: String,
    /// Where its packing came from.
    pub packing: Origin,
    /// Particles.
    pub particles: usize,
    /// Their mean radius [m].
    pub mean_radius: f64,
    /// Mass of all [kg].
    pub mass: f64,
    /// Bonds.
    pub bonds: usize,
    /// 2 × bonds / particles.
    pub coordination_all: f64,
    /// Mean bonds of the particles that touch no wall.
    pub coordination_interior: f64,
    /// The convention that was asked.
    pub convention: Convention,
    /// What its bonds are.
    pub joints: Joints,
    /// Names and sizes of the wall sets.
    pub walls: Vec<(String, usize)>,
    /// When its bonds break.
    pub fracture: Option<FoundStrengths>,
}

/// What the bonds of a body are.
#[derive(Clone, Copy, Debug)]
pub enum Joints {
    /// Beams, and where they came from.
    Beams(Beams, Origin),
    /// Interfaces of the local constitutive law.
    Interfaces(InterfaceReport),
}

/// All bodies of particles of a case.
#[derive(Default)]
pub struct BondedBodies {
    /// What the scene is built from, in the order of the case.
    pub prepared: Vec<PreparedBody>,
    /// What the plan says of them.
    pub reports: Vec<BondedReport>,
    /// Doubts that do not keep them from running.
    pub warnings: Vec<Diagnostic>,
    /// What took how long, for the log.
    pub timings: Vec<String>,
}

/// Makes the bodies of particles of a case ready.
///
/// - `tell`: called with what is being done, again and again while it takes long
///
/// # Errors
/// Everything that cannot be packed, bonded or calibrated, with its place.
pub fn prepare_bodies(
    case: &Case,
    mesh: &Mesh,
    cache: &Cache,
    tell: &dyn Fn(&str),
) -> Result<BondedBodies, Diagnostics> {
    let mut all = BondedBodies::default();
    let mut errors = Vec::new();
    for body in &case.bodies {
        let bonded = match &body.kind {
            BodyKind::Bonded(bonded) => bonded,
            BodyKind::Particles(loose) => {
                match crate::loose::prepare(loose, &case.materials[loose.material]) {
                    Ok(prepared) => all.prepared.push(prepared),
                    Err(error) => errors.push(*error),
                }
                continue;
            }
            _ => continue,
        };
        let maker = Maker { case, mesh, cache, tell, name: &body.name, bonded };
        if let Err(error) = maker.make(&mut all) {
            errors.push(*error);
        }
    }
    if errors.is_empty() { Ok(all) } else { Err(Diagnostics(errors)) }
}

/// What decides a packing.
#[derive(Serialize)]
struct PackingKey {
    domain: fractum_pack::DomainData,
    count: Option<u64>,
    radius: Option<f64>,
    dispersion: f64,
    seed: u64,
    contacts: f64,
}

/// What decides the beams.
#[derive(Serialize)]
struct BeamsKey {
    packing: u128,
    coordination: f64,
    convention: Convention,
    young_modulus: f64,
    poisson_ratio: f64,
}

struct Maker<'a> {
    case: &'a Case,
    mesh: &'a Mesh,
    cache: &'a Cache,
    tell: &'a dyn Fn(&str),
    name: &'a Spanned<String>,
    bonded: &'a BondedBody,
}

impl Maker<'_> {
    fn make(&self, all: &mut BondedBodies) -> Result<(), Box<Diagnostic>> {
        let start = Instant::now();
        let region = self.region()?;
        let (packing, packing_from) = self.packing(region.as_ref())?;
        let packed = Instant::now();
        if self.arrangement() == Arrangement::Random {
            all.warnings.extend(self.check_packing(&packing, packing_from)?);
        }
        if self.bonded.law != BondLawKind::CohesiveBeam {
            return self.make_interfaces(packing, packing_from, region, all);
        }
        let material = self.material();
        let (made, beams_from, coordination) = self.bond(packing)?;
        let faces = CrackFaces { friction: material.contact.friction, damping_ratio: material.contact.damping_ratio };
        let fracture = match &material.fracture {
            Some(failure) => {
                Some(self.strengths(&failure.value, &made.sample, made.beams.micro, coordination, faces)?)
            }
            None => None,
        };
        all.warnings.extend(fracture.as_ref().and_then(|found| self.doubt_strength(found)));
        let done = Instant::now();
        all.timings.push(format!(
            "{}: packing {:.2} s, bonds and beams {:.2} s",
            self.name.value,
            (packed - start).as_secs_f64(),
            (done - packed).as_secs_f64()
        ));
        let joints = Joints::Beams(made.beams, beams_from);
        let mass = made.particles.mass.iter().sum();
        all.reports.push(BondedReport { fracture, ..self.report(&made.sample, mass, packing_from, joints) });
        let (fraction, volume) = (made.sample.fraction, made.sample.measured_volume());
        let breaks = |found: FoundStrengths| BondFracture {
            criterion: Some(found.criterion),
            faces,
            volume,
            strength_factors: Vec::new(),
        };
        all.prepared.push(PreparedBody {
            fraction,
            fracture: fracture.map(breaks),
            law: made.sample.lattice.section().into(),
            shares: Vec::new(),
            particles: made.particles,
            pairs: made.sample.network.pairs,
            shift_to_walls: made.sample.packing.shift_to_walls(),
            walls: made.sample.packing.walls,
            replaced: region.map_or_else(Vec::new, |region| region.elements),
        });
        Ok(())
    }

    /// Says what is being done, for what takes long.
    fn tell(&self, what: &str) {
        (self.tell)(&format!("{}: {what}", self.name.value));
    }

    fn material(&self) -> &Material {
        &self.case.materials[self.bonded.material]
    }

    /// Refuses a packing that misses its targets; warns of one that the user gave.
    fn check_packing(&self, packing: &Packing, from: Origin) -> Result<Option<Diagnostic>, Box<Diagnostic>> {
        let Err(error) = Certificate::of(packing).check() else { return Ok(None) };
        if from != Origin::Given {
            let wrong = self.refuse(&self.name.place, format!(": {error}"));
            return Err(Box::new(wrong.remedy(REFUSED)));
        }
        let warning = Diagnostic::warning(Code::Packing, &self.name.place, format!(": {error}"));
        Ok(Some(warning.remedy("fractum pack shows the whole certificate")))
    }

    /// Bonds a packing with beams that are given, kept or found now, to the coordination that it returns.
    fn bond(&self, packing: Packing) -> Result<(fractum_calibrate::BondedBody, Origin, f64), Box<Diagnostic>> {
        let (material, convention) = (self.material(), self.bonded.convention);
        let coordination = match &self.bonded.coordination {
            Some(coordination) => coordination.value,
            None => suitable_coordination(material.poisson_ratio, convention).map_err(|e| self.wrong(&e))?,
        };
        let beams_key = key(&BeamsKey {
            packing: xxhash_rust::xxh3::xxh3_128(&packing.to_bytes()),
            coordination,
            convention,
            young_modulus: material.young_modulus,
            poisson_ratio: material.poisson_ratio,
        });
        let given = material.bonds.as_ref().map(|bonds| {
            let (radius_ratio, young_modulus) = (bonds.value.radius_ratio, bonds.value.young_modulus);
            Beams::given(Micro { radius_ratio, young_modulus })
        });
        let (beams, from) = match given {
            Some(beams) => (Some(beams), Origin::Given),
            None => match self.cache.find("beams", beams_key, |bytes| postcard::from_bytes(bytes).ok()) {
                Some(beams) => (Some(beams), Origin::Cached),
                None => (None, Origin::Made),
            },
        };
        let wanted = BondedMaterial {
            young_modulus: material.young_modulus,
            poisson_ratio: material.poisson_ratio,
            density: material.density,
            coordination,
            convention,
            beams,
        };
        if from == Origin::Made {
            self.tell("finding beams that give the material its Young's modulus and Poisson's ratio");
        }
        let made = prepare(packing, &wanted).map_err(|error| self.wrong(&error))?;
        if from == Origin::Made {
            // Serialising plain numbers into memory has no way to fail.
            self.cache.keep("beams", beams_key, &postcard::to_stdvec(&made.beams).unwrap_or_default());
        }
        Ok((made, from, coordination))
    }

    /// What the plan says of a body.
    fn report(&self, sample: &Sample, mass: f64, packing: Origin, joints: Joints) -> BondedReport {
        let network = &sample.network;
        BondedReport {
            name: self.name.value.clone(),
            packing,
            particles: sample.packing.len(),
            mean_radius: sample.mean_radius,
            mass,
            bonds: network.pairs.len(),
            coordination_all: network.coordination_all,
            coordination_interior: network.coordination_interior,
            convention: self.bonded.convention,
            joints,
            walls: sample.packing.walls.iter().map(|(name, set)| (name.clone(), set.len())).collect(),
            fracture: None,
        }
    }

    fn arrangement(&self) -> Arrangement {
        match &self.bonded.packing {
            PackingSource::Shape { arrangement, .. } => *arrangement,
            PackingSource::File(_) => Arrangement::Random,
        }
    }

    /// What it takes the place of.
    fn region(&self) -> Result<Option<Region>, Box<Diagnostic>> {
        let (Some(replaces), PackingSource::Shape { shape, .. }) = (&self.bonded.replaces, &self.bonded.packing) else {
            return Ok(None);
        };
        let domain = match &shape.value {
            BondedShape::Group(_) => None,
            other => Some(self.domain(other).map_err(|(place, error)| self.refuse(&place, format!(": {error}")))?),
        };
        region(self.case, self.mesh, replaces, shape, domain.as_ref()).map(Some)
    }

    /// Reads the packing, finds it among the kept ones, or makes it.
    ///
    /// - `region`: what is filled instead of the shape
    fn packing(&self, region: Option<&Region>) -> Result<(Packing, Origin), Box<Diagnostic>> {
        let (shape, size, dispersion, seed) = match &self.bonded.packing {
            PackingSource::File(file) => {
                let read = Packing::from_bytes(&file.bytes);
                let found = |error| self.refuse(&file.name.place, format!("= \"{}\": {error}", file.name.value));
                return read.map(|packing| (packing, Origin::Given)).map_err(found);
            }
            PackingSource::Shape { shape, size, dispersion, seed, .. } => (shape, size, *dispersion, *seed),
        };
        let domain = match region {
            Some(region) => region.domain.clone(),
            None => self.domain(&shape.value).map_err(|(place, error)| self.refuse(&place, format!(": {error}")))?,
        };
        if let (
            Arrangement::Cartesian | Arrangement::Staggered,
            Domain::Box { lower, upper },
            ParticleSize::Radius(radius),
        ) = (self.arrangement(), &domain, size.value)
        {
            let made = regular(*lower, *upper, radius, self.arrangement());
            return made
                .map(|packing| (packing, Origin::Made))
                .map_err(|error| self.refuse(&size.place, format!(": {error}")));
        }
        let (count, radius) = match size.value {
            ParticleSize::Count(count) => (Some(count), None),
            ParticleSize::Radius(radius) => (None, Some(radius)),
        };
        let packing_key =
            key(&PackingKey { domain: domain.data(), count, radius, dispersion, seed, contacts: CONTACTS });
        if let Some(packing) = self.cache.find("fpk", packing_key, |bytes| Packing::from_bytes(bytes).ok()) {
            return Ok((packing, Origin::Cached));
        }
        let size_of = match size.value {
            ParticleSize::Count(count) => PackSize::Count(count as usize),
            ParticleSize::Radius(radius) => PackSize::MeanRadius(radius),
        };
        let spec = PackSpec { domain, size: size_of, dispersion, seed, coordination: CONTACTS };
        self.tell("packing");
        let progress = |progress: PackProgress| self.tell(&progress.to_string());
        let (packing, _) = pack_certified(&spec, &progress).map_err(|error| {
            let place = match error {
                PackError::TooSmall { .. } | PackError::Count(_) => &size.place,
                _ => &shape.place,
            };
            self.refuse(place, format!(": {error}"))
        })?;
        self.cache.keep("fpk", packing_key, &packing.to_bytes());
        Ok((packing, Origin::Made))
    }

    fn domain(&self, shape: &BondedShape) -> Result<Domain, (Place, PackError)> {
        Ok(match shape {
            BondedShape::Box { point, size } => Domain::Box { lower: *point, upper: point + size },
            BondedShape::Cylinder { point, length, radius } => {
                Domain::Cylinder { start: *point, length: *length, radius: *radius }
            }
            BondedShape::Sphere { point, radius } => Domain::Sphere { centre: *point, radius: *radius },
            BondedShape::Group(group) => {
                let surface = group_surface(self.mesh, Some(&group.value));
                Domain::Surface(surface.map_err(|error| (group.place.clone(), error))?)
            }
            BondedShape::Stl { file, unit } => {
                let surface = read_stl(&file.bytes, *unit);
                Domain::Surface(surface.map_err(|error| (file.name.place.clone(), error))?)
            }
        })
    }

    fn refuse(&self, place: &Place, found: String) -> Box<Diagnostic> {
        Box::new(Diagnostic::error(place, found))
    }

    /// Where in the case the reason for an error stands.
    fn wrong(&self, error: &CalibrateError) -> Box<Diagnostic> {
        let material = &self.case.materials[self.bonded.material].name.place;
        let coordination = self.bonded.coordination.as_ref().map(|c| &c.place);
        let place = match error {
            CalibrateError::Material { .. } => material,
            CalibrateError::PoissonRange { .. } => coordination.unwrap_or(material),
            CalibrateError::Pack(PackError::Coordination { .. }) => coordination.unwrap_or(&self.name.place),
            _ => &self.name.place,
        };
        self.refuse(place, format!(": {error}"))
    }
}

/// The closed surface of a mesh group, its tetrahedra or triangles; of all tetrahedra without a name.
///
/// # Errors
/// [`PackError::OpenSurface`] and [`PackError::BadSurface`].
pub fn group_surface(mesh: &Mesh, group: Option<&str>) -> Result<ClosedSurface, PackError> {
    let (mut tetrahedra, mut triangles) = (Vec::new(), Vec::new());
    match group {
        None => tetrahedra.clone_from(&mesh.tetrahedra),
        Some(name) => {
            for part in mesh.group(name) {
                tetrahedra.extend(part.tetrahedra.iter().map(|&e| mesh.tetrahedra[e as usize]));
                triangles.extend(part.triangles.iter().map(|&e| mesh.triangles[e as usize]));
            }
        }
    }
    if !tetrahedra.is_empty() {
        triangles = topology::boundary_of_tetrahedra(&tetrahedra).iter().map(|f| f.nodes).collect();
    }
    ClosedSurface::new(&mesh.nodes, &triangles)
}
