//! Grains: Voronoi cells around seeds (Voronoi, *J. reine angew. Math.* 134 (1908)).

use super::sets::Random;
use crate::Vec3;

/// Grains of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Grains {
    /// Mean size of a cell: the diameter of a circle or ball as large.
    pub size: f64,
    /// Rounds in which every seed moves to the middle of its cell (Lloyd, *IEEE Trans. Inf. Theory* 28 (1982)).
    pub rounds: u32,
    /// Share of the body that the grains fill; the rest is a matrix between them.
    pub share: f64,
    /// Groups of grains and the share of the grains that belongs to each; without a group, none has one.
    pub phases: Vec<(String, f64)>,
    /// Group of the matrix.
    pub matrix: String,
    /// Group of the boundaries.
    pub boundary: String,
    /// Another one gives other grains.
    pub seed: u64,
}

/// Sides of cells are told apart by this over the size of a grain.
const SAME: f64 = 1e-6;

impl Grains {
    /// Seeds in a rectangle around a body, some beyond it.
    pub(super) fn seeds(&self, [low, high]: [[f64; 2]; 2]) -> Vec<[f64; 2]> {
        let beyond = 2.0 * self.size;
        let [low, high] = [low.map(|x| x - beyond), high.map(|x| x + beyond)];
        let (mut random, area) = (Random::new(self.seed), (high[0] - low[0]) * (high[1] - low[1]));
        let count = (area / (0.25 * std::f64::consts::PI * self.size * self.size)).round().max(1.0) as usize;
        let mut seeds: Vec<[f64; 2]> =
            (0..count).map(|_| [0, 1].map(|axis| low[axis] + (high[axis] - low[axis]) * random.share())).collect();
        for _ in 0..self.rounds {
            let middles: Vec<[f64; 2]> =
                cells(&seeds, [low, high], self.size).iter().map(|cell| centroid(cell)).collect();
            seeds = middles;
        }
        seeds
    }

    /// Seeds in a box around a body.
    pub(super) fn seeds_in_space(&self, [low, high]: [Vec3; 2]) -> Vec<Vec3> {
        let beyond = Vec3::from_element(self.size);
        let [low, high] = [low - beyond, high + beyond];
        let mut random = Random::new(self.seed);
        let span = high - low;
        let count = (span.x * span.y * span.z / (std::f64::consts::PI / 6.0 * self.size.powi(3))).round().max(1.0);
        let mut seeds: Vec<Vec3> = Vec::new();
        // Instead of moving seeds to the middles of cells: places too near to others are drawn anew.
        let apart = self.size * (1.0 - 1.0 / f64::from(self.rounds + 1)) * 0.8;
        for _ in 0..count as usize {
            let mut draw = || low + span.component_mul(&Vec3::from_fn(|_, _| random.share()));
            let trials: Vec<Vec3> = (0..30).map(|_| draw()).collect();
            let free = |at: &&Vec3| seeds.iter().all(|seed| (seed - **at).norm() > apart);
            let found = trials.iter().find(free).copied();
            seeds.extend(found);
        }
        seeds
    }

    /// The phase of a grain, by its number.
    pub(super) fn phase(&self, grain: usize) -> usize {
        let drawn = crate::generate::unit_interval(self.seed.wrapping_add(77), grain as u64);
        let all: f64 = self.phases.iter().map(|(_, share)| share).sum();
        let mut sum = 0.0;
        self.phases
            .iter()
            .position(|(_, share)| {
                sum += share / all;
                drawn < sum
            })
            .unwrap_or(self.phases.len().saturating_sub(1))
    }

    /// Lines between cells, or around them where there is a matrix.
    pub(super) fn lines(&self, seeds: &[[f64; 2]], bounds: [[f64; 2]; 2]) -> Vec<[[f64; 2]; 2]> {
        let beyond = 2.0 * self.size;
        let bounds = [bounds[0].map(|x| x - beyond), bounds[1].map(|x| x + beyond)];
        let scale = self.share.sqrt();
        let mut lines: Vec<[[f64; 2]; 2]> = Vec::new();
        for (cell, seed) in cells(seeds, bounds, self.size).iter().zip(seeds) {
            for (index, &a) in cell.iter().enumerate() {
                let b = cell[(index + 1) % cell.len()];
                let shrunk = |p: [f64; 2]| [0, 1].map(|axis| seed[axis] + scale * (p[axis] - seed[axis]));
                // A line between two cells is that of the one from which it leads to the right.
                let leads_right = (a[0], a[1]) < (b[0], b[1]);
                if self.share < 1.0 {
                    lines.push([shrunk(a), shrunk(b)]);
                } else if leads_right {
                    lines.push([a, b]);
                }
            }
        }
        lines
    }
}

