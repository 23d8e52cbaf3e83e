//! Flaws in space: a Poisson process that is a function of place and seed, whatever asks for it.
//!
//! Space is a grid of cubes (squares in the plane), each halved along every axis again and again. A cube draws the weakest
//! flaw that none of those around it has drawn, uniform in its place, and leaves the stronger ones to its parts: the
//! number of flaws below a level in any region is Poisson's, and regions without a common point are independent.

use fractum_math::Vec3;
use fractum_math::elementary::{cbrt, ln, pow};
use rand::SeedableRng;
use rand_distr::{Distribution as _, OpenClosed01};
use rand_pcg::Pcg64Mcg;

/// Side of the largest cubes over that of one with a flaw below level 1.
const LARGEST: f64 = 256.0;

/// Expected number of flaws within reach of a point among those that are kept: one point in e⁶ has none, and the strength of the last one.
pub(super) const KEPT: f64 = 6.0;

/// Ratio and number of the steps in which flaws are counted over their levels.
const STEP: f64 = 1.1;
const STEPS: usize = 440;

/// A weak place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Flaw {
    /// Where [m].
    pub(super) place: Vec3,
    /// Expected number of weaker flaws in the reference volume or area [-].
    pub(super) level: f64,
}

impl Flaw {
    /// Place and level.
    pub(super) fn numbers(&self) -> [f64; 4] {
        [self.place.x, self.place.y, self.place.z, self.level]
    }
}

/// How far from a flaw edges are as weak as it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    /// Of a flaw of level 1, that of the strength given [m].
    pub(super) radius: f64,
    /// It goes with the level to this power: 0 where it is the same for all.
    power: f64,
}

impl Reach {
    /// Half of a correlation length given for all flaws.
    pub(super) fn of_length(length: f64) -> Self {
        Reach { radius: 0.5 * length, power: 0.0 }
    }

    /// That of cracks which Griffith's criterion lets run at the strength of the flaw: with one over the strength squared.
    pub(super) fn of_crack(diameter: f64, modulus: f64) -> Self {
        Reach { radius: 0.5 * diameter, power: -2.0 / modulus }
    }

    /// Of a flaw [m].
    pub(super) fn at(&self, level: f64) -> f64 {
        if self.power == 0.0 { self.radius } else { self.radius * pow(level, self.power) }
    }

    /// The level up to which flaws are kept, so that [`KEPT`] reach a point on average.
    ///
    /// - `spot`: volume or area that a flaw of this radius weakens, over the reference; `least`: and at least
    pub(super) fn level_kept(&self, spot: impl Fn(f64) -> f64, least: f64, most: f64) -> f64 {
        // Smaller spots need more flaws; elements bound it.
        let next = |level: f64| KEPT / spot(self.at(level)).max(least).min(most);
        (0..60).fold(KEPT / spot(self.radius).max(least).min(most), |level, _| next(level).max(level))
    }

    /// How many flaws up to a level reach a point on average.
    ///
    /// - `spot`, `least`, `most`: as those of [`level_kept`](Self::level_kept)
    pub(super) fn expected(&self, level: f64, spot: impl Fn(f64) -> f64, least: f64, most: f64) -> f64 {
        // Steps of a tenth downwards, over 18 decades.
        let mut upper = level;
        let of_step = |_| {
            let lower = upper / STEP;
            let middle = (lower * upper).sqrt();
            let found = (upper - lower) * spot(self.at(middle)).max(least).min(most);
            upper = lower;
            found
        };
        (0..STEPS).map(of_step).sum()
    }
}

/// A Poisson process of flaws.
#[derive(Clone, Copy, Debug)]
pub(super) struct FlawField {
    seed: u64,
    /// Axes along which it extends: 2 in the plane.
    axes: usize,
    /// Flaws per volume (area in the plane) and level [1/m³], [1/m²].
    density: f64,
    /// Side of the largest cubes [m].
    side: f64,
}

