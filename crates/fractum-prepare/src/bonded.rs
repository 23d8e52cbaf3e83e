//! Bonded bodies made ready: packed or read, bonded, calibrated.

mod interfaces;
mod own_particles;
mod strengths;

use std::time::Instant;

use fractum_calibrate::{
    Beams, BondedMaterial, CalibrateError, Sample, prepare, prepare_sample, suitable_coordination,
};
use fractum_dem::Clumps;
use fractum_math::Vec3;
use fractum_mesh::{Mesh, topology};
use fractum_output::warning::Code;
use fractum_pack::{
    Arrangement, BondNetwork, Certificate, ClosedSurface, Convention, Domain, PackError, PackProgress, PackSize,
    PackSpec, Packing, pack_certified, read_stl, regular, regular_repeating,
};
use fractum_scene::BondFracture;
use serde::Serialize;

use crate::asked::{
    At, BondLawKind, BondedRequest, BondedSubstance, Doubt, Fault, PackingRequest, ParticleSize, Shape,
};
use crate::body::PreparedBody;
use crate::cache::{Cache, key};
use crate::region::{Region, Space, region};
pub use interfaces::InterfaceReport;
use own_particles::OwnParticles;
pub use strengths::FoundStrengths;

/// Fills a box of these corners with particles of a radius, regularly.
type Fill = fn(Vec3, Vec3, f64, Arrangement) -> Result<Packing, PackError>;

/// Contacts per particle at which compaction stops.
const CONTACTS: f64 = 6.2;

/// What to do about a packing that misses its targets.
const REFUSED: &str = "fractum pack shows the whole certificate, and with --keep it writes a packing that the key packing takes all the same";

/// What to know about a packing of the user's that misses them.
const GIVEN: &str = "its elastic constants are calibrated on itself; its strength may depend on the direction";

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
    /// See [`Sample::stiffen_walls`].
    pub wall_stiffening: f64,
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

/// A bonded body that was made.
pub struct MadeBody {
    /// What the scene is built from.
    pub body: PreparedBody,
    /// What the plan says of it.
    pub report: BondedReport,
    /// Doubts that do not keep it from running.
    pub doubts: Vec<Doubt>,
    /// What took how long, for the log.
    pub timing: Option<String>,
    /// What was read, where its particles come from a file.
    pub read: Option<String>,
}

/// Makes a bonded body ready.
///
/// - `tell`: called with what is being done, again and again while it takes long
///
/// # Errors
/// What cannot be packed, bonded or calibrated.
pub fn prepare_bonded(
    asked: &BondedRequest<'_>,
    mesh: &Mesh,
    cache: &Cache,
    tell: &dyn Fn(&str),
) -> Result<MadeBody, Fault> {
    Maker { mesh, cache, tell, asked }.make()
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
    wall_stiffening: f64,
    young_modulus: f64,
    poisson_ratio: f64,
    /// Bonds that are given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pairs: Option<Vec<[u32; 2]>>,
}

struct Maker<'a> {
    mesh: &'a Mesh,
    cache: &'a Cache,
    tell: &'a dyn Fn(&str),
    asked: &'a BondedRequest<'a>,
}

