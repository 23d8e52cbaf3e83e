//! Properties of an edge that is damaged on any way through strains.

use fractum_kernels::damage::{EdgeDamage, Restraint, RubbingStep, Softens};
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
fn edge(draw: &mut Draw, softening: Softening, unilateral: bool, friction: Option<f64>) -> Edge {
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
    let law = DamageLaw { criterion, softening, unilateral, friction, ..DamageLaw::rankine(strength, energy) };
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

    /// A way to and fro through strains, from 0 to 1, and how far it goes.
    fn to_and_fro(&self, draw: &mut Draw) -> (f64, impl Fn(f64) -> Sym3 + use<>) {
        let far = self.strength / self.softens.restraint.modulus * draw.over_decades(0.5, 20.0);
        let mut ends = || -> [f64; 6] { std::array::from_fn(|_| far * draw.between(-1.0, 1.0)) };
        let (one, two, in_plane) = (ends(), ends(), self.in_plane);
        let strain = move |at: f64| {
            let (a, b) = ((7.0 * at).sin() * at, (17.0 * at).sin());
            let [xx, yy, zz, xy, yz, zx] = std::array::from_fn(|k| one[k] * a + two[k] * b);
            if in_plane { Sym3([xx, yy, 0.0, xy, 0.0, 0.0]) } else { Sym3([xx, yy, zz, xy, yz, zx]) }
        };
        (far, strain)
    }

    /// Axes that are turned, in a plane about its normal.
    fn turned(&self, draw: &mut Draw) -> impl Fn(Sym3) -> Sym3 + use<> {
        let turn: Mat3 = if self.in_plane { draw.turn_in_plane() } else { draw.turn() };
        move |tensor| Sym3::symmetric_part(&(turn * tensor.to_matrix() * turn.transpose()))
    }
}

/// On a way to and fro: damage only grows, no edge mends, what damage takes is what the forces do not give back and never below zero,
/// what is stored is never below zero, and turned axes change nothing.
pub(crate) fn way(draw: &mut Draw, curve: Softening, unilateral: bool) -> Held {
    let law = edge(draw, curve, unilateral, None);
    let words = format!("{:?}, {:?}", law.softens.criterion.kind(), law.softens.restraint);
    let (_, strain) = law.to_and_fro(draw);
    let turned = law.turned(draw);
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

/// An edge that is damaged, closes, slides and opens again on any way: the broken share bears no more than friction allows and nothing where it is open, what the step takes is
/// what the forces do not give back, damage and friction take and do not give, and turned axes change nothing.
pub(crate) fn rubbing(draw: &mut Draw) -> Held {
    let any = draw.between(0.0, 0.999);
    let coefficient = draw.one_of(&[0.0, any]);
    let curve = draw.one_of(&[Softening::Exponential, Softening::Linear]);
    let law = edge(draw, curve, false, Some(coefficient));
    let (softens, friction) = (&law.softens, law.softens.friction.expect("it was given"));
    let crushed = draw.one_of(&[false, true]);
    let limit = friction.limit(if crushed { 0.0 } else { 1.0 }, 1.0);
    let words = format!("{:?}, {:?}", softens.criterion.kind(), friction);
    let (far, strain) = law.to_and_fro(draw);
    let turned = law.turned(draw);
    let is_flat = softens.hooke.zz == 0.0;
    let (mut edge, mut slip, mut turned_slip) = (EdgeDamage::intact(law.strength), Sym3::ZERO, Sym3::ZERO);
    let (mut from, mut stress, mut stored) = (Sym3::ZERO, Sym3::ZERO, 0.0);
    let (mut rubbed_away, mut most) = (0.0, 0.0f64);
    let steps = 300;
    for at in (1..=steps).map(|step| f64::from(step) / f64::from(steps)) {
        let to = strain(at);
        let (full, damage) = (softens.hooke.stress(to), edge.damage);
        let seen = softens.see(&edge, law.strength, full, softens.equivalent(&edge, full, 0.0));
        let growth = softens.load(&mut edge, seen, law.strength, law.length, 0.0);
        let (mut nominal, mut takes, mut held) = (full, [0.0; 2], Sym3::ZERO);
        if edge.damage > 0.0 {
            let step = friction.step(&RubbingStep { strains: [from, to], slip, limit, damage }, full);
            let closed = step.closed;
            friction.load(turned(to), &mut turned_slip, limit);
            let off = turned(step.slip) - turned_slip;
            let size = to.dot(to).sqrt() + far;
            hold(off.dot(off).sqrt() <= 1e-5 * size, || {
                format!("{words}: slips by {off:?} otherwise where axes are turned")
            })?;
            hold(step.slip.trace().abs() <= 1e-9 * size, || {
                format!("{words}: slip opens it by {}", step.slip.trace())
            })?;
            let [first, _, last] = closed.principal_values();
            let flat = [closed.0[0] + closed.0[1], (closed.0[0] - closed.0[1]).hypot(2.0 * closed.0[3])];
            let [sum, difference] = if is_flat { flat } else { [first + last, first - last] };
            let scale = softens.hooke.mu * size;
            hold(difference <= -limit * sum + 1e-6 * scale, || format!("{words}: bears {difference} under {sum}"))?;
            let is_open = to.trace() >= 0.0;
            hold(!is_open || closed.dot(closed).sqrt() <= 1e-9 * scale, || format!("{words}: open, bears {closed:?}"))?;
            (slip, held) = (step.slip, closed);
            nominal = full * (1.0 - edge.damage) + closed * edge.damage;
            takes = [step.per_damage * growth, step.taken];
        }
        let scale = full.dot(to) + softens.hooke.stress(from).dot(from) + softens.hooke.mu * far * far;
        let stores = 0.5 * ((1.0 - edge.damage) * full.dot(to) + edge.damage * held.dot(to - slip));
        let missing = 0.5 * (stress + nominal).dot(to - from) + stored - stores;
        let sum = takes[0] + takes[1];
        hold((sum - missing).abs() <= 1e-9 * scale, || format!("{words}: takes {takes:?} of {missing} at {at}"))?;
        hold(stores >= 0.0, || format!("{words}: stores {stores}"))?;
        rubbed_away += takes[1];
        most = most.max(scale);
        (from, stress, stored) = (to, nominal, stores);
    }
    hold(rubbed_away >= -1e-3 * most, || format!("{words}: friction gives {rubbed_away} of {most}"))
}
