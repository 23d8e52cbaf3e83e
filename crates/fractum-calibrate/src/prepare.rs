//! A bonded body ready to move, from a shape and a material.

use fractum_dem::{BeamNetwork, Particles};
use fractum_pack::{Convention, Packing};

use crate::{CalibrateError, Micro, Request, Sample, calibrate, invert};

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
    /// Beams, when they are known; found by calibration otherwise.
    pub micro: Option<Micro>,
}

/// A bonded body at rest.
#[derive(Clone, Debug)]
pub struct BondedBody {
    /// The bonded packing, with its lattice.
    pub sample: Sample,
    /// Particles at rest, with the mass of the continuum.
    pub particles: Particles,
    /// Bonds for explicit dynamics.
    pub bonds: BeamNetwork,
    /// The beams used.
    pub micro: Micro,
}

/// Bonds a packing, calibrates the beams and gives the particles their mass.
///
/// Boxes and cylinders are calibrated on the very packing; other shapes on a box of 10,000 particles of the same
/// dispersion and convention, since a tension test needs two faces.
///
/// # Errors
/// Those of bonding and calibration; a density that is not positive.
pub fn prepare(packing: Packing, material: &BondedMaterial) -> Result<BondedBody, CalibrateError> {
    let (young, poisson) = (material.young_modulus, material.poisson_ratio);
    if !(material.density.is_finite() && material.density > 0.0) {
        let expected = "a positive number of kilograms per cubic metre";
        return Err(CalibrateError::Material { what: "density", value: material.density, expected });
    }
    let mut sample = Sample::new(packing, material.coordination, material.convention)?;
    let has_faces = sample.box_extents().is_some() || sample.cylinder_extents().is_some();
    let micro = match material.micro {
        Some(micro) => micro,
        None if has_faces => {
            let law = crate::laws::stored(material.convention)?.micro(young, poisson, material.coordination);
            invert(&mut sample, young, poisson, law.map_or(0.4, |m| m.radius_ratio))?.micro
        }
        None => {
            let (coordination, convention) = (Some(material.coordination), material.convention);
            calibrate(&Request { coordination, convention, ..Request::new(young, poisson) })?.micro
        }
    };
    sample.set_micro(micro)?;
    let mass = material.density * sample.measured_volume();
    let particles = Particles::at_rest(sample.packing.position.clone(), sample.packing.radius.clone(), mass)?;
    let bonds = BeamNetwork::new(&particles.position, &sample.network.pairs, sample.lattice.section())?;
    Ok(BondedBody { sample, particles, bonds, micro })
}

#[cfg(test)]
mod tests {
    use super::*;
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
            micro: None,
        }
    }

    #[test]
    fn a_box_of_glass_has_the_mass_and_the_stiffness_of_glass() {
        let packing = pack(&PackSpec::new(Domain::cuboid(1e-3, 2e-3, 1e-3), 800, 1)).unwrap();
        let body = prepare(packing, &glass()).unwrap();
        let mass: f64 = body.particles.mass.iter().sum();
        assert!((mass / (2500.0 * 2e-9) - 1.0).abs() < 0.02, "{mass}");
        let mean =
            (0..3).map(|a| crate::lab::tension(&body.sample, a, None, Tolerance::default()).unwrap().0.young_modulus);
        assert!((mean.sum::<f64>() / 3.0 / 72e9 - 1.0).abs() < 1e-3);
        assert!(body.bonds.stable_step(&body.particles, 0.7) > 0.0);
    }

    #[test]
    fn given_beams_are_used_as_they_are_and_a_bad_density_is_refused() {
        let packing = pack(&PackSpec::new(Domain::sphere(1e-3), 300, 1)).unwrap();
        let micro = Micro { radius_ratio: 0.4, young_modulus: 1e9 };
        let body = prepare(packing.clone(), &BondedMaterial { micro: Some(micro), ..glass() }).unwrap();
        assert_eq!(body.micro, micro);
        let wrong = prepare(packing, &BondedMaterial { density: 0.0, ..glass() });
        assert!(matches!(wrong, Err(CalibrateError::Material { .. })));
    }
}