/// The grain that a place is in; none in the matrix.
///
/// - `scale`: of each cell about its seed
pub(super) fn grain_at<const N: usize>(seeds: &[[f64; N]], at: [f64; N], scale: f64) -> Option<usize> {
    let far = |a: &[f64; N], b: &[f64; N]| a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum::<f64>();
    let nearest = |at: &[f64; N]| {
        let all = seeds.iter().enumerate().map(|(number, seed)| (far(seed, at), number));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, number)| number)
    };
    let own = nearest(&at)?;
    let seed = seeds[own];
    let outward: [f64; N] = std::array::from_fn(|axis| seed[axis] + (at[axis] - seed[axis]) / scale);
    (nearest(&outward) == Some(own)).then_some(own)
}

/// The cells of seeds in a rectangle, counter-clockwise.
fn cells(seeds: &[[f64; 2]], [low, high]: [[f64; 2]; 2], size: f64) -> Vec<Vec<[f64; 2]>> {
    let rectangle = vec![low, [high[0], low[1]], high, [low[0], high[1]]];
    let mut order: Vec<usize> = (0..seeds.len()).collect();
    order.sort_by(|&a, &b| seeds[a][0].total_cmp(&seeds[b][0]));
    let place: Vec<usize> = {
        let mut place = vec![0; seeds.len()];
        order.iter().enumerate().for_each(|(at, &seed)| place[seed] = at);
        place
    };
    let cell = |own: usize| {
        let seed = seeds[own];
        let mut cell = rectangle.clone();
        let reach = |cell: &[[f64; 2]]| {
            let far = |p: &[f64; 2]| (p[0] - seed[0]).powi(2) + (p[1] - seed[1]).powi(2);
            2.0 * cell.iter().map(far).fold(0.0, f64::max).sqrt()
        };
        // Outwards along x, until no other seed can cut the cell.
        let (mut left, mut right) = (place[own], place[own] + 1);
        loop {
            let to_left = (left > 0).then(|| seed[0] - seeds[order[left - 1]][0]);
            let to_right = (right < order.len()).then(|| seeds[order[right]][0] - seed[0]);
            let (gap, next) = match (to_left, to_right) {
                (Some(l), r) if r.is_none_or(|r| l <= r) => {
                    left -= 1;
                    (l, order[left])
                }
                (_, Some(r)) => {
                    right += 1;
                    (r, order[right - 1])
                }
                _ => break,
            };
            if gap > reach(&cell) {
                break;
            }
            cell = clipped(&cell, seed, seeds[next]);
        }
        // Corners of four cells in one place.
        cell.dedup_by(|a, b| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < SAME * size);
        cell
    };
    (0..seeds.len()).map(cell).collect()
}

/// The part of a polygon that is nearer to one seed than to another.
fn clipped(cell: &[[f64; 2]], own: [f64; 2], other: [f64; 2]) -> Vec<[f64; 2]> {
    let across = [other[0] - own[0], other[1] - own[1]];
    let middle = [f64::midpoint(own[0], other[0]), f64::midpoint(own[1], other[1])];
    let height = |p: [f64; 2]| (p[0] - middle[0]) * across[0] + (p[1] - middle[1]) * across[1];
    let mut kept = Vec::with_capacity(cell.len() + 1);
    for (index, &a) in cell.iter().enumerate() {
        let b = cell[(index + 1) % cell.len()];
        let [low, high] = [height(a), height(b)];
        if low <= 0.0 {
            kept.push(a);
        }
        if low * high < 0.0 {
            let share = low / (low - high);
            kept.push([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]);
        }
    }
    kept
}

/// The middle of a polygon.
fn centroid(cell: &[[f64; 2]]) -> [f64; 2] {
    let (mut sum, mut at) = (0.0, [0.0; 2]);
    let first = cell.first().copied().unwrap_or_default();
    for (index, &a) in cell.iter().enumerate() {
        let b = cell[(index + 1) % cell.len()];
        let [ax, ay, bx, by] = [a[0] - first[0], a[1] - first[1], b[0] - first[0], b[1] - first[1]];
        let area = ax * by - bx * ay;
        sum += area;
        at = [at[0] + area * (ax + bx) / 3.0, at[1] + area * (ay + by) / 3.0];
    }
    if sum > 0.0 { [first[0] + at[0] / sum, first[1] + at[1] / sum] } else { first }
}
