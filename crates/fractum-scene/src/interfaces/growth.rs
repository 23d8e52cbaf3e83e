//! How far interfaces go down their softening curves in a step of a path.

use fractum_kernels::interface::{Led, SpringInterface, Standing};
use fractum_math::{Mat3, Vec3};

use super::joints::PointPlace;
use super::reading::is_broken;
use super::{Interfaces, Point};

/// Step of a difference over the jump.
const DIFFERENCE: f64 = 1e-6;

/// How far a point may go: the [ratio](Standing::ratio) at which it softens further and a part of the larger of that and the length of its
/// softening; below that ratio, less of it.
fn limit(standing: &Standing, growth: f64) -> f64 {
    let scale = if growth < 0.0 { standing.onset } else { standing.onset.max(standing.length) };
    standing.onset + growth * scale
}

impl Interfaces {
    /// Whether any of them has a strength that may go down at rest.
    pub(crate) fn may_soften(&self) -> bool {
        self.kinds.iter().any(|kind| kind.law.is_bonded() && kind.stiffness.is_some())
    }

    /// Whether none has begun to.
    pub(crate) fn is_whole(&self) -> bool {
        let bonded = |point: &Point| self.kinds[point.kind as usize].law.is_bonded();
        let points = self.clusters.iter().flat_map(|cluster| &cluster.points);
        points.filter(|point| bonded(point)).all(|point| point.state.secant >= 1.0)
    }

    /// Points that have strength left.
    fn softening(&self) -> impl Iterator<Item = (PointPlace, &Point, SpringInterface)> {
        let all = (0u32..)
            .zip(&self.clusters)
            .flat_map(|(cluster, own)| (0u32..).zip(&own.points).map(move |(index, point)| ((cluster, index), point)));
        all.filter_map(|(at, point)| {
            let kind = &self.kinds[point.kind as usize];
            let softens = kind.law.is_bonded() && point.area > 0.0 && !is_broken(point);
            let stiffness = kind.stiffness.filter(|_| softens)?;
            Some((at, point, SpringInterface { law: kind.law, stiffness }))
        })
    }

    /// What a point sees under a displacement field over how far it may go.
    pub(crate) fn reach(&self, (cluster, index): PointPlace, field: impl Fn(u32) -> Vec3, growth: f64) -> f64 {
        let point = &self.clusters[cluster as usize].points[index as usize];
        let kind = &self.kinds[point.kind as usize];
        let Some(stiffness) = kind.stiffness else { return 0.0 };
        seen(point, &SpringInterface { law: kind.law, stiffness }, &field, growth)
    }

    /// The τ at which a point comes to how far it may go, where its nodes move by start + τ slope and its mode stays as it is; none where it does not answer to τ.
    ///
    /// - `place`: displacements of the last iterate [m]
    pub(crate) fn step_in_mode(
        &self,
        at: PointPlace,
        place: &[Vec3],
        [start, slope]: [&[Vec3]; 2],
        growth: f64,
    ) -> Option<f64> {
        let LedPair { at: point, led, .. } = self.led(at, place, growth)?;
        let kind = &self.kinds[point.kind as usize];
        let interface = SpringInterface { law: kind.law, stiffness: kind.stiffness? };
        let ratio = |jump: Vec3| Some(interface.standing(&jump, &point.state)?.ratio);
        let change = |way: Vec3| {
            let step = DIFFERENCE * led.jump.norm() / way.norm();
            Some((ratio(led.jump + way * step)? - ratio(led.jump)?) / step)
        };
        let [a, b] = point.pair.map(|node| node as usize);
        let missing = point.local(start[b] - start[a]) - led.jump;
        let by_load = point.frame * (slope[b] - slope[a]);
        let tau = -change(missing)? / change(by_load)?;
        tau.is_finite().then_some(tau)
    }

    /// The point that sees most over how far it may go, and that.
    pub(crate) fn farthest(&self, field: impl Fn(u32) -> Vec3, growth: f64) -> Option<(PointPlace, f64)> {
        largest(self.softening().map(|(at, point, interface)| (at, seen(point, &interface, &field, growth))))
    }

    /// The point that has gone farthest down its curve since the last equilibrium, and by which part of its length; none where none has.
    pub(crate) fn most_grown(&self, field: impl Fn(u32) -> Vec3) -> Option<(PointPlace, f64)> {
        let grown = self.softening().filter_map(|(at, point, interface)| {
            let standing = interface.standing(&jump(point, &field), &point.state)?;
            Some((at, (standing.ratio - standing.onset) / standing.onset.max(standing.length)))
        });
        largest(grown.filter(|(_, growth)| *growth > 0.0))
    }

    /// A point on its way to how far it may go; none where nothing is asked of its strength.
    pub(super) fn led(&self, (cluster, index): PointPlace, field: &[Vec3], growth: f64) -> Option<LedPair<'_>> {
        let point = &self.clusters[cluster as usize].points[index as usize];
        let kind = &self.kinds[point.kind as usize];
        let interface = SpringInterface { law: kind.law, stiffness: kind.stiffness? };
        let jump = jump(point, &|node| field[node as usize]);
        let standing = interface.standing(&jump, &point.state)?;
        let led = interface.lead(&jump, &point.state, limit(&standing, growth));
        let in_space = point.frame.tr_mul(&(led.jump + point.offset));
        Some(LedPair { at: point, led, in_space })
    }
}

/// A point whose softening is given, with all others between its nodes.
pub(super) struct LedPair<'a> {
    at: &'a Point,
    led: Led,
    /// The jump of its nodes [m].
    in_space: Vec3,
}

impl LedPair<'_> {
    /// How a point behaves in this pair; none of points between other nodes.
    pub(super) fn of(&self, point: &Point, interface: &SpringInterface) -> Option<Led> {
        let [a, b] = self.at.pair;
        if std::ptr::eq(point, self.at) {
            return Some(self.led);
        }
        let in_space = if point.pair == [a, b] { self.in_space } else { -self.in_space };
        if point.pair != [a, b] && point.pair != [b, a] {
            return None;
        }
        let (jump, mut state) = (point.local(in_space), point.state);
        let force = interface.load(jump, &mut state);
        let [first, second] = interface.secant(&jump, &force, &state);
        let stiffness = Mat3::from_diagonal(&Vec3::new(first, second, second));
        Some(Led { jump, traction: force.traction(), stiffness })
    }
}

/// The first of the largest.
fn largest(all: impl Iterator<Item = (PointPlace, f64)>) -> Option<(PointPlace, f64)> {
    all.reduce(|most, own| if own.1 > most.1 { own } else { most })
}

fn jump(point: &Point, field: &impl Fn(u32) -> Vec3) -> Vec3 {
    let [a, b] = point.pair.map(field);
    point.local(b - a)
}

fn seen(point: &Point, interface: &SpringInterface, field: &impl Fn(u32) -> Vec3, growth: f64) -> f64 {
    let standing = interface.standing(&jump(point, field), &point.state);
    standing.map_or(0.0, |standing| standing.ratio / limit(&standing, growth))
}
