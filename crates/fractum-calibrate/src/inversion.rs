//! Calibration on the packing at hand: ν fixes the beam radius, then E scales their modulus.

use fractum_dem::{Equilibrium, Tolerance};
use fractum_math::elementary::{exp, ln};

use crate::{CalibrateError, Micro, Sample, lab};

/// Micro-parameters found on a sample, and what they give there.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Inverted {
    /// The micro-parameters.
    pub micro: Micro,
    /// E, mean over the axes tested (the long ones of a box, x of a cylinder) [Pa].
    pub young_modulus: f64,
    /// ν, mean over the axes.
    pub poisson_ratio: f64,
    /// Relative spread (largest minus smallest) of E over the axes.
    pub anisotropy: f64,
    /// Solves used.
    pub solves: usize,
}

/// Beam radii searched, in mean radii.
pub const RADIUS_RATIOS: [f64; 2] = [0.05, 1.2];
/// Axes above this share of the longest one are tested.
const LONG: f64 = 0.75;
/// Difference of ν at which the search stops.
const CLOSE: f64 = 1e-4;
/// Steps of the search, at most.
const ITERATIONS: usize = 30;

/// Finds the beam radius and modulus that give a sample Young's modulus and Poisson's ratio, by a safeguarded secant
/// search on ν(ln r_m) with warm-started solves. On a box, the result is for the mean over the axes along which it is
/// long: a short one shows the layers at its faces rather than the material.
///
/// - `start`: beam radius over the mean radius to begin with
///
/// # Errors
/// An impossible material; a Poisson's ratio out of reach, with the reachable range; a solve that does not converge.
pub fn invert(
    sample: &mut Sample,
    young_modulus: f64,
    poisson_ratio: f64,
    start: f64,
) -> Result<Inverted, CalibrateError> {
    check_material(young_modulus, poisson_ratio)?;
    let axes = tested_axes(sample);
    let tolerance = Tolerance::default();
    let mut warm: [Option<Equilibrium>; 6] = Default::default();
    let mut solves = 0;
    let mut test = |sample: &mut Sample, log: f64, axes: &[usize]| -> Result<(f64, f64, f64), CalibrateError> {
        sample.set_micro(Micro { radius_ratio: exp(log), young_modulus: 1.0 })?;
        let (mut young, mut poisson) = (Vec::new(), 0.0);
        if sample.packing.domain.period().is_some() {
            let found = lab::uniaxial(&lab::stiffness(sample, 3, &mut warm, tolerance)?);
            for &axis in axes {
                young.push(found[axis].0);
                poisson += found[axis].1 / axes.len() as f64;
            }
            solves += 3;
        } else {
            for &axis in axes {
                let (tension, rest) = lab::tension(sample, axis, warm[axis].as_ref(), tolerance)?;
                warm[axis] = Some(rest);
                young.push(tension.young_modulus);
                poisson += tension.poisson_ratio / axes.len() as f64;
                solves += 1;
            }
        }
        let mean = young.iter().sum::<f64>() / axes.len() as f64;
        let (low, high) = young.iter().fold((f64::INFINITY, 0.0f64), |(l, h), &y| (l.min(y), h.max(y)));
        Ok((mean, poisson, (high - low) / mean))
    };
    let [thin, thick] = RADIUS_RATIOS.map(ln);
    let mut search = RadiusSearch::default();
    let mut log = ln(start.clamp(RADIUS_RATIOS[0], RADIUS_RATIOS[1]));
    for _ in 0..ITERATIONS {
        let (young, poisson, anisotropy) = test(sample, log, &axes)?;
        let miss = poisson - poisson_ratio;
        if miss.abs() < CLOSE {
            let micro = Micro { radius_ratio: exp(log), young_modulus: young_modulus / young };
            sample.set_micro(micro)?;
            return Ok(Inverted { micro, young_modulus, poisson_ratio: poisson, anisotropy, solves });
        }
        let next = search.next(log, poisson, miss);
        if next == log {
            // At an end of the range with the target beyond it.
            let other = if log == thin { thick } else { thin };
            let (_, beyond, _) = test(sample, other, &axes[..1])?;
            return Err(out_of_reach(sample, poisson_ratio, [poisson.min(beyond), poisson.max(beyond)]));
        }
        log = next;
    }
    let last = search.last.map_or(f64::NAN, |(_, poisson)| poisson);
    Err(out_of_reach(sample, poisson_ratio, [last, last]))
}

/// Secant search for the logarithm of the beam radius, with which ν falls, kept between the points that bracket the target.
struct RadiusSearch {
    /// ln r of the last points with a larger and with a smaller ν than the target.
    above: Option<f64>,
    below: Option<f64>,
    /// (ln r, ν) of the last point.
    last: Option<(f64, f64)>,
    /// dν/d(ln r), negative.
    slope: f64,
}

impl Default for RadiusSearch {
    fn default() -> Self {
        RadiusSearch { above: None, below: None, last: None, slope: -0.1 }
    }
}

impl RadiusSearch {
    /// Where to look after a point that misses the target by `miss`.
    fn next(&mut self, log: f64, poisson: f64, miss: f64) -> f64 {
        if let Some((before, then)) = self.last.filter(|last| last.0 != log) {
            let measured = (poisson - then) / (log - before);
            self.slope = if measured < -1e-3 { measured } else { self.slope };
        }
        self.last = Some((log, poisson));
        *(if miss > 0.0 { &mut self.above } else { &mut self.below }) = Some(log);
        let [thin, thick] = RADIUS_RATIOS.map(ln);
        let next = (log - miss / self.slope).clamp(log - 0.7, log + 0.7).clamp(thin, thick);
        match (self.above, self.below) {
            (Some(a), Some(b)) if next <= a || next >= b => 0.5 * (a + b),
            _ => next,
        }
    }
}

/// The error for a Poisson's ratio that the packing cannot have.
fn out_of_reach(sample: &Sample, asked: f64, [lowest, highest]: [f64; 2]) -> CalibrateError {
    let [thin, thick] = RADIUS_RATIOS;
    let (coordination, convention) = (coordination_of(sample), sample.convention);
    CalibrateError::PoissonRange { asked, coordination, convention, thin, thick, lowest, highest }
}

/// Axes of a box along which it is about as long as it gets, x of a cylinder, all of a box without walls.
fn tested_axes(sample: &Sample) -> Vec<usize> {
    if sample.packing.domain.period().is_some() {
        return vec![0, 1, 2];
    }
    let Some(extents) = sample.box_extents() else { return vec![0] };
    (0..3).filter(|&axis| extents[axis] > LONG * extents.max()).collect()
}

fn coordination_of(sample: &Sample) -> f64 {
    match sample.convention {
        fractum_pack::Convention::All => sample.network.coordination_all,
        fractum_pack::Convention::Interior => sample.network.coordination_interior,
    }
}

/// Refuses what is no isotropic elastic material.
pub(crate) fn check_material(young_modulus: f64, poisson_ratio: f64) -> Result<(), CalibrateError> {
    if !(young_modulus.is_finite() && young_modulus > 0.0) {
        return Err(CalibrateError::Material {
            what: "Young's modulus",
            value: young_modulus,
            expected: "a positive number of pascals",
        });
    }
    if !(poisson_ratio > -1.0 && poisson_ratio < 0.5) {
        return Err(CalibrateError::Material {
            what: "Poisson's ratio",
            value: poisson_ratio,
            expected: "between -1 and 0.5",
        });
    }
    Ok(())
}
