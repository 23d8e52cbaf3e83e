//! The strengths of a criterion that give a body its strength in tension.

use fractum_dem::FractureCriterion;
use fractum_pack::{Convention, Domain, PackSpec, pack};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::pull::{StrengthCriterion, pull};
use crate::strength_law::{self, READINGS};
use crate::{CalibrateError, Micro, Sample, published};

/// Strengths of a criterion [Pa], by what shall happen at the asked tensile strength.
#[derive(Clone, Debug, Serialize)]
pub struct Strength {
    /// The criterion.
    pub criterion: StrengthCriterion,
    /// The load peak: mean over the packings. A tension test shows this strength.
    pub peak: f64,
    /// The first break: mean over the packings.
    pub first_break: f64,
    /// Smallest and largest of both over the packings.
    pub range: [[f64; 2]; 2],
    /// By eq. (22) of Nguyen et al. (2019), for the principal criterion.
    pub law: Option<f64>,
    /// By our own law for these packings, see [`strength_law`]: for the load peak and for the first break, for the
    /// principal criterion within its ranges.
    pub own_law: Option<[f64; 2]>,
}

/// Finds the strength on samples whose beams are set, by tension along x.
///
/// Every criterion is proportional to the load, so that one test with any strength tells all: with the strength s a sample
/// whose load peaks at σ needs s f/σ to peak at f.
///
/// # Errors
/// A tensile strength that is none; another shape than a box; a solve that does not converge.
pub fn calibrate(samples: &[&Sample], asked: f64, criterion: StrengthCriterion) -> Result<Strength, CalibrateError> {
    let (mut first, mut peak) = (Vec::new(), Vec::new());
    for sample in samples {
        let broken = pull(sample, asked, criterion.with(asked))?;
        first.push(asked * asked / broken.first_break.unwrap_or(f64::NAN));
        peak.push(asked * asked / broken.strength);
    }
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let range = |v: &[f64]| v.iter().fold([f64::INFINITY, 0.0f64], |[l, h], &x| [l.min(x), h.max(x)]);
    // The laws count bonds over all particles.
    let place = |sample: &&Sample| {
        let ratio = sample.lattice.section().radius / sample.mean_radius;
        (ratio, sample.network.coordination_all, sample.packing.len())
    };
    // They were fitted to stresses of the middle of neighbourhoods.
    let known = |sample: &&&Sample| criterion == StrengthCriterion::Principal && sample.to_wall.is_empty();
    let place = samples.first().filter(known).map(place);
    let law = place.map(|(ratio, coordination, _)| asked / published::strength_ratio(ratio, coordination));
    let own = strength_law::stored()?;
    let own_law = place.filter(|&(ratio, coordination, _)| own.covers(ratio, coordination));
    let own_law = own_law.map(|(ratio, coordination, particles)| {
        READINGS.map(|reading| asked / own.ratio(reading, ratio, coordination, particles))
    });
    let range = [range(&peak), range(&first)];
    Ok(Strength { criterion, peak: mean(&peak), first_break: mean(&first), range, law, own_law })
}

/// Bonds of which a criterion's strengths are asked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BondKind {
    /// The beams; only their radius matters here.
    pub micro: Micro,
    /// Coordination.
    pub coordination: f64,
    /// How it is counted.
    pub convention: Convention,
    /// κ of the radii.
    pub dispersion: f64,
    /// See [`Sample::stiffen_walls`].
    pub wall_stiffening: f64,
    /// See [`Sample::read_at_walls`].
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub at_walls: bool,
}

impl BondKind {
    /// A packing with such bonds; its radii have their dispersion.
    pub(crate) fn sample(&self, spec: PackSpec) -> Result<Sample, CalibrateError> {
        let packing = pack(&PackSpec { dispersion: self.dispersion, ..spec })?;
        let sample = Sample::new(packing, self.coordination, self.convention)?;
        let sample = sample.stiffen_walls(self.wall_stiffening)?;
        let mut sample = if self.at_walls { sample.read_at_walls() } else { sample };
        sample.set_micro(self.micro)?;
        Ok(sample)
    }
}

/// Particles of the boxes on which strengths are found, and how many of them are broken.
const STRENGTH_BOXES: (usize, u64) = (5_000, 3);

/// What takes the strengths of a material to those of a criterion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pulling {
    /// The strengths of the criterion over those of the material.
    pub factor: f64,
    /// Scatter of the tensile strength between packings: standard deviation over mean.
    pub scatter: f64,
}

/// Finds the factor from the material's strengths to the criterion's own: with all of them times it, boxes of such bonds peak
/// at the tensile strength `asked` [Pa] of the material.
///
/// # Errors
/// Those of packing, bonding and breaking.
pub fn pulling(bonds: &BondKind, asked: f64, criterion: FractureCriterion) -> Result<Pulling, CalibrateError> {
    let (particles, packings) = STRENGTH_BOXES;
    let factor = |seed: u64| {
        let sample = bonds.sample(PackSpec::new(Domain::cuboid(1e-3, 1e-3, 1e-3), particles, seed))?;
        Ok(asked / pull(&sample, asked, criterion)?.strength)
    };
    let factors = (1..=packings).into_par_iter().map(factor).collect::<Result<Vec<f64>, CalibrateError>>()?;
    let (factor, scatter) = spread(&factors);
    Ok(Pulling { factor, scatter })
}

/// Mean, and standard deviation over the mean.
pub(crate) fn spread(values: &[f64]) -> (f64, f64) {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square: f64 = values.iter().map(|v| (v / mean - 1.0).powi(2)).sum();
    (mean, (square / (count - 1.0).max(1.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Micro, lab};
    use fractum_pack::{Convention, Domain, PackSpec, pack};

    #[test]
    fn a_sample_has_the_strength_it_was_calibrated_to() {
        let packing = pack(&PackSpec::new(Domain::cuboid(1e-3, 1e-3, 1e-3), 500, 1)).unwrap();
        let mut sample = Sample::new(packing, 9.0, Convention::Interior).unwrap();
        sample.set_micro(Micro { radius_ratio: 0.4, young_modulus: 600e9 }).unwrap();
        for criterion in [StrengthCriterion::Principal, StrengthCriterion::Beam, StrengthCriterion::Hydrostatic] {
            let found = calibrate(&[&sample], 50e6, criterion).unwrap();
            assert!(found.peak <= found.first_break);
            let broken = |strength| {
                let options = lab::FailureOptions::new(lab::Failure::Tension, criterion.with(strength));
                lab::break_sample(&sample, lab::Failure::Tension, &options).unwrap()
            };
            assert!((broken(found.peak).strength / 50e6 - 1.0).abs() < 1e-3, "{criterion:?}");
            assert!((broken(found.first_break).first_break.unwrap() / 50e6 - 1.0).abs() < 1e-6);
        }
        assert!(matches!(calibrate(&[&sample], 0.0, StrengthCriterion::Beam), Err(CalibrateError::Material { .. })));
    }
}
