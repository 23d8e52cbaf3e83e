//! Sets of joints: orientation, spacing, length and persistence, with their scatter and a seed.

use std::f64::consts::PI;

use fractum_math::elementary::{acos, cos, exp, ln, sin_cos};

use super::Trace;
use super::space::Disc;
use crate::Vec3;
use crate::generate::unit_interval;

/// How a set is oriented [rad].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Orientation {
    /// In a plane: the angle of its traces from the x-axis, counter-clockwise.
    Angle(f64),
    /// In space, with z up and y to the north: dip, and the direction to which it dips, from north over east (x).
    Dip([f64; 2]),
}

/// A set of joints.
#[derive(Clone, Debug, PartialEq)]
pub struct JointSet {
    /// The group of its lines or triangles, by its number.
    pub group: u32,
    /// Mean orientation.
    pub orientation: Orientation,
    /// Standard deviation of the angle of traces, or of the two angles of Fisher's distribution of normals, 1/√κ [rad].
    pub scatter: f64,
    /// Mean distance of joints across them.
    pub spacing: f64,
    /// Standard deviation of the spacing over its mean.
    pub spacing_scatter: f64,
    /// Mean length of traces or diameter of discs; none where they go through the body.
    pub length: Option<f64>,
    /// Standard deviation of the length over its mean.
    pub length_scatter: f64,
    /// Share of the length or area of the plane of a joint that is open, above 0 and at most 1.
    pub persistence: f64,
    /// Another one gives another network.
    pub seed: u64,
}

/// Numbers at random, by a seed.
pub(super) struct Random {
    seed: u64,
    drawn: u64,
}

impl Random {
    pub(super) fn new(seed: u64) -> Self {
        // A seed that is a plain multiple would only shift the numbers of another one.
        let mixed = (unit_interval(seed, 0x5851_f42d) * 2f64.powi(53)) as u64;
        Random { seed: mixed.wrapping_mul(0x2545_f491_4f6c_dd1d), drawn: 0 }
    }

    /// From 0 to 1.
    pub(super) fn share(&mut self) -> f64 {
        self.drawn += 1;
        unit_interval(self.seed, self.drawn)
    }

    /// Of mean 0 and standard deviation 1 (Box and Muller, *Ann. Math. Stat.* 29 (1958)).
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * ln(1.0 - self.share())).sqrt();
        radius * cos(2.0 * PI * self.share())
    }

    /// Of mean 1 with a log-normal distribution of this standard deviation.
    fn around_one(&mut self, deviation: f64) -> f64 {
        let variance = ln(1.0 + deviation * deviation);
        exp(variance.sqrt() * self.normal() - 0.5 * variance)
    }
}

impl JointSet {
    /// The traces of a set in a rectangle: on parallel lines, on which traces and bridges follow each other; each turns about its middle.
    pub fn traces(&self, [low, high]: [[f64; 2]; 2]) -> Vec<Trace> {
        let Orientation::Angle(angle) = self.orientation else { return Vec::new() };
        let mut random = Random::new(self.seed);
        let (y, x) = sin_cos(angle);
        let (along, across) = ([x, y], [-y, x]);
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        let range = |axis: [f64; 2]| {
            let at = corners.map(|corner| corner[0] * axis[0] + corner[1] * axis[1]);
            at.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)))
        };
        let ((first, last), (begin, end)) = (range(across), range(along));
        let mut traces = Vec::new();
        let mut add = |random: &mut Random, offset: f64, from: f64, to: f64| {
            let turned = angle + self.scatter * random.normal();
            let (y, x) = sin_cos(turned);
            let (middle, half) = (f64::midpoint(from, to), 0.5 * (to - from));
            let centre = [0, 1].map(|axis| offset * across[axis] + middle * along[axis]);
            let ends = [-half, half].map(|way| [centre[0] + way * x, centre[1] + way * y]);
            traces.push(Trace { ends, group: self.group });
        };
        let mut offset = first - self.spacing * random.share();
        while offset < last {
            offset += self.spacing * random.around_one(self.spacing_scatter);
            let Some(length) = self.length.filter(|_| self.persistence < 1.0) else {
                add(&mut random, offset, begin, end);
                continue;
            };
            let bridge = length * (1.0 / self.persistence - 1.0);
            let mut from = begin - (length + bridge) * random.share();
            while from < end {
                let to = from + length * random.around_one(self.length_scatter);
                add(&mut random, offset, from, to);
                from = to + bridge * random.around_one(self.length_scatter);
            }
        }
        traces
    }

    /// The discs of a set in a box: on parallel planes, on each of which discs of the share asked for lie apart from each other; each turns about its middle.
    pub fn discs(&self, [low, high]: [Vec3; 2]) -> Vec<Disc> {
        /// Trials of a place for a disc.
        const TRIALS: usize = 200;
        let Orientation::Dip([dip, direction]) = self.orientation else { return Vec::new() };
        let mut random = Random::new(self.seed);
        let normal = normal_of(dip, direction);
        let [u, v] = across(&normal);
        let corners: Vec<Vec3> =
            (0..8).map(|k| Vec3::from_fn(|axis, _| if k >> axis & 1 == 0 { low[axis] } else { high[axis] })).collect();
        let range = |axis: &Vec3| {
            let at = corners.iter().map(|corner| corner.dot(axis));
            at.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let ((first, last), [(u0, u1), (v0, v1)]) = (range(&normal), [range(&u), range(&v)]);
        let whole = 0.5 * (high - low).norm();
        let mut discs = Vec::new();
        let mut offset = first - self.spacing * random.share();
        while offset < last {
            offset += self.spacing * random.around_one(self.spacing_scatter);
            let Some(length) = self.length.filter(|_| self.persistence < 1.0) else {
                let middle = (low + high) / 2.0;
                let centre = middle + normal * (offset - middle.dot(&normal));
                let normal = self.scattered(&normal, &mut random);
                discs.push(Disc { centre, normal, radius: 1.05 * whole, group: self.group });
                continue;
            };
            // Beyond the box, so that its rim has as many.
            let [(u0, u1), (v0, v1)] = [(u0, u1), (v0, v1)].map(|(low, high)| (low - length, high + length));
            let wanted = self.persistence * (u1 - u0) * (v1 - v0);
            let (mut area, mut own): (f64, Vec<([f64; 2], f64)>) = (0.0, Vec::new());
            while area < wanted {
                let radius = 0.5 * length * random.around_one(self.length_scatter);
                let free = (0..TRIALS).find_map(|_| {
                    let at = [u0 + (u1 - u0) * random.share(), v0 + (v1 - v0) * random.share()];
                    let apart = |(other, r): &([f64; 2], f64)| {
                        (other[0] - at[0]).powi(2) + (other[1] - at[1]).powi(2) > (radius + r).powi(2)
                    };
                    own.iter().all(apart).then_some(at)
                });
                let Some(at) = free else { break };
                own.push((at, radius));
                area += PI * radius * radius;
            }
            for ([x, y], radius) in own {
                let centre = normal * offset + u * x + v * y;
                let normal = self.scattered(&normal, &mut random);
                discs.push(Disc { centre, normal, radius, group: self.group });
            }
        }
        discs
    }

    /// A normal of Fisher's distribution around a mean (Fisher, *Proc. R. Soc. A* 217 (1953)).
    fn scattered(&self, mean: &Vec3, random: &mut Random) -> Vec3 {
        if self.scatter == 0.0 {
            return *mean;
        }
        let kappa = 1.0 / (self.scatter * self.scatter);
        let least = exp(-2.0 * kappa);
        let cosine = 1.0 + ln(least + (1.0 - least) * (1.0 - random.share())) / kappa;
        let (sine, around) = ((1.0 - cosine * cosine).max(0.0).sqrt(), sin_cos(2.0 * PI * random.share()));
        let [u, v] = across(mean);
        mean * cosine + (u * around.1 + v * around.0) * sine
    }
}