/// An axis-aligned box [m].
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Bounds {
    pub(super) fn of(points: &[Vec3]) -> Self {
        let first = points[0];
        let wider = |bounds: Bounds, p: &Vec3| Bounds { low: bounds.low.inf(p), high: bounds.high.sup(p) };
        points.iter().fold(Bounds { low: first, high: first }, wider)
    }
}

/// A cube of the process: its place among those of its size, and the level below which its flaws are drawn already.
#[derive(Clone, Copy)]
struct Cube {
    depth: u32,
    index: [i64; 3],
    side: f64,
    level: f64,
}

impl FlawField {
    /// - `density`: flaws per volume (area in the plane) and level [1/m³], [1/m²], > 0
    pub(super) fn new(seed: u64, axes: usize, density: f64) -> Self {
        let side = if axes == 2 { density.sqrt() } else { cbrt(density) }.recip();
        FlawField { seed, axes, density, side: LARGEST * side }
    }

    /// Sees the flaws below a level within some bounds.
    pub(super) fn each_below(&self, bounds: &Bounds, level: f64, see: &mut impl FnMut(Flaw)) {
        let cell = |x: f64| (x / self.side).floor() as i64;
        let range = |axis: usize| {
            if axis < self.axes { cell(bounds.low[axis])..=cell(bounds.high[axis]) } else { 0..=0 }
        };
        for i in range(0) {
            for j in range(1) {
                for k in range(2) {
                    let cube = Cube { depth: 0, index: [i, j, k], side: self.side, level: 0.0 };
                    self.look(cube, bounds, level, see);
                }
            }
        }
    }

    fn look(&self, cube: Cube, bounds: &Bounds, limit: f64, see: &mut impl FnMut(Flaw)) {
        let Cube { depth, index, side, level } = cube;
        let mut generator = self.generator(depth, index);
        let mut draw = || -> f64 { OpenClosed01.sample(&mut generator) };
        let level = level - ln(draw()) / (self.density * side.powi(self.axes as i32));
        if level >= limit {
            return;
        }
        let mut place = Vec3::zeros();
        for axis in 0..self.axes {
            place[axis] = (index[axis] as f64 + draw()) * side;
        }
        let within = |axis: usize| place[axis] >= bounds.low[axis] && place[axis] <= bounds.high[axis];
        if (0..self.axes).all(within) {
            see(Flaw { place, level });
        }
        let half = 0.5 * side;
        for part in 0..1i64 << self.axes {
            let index = std::array::from_fn(|axis| 2 * index[axis] + (part >> axis & 1));
            let meets = |axis: usize| {
                let low = index[axis] as f64 * half;
                low <= bounds.high[axis] && low + half >= bounds.low[axis]
            };
            if (0..self.axes).all(meets) {
                self.look(Cube { depth: depth + 1, index, side: half, level }, bounds, limit, see);
            }
        }
    }

