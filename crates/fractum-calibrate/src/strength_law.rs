//! The law k(r_m, cn) = σ_M/σ_m of the principal criterion, fitted to virtual tension tests of our own packings.

use fractum_math::elementary::{exp, ln, pow};
use std::fmt::Write as _;

use fractum_pack::{Convention, Domain, PackSpec, pack};
use rayon::prelude::*;

use crate::laws::{least_squares, products};
use crate::pull::{StrengthCriterion, pull};
use crate::{CalibrateError, Micro, Sample};

/// What a strength is read off from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reading {
    /// The largest load.
    Peak,
    /// The first broken bond.
    FirstBreak,
}

/// Both readings, in the order of [`Point::ratio`].
pub const READINGS: [Reading; 2] = [Reading::Peak, Reading::FirstBreak];

/// One virtual tension test to failure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Seed of the packing.
    pub seed: u64,
    /// Its particles.
    pub particles: usize,
    /// Coordination, convention `all`.
    pub coordination: f64,
    /// Beam radius over the mean radius.
    pub radius_ratio: f64,
    /// Strength over that of the criterion, by [`READINGS`].
    pub ratio: [f64; 2],
}

/// The tests of a survey: every combination.
#[derive(Clone, Debug)]
pub struct Survey {
    /// Particles per packing.
    pub particles: Vec<usize>,
    /// Seeds.
    pub seeds: Vec<u64>,
    /// Coordinations, convention `all`.
    pub coordinations: Vec<f64>,
    /// Beam radii over the mean radius.
    pub radius_ratios: Vec<f64>,
}

impl Survey {
    /// What the law is fitted to.
    pub fn fitted() -> Self {
        Survey {
            particles: vec![1_000, 4_000],
            seeds: vec![201, 202],
            coordinations: vec![6.0, 7.5, 9.0, 11.0, 13.0],
            radius_ratios: vec![0.2, 0.3, 0.45, 0.68, 1.0],
        }
    }

    /// Another packing at other places of the ranges, to hold the law and eq. (22) against.
    pub fn check() -> Self {
        Survey {
            particles: vec![4_000],
            seeds: vec![203],
            coordinations: vec![6.5, 8.0, 10.0, 12.0],
            radius_ratios: vec![0.25, 0.37, 0.55, 0.8],
        }
    }
}

/// Breaks boxes in tension; results in a fixed order.
///
/// # Errors
/// Packing, bonding or solving.
pub fn survey(survey: &Survey) -> Result<Vec<Point>, CalibrateError> {
    let mut jobs = Vec::new();
    for &particles in &survey.particles {
        for &seed in &survey.seeds {
            let packing = pack(&PackSpec::new(Domain::cuboid(1e-3, 1e-3, 1e-3), particles, seed))?;
            jobs.extend(survey.coordinations.iter().map(|&coordination| (packing.clone(), coordination)));
        }
    }
    let series = |(packing, coordination): &(fractum_pack::Packing, f64)| {
        let mut sample = Sample::new(packing.clone(), *coordination, Convention::All)?;
        let mut points = Vec::new();
        for &radius_ratio in &survey.radius_ratios {
            // Neither the modulus nor the strength matters to the ratio of strengths.
            sample.set_micro(Micro { radius_ratio, young_modulus: 1e9 })?;
            let broken = pull(&sample, 1e6, StrengthCriterion::Principal.with(1e6))?;
            let ratio = [broken.strength, broken.first_break.unwrap_or(f64::NAN)].map(|strength| strength / 1e6);
            let (seed, particles) = (packing.seed, packing.len());
            points.push(Point { seed, particles, coordination: *coordination, radius_ratio, ratio });
        }
        Ok(points)
    };
    let results: Vec<Result<Vec<Point>, CalibrateError>> = jobs.par_iter().map(series).collect();
    let mut points = Vec::new();
    for result in results {
        points.extend(result?);
    }
    Ok(points)
}

/// Degrees of the fit in ln r_m and cn.
const DEGREE: (usize, usize) = (2, 3);
/// Coefficients of a reading.
const TERMS: usize = (DEGREE.0 + 1) * (DEGREE.1 + 1) + 1;

/// ln k = Σ c_ij T_i(s) T_j(t) + c n^(−1/3): s from ln r_m, t from cn, each mapped to [−1, 1] over its range, n particles.
#[derive(Clone, Debug, PartialEq)]
pub struct StrengthLaw {
    /// Range of coordinations.
    pub coordination: [f64; 2],
    /// Range of beam radii over the mean radius.
    pub radius_ratio: [f64; 2],
    /// Coefficients by [`READINGS`], j running fast, that of the size last.
    pub coefficients: [Vec<f64>; 2],
}

