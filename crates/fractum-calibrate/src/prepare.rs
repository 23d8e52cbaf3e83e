//! A bonded body ready to move, from a shape and a material.

use fractum_dem::Particles;
use fractum_pack::{Convention, Packing};
use serde::{Deserialize, Serialize};

use crate::{CalibrateError, Inverted, Micro, Request, Sample, calibrate, invert};

/// What a bonded body is made of.
#[derive(Clone, Copy, Debug)]
pub struct BondedMaterial {
    /// Young's modulus [Pa].
    pub young_modulus: f64,
    /// Poisson's ratio.
    pub poisson_ratio: f64,
    /// Density of the continuum [kg/m³]; the particles together have its mass.
    pub density: f64,
    /// Coordination of the bonds.
    pub coordination: f64,
    /// How it is counted.
    pub convention: Convention,
    /// See [`Sample::stiffen_walls`].
    pub wall_stiffening: f64,
    /// Beams, when they are known; found by calibration otherwise.
    pub beams: Option<Beams>,
}

/// Beams, and what they are known to give.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Beams {
    /// The micro-parameters.
    pub micro: Micro,
    /// Young's modulus [Pa] and Poisson's ratio in tension tests, mean over the axes, where they were calibrated.
    pub reached: Option<(f64, f64)>,
    /// Relative spread of Young's modulus over the axes; 0 for a single one.
    pub anisotropy: f64,
    /// Whether the tests were made on the very packing; else on a box of the same kind.
    pub own_packing: bool,
}

impl Beams {
    /// Beams of which nothing else is known.
    pub fn given(micro: Micro) -> Self {
        Beams { micro, reached: None, anisotropy: 0.0, own_packing: false }
    }

    fn calibrated(found: &Inverted, own_packing: bool) -> Self {
        let Inverted { micro, young_modulus, poisson_ratio, anisotropy, .. } = *found;
        Beams { micro, reached: Some((young_modulus, poisson_ratio)), anisotropy, own_packing }
    }
}

/// A bonded body at rest.
#[derive(Clone, Debug)]
pub struct BondedBody {
    /// The bonded packing, with its lattice.
    pub sample: Sample,
    /// Particles at rest, with the mass of the continuum.
    pub particles: Particles,
    /// The beams used.
    pub beams: Beams,
}

/// Bonds a packing, calibrates the beams and gives the particles their mass.
///
/// Boxes, with walls or repeating, and cylinders are calibrated on the very packing; other shapes on a box of 10,000 particles of the same
/// dispersion and convention, since a tension test needs two faces.
///
/// # Errors
/// Those of bonding and calibration; a density that is not positive.
pub fn prepare(packing: Packing, material: &BondedMaterial) -> Result<BondedBody, CalibrateError> {
    prepare_sample(Sample::new(packing, material.coordination, material.convention)?, material)
}

/// The same for a packing that is bonded already, to the coordination that the material tells.
///
/// # Errors
/// Those of calibration; a density that is not positive.
pub fn prepare_sample(sample: Sample, material: &BondedMaterial) -> Result<BondedBody, CalibrateError> {
    let (young, poisson) = (material.young_modulus, material.poisson_ratio);
    if !(material.density.is_finite() && material.density > 0.0) {
        let expected = "a positive number of kilograms per cubic metre";
        return Err(CalibrateError::Material { what: "density", value: material.density, expected });
    }
    let mut sample = sample.stiffen_walls(material.wall_stiffening)?;
    let repeats = sample.packing.domain.period().is_some();
    let may_be_tested = repeats || sample.box_extents().is_some() || sample.cylinder_extents().is_some();
    let beams = match material.beams {
        Some(beams) => beams,
        None if may_be_tested => {
            let law = crate::laws::stored(material.convention)?.micro(young, poisson, material.coordination);
            let found = invert(&mut sample, young, poisson, law.map_or(0.4, |m| m.radius_ratio))?;
            Beams::calibrated(&found, true)
        }
        None => {
            let (coordination, convention) = (Some(material.coordination), material.convention);
            let found = calibrate(&Request {
                coordination,
                convention,
                wall_stiffening: material.wall_stiffening,
                ..Request::new(young, poisson)
            })?;
            Beams::calibrated(&found.inverted[0], false)
        }
    };
    sample.set_micro(beams.micro)?;
    let mass = material.density * sample.measured_volume();
    let particles = Particles::at_rest(sample.packing.position.clone(), sample.packing.radius.clone(), mass)?;
    Ok(BondedBody { sample, particles, beams })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab;
    use fractum_dem::Tolerance;
    use fractum_pack::{Domain, PackSpec, pack};

    fn glass() -> BondedMaterial {
        let convention = Convention::Interior;
        BondedMaterial {
            young_modulus: 72e9,
            poisson_ratio: 0.23,
            density: 2500.0,
            coordination: 9.0,
            convention,
            wall_stiffening: 0.0,
            beams: None,
        }
    }

    #[test]
    fn a_box_of_glass_has_the_mass_and_the_stiffness_of_glass() {
        let packing = pack(&PackSpec::new(Domain::cuboid(1e-3, 2e-3, 1e-3), 800, 1)).unwrap();
        let body = prepare(packing, &glass()).unwrap();
        let mass: f64 = body.particles.mass.iter().sum();
        assert!((mass / (2500.0 * 2e-9) - 1.0).abs() < 0.02, "{mass}");
        // Calibrated along the long axis; across it a dozen particles do not make a material.
        let along = |axis: usize| lab::tension(&body.sample, axis, None, Tolerance::default()).unwrap().0.young_modulus;
        assert!((along(1) / 72e9 - 1.0).abs() < 1e-3 && (along(0) / 72e9 - 1.0).abs() > 1e-2);
        let (young, poisson) = body.beams.reached.unwrap();
        assert!((young / 72e9 - 1.0).abs() < 1e-9 && (poisson - 0.23).abs() < 1e-3 && body.beams.own_packing);
    }

    #[test]
    fn given_beams_are_used_as_they_are_and_a_bad_density_is_refused() {
        let packing = pack(&PackSpec::new(Domain::sphere(1e-3), 300, 1)).unwrap();
        let micro = Micro { radius_ratio: 0.4, young_modulus: 1e9 };
        let body = prepare(packing.clone(), &BondedMaterial { beams: Some(Beams::given(micro)), ..glass() }).unwrap();
        assert_eq!(body.beams, Beams::given(micro));
        let wrong = prepare(packing, &BondedMaterial { density: 0.0, ..glass() });
        assert!(matches!(wrong, Err(CalibrateError::Material { .. })));
    }
}
