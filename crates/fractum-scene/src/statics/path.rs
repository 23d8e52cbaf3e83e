//! How far to go along a solution that is linear in the load parameter, a + τ b.

use fractum_fem::{DamagePoint, Solid};
use fractum_math::Sym3;

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

/// The largest τ ≤ `longest` at which no edge that is not broken yet sees more than `growth` lets it; none if every τ
/// does.
///
/// The equivalent stresses are convex in τ, and so is their maximum over the edges: Newton's method from the right
/// comes down to the upper root without passing it. Lateral restraint, once it begins to act on an edge, makes it see less; a step may then
/// end a little before that root.
pub(super) fn largest_step(
    solid: &Solid,
    points: &[DamagePoint],
    start: &[Sym3],
    slope: &[Sym3],
    growth: f64,
    longest: f64,
) -> Option<f64> {
    let mut stresses = Vec::with_capacity(points.len());
    let mut seen = Vec::with_capacity(points.len());
    let mut worst = |tau: f64| -> (f64, usize) {
        stresses.clear();
        stresses.extend(start.iter().zip(slope).map(|(&a, &b)| a + b * tau));
        solid.see(points, &stresses, |point| limit(point, growth), &mut seen);
        let ratio = |i: usize| if points[i].broken { 0.0 } else { seen[i].stress / limit(&points[i], growth) };
        (0..points.len()).map(|i| (ratio(i), i)).fold((0.0, usize::MAX), |a, b| if b.0 > a.0 { b } else { a })
    };
    let mut tau = longest;
    for _ in 0..200 {
        let (ratio, edge) = worst(tau);
        if ratio <= 1.0 + 1e-12 {
            return Some(tau);
        }
        // Slope of the worst edge alone, by a difference towards where the root must lie.
        let h = 1e-6 * (tau.abs() + 1e-3 * longest.abs());
        let one = |tau: f64| {
            let mut seen = Vec::with_capacity(1);
            solid.see(&points[edge..=edge], &[start[edge] + slope[edge] * tau], |_| 0.0, &mut seen);
            seen[0].stress / limit(&points[edge], growth)
        };
        let rise = (ratio - one(tau - h)) / h;
        if rise.is_nan() || rise <= 0.0 {
            return None;
        }
        tau -= (ratio - 1.0) / rise;
    }
    None
}
