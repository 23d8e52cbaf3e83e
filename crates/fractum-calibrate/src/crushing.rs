//! The strength of a criterion that gives a body its strength in compression, found by crushing prisms in motion.

use fractum_dem::{CrackFaces, FractureCriterion, Tolerance};
use fractum_math::Sym3;
use fractum_math::elementary::{asin, exp, ln};
use fractum_pack::{Domain, PackSpec};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::lab::{self, Failure, FailureOptions, MotionOptions};
use crate::strength::{BondKind, spread};
use crate::{CalibrateError, Sample};

/// Particles of the prisms that are crushed, their edges, and how many of them.
const PRISMS: (usize, [f64; 3], u64) = (2_500, [2e-3, 1e-3, 1e-3], 3);
/// Times that a wave takes along a prism until the asked load: twenty periods of its slowest vibration.
const TRANSITS: f64 = 40.0;
/// Pressure on the sides with which the friction angle is found, over the strength.
const CONFINED: f64 = 0.1;
/// Share of the stable step, as in a scene.
const SAFETY: f64 = 0.8;
/// Share of the peak below which the load shows that a prism is crushed.
const CRUSHED: f64 = 0.7;
/// Strength of the first trial over the asked one: slip begins in weak places.
const FIRST_TRIAL: f64 = 1.75;
/// Difference from the asked strength at which the search ends, and its most trials.
const CLOSE: f64 = 0.02;
const TRIALS: usize = 5;

/// How a body is loaded.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Use {
    /// By equilibria, in which broken bonds leave no faces that touch.
    pub at_rest: bool,
    /// The faces of its cracks.
    pub faces: CrackFaces,
}

/// The strength of a criterion in compression that gives a body the one that is asked.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Crushing {
    /// The criterion's own [Pa].
    pub strength: f64,
    /// Share of a compression that chains of such bonds turn into tension across it.
    pub chains: f64,
    /// What prisms bear with it, mean over the packings [Pa].
    pub reached: f64,
    /// Its scatter between packings: standard deviation over mean.
    pub scatter: f64,
    /// Friction angle of the prisms [rad], and its standard deviation between packings: from what they bear beside a pressure
    /// on their sides of a tenth of the asked strength. None at rest.
    pub friction_angle: Option<[f64; 2]>,
}

