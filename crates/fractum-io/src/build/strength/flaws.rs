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
const KEPT: f64 = 6.0;

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
