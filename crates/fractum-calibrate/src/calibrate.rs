//! The whole way from a material to checked micro-parameters.

use fractum_dem::Tolerance;
use fractum_pack::{Convention, Domain, PackSpec, pack};
use serde::Serialize;

use crate::inversion::check_material;
use crate::pull::StrengthCriterion;
use crate::strength::{self, Strength};
use crate::{CalibrateError, Inverted, Micro, Sample, invert, lab, laws};

/// What to calibrate.
#[derive(Clone, Debug, Serialize)]
pub struct Request {
    /// Young's modulus [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Tensile strength [Pa] and the criterion that shall give it, when fracture is wanted.
    pub tensile_strength: Option<(f64, StrengthCriterion)>,
    /// Whether the criterion takes the stress of particles at walls there, see [`Sample::read_at_walls`].
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub at_walls: bool,
    /// Coordination; chosen when absent.
    pub coordination: Option<f64>,
    /// How the coordination is counted.
    pub convention: Convention,
    /// See [`Sample::stiffen_walls`].
    pub wall_stiffening: f64,
    /// Particles of the calibration packings (boxes).
    pub particles: usize,
    /// Seed of the first packing; further ones follow it.
    pub seed: u64,
    /// Packings inverted; the parameters are their mean.
    pub packings: usize,
}

impl Request {
    /// A request with the defaults: one packing of 10,000, convention `interior`.
    pub fn new(young_modulus: f64, poisson_ratio: f64) -> Self {
        Request {
            young_modulus,
            poisson_ratio,
            tensile_strength: None,
            at_walls: false,
            coordination: None,
            convention: Convention::Interior,
            wall_stiffening: 0.0,
            particles: 10_000,
            seed: 1,
            packings: 1,
        }
    }
}

/// Micro-parameters and how well they work.
#[derive(Clone, Debug, Serialize)]
pub struct Calibration {
    /// What was asked.
    pub request: Request,
    /// Coordination used.
    pub coordination: f64,
    /// The micro-parameters: mean over the packings.
    pub micro: Micro,
    /// Relative scatter (standard deviation) of r_m and E_m over the packings; none for one packing.
    pub scatter: Option<[f64; 2]>,
    /// The inversion on each packing.
    pub inverted: Vec<Inverted>,
    /// What the stored laws propose.
    pub law: Option<Micro>,
    /// Reachable Poisson's ratios at this coordination, lowest and highest, by the stored laws.
    pub poisson_range: [f64; 2],
    /// E and ν of tension tests along x, y, z on the first packing, from rest and to a tighter tolerance than the
    /// inversion's [Pa, -].
    pub own_check: [(f64, f64); 3],
    /// E on a packing not used before, mean over the three axes [Pa].
    pub check_young_modulus: f64,
    /// ν on that packing, mean over the three axes.
    pub check_poisson_ratio: f64,
    /// Seed of that packing.
    pub check_seed: u64,
    /// Strength of the criterion for the asked tensile strength.
    pub strength: Option<Strength>,
}

/// Coordinations tried in turn when none is asked: the usual ten, then lower ones for higher Poisson's ratios.
const COORDINATIONS: [f64; 4] = [10.0, 8.5, 7.5, 6.5];
/// Thinnest beams chosen of our own accord, in mean radii: thinner ones make the lattice ill-conditioned.
const THINNEST: f64 = 0.2;

/// The coordination that suits a Poisson's ratio: the usual ten, or the highest below it at which beams are not thin.
///
/// # Errors
/// A ratio out of reach at every coordination.
pub fn suitable_coordination(poisson_ratio: f64, convention: Convention) -> Result<f64, CalibrateError> {
    let law = laws::stored(convention)?;
    let propose = |c: f64| law.micro(1.0, poisson_ratio, c);
    let works = |c: &&f64| propose(**c).is_ok_and(|m| m.radius_ratio >= THINNEST);
    match COORDINATIONS.iter().find(works) {
        Some(&coordination) => Ok(coordination),
        None => {
            let lowest = COORDINATIONS[COORDINATIONS.len() - 1];
            propose(lowest).map(|_| lowest)
        }
    }
}