    /// Every cube has its own stream.
    fn generator(&self, depth: u32, index: [i64; 3]) -> Pcg64Mcg {
        // The finaliser of SplitMix64 (Steele, Lea and Flood 2014).
        let mixed = |hash: u64, word: u64| {
            let mut z = (hash ^ word).wrapping_add(0x9e37_79b9_7f4a_7c15);
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        };
        let hash = index.iter().fold(mixed(self.seed, u64::from(depth)), |hash, &i| mixed(hash, i as u64));
        Pcg64Mcg::seed_from_u64(hash)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Flaws below a level in a box, of one seed after the other.
    fn fields(axes: usize, low: Vec3, side: f64, level: f64) -> impl Iterator<Item = Vec<Flaw>> {
        let bounds = Bounds { low, high: low + Vec3::repeat(side) };
        (0..4000).map(move |seed| {
            let mut found = Vec::new();
            FlawField::new(seed, axes, 2.0).each_below(&bounds, level, &mut |flaw| found.push(flaw));
            found
        })
    }

    #[test]
    fn numbers_of_flaws_are_poissons_wherever_the_box_lies() {
        for (axes, expected) in [(2, 0.5 * 0.5 * 2.0 * 8.0), (3, 0.5f64.powi(3) * 2.0 * 8.0)] {
            for low in [Vec3::zeros(), Vec3::new(-0.2, -130.1, 63.9), Vec3::new(4.5e5, 5.1e6, -2e3)] {
                let (mut sum, mut squares) = (0.0, 0.0);
                fields(axes, low, 0.5, 8.0).for_each(|found| {
                    sum += found.len() as f64;
                    squares += (found.len() as f64 - expected).powi(2);
                });
                let (mean, variance) = (sum / 4000.0, squares / 4000.0);
                assert!((mean / expected - 1.0).abs() < 3.5 / (4000.0 * expected).sqrt(), "{axes}, {low}: {mean}");
                let error = (2.0f64 + 1.0 / expected).sqrt() / 4000f64.sqrt();
                assert!((variance / expected - 1.0).abs() < 3.5 * error, "{axes}, {low}: {variance} for {expected}");
            }
        }
    }

    #[test]
    fn the_weakest_flaw_has_an_exponential_level_and_any_place() {
        let low = Vec3::new(12.3, -7.0, 2.0);
        let (mut levels, mut middle, mut count) = (0.0, Vec3::zeros(), 0.0);
        for found in fields(3, low, 0.8, 20.0) {
            let weakest = found.iter().min_by(|a, b| a.level.total_cmp(&b.level)).expect("20 flaws on average");
            levels += weakest.level;
            middle += (weakest.place - low) / 0.8;
            count += 1.0;
        }
        let expected = 1.0 / (2.0 * 0.8f64.powi(3));
        assert!((levels / count / expected - 1.0).abs() < 3.5 / f64::sqrt(count), "{}", levels / count);
        assert!((middle / count - Vec3::repeat(0.5)).amax() < 3.5 * (1.0 / 12.0 / count).sqrt(), "{middle}");
    }

    #[test]
    fn parts_of_a_box_have_its_flaws() {
        let field = FlawField::new(7, 3, 2.0);
        let in_box = |low: Vec3, high: Vec3, level: f64| {
            let mut found = Vec::new();
            field.each_below(&Bounds { low, high }, level, &mut |flaw| found.push(flaw.numbers()));
            found.sort_by(|a, b| a.partial_cmp(b).unwrap());
            found
        };
        let (low, high, cut) = (Vec3::new(-3.0, 1.0, 700.0), Vec3::new(2.0, 4.0, 703.0), -0.37);
        let whole = in_box(low, high, 5.0);
        let mut parts = in_box(low, Vec3::new(cut, high.y, high.z), 5.0);
        parts.extend(in_box(Vec3::new(cut, low.y, low.z), high, 5.0));
        parts.sort_by(|a, b| a.partial_cmp(b).unwrap());
        assert!(whole.len() > 300 && whole == parts);
        let weak: Vec<_> = whole.iter().copied().filter(|flaw| flaw[3] < 2.0).collect();
        assert_eq!(weak, in_box(low, high, 2.0));
    }

    #[test]
    fn weaker_flaws_reach_farther_by_griffith() {
        let reach = Reach::of_crack(0.02, 5.0);
        // Half of the strength: level 1/32, four times the size.
        assert!((reach.at(1.0 / 32.0) / 0.04 - 1.0).abs() < 1e-12);
        assert_eq!(Reach::of_length(0.02).at(1e-3), 0.01);
    }

    #[test]
    fn flaws_that_reach_a_point_are_counted() {
        // The same spot for all; and one that goes with the level to the power of -6/5 and is bounded by 20.
        let flat = Reach::of_length(0.02).expected(7.0, |radius| radius * radius, 0.0, 1.0);
        assert!((flat / (7.0 * 1e-4) - 1.0).abs() < 1e-9, "{flat}");
        let spots = Reach::of_crack(2.0, 5.0).expected(1.0, |radius| radius.powi(3), 0.0, 20.0);
        let kink = 20f64.powf(-5.0 / 6.0);
        let exact = 20.0 * kink + 5.0 * (kink.powf(-0.2) - 1.0);
        assert!((spots / exact - 1.0).abs() < 2e-3, "{spots} of {exact}");
    }
}