/// The upward normal of a plane by its dip and the direction of that [rad], with z up, y to the north and x to the east.
pub fn normal_of(dip: f64, direction: f64) -> Vec3 {
    let ((sin_dip, cos_dip), (east, north)) = (sin_cos(dip), sin_cos(direction));
    Vec3::new(east * sin_dip, north * sin_dip, cos_dip)
}

/// Two axes across a third.
fn across(normal: &Vec3) -> [Vec3; 2] {
    let least = if normal.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
    let u = normal.cross(&least).normalize();
    [u, normal.cross(&u)]
}

/// Mean direction of lines [rad] and the standard deviation about it, in a plane, by their doubled angles, weighed by length.
pub fn mean_direction(lines: impl Iterator<Item = [[f64; 2]; 2]> + Clone) -> (f64, f64) {
    let (mut x, mut y) = (0.0, 0.0);
    let angle = |[a, b]: [[f64; 2]; 2]| {
        let along = [b[0] - a[0], b[1] - a[1]];
        (fractum_math::elementary::atan2(along[1], along[0]), (along[0] * along[0] + along[1] * along[1]).sqrt())
    };
    for (angle, length) in lines.clone().map(angle) {
        let (sin, cos) = sin_cos(2.0 * angle);
        (x, y) = (x + length * cos, y + length * sin);
    }
    let mean = 0.5 * fractum_math::elementary::atan2(y, x);
    let (sum, all) = lines.map(angle).fold((0.0, 0.0), |(sum, all), (angle, length)| {
        let off = (angle - mean) - PI * ((angle - mean) / PI).round();
        (sum + length * off * off, all + length)
    });
    (if mean < 0.0 { mean + PI } else { mean }, if all > 0.0 { (sum / all).sqrt() } else { 0.0 })
}

/// Mean dip and dip direction of discs [rad] and the standard deviation 1/√κ about it, weighed by area.
pub fn mean_dip(discs: impl Iterator<Item = Disc> + Clone) -> ([f64; 2], f64) {
    let first = discs.clone().next().map_or(Vec3::z(), |disc| disc.normal);
    let upward = |normal: Vec3| if normal.dot(&first) < 0.0 { -normal } else { normal };
    let area = |disc: &Disc| disc.radius * disc.radius;
    let sum = discs.clone().map(|disc| upward(disc.normal) * area(&disc)).sum::<Vec3>();
    let all: f64 = discs.map(|disc| area(&disc)).sum();
    let mean = sum.normalize();
    let mean = if mean.z < 0.0 { -mean } else { mean };
    let direction = fractum_math::elementary::atan2(mean.x, mean.y);
    let dip = acos(mean.z.clamp(-1.0, 1.0));
    ([dip, if direction < 0.0 { direction + 2.0 * PI } else { direction }], (1.0 - sum.norm() / all).max(0.0).sqrt())
}
