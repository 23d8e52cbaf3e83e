//! Properties of an edge that is damaged on any way through strains.

use fractum_kernels::damage::{EdgeDamage, Restraint, Softens};
use fractum_kernels::material::{Criterion, CriterionKind, DamageLaw, Elastic, Hooke, Plane, Softening};
use fractum_kernels::{Mat3, Sym3};

use super::draw::{Draw, Held, hold};

/// A law of an edge with its strength [Pa], its characteristic length [m], and whether it lies in a plane.
struct Edge {
    softens: Softens,
    strength: f64,
    length: f64,
    in_plane: bool,
}

/// Any criterion, body and size that a case may give.
fn edge(draw: &mut Draw, softening: Softening, unilateral: bool) -> Edge {
    let kind = draw.one_of(&[
        CriterionKind::Rankine,
        CriterionKind::MohrCoulomb,
        CriterionKind::PureMohrCoulomb,
        CriterionKind::DruckerPrager,
        CriterionKind::Mazars,
        CriterionKind::ModifiedMohrCoulomb,
    ]);
    let angle = draw.between(1.0, 60.0).to_radians();
    let strength_ratio = kind.least_strength_ratio(angle) * draw.over_decades(1.001, 50.0);
    let plane = draw.one_of(&[None, Some(Plane::Strain), Some(Plane::Stress)]);
    let young_modulus = draw.over_decades(1e6, 1e12);
    let elastic = Elastic { density: 2400.0, young_modulus, poisson_ratio: draw.between(0.0, 0.49) };
    let restraint = Restraint::new(&elastic, plane, false);
    let strength = young_modulus * draw.over_decades(1e-6, 1e-2);
    let energy = draw.over_decades(1e-1, 1e5);
    let length = draw.between(0.001, 0.9) * softening.largest_length(restraint.modulus, strength, energy);
    let criterion = Criterion::new(kind, angle, strength_ratio, elastic.poisson_ratio);
    let law = DamageLaw { criterion, softening, unilateral, ..DamageLaw::rankine(strength, energy) };
    let softens = Softens::new(&law, Hooke::new(&elastic, plane), restraint);
    Edge { softens, strength, length, in_plane: plane.is_some() }
}

/// What a step has left of an edge.
struct Step {
    growth: f64,
    taken: f64,
    /// Stress with damage [Pa].
    nominal: Sym3,
}

impl Edge {
    fn nominal(&self, edge: &EdgeDamage, strain: Sym3) -> Sym3 {
        self.softens.hooke.stress(strain) - self.softens.opening_stress(strain) * edge.damage
    }

    /// Advances a history by a step from one strain to another.
    fn step(&self, edge: &mut EdgeDamage, before: Sym3, strain: Sym3) -> Step {
        let (softens, stress) = (&self.softens, self.softens.hooke.stress(strain));
        let (damage, q) = (edge.damage, softens.equivalent(edge, stress, 0.0));
        let seen = softens.see(edge, self.strength, stress, q);
        let growth = softens.load(edge, seen, self.strength, self.length, 0.0);
        let taken = softens.taken(damage, [before, strain], stress, softens.closed_stress(strain));
        let taken = if growth > 0.0 { taken.by(growth) } else { 0.0 };
        Step { growth, taken, nominal: self.nominal(edge, strain) }
    }
}

/// On a way to and fro: damage only grows, no edge mends, what damage takes is what the forces do not give back and never below zero,
/// what is stored is never below zero, and turned axes change nothing.
pub(crate) fn way(draw: &mut Draw, curve: Softening, unilateral: bool) -> Held {
    let law = edge(draw, curve, unilateral);
    let words = format!("{:?}, {:?}", law.softens.criterion.kind(), law.softens.restraint);
    let limit = law.strength / law.softens.restraint.modulus * draw.over_decades(0.5, 20.0);
    let mut ends = || -> [f64; 6] { std::array::from_fn(|_| limit * draw.between(-1.0, 1.0)) };
    let (one, two) = (ends(), ends());
    let strain = |at: f64| {
        let (a, b) = ((7.0 * at).sin() * at, (17.0 * at).sin());
        let [xx, yy, zz, xy, yz, zx] = std::array::from_fn(|k| one[k] * a + two[k] * b);
        if law.in_plane { Sym3([xx, yy, 0.0, xy, 0.0, 0.0]) } else { Sym3([xx, yy, zz, xy, yz, zx]) }
    };
    let turn: Mat3 = if law.in_plane { draw.turn_in_plane() } else { draw.turn() };
    let turned = |tensor: Sym3| Sym3::symmetric_part(&(turn * tensor.to_matrix() * turn.transpose()));
    let (mut edge, mut other) = (EdgeDamage::intact(law.strength), EdgeDamage::intact(law.strength));
    let mut last = (Sym3::ZERO, Sym3::ZERO);
    let steps = 300;
    for at in (1..=steps).map(|step| f64::from(step) / f64::from(steps)) {
        let (before, (from, stress)) = (edge, last);
        let to = strain(at);
        let Step { growth, taken, nominal } = law.step(&mut edge, from, to);
        law.step(&mut other, turned(from), turned(to));
        hold(growth >= 0.0 && (0.0..=1.0).contains(&edge.damage), || format!("{words}: {edge:?} after {before:?}"))?;
        let mends = edge.kappa < before.kappa || before.broken && !edge.broken || edge.lateral > before.lateral;
        hold(!mends, || format!("{words}: mends to {edge:?} from {before:?}"))?;
        let scale = law.softens.hooke.stress(to).dot(to) + law.softens.hooke.stress(from).dot(from);
        let stored = [0.5 * stress.dot(from), 0.5 * nominal.dot(to)];
        hold(taken >= 0.0 && stored[1] >= -1e-7 * scale, || format!("{words}: takes {taken}, stores {stored:?}"))?;
        let missing = 0.5 * (stress + nominal).dot(to - from) + stored[0] - stored[1];
        let is_balanced = growth == 0.0 && unilateral || (taken - missing.max(0.0)).abs() <= 1e-6 * scale;
        hold(is_balanced, || format!("{words}: takes {taken} of {missing} at {at}"))?;
        hold((edge.damage - other.damage).abs() < 1e-3, || {
            format!("{words}: damage {} turned, {}", other.damage, edge.damage)
        })?;
        last = (to, nominal);
    }
    Ok(())
}
