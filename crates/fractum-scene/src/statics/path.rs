//! How far to go along a solution that is linear in the load parameter, a + τ b.

use fractum_fem::{DamagePoint, Solid};
use fractum_math::Vec3;

use super::Response;
use crate::interfaces::Interfaces;
use crate::interfaces::joints::PointPlace;

/// What an edge may see in a step: κ and a part of the larger of κ and the scale of its softening [Pa].
pub(super) fn limit(point: &DamagePoint, growth: f64) -> f64 {
    point.kappa + growth * point.kappa.max(point.softening)
}

/// Whether an edge stands `near` to its strength at most, as [`limit`] measures it.
pub(super) fn is_at_onset(solid: &Solid, points: &[DamagePoint], near: f64) -> bool {
    let least = |point: &DamagePoint| limit(point, -near);
    let (mut stresses, mut seen) = (Vec::new(), Vec::new());
    solid.effective_stresses(&solid.displacement, &mut stresses);
    solid.see(points, &stresses, least, &mut seen);
    seen.iter().zip(points).any(|(seen, point)| seen.stress >= least(point))
}

/// What goes farthest of all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Farthest {
    /// An edge, by its number among those that may be damaged.
    Edge(usize),
    /// A point of an interface.
    Interface(PointPlace),
}

/// Displacements that are linear in the load parameter, with what may soften on them.
pub(super) struct Way<'a> {
    pub(super) solid: &'a Solid,
    pub(super) points: &'a [DamagePoint],
    pub(super) interfaces: &'a Interfaces,
    pub(super) response: &'a Response,
    /// Displacements of the last iterate [m].
    pub(super) place: &'a [Vec3],
    /// How far each edge and each point of an interface may go down its softening curve.
    pub(super) growth: f64,
}

impl Way<'_> {
    /// The largest τ ≤ `longest` at which nothing that is not broken yet sees more than its growth lets it, and what stops it there; none if every
    /// τ does.
    ///
    /// The equivalent stresses are convex in τ, and so is their maximum: Newton's method from the right
    /// comes down to the upper root without passing it. Lateral restraint, once it begins to act on an edge, makes it see less; a step may then
    /// end a little before that root.
    pub(super) fn largest_step(&self, longest: f64) -> Option<(f64, Option<Farthest>)> {
        let mut seen = Vec::with_capacity(self.points.len());
        let mut stresses = Vec::with_capacity(self.points.len());
        let worst = |tau: f64| {
            stresses.clear();
            let Response { start_stress, slope_stress, .. } = self.response;
            stresses.extend(start_stress.iter().zip(slope_stress).map(|(&a, &b)| a + b * tau));
            self.solid.see(self.points, &stresses, |point| limit(point, self.growth), &mut seen);
            let points = self.points;
            let ratio = |i: usize| if points[i].broken { 0.0 } else { seen[i].stress / limit(&points[i], self.growth) };
            let farther = |a: (f64, usize), b: (f64, usize)| if b.0 > a.0 { b } else { a };
            let edge = (0..points.len()).map(|i| (ratio(i), i)).fold((0.0, usize::MAX), farther);
            match self.interfaces.farthest(|node| self.place(node, tau), self.growth) {
                Some((at, ratio)) if ratio > edge.0 => (ratio, Farthest::Interface(at)),
                _ => (edge.0, Farthest::Edge(edge.1)),
            }
        };
        self.go_back(longest, worst)
    }

    /// The same for one point of an interface alone.
    pub(super) fn step_of(&self, at: PointPlace, longest: f64) -> Option<f64> {
        let only = Farthest::Interface(at);
        Some(self.go_back(longest, |tau| (self.seen(only, tau), only))?.0)
    }

    /// The same in the mode that it has, where its own gives none.
    pub(super) fn step_in_mode(&self, at: PointPlace) -> Option<f64> {
        let Response { start, slope, .. } = self.response;
        self.interfaces.step_in_mode(at, self.place, [start, slope], self.growth)
    }

    /// The point of an interface that goes farthest down its curve at τ, and by which part of its length.
    pub(super) fn most_grown(&self, tau: f64) -> Option<(PointPlace, f64)> {
        self.interfaces.most_grown(|node| self.place(node, tau))
    }

    fn place(&self, node: u32, tau: f64) -> Vec3 {
        let Response { start, slope, .. } = self.response;
        start[node as usize] + slope[node as usize] * tau
    }

    /// What one of them sees over how far it may go.
    fn seen(&self, of: Farthest, tau: f64) -> f64 {
        match of {
            Farthest::Interface(at) => self.interfaces.reach(at, |node| self.place(node, tau), self.growth),
            Farthest::Edge(edge) => {
                let mut seen = Vec::with_capacity(1);
                let stress = self.response.start_stress[edge] + self.response.slope_stress[edge] * tau;
                self.solid.see(&self.points[edge..=edge], &[stress], |_| 0.0, &mut seen);
                seen[0].stress / limit(&self.points[edge], self.growth)
            }
        }
    }

    /// - `worst`: what goes farthest at some τ, and how far
    fn go_back(&self, longest: f64, mut worst: impl FnMut(f64) -> (f64, Farthest)) -> Option<(f64, Option<Farthest>)> {
        let (mut tau, mut stops) = (longest, None);
        for _ in 0..200 {
            let (ratio, farthest) = worst(tau);
            if ratio <= 1.0 + 1e-12 {
                return Some((tau, stops));
            }
            // Slope of the worst alone, by a difference towards where the root must lie.
            let h = 1e-6 * (tau.abs() + 1e-3 * longest.abs());
            let rise = (ratio - self.seen(farthest, tau - h)) / h;
            if rise.is_nan() || rise <= 0.0 {
                return None;
            }
            tau -= (ratio - 1.0) / rise;
            stops = Some(farthest);
        }
        None
    }
}