impl StrengthLaw {
    /// Fits both readings by least squares.
    ///
    /// # Errors
    /// [`CalibrateError::LawTable`] for fewer tests than twice the coefficients.
    pub fn fit(points: &[Point]) -> Result<Self, CalibrateError> {
        if points.len() < 2 * TERMS {
            let what = format!("{} tests; at least {} are needed", points.len(), 2 * TERMS);
            return Err(CalibrateError::LawTable { line: 0, what });
        }
        let range = |f: &dyn Fn(&Point) -> f64| {
            points.iter().map(f).fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], x| [l.min(x), h.max(x)])
        };
        let mut law = StrengthLaw {
            coordination: range(&|p| p.coordination),
            radius_ratio: range(&|p| p.radius_ratio),
            coefficients: [Vec::new(), Vec::new()],
        };
        let rows: Vec<Vec<f64>> =
            points.iter().map(|p| law.terms(p.radius_ratio, p.coordination, p.particles)).collect();
        let right = [0, 1].map(|k| points.iter().map(|p| ln(p.ratio[k])).collect());
        law.coefficients = least_squares(&rows, right)?;
        Ok(law)
    }

    fn terms(&self, radius_ratio: f64, coordination: f64, particles: usize) -> Vec<f64> {
        let mut terms = products(DEGREE, (radius_ratio, self.radius_ratio), (coordination, self.coordination));
        terms.push(pow(particles as f64, -1.0 / 3.0));
        terms
    }

    /// Whether a beam radius and a coordination lie within the ranges of the law.
    pub fn covers(&self, radius_ratio: f64, coordination: f64) -> bool {
        let within = |x: f64, [low, high]: [f64; 2]| (low..=high).contains(&x);
        within(radius_ratio, self.radius_ratio) && within(coordination, self.coordination)
    }

    /// k for a beam radius, a coordination (`all`) and a number of particles, within the ranges of the law.
    pub fn ratio(&self, reading: Reading, radius_ratio: f64, coordination: f64, particles: usize) -> f64 {
        let terms = self.terms(radius_ratio, coordination, particles);
        exp(terms.iter().zip(&self.coefficients[reading as usize]).map(|(t, c)| t * c).sum())
    }
}

/// Root mean square and largest of the relative differences of a law from tests.
pub fn difference(points: &[Point], reading: Reading, law: impl Fn(&Point) -> f64) -> [f64; 2] {
    let relative = |p: &Point| law(p) / p.ratio[reading as usize] - 1.0;
    let square: f64 = points.iter().map(|p| relative(p).powi(2)).sum();
    let largest = points.iter().map(|p| relative(p).abs()).fold(0.0, f64::max);
    [(square / points.len() as f64).sqrt(), largest]
}

/// Relative scatter of a reading between packings that differ in their seed only: the root mean square over all places
/// with two packings or more.
pub fn scatter(points: &[Point], reading: Reading) -> f64 {
    let alike = |a: &Point, b: &Point| {
        (a.particles, a.coordination, a.radius_ratio) == (b.particles, b.coordination, b.radius_ratio)
    };
    let (mut square, mut freedom) = (0.0, 0usize);
    for (i, p) in points.iter().enumerate().filter(|(i, p)| !points[..*i].iter().any(|q| alike(p, q))) {
        let group: Vec<f64> = points[i..].iter().filter(|q| alike(p, q)).map(|q| q.ratio[reading as usize]).collect();
        let mean = group.iter().sum::<f64>() / group.len() as f64;
        square += group.iter().map(|k| (k / mean - 1.0).powi(2)).sum::<f64>();
        freedom += group.len() - 1;
    }
    (square / freedom.max(1) as f64).sqrt()
}

/// Tests as CSV.
pub fn write_tests(points: &[Point]) -> String {
    let mut text = String::from("seed,particles,coordination,radius_ratio,peak,first_break\n");
    for Point { seed, particles, coordination, radius_ratio, ratio: [peak, first] } in points {
        // Writing into a string has no way to fail.
        let _ = writeln!(text, "{seed},{particles},{coordination},{radius_ratio},{peak:.6},{first:.6}");
    }
    text
}

/// The law shipped with the program.
///
/// # Errors
/// [`CalibrateError::LawTable`] if the stored table is damaged.
pub fn stored() -> Result<StrengthLaw, CalibrateError> {
    read(include_str!("../laws/strength.csv"))
}

/// Reads what [`write_law`] wrote.
///
/// # Errors
/// [`CalibrateError::LawTable`] with the line.
pub fn read(text: &str) -> Result<StrengthLaw, CalibrateError> {
    let mut law = StrengthLaw { coordination: [0.0; 2], radius_ratio: [0.0; 2], coefficients: Default::default() };
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.starts_with('#')) {
        let bad = |what: &str| CalibrateError::LawTable { line: number + 1, what: what.into() };
        let (name, rest) = line.split_once(',').ok_or_else(|| bad("expected a name and numbers"))?;
        let values: Option<Vec<f64>> =
            rest.split(',').map(|word| word.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect();
        let values = values.ok_or_else(|| bad("expected numbers"))?;
        match (name, &values[..]) {
            ("range", &[c0, c1, r0, r1]) => (law.coordination, law.radius_ratio) = ([c0, c1], [r0, r1]),
            ("peak", list) if list.len() == TERMS => law.coefficients[0] = values,
            ("first_break", list) if list.len() == TERMS => law.coefficients[1] = values,
            _ => return Err(bad("unknown name, or wrong number of numbers")),
        }
    }
    let complete = law.coefficients.iter().all(|list| !list.is_empty()) && law.radius_ratio[0] > 0.0;
    let what = "ranges or coefficients are missing".into();
    if complete { Ok(law) } else { Err(CalibrateError::LawTable { line: text.lines().count(), what }) }
}