impl Maker<'_> {
    fn make(&self) -> Result<MadeBody, Fault> {
        let start = Instant::now();
        let region = self.region()?;
        let (packing, packing_from, own) = match &self.asked.packing {
            PackingRequest::Particles { file, shape, bond_gap } => {
                let (packing, own) = self.own_particles(file, shape.as_ref(), *bond_gap)?;
                (packing, Origin::Given, own)
            }
            _ => {
                let (packing, from) = self.packing(region.as_ref())?;
                (packing, from, OwnParticles::default())
            }
        };
        let packed = Instant::now();
        let mut doubts = Vec::new();
        if self.arrangement() == Arrangement::Random {
            doubts.extend(self.check_packing(&packing, packing_from)?);
        }
        if self.asked.law != BondLawKind::CohesiveBeam {
            let (body, report) = self.make_interfaces(packing, packing_from, region, own.pairs)?;
            return Ok(MadeBody { body, report, doubts, timing: None, read: own.read });
        }
        let (made, beams_from, coordination) = self.bond(packing, own.pairs)?;
        let faces = self.material().faces;
        let fracture = match &self.material().strength {
            Some(strength) => Some(self.strengths(strength, &made.sample, made.beams.micro, coordination)?),
            None => None,
        };
        doubts.extend(fracture.as_ref().and_then(|found| self.doubt_strength(found)));
        let done = Instant::now();
        let timing = format!(
            "{}: packing {:.2} s, bonds and beams {:.2} s",
            self.asked.name,
            (packed - start).as_secs_f64(),
            (done - packed).as_secs_f64()
        );
        let joints = Joints::Beams(made.beams, beams_from);
        let mass = made.particles.mass.iter().sum();
        let report = BondedReport { fracture, ..self.report(&made.sample, mass, packing_from, joints) };
        let (fraction, volume) = (made.sample.fraction, made.sample.measured_volume());
        let breaks = |found: FoundStrengths| BondFracture {
            criterion: Some(found.criterion),
            faces,
            volume,
            strength_factors: Vec::new(),
            to_wall: if found.at_walls { made.sample.packing.to_walls() } else { Vec::new() },
        };
        let body = PreparedBody {
            fraction,
            fracture: fracture.map(breaks),
            law: made.sample.lattice.section().into(),
            shares: made.sample.shares,
            particles: made.particles,
            pairs: made.sample.network.pairs,
            shift_to_walls: made.sample.packing.shift_to_walls(),
            out_of_flat_walls: made.sample.packing.out_of_flat_walls(),
            walls: made.sample.packing.walls,
            domain: Some(made.sample.packing.domain),
            arrivals: None,
            clumps: Clumps::default(),
            replaced: region.map_or_else(Vec::new, |region| region.elements),
        };
        Ok(MadeBody { body, report, doubts, timing: Some(timing), read: own.read })
    }

    /// Says what is being done, for what takes long.
    fn tell(&self, what: &str) {
        (self.tell)(&format!("{}: {what}", self.asked.name));
    }

    fn material(&self) -> &BondedSubstance {
        &self.asked.material
    }

    /// Refuses a packing that misses its targets; warns of one that the user gave.
    fn check_packing(&self, packing: &Packing, from: Origin) -> Result<Option<Doubt>, Fault> {
        let Err(error) = Certificate::of(packing).check() else { return Ok(None) };
        if from != Origin::Given {
            return Err(Fault::new(At::Body, error).remedy(REFUSED));
        }
        let found = match error {
            PackError::Refused { target, reached, .. } => {
                format!("the packing that was given misses its target: {target}; reached {reached}")
            }
            other => other.to_string(),
        };
        Ok(Some(Doubt { code: Code::Packing, found, remedy: GIVEN }))
    }

    /// Bonds a packing with beams that are given, kept or found now, to the coordination that it returns.
    ///
    /// - `pairs`: bonds that are given
    fn bond(
        &self,
        packing: Packing,
        pairs: Option<Vec<[u32; 2]>>,
    ) -> Result<(fractum_calibrate::BondedBody, Origin, f64), Fault> {
        let (material, convention) = (self.material(), self.asked.convention);
        let network = pairs.map(|pairs| BondNetwork::of_pairs(&packing, pairs));
        let coordination = match (&network, self.asked.coordination) {
            (Some(network), _) => network.coordination(convention),
            (None, Some(coordination)) => coordination,
            (None, None) => suitable_coordination(material.poisson_ratio, convention).map_err(|e| self.wrong(&e))?,
        };
        if material.beams.is_none() {
            self.may_be_calibrated(&packing)?;
        }
        let beams_key = key(&BeamsKey {
            packing: xxhash_rust::xxh3::xxh3_128(&packing.to_bytes()),
            coordination,
            convention,
            wall_stiffening: self.asked.wall_stiffening,
            young_modulus: material.young_modulus,
            poisson_ratio: material.poisson_ratio,
            pairs: network.as_ref().map(|network| network.pairs.clone()),
        });
        let (beams, from) = match material.beams.map(Beams::given) {
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
            wall_stiffening: self.asked.wall_stiffening,
            beams,
        };
        if from == Origin::Made {
            self.tell("finding beams that give the material its Young's modulus and Poisson's ratio");
        }
        let made = match network {
            Some(network) => {
                Sample::of_network(packing, network, convention).and_then(|sample| prepare_sample(sample, &wanted))
            }
            None => prepare(packing, &wanted),
        };
        let made = made.map_err(|error| self.wrong(&error))?;
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
            name: self.asked.name.to_owned(),
            packing,
            particles: sample.packing.len(),
            mean_radius: sample.mean_radius,
            mass,
            bonds: network.pairs.len(),
            coordination_all: network.coordination_all,
            coordination_interior: network.coordination_interior,
            convention: self.asked.convention,
            wall_stiffening: self.asked.wall_stiffening,
            joints,
            walls: sample.packing.walls.iter().map(|(name, set)| (name.clone(), set.len())).collect(),
            fracture: None,
        }
    }

    fn arrangement(&self) -> Arrangement {
        match &self.asked.packing {
            PackingRequest::Fill { arrangement, .. } => *arrangement,
            PackingRequest::File(_) | PackingRequest::Particles { .. } => Arrangement::Random,
        }
    }

    /// What it takes the place of.
    fn region(&self) -> Result<Option<Region>, Fault> {
        let (Some(solid), PackingRequest::Fill { shape, .. }) = (self.asked.replaces, &self.asked.packing) else {
            return Ok(None);
        };
        let space = match shape {
            Shape::Group(name) => Space::Group(name),
            other => Space::Domain(self.domain(other)?),
        };
        region(self.mesh, solid, &space).map(Some)
    }

    /// Reads the packing, finds it among the kept ones, or makes it.
    ///
    /// - `region`: what is filled instead of the shape
    fn packing(&self, region: Option<&Region>) -> Result<(Packing, Origin), Fault> {
        let (shape, size, dispersion, seed) = match &self.asked.packing {
            PackingRequest::File(bytes) => {
                let read = Packing::from_bytes(bytes).map_err(|error| {
                    Fault::new(At::File, error).remedy("particles of other programs are read by the key file")
                });
                return read.map(|packing| (packing, Origin::Given));
            }
            PackingRequest::Particles { .. } => {
                return Err(Fault::new(At::File, "holds particles, and no packing"));
            }
            PackingRequest::Fill { shape, size, dispersion, seed, .. } => (shape, *size, *dispersion, *seed),
        };
        let domain = match region {
            Some(region) => region.domain.clone(),
            None => self.domain(shape)?,
        };
        let fill = match (self.arrangement(), &domain) {
            (Arrangement::Random, _) => None,
            (_, Domain::Box { .. }) => Some(regular as Fill),
            (_, Domain::Periodic { .. }) => Some(regular_repeating as Fill),
            _ => None,
        };
        if let (Some(fill), ParticleSize::Radius(radius)) = (fill, size) {
            let (lower, upper) = domain.bounds();
            return fill(lower, upper, radius, self.arrangement())
                .map(|packing| (packing, Origin::Made))
                .map_err(|error| Fault::new(At::Size, error));
        }
        let (count, radius) = match size {
            ParticleSize::Count(count) => (Some(count), None),
            ParticleSize::Radius(radius) => (None, Some(radius)),
        };
        let packing_key =
            key(&PackingKey { domain: domain.data(), count, radius, dispersion, seed, contacts: CONTACTS });
        if let Some(packing) = self.cache.find("fpk", packing_key, |bytes| Packing::from_bytes(bytes).ok()) {
            return Ok((packing, Origin::Cached));
        }
        let size_of = match size {
            ParticleSize::Count(count) => PackSize::Count(count as usize),
            ParticleSize::Radius(radius) => PackSize::MeanRadius(radius),
        };
        let spec = PackSpec { domain, size: size_of, dispersion, seed, coordination: CONTACTS };
        self.tell("packing");
        let progress = |progress: PackProgress| self.tell(&progress.to_string());
        let (packing, _) = pack_certified(&spec, &progress).map_err(|error| {
            let at = match error {
                PackError::TooSmall { .. } | PackError::Count(_) => At::Size,
                _ => At::Shape,
            };
            Fault::new(at, error)
        })?;
        self.cache.keep("fpk", packing_key, &packing.to_bytes());
        Ok((packing, Origin::Made))
    }

    fn domain(&self, shape: &Shape<'_>) -> Result<Domain, Fault> {
        let surface = match shape {
            Shape::Plain(domain) => return Ok(domain.clone()),
            Shape::Group(group) => group_surface(self.mesh, Some(group)),
            Shape::Stl { bytes, unit } => read_stl(bytes, *unit),
        };
        surface.map(Domain::Surface).map_err(|error| Fault::new(At::Source, error))
    }

    /// What of the request is the reason for an error.
    fn wrong(&self, error: &CalibrateError) -> Fault {
        let coordination = self.asked.coordination.map(|_| At::Coordination);
        let at = match error {
            CalibrateError::Material { .. } => At::Material,
            CalibrateError::PoissonRange { .. } => coordination.unwrap_or(At::Material),
            CalibrateError::Pack(PackError::Coordination { .. }) => coordination.unwrap_or(At::Body),
            _ => At::Body,
        };
        Fault::new(at, error)
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