/// Finds the criterion's strength in compression with which prisms of such bonds, twice as long as wide, bear the strength
/// `asked` [Pa] when their ends, which are free to widen, move towards each other: as slowly as in a quasi-static scene, or at rest.
///
/// - `criterion`: with its own strength in tension
/// - `use_of_body`: how the body that gets this strength is loaded
/// - `tell`: called before each trial with its number and what the one before bore over the asked strength
///
/// Where such bonds cannot bear so much beside this strength in tension, the nearest that was reached is returned.
///
/// # Errors
/// Those of packing, bonding and breaking.
pub fn crushing(
    bonds: &BondKind,
    asked: f64,
    criterion: FractureCriterion,
    use_of_body: Use,
    tell: &dyn Fn(usize, Option<f64>),
) -> Result<Crushing, CalibrateError> {
    let (particles, [x, y, z], packings) = PRISMS;
    let prism = |seed: u64| bonds.sample(PackSpec::new(Domain::cuboid(x, y, z), particles, seed));
    let samples = (1..=packings).into_par_iter().map(prism).collect::<Result<Vec<Sample>, CalibrateError>>()?;
    let shares = samples.par_iter().map(share_of_chains).collect::<Result<Vec<f64>, CalibrateError>>()?;
    let chains = criterion.numbers().chains.max(SPARED * spread(&shares).0).min(MOST_SPARED);
    let press = |strength: f64| {
        let criterion = criterion.with_chains(chains).with_compressive_strength(strength);
        let one = |sample: &Sample| match use_of_body.at_rest {
            true => crush_at_rest(sample, criterion),
            false => crush(sample, asked, 0.0, criterion, use_of_body.faces),
        };
        let borne = samples.par_iter().map(one).collect::<Result<Vec<f64>, CalibrateError>>()?;
        Ok::<Trial, CalibrateError>(Trial { strength, reached: spread(&borne).0, borne })
    };
    let miss = |tried: &Trial| ln(tried.reached / asked);
    tell(1, None);
    let (mut best, mut slope) = (press(FIRST_TRIAL * asked)?, 1.0);
    let mut last = best.clone();
    for trial in 2..=TRIALS {
        if miss(&best).abs() < CLOSE {
            break;
        }
        tell(trial, Some(last.reached / asked));
        let next = press(last.strength * exp((-miss(&last) / slope).clamp(-0.7, 0.7)))?;
        // Peaks scatter from trial to trial: a slope that few per cent of strength show is none.
        let way = ln(next.strength / last.strength);
        if way.abs() > 0.05 {
            slope = ((miss(&next) - miss(&last)) / way).clamp(0.4, 1.5);
        }
        if miss(&next).abs() < miss(&best).abs() {
            best = next.clone();
        }
        last = next;
    }
    let Trial { strength, reached, ref borne } = best;
    let (pressure, criterion) = (CONFINED * asked, criterion.with_chains(chains).with_compressive_strength(strength));
    let angle = |(sample, alone): (&Sample, &f64)| {
        // σ = σ_c + N p with N = (1 + sin φ)/(1 - sin φ).
        let slope = (crush(sample, asked, pressure, criterion, use_of_body.faces)? - alone) / pressure;
        Ok(asin(((slope - 1.0) / (slope + 1.0)).clamp(0.0, 1.0)))
    };
    let friction_angle = if use_of_body.at_rest {
        None
    } else {
        let angles = samples.par_iter().zip(borne).map(angle).collect::<Result<Vec<f64>, CalibrateError>>()?;
        let (mean, relative) = spread(&angles);
        Some([mean, mean * relative])
    };
    let scatter = spread(borne).1;
    Ok(Crushing { strength, chains, reached, scatter, friction_angle })
}

/// What prisms bear with a strength of the criterion.
#[derive(Clone)]
struct Trial {
    strength: f64,
    reached: f64,
    borne: Vec<f64>,
}

/// What a prism bears at rest [Pa].
fn crush_at_rest(sample: &Sample, criterion: FractureCriterion) -> Result<f64, CalibrateError> {
    let options = FailureOptions::new(Failure::Compression, criterion);
    Ok(lab::break_sample(sample, Failure::Compression, &options)?.strength)
}

/// What a prism bears in motion beside a pressure on its sides [Pa].
fn crush(
    sample: &Sample,
    asked: f64,
    pressure: f64,
    criterion: FractureCriterion,
    faces: CrackFaces,
) -> Result<f64, CalibrateError> {
    let options = FailureOptions { stop: CRUSHED, ..FailureOptions::new(Failure::Compression, criterion) };
    // Strength does not depend on the density where the time is given in transits.
    let (density, of) = (1e3, Some(asked));
    let motion = MotionOptions { density, transits: TRANSITS, of, pressure, start: 0.9, faces, safety: SAFETY };
    Ok(lab::break_in_motion(sample, Failure::Compression, &options, &motion)?.strength)
}

/// Share of the neighbourhoods of a compressed body whose tension across is looked at.
const QUANTILE: f64 = 0.99;
/// Tension across that the criterion spares over that of this quantile, and the most that it spares over the compression. With 1.1
/// and less, prisms at coordination 8.5 and 7.5 shatter at half of their strength in motion, and the slower, the sooner.
const SPARED: f64 = 1.25;
const MOST_SPARED: f64 = 0.5;