/// The law as CSV: its ranges, and a line per reading.
pub fn write_law(law: &StrengthLaw) -> String {
    let ([c0, c1], [r0, r1]) = (law.coordination, law.radius_ratio);
    let mut text = format!(
        "# ln k = sum c_ij T_i(s) T_j(t) + c n^(-1/3); s from ln r, t from cn (all), each mapped to [-1, 1] over its range\n\
         # degrees {} in s and {} in t, j running fast, c last; made by `fractum calibrate --refit-strength`\n\
         # range,cn from,cn to,r from,r to\nrange,{c0},{c1},{r0},{r1}\n",
        DEGREE.0, DEGREE.1
    );
    for (name, values) in ["peak", "first_break"].iter().zip(&law.coefficients) {
        let values: Vec<String> = values.iter().map(|v| format!("{v:.9e}")).collect();
        let _ = writeln!(text, "{name},{}", values.join(","));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tests with a known k and a known scatter of the packings.
    fn drawn() -> Vec<Point> {
        let mut points = Vec::new();
        for (coordination, radius_ratio) in (0..60).map(|i| (6.0 + f64::from(i % 6), 0.2 + 0.08 * f64::from(i / 6))) {
            for (particles, seed) in [(1_000, 1), (1_000, 2), (8_000, 1), (8_000, 2)] {
                let size = 1.0 - 0.5 * (particles as f64).powf(-1.0 / 3.0);
                let k = (0.5 + 0.03 * coordination) * (1.0 - 0.2 * radius_ratio) * size;
                let k = k * if seed == 1 { 1.01 } else { 0.99 };
                points.push(Point { seed, particles, coordination, radius_ratio, ratio: [k, 0.9 * k] });
            }
        }
        points
    }

    #[test]
    fn a_smooth_law_is_found_with_its_scatter() {
        let points = drawn();
        let law = StrengthLaw::fit(&points).unwrap();
        for reading in READINGS {
            let [rms, most] =
                difference(&points, reading, |p| law.ratio(reading, p.radius_ratio, p.coordination, p.particles));
            assert!(rms < 0.011 && most < 0.015, "{rms} {most}");
            // Two of a pair at ± 1 %.
            assert!((scatter(&points, reading) - 0.01 * 2f64.sqrt()).abs() < 1e-3);
        }
        let k = (0.5 + 0.03 * 8.5) * (1.0 - 0.2 * 0.4) * (1.0 - 0.5 / 20.0);
        assert!((law.ratio(Reading::Peak, 0.4, 8.5, 8_000) / k - 1.0).abs() < 5e-3);
        let text = write_law(&law);
        let back = read(&text).unwrap();
        assert!(back.covers(0.4, 8.5) && !back.covers(0.1, 8.5) && !back.covers(0.4, 12.0));
        let k = law.ratio(Reading::FirstBreak, 0.4, 8.5, 500);
        assert!((back.ratio(Reading::FirstBreak, 0.4, 8.5, 500) / k - 1.0).abs() < 1e-8);
        assert!(read(&text.replace("peak,", "pick,")).is_err() && read(&text[..text.len() / 2]).is_err());
        assert!(read("range,6,13,0.2,1\n").is_err());
        assert_eq!(write_tests(&points).lines().count(), points.len() + 1);
    }

    #[test]
    fn the_stored_law_holds_for_tests_that_it_was_not_fitted_to() {
        // Packing 203 of 4,000 particles, from `fractum calibrate --refit-strength`: cn, r_m, k for the load peak. The fit is
        // within 2.4 % of all sixteen, eq. (22) within 6.7 %.
        let law = stored().unwrap();
        for (coordination, radius_ratio, k) in [
            (6.5, 0.25, 0.614833),
            (6.5, 0.8, 0.743725),
            (8.0, 0.55, 0.780309),
            (10.0, 0.37, 0.814595),
            (12.0, 0.25, 0.836756),
            (12.0, 0.8, 0.840438),
        ] {
            let fit = law.ratio(Reading::Peak, radius_ratio, coordination, 4_000);
            assert!((fit / k - 1.0).abs() < 0.025, "cn {coordination}, r_m {radius_ratio}: {fit} against {k}");
        }
    }

    #[test]
    fn too_few_tests_are_refused() {
        assert!(matches!(StrengthLaw::fit(&drawn()[..20]), Err(CalibrateError::LawTable { .. })));
    }
}
