//! Sizes of particles by a sieve curve or a law.

use fractum_math::elementary::{exp, ln};

use crate::random::Random;

/// Points of a law that is tabulated.
const POINTS: usize = 200;

/// A distribution of particle diameters, as the shares of the mass that pass through sieves.
#[derive(Clone, Debug, PartialEq)]
pub struct Grading {
    /// Diameters [m], ascending, and the share of the mass below each: from 0 to 1.
    passing: Vec<[f64; 2]>,
    /// Share of the number of particles below each of these diameters.
    number: Vec<f64>,
    /// Mean over the particles of the cube of the diameter [m³], of discs of its square [m²].
    mean_power: f64,
    /// Whether the particles are discs of one thickness, and not spheres.
    of_discs: bool,
}

impl Grading {
    /// Diameters between the sieves of a curve, on which the share of the mass is linear.
    ///
    /// - `passing`: openings [m], > 0 and ascending, with the share of the mass that passes: from 0 to 1, not descending
    pub fn sieves(passing: Vec<[f64; 2]>) -> Self {
        Grading::new(passing, false)
    }

    /// The same shares of the mass, of discs of one thickness.
    pub fn of_discs(self) -> Self {
        Grading::new(self.passing, true)
    }

    fn new(passing: Vec<[f64; 2]>, of_discs: bool) -> Self {
        // Of the mass dM between two diameters there are dM/(π/6 ρ d³) spheres, or dM/(π/4 ρ t d²) discs.
        let count = |pair: &[[f64; 2]]| {
            let ([a, low], [b, high]) = (pair[0], pair[1]);
            if of_discs { (high - low) / (a * b) } else { (high - low) * (a + b) / (2.0 * a * a * b * b) }
        };
        let mut number = vec![0.0];
        for pair in passing.windows(2) {
            number.push(number[number.len() - 1] + count(pair));
        }
        let all = number[number.len() - 1];
        number.iter_mut().for_each(|share| *share /= all);
        // All mass over all particles, both over the same mass.
        Grading { passing, number, mean_power: 1.0 / all, of_discs }
    }

    /// As many particles of every diameter between two [m], which may be one.
    pub fn uniform(smallest: f64, largest: f64) -> Self {
        if smallest == largest {
            return Grading::sieves(vec![[smallest, 0.0], [largest, 1.0]]);
        }
        Grading::tabulated(smallest, largest, |_| 1.0)
    }

    /// The same of discs.
    pub fn uniform_discs(smallest: f64, largest: f64) -> Self {
        if smallest == largest {
            return Grading::uniform(smallest, largest).of_discs();
        }
        Grading::tabulated(smallest, largest, |d| 1.0 / d).of_discs()
    }

    /// Logarithms of the diameters of the mass that are normally distributed, cut off at two diameters [m].
    ///
    /// - `median` [m]; `deviation`: standard deviation of ln d
    pub fn log_normal(median: f64, deviation: f64, smallest: f64, largest: f64) -> Self {
        let mass = |d: f64| {
            let z = ln(d / median) / deviation;
            exp(-0.5 * z * z) / d
        };
        Grading::tabulated(smallest, largest, |d| mass(d) / (d * d * d))
    }

    /// - `number`: particles per diameter, up to a factor
    fn tabulated(smallest: f64, largest: f64, number: impl Fn(f64) -> f64) -> Self {
        let step = ln(largest / smallest) / POINTS as f64;
        let at = |k: usize| if k == POINTS { largest } else { smallest * exp(step * k as f64) };
        let mut passing = vec![[smallest, 0.0]];
        for k in 0..POINTS {
            let (a, b) = (at(k), at(k + 1));
            let mass = |d: f64| number(d) * d * d * d;
            let share = (b - a) / 6.0 * (mass(a) + 4.0 * mass(0.5 * (a + b)) + mass(b));
            passing.push([b, passing[k][1] + share]);
        }
        let all = passing[POINTS][1];
        passing.iter_mut().for_each(|point| point[1] /= all);
        passing[POINTS][1] = 1.0;
        Grading::sieves(passing)
    }

    /// Smallest and largest diameter [m].
    pub fn limits(&self) -> [f64; 2] {
        let below = self.passing.iter().take_while(|point| point[1] == 0.0).last();
        let above = self.passing.iter().find(|point| point[1] >= 1.0);
        [below.map_or(self.passing[0][0], |p| p[0]), above.map_or(self.passing[self.passing.len() - 1][0], |p| p[0])]
    }

    /// Mean volume of a sphere [m³], or area of a disc [m²].
    pub fn mean_volume(&self) -> f64 {
        std::f64::consts::PI * self.mean_power / if self.of_discs { 4.0 } else { 6.0 }
    }

    /// Diameter below which this share of the mass lies [m].
    pub fn at(&self, share: f64) -> f64 {
        let next = self.passing.partition_point(|point| point[1] < share).clamp(1, self.passing.len() - 1);
        let ([a, low], [b, high]) = (self.passing[next - 1], self.passing[next]);
        if high > low { a + (b - a) * ((share - low) / (high - low)).clamp(0.0, 1.0) } else { b }
    }