/// Tension across over compression along, of nearly all neighbourhoods of a body that is compressed along x and elastic.
fn share_of_chains(sample: &Sample) -> Result<f64, CalibrateError> {
    // The elastic state of tension with the opposite sign.
    let (_, rest) = lab::tension(sample, 0, None, Tolerance::default())?;
    let position = &sample.packing.position;
    let virials = fractum_dem::stress::particle_virials(position.len(), |visit| {
        sample.lattice.bond_forces(&rest.state, |i, j, force| visit(i, j, position[j] - position[i], force));
    });
    // Neighbourhoods by the principal values of their sums: the volume cancels.
    let mut sums: Vec<Sym3> = virials.clone();
    for &[i, j] in &sample.network.pairs {
        sums[i as usize] += virials[j as usize];
        sums[j as usize] += virials[i as usize];
    }
    let deep = 4.0 * sample.mean_radius;
    let (lower, upper) = sample.packing.domain.bounds();
    let middle = |i: &usize| (lower.x + deep..upper.x - deep).contains(&position[*i].x);
    let share = |i: usize| {
        let [along, _, across] = sums[i].principal_values();
        if along > 0.0 { (-across / along).max(0.0) } else { 0.0 }
    };
    let mut shares: Vec<f64> = (0..position.len()).filter(middle).map(share).collect();
    shares.sort_by(f64::total_cmp);
    Ok(shares.get((QUANTILE * (shares.len().max(1) - 1) as f64) as usize).copied().unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{invert, laws};
    use fractum_dem::criterion::{Level, MohrCoulomb};
    use fractum_pack::{Convention, pack};

    /// A prism whose beams suit a Poisson's ratio at a coordination.
    fn prism(poisson: f64, coordination: f64, particles: usize) -> Sample {
        let packing = pack(&PackSpec::new(Domain::cuboid(2e-3, 1e-3, 1e-3), particles, 1)).unwrap();
        let mut sample = Sample::new(packing, coordination, Convention::Interior).unwrap();
        let law = laws::stored(Convention::Interior).unwrap().micro(60e9, poisson, coordination).unwrap();
        let found = invert(&mut sample, 60e9, poisson, law.radius_ratio).unwrap();
        sample.set_micro(found.micro).unwrap();
        sample
    }

    fn granite(strength: f64, chains: f64) -> FractureCriterion {
        FractureCriterion::MohrCoulomb(MohrCoulomb {
            tensile_strength: 13.5e6,
            compressive_strength: strength,
            friction_angle: 35f64.to_radians(),
            chains,
            level: Level::Neighbours,
        })
    }

    #[test]
    fn chains_pull_harder_the_higher_poissons_ratio_at_any_coordination() {
        let bonds = [(0.2, 10.0), (0.2, 8.5), (0.26, 8.5), (0.3, 7.5), (0.3, 8.0)];
        let shares = bonds.map(|(poisson, coordination)| {
            let share = share_of_chains(&prism(poisson, coordination, 1_000)).unwrap();
            println!("Poisson's ratio {poisson}, coordination {coordination}: share of chains {share:.3}");
            share
        });
        let [low, fewer, middle, high, more] = shares;
        assert!((0.05..0.16).contains(&low) && (0.0..0.06).contains(&(fewer - low)), "{shares:?}");
        assert!((0.18..0.3).contains(&middle), "{shares:?}");
        assert!((0.28..0.5).contains(&high) && (more - high).abs() < 0.06, "{shares:?}");
    }

    #[test]
    fn a_prism_bears_its_strength_in_motion_once_its_chains_are_spared() {
        let sample = prism(0.26, 8.5, 1_000);
        let spared = SPARED * share_of_chains(&sample).unwrap();
        let bears = |chains, pressure| {
            crush(&sample, 200e6, pressure, granite(370e6, chains), CrackFaces::default()).unwrap() / 200e6
        };
        let [usual, spared_alone, beside_pressure] =
            [bears(0.2, 0.0), bears(spared, 0.0), bears(spared, CONFINED * 200e6)];
        println!(
            "borne over asked: {usual:.3}, chains spared {spared_alone:.3}, beside a pressure {beside_pressure:.3}"
        );
        assert!(usual < 0.65, "{usual}");
        assert!(spared_alone > 0.85, "{spared_alone}");
        // N of 10 to 50 degrees.
        assert!((0.14..0.76).contains(&(beside_pressure - spared_alone)), "{spared_alone} {beside_pressure}");
    }
}
