//! The strengths of a criterion that give a body its strengths in tension and in compression.

use fractum_dem::FractureCriterion;
use fractum_math::elementary::{exp, ln};
use fractum_pack::{Convention, Domain, PackSpec, pack};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::lab::Failure;
use crate::pull::{StrengthCriterion, pull, to_peak};
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
    let place = samples.first().filter(|_| criterion == StrengthCriterion::Principal).map(place);
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
}

impl BondKind {
    /// A packing with such bonds; its radii have their dispersion.
    fn sample(&self, spec: PackSpec) -> Result<Sample, CalibrateError> {
        let packing = pack(&PackSpec { dispersion: self.dispersion, ..spec })?;
        let mut sample = Sample::new(packing, self.coordination, self.convention)?;
        sample.set_micro(self.micro)?;
        Ok(sample)
    }
}

/// Particles of the boxes on which strengths are found, and how many of them are broken.
const STRENGTH_BOXES: (usize, u64) = (5_000, 2);

/// The factor from the material's strengths to the criterion's own: with all of them times it, boxes of such bonds peak at
/// the tensile strength `asked` [Pa] of the material.
///
/// # Errors
/// Those of packing, bonding and breaking.
pub fn strength_factor(bonds: &BondKind, asked: f64, criterion: FractureCriterion) -> Result<f64, CalibrateError> {
    let (particles, packings) = STRENGTH_BOXES;
    let mut factor = 0.0;
    for seed in 1..=packings {
        let sample = bonds.sample(PackSpec::new(Domain::cuboid(1e-3, 1e-3, 1e-3), particles, seed))?;
        factor += asked / pull(&sample, asked, criterion)?.strength / packings as f64;
    }
    Ok(factor)
}

/// Particles of the prisms on which strength in compression is found, their edges, and how many of them are pressed.
const PRISMS: (usize, [f64; 3], u64) = (2_500, [2e-3, 1e-3, 1e-3], 2);
/// Strength of the first trial over the asked one: slip begins in weak places.
const FIRST_TRIAL: f64 = 1.3;
/// Difference from the asked strength at which the search ends, that which is still accepted, and its most trials.
const CLOSE: f64 = 0.01;
const ACCEPTED: f64 = 0.05;
const TRIALS: usize = 5;

/// The strength of a criterion in compression that gives a body the one that is asked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Crushing {
    /// The criterion's own [Pa].
    pub strength: f64,
    /// What prisms bear with it, mean over the packings [Pa].
    pub reached: f64,
    /// Difference between the packings over that mean.
    pub scatter: f64,
}

/// Finds the criterion's strength in compression with which prisms of such bonds, twice as long as wide, bear the strength
/// `asked` [Pa] between ends that are free to widen.
///
/// - `criterion`: with its own strength in tension
///
/// # Errors
/// [`CalibrateError::Compression`] where the strength in tension does not let them bear so much; those of packing, bonding
/// and breaking.
pub fn crushing(bonds: &BondKind, asked: f64, criterion: FractureCriterion) -> Result<Crushing, CalibrateError> {
    let (particles, [x, y, z], packings) = PRISMS;
    let prism = |seed: u64| bonds.sample(PackSpec::new(Domain::cuboid(x, y, z), particles, seed));
    let samples = (1..=packings).into_par_iter().map(prism).collect::<Result<Vec<Sample>, CalibrateError>>()?;
    let press = |strength: f64| {
        let criterion = criterion.with_compressive_strength(strength);
        let one = |sample: &Sample| Ok(to_peak(sample, Failure::Compression, criterion)?.strength);
        let borne = samples.par_iter().map(one).collect::<Result<Vec<f64>, CalibrateError>>()?;
        let reached = borne.iter().sum::<f64>() / borne.len() as f64;
        let (low, high) = borne.iter().fold((f64::INFINITY, 0.0f64), |(l, h), &b| (l.min(b), h.max(b)));
        Ok::<Crushing, CalibrateError>(Crushing { strength, reached, scatter: (high - low) / reached })
    };
    let miss = |tried: &Crushing| ln(tried.reached / asked);
    let (mut best, mut slope) = (press(FIRST_TRIAL * asked)?, 1.0);
    let mut last = best;
    for _ in 1..TRIALS {
        if miss(&best).abs() < CLOSE {
            break;
        }
        let next = press(last.strength * exp((-miss(&last) / slope).clamp(-0.7, 0.7)))?;
        // Peaks scatter from trial to trial: a slope that few per cent of strength show is none.
        let way = ln(next.strength / last.strength);
        if way.abs() > 0.05 {
            slope = ((miss(&next) - miss(&last)) / way).clamp(0.4, 1.5);
        }
        last = next;
        if miss(&next).abs() < miss(&best).abs() {
            best = next;
        }
    }
    let Crushing { reached, .. } = best;
    if miss(&best).abs() < ACCEPTED { Ok(best) } else { Err(CalibrateError::Compression { asked, reached }) }
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