/// Calibrates by direct inversion on packings of its own, and checks the result on a further packing.
///
/// # Errors
/// An impossible material or coordination; a Poisson's ratio out of reach, with the range; packing and solving.
pub fn calibrate(request: &Request) -> Result<Calibration, CalibrateError> {
    check_material(request.young_modulus, request.poisson_ratio)?;
    let law = laws::stored(request.convention)?;
    let propose = |c: f64| law.micro(request.young_modulus, request.poisson_ratio, c);
    let coordination = match request.coordination {
        Some(coordination) => coordination,
        None => suitable_coordination(request.poisson_ratio, request.convention)?,
    };
    let proposed = propose(coordination).ok();
    let start = proposed.map_or(0.4, |m| m.radius_ratio);
    let cube = |seed: u64| -> Result<Sample, CalibrateError> {
        let packing = pack(&PackSpec::new(Domain::cuboid(1e-3, 1e-3, 1e-3), request.particles, seed))?;
        let sample = Sample::new(packing, coordination, request.convention)?.stiffen_walls(request.wall_stiffening)?;
        Ok(if request.at_walls { sample.read_at_walls() } else { sample })
    };
    let mut inverted = Vec::new();
    let mut first = None;
    for k in 0..request.packings.max(1) as u64 {
        let mut sample = cube(request.seed + k)?;
        inverted.push(invert(&mut sample, request.young_modulus, request.poisson_ratio, start)?);
        first.get_or_insert(sample);
    }
    let count = inverted.len() as f64;
    let mean = |f: &dyn Fn(&Inverted) -> f64| inverted.iter().map(f).sum::<f64>() / count;
    let micro =
        Micro { radius_ratio: mean(&|i| i.micro.radius_ratio), young_modulus: mean(&|i| i.micro.young_modulus) };
    let scatter = (inverted.len() > 1).then(|| {
        let deviation =
            |f: &dyn Fn(&Inverted) -> f64, m: f64| (mean(&|i| (f(i) / m - 1.0).powi(2)) * count / (count - 1.0)).sqrt();
        [
            deviation(&|i| i.micro.radius_ratio, micro.radius_ratio),
            deviation(&|i| i.micro.young_modulus, micro.young_modulus),
        ]
    });
    let check_seed = request.seed + inverted.len() as u64;
    let fresh = cube(check_seed)?;
    let mut own = first.map_or_else(|| cube(request.seed), Ok)?;
    own.set_micro(micro)?;
    let own_check = test_axes(&own)?;
    let mut sample = fresh;
    sample.set_micro(micro)?;
    let check = test_axes(&sample)?;
    let average = |f: fn(&(f64, f64)) -> f64| check.iter().map(f).sum::<f64>() / 3.0;
    let [highest, lowest] = law.poisson_range(coordination);
    let strength = match request.tensile_strength {
        Some((asked, criterion)) => Some(strength::calibrate(&[&own, &sample], asked, criterion)?),
        None => None,
    };
    Ok(Calibration {
        request: request.clone(),
        coordination,
        micro,
        scatter,
        inverted,
        law: proposed,
        poisson_range: [lowest, highest],
        own_check,
        check_young_modulus: average(|c| c.0),
        check_poisson_ratio: average(|c| c.1),
        check_seed,
        strength,
    })
}

/// E and ν along x, y, z.
fn test_axes(sample: &Sample) -> Result<[(f64, f64); 3], CalibrateError> {
    let tolerance = Tolerance { residual: 1e-6, ..Tolerance::default() };
    let mut found = [(0.0, 0.0); 3];
    for (axis, slot) in found.iter_mut().enumerate() {
        let (tension, _) = lab::tension(sample, axis, None, tolerance)?;
        *slot = (tension.young_modulus, tension.poisson_ratio);
    }
    Ok(found)
}