    /// Share of the mass below a diameter [m].
    pub fn share(&self, diameter: f64) -> f64 {
        let next = self.passing.partition_point(|point| point[0] < diameter);
        match next {
            0 => 0.0,
            next if next == self.passing.len() => 1.0,
            next => {
                let ([a, low], [b, high]) = (self.passing[next - 1], self.passing[next]);
                low + (high - low) * (diameter - a) / (b - a)
            }
        }
    }

    /// Diameter below which this share of the particles lies [m].
    pub(crate) fn at_number(&self, share: f64) -> f64 {
        let next = self.number.partition_point(|own| *own <= share).clamp(1, self.number.len() - 1);
        let (low, high) = (self.number[next - 1], self.number[next]);
        let part = if high > low { (share - low) / (high - low) } else { 1.0 };
        // The number of spheres grows with 1/a² − 1/d² where the mass grows in proportion to d, that of discs with 1/a − 1/d.
        let [a, b] = [self.passing[next - 1][0], self.passing[next][0]];
        if self.of_discs {
            return (1.0 / (1.0 / a + part * (1.0 / b - 1.0 / a))).clamp(a, b);
        }
        let inverse = 1.0 / (a * a) + part * (1.0 / (b * b) - 1.0 / (a * a));
        (1.0 / inverse.sqrt()).clamp(a, b)
    }

    /// Diameters of so many particles [m], largest first: one by chance of each of as many equal shares of the number.
    pub fn draw(&self, count: usize, seed: u64) -> Vec<f64> {
        let mut random = Random::new(seed);
        let mut diameters: Vec<f64> =
            (0..count).map(|k| self.at_number((k as f64 + random.uniform()) / count as f64)).collect();
        diameters.reverse();
        diameters
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest difference of the share of the mass below a diameter from what was asked.
    fn off(grading: &Grading, diameters: &[f64], power: i32) -> f64 {
        let mut sorted = diameters.to_vec();
        sorted.sort_by(f64::total_cmp);
        let all: f64 = sorted.iter().map(|d| d.powi(power)).sum();
        let mut below = 0.0;
        let mut worst = 0.0f64;
        for d in sorted {
            worst = worst.max((below / all - grading.share(d)).abs());
            below += d.powi(power);
            worst = worst.max((below / all - grading.share(d)).abs());
        }
        worst
    }

    #[test]
    fn what_is_drawn_has_the_curve_that_was_asked_for() {
        let sieves = Grading::sieves(vec![[0.5e-3, 0.0], [1e-3, 0.3], [2e-3, 0.7], [4e-3, 1.0]]);
        let log_normal = Grading::log_normal(1e-3, 0.3, 0.4e-3, 2.5e-3);
        let discs = [sieves.clone().of_discs(), Grading::uniform_discs(1e-3, 3e-3), log_normal.clone().of_discs()];
        let spheres = [sieves, Grading::uniform(1e-3, 3e-3), log_normal];
        for (grading, power) in spheres.into_iter().map(|own| (own, 3)).chain(discs.into_iter().map(|own| (own, 2))) {
            for seed in 1..4 {
                for count in [500, 5000] {
                    let diameters = grading.draw(count, seed);
                    let powers: f64 = diameters.iter().map(|d| d.powi(power)).sum();
                    // The largest particle is a step of the curve.
                    let step = diameters[0].powi(power) / powers;
                    let worst = off(&grading, &diameters, power);
                    assert!(worst < 1.5 * step, "{count} {seed}: {worst} for {step}");
                    let mean = powers / count as f64;
                    assert!((mean / grading.mean_power - 1.0).abs() < 1.5 * step, "{mean}");
                }
            }
        }
    }

    #[test]
    fn laws_have_their_moments() {
        let uniform = Grading::uniform(1.0, 3.0);
        // The mean of d³ between 1 and 3 is 10.
        assert!((uniform.mean_power / 10.0 - 1.0).abs() < 1e-3, "{}", uniform.mean_power);
        // That of d² is 13/3, and as many discs of every diameter are there.
        let discs = Grading::uniform_discs(1.0, 3.0);
        assert!((discs.mean_power * 3.0 / 13.0 - 1.0).abs() < 1e-3, "{}", discs.mean_power);
        assert!((discs.at_number(0.5) - 2.0).abs() < 1e-2);
        let log_normal = Grading::log_normal(1.0, 0.3, 0.1, 10.0);
        assert!((log_normal.at(0.5) - 1.0).abs() < 1e-3);
        // One standard deviation above the median.
        assert!((log_normal.share(0.3f64.exp()) - 0.841_345).abs() < 1e-3);
        assert!((log_normal.at(log_normal.share(1.2)) - 1.2).abs() < 1e-9);
        assert_eq!(Grading::sieves(vec![[1.0, 0.0], [2.0, 0.0], [3.0, 1.0], [4.0, 1.0]]).limits(), [2.0, 3.0]);
    }
}
