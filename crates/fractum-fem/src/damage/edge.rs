//! Damage on the edges of a body.

use std::sync::Arc;

use fractum_math::{FOUR, Lane, Sym3, negative_parts};
use serde::{Deserialize, Serialize};

use crate::body::{Body, DamageZone};
use crate::damage::Taken;
use crate::damage::restraint::{Restraint, Seen};
use crate::damage::threshold::Threshold;
use crate::element::hooke::Hooke;
use crate::material::{Criterion, DamageLaw, Softening, equivalent_stresses};

/// An equivalent stress beyond all that occur [Pa], of which the square is a number.
pub(crate) const ABOVE_ALL: f64 = 1e100;

/// History of one edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EdgeDamage {
    /// Largest equivalent stress so far [Pa]; starts at the strength.
    pub kappa: f64,
    /// Damage d, 0 to 1.
    pub damage: f64,
    /// Sum of the lateral principal stresses at the onset of damage [Pa]; infinite before.
    pub lateral: f64,
    /// Part of the largest effective principal stress that belonged to the opening when κ last grew.
    pub share: f64,
    /// Strain at the last step, kept from the onset of damage on.
    pub strain: Sym3,
    /// Whether the residual stress ratio has fallen to the limit.
    pub broken: bool,
}

impl EdgeDamage {
    /// An edge that nothing has happened to yet.
    pub(crate) fn intact(strength: f64) -> Self {
        EdgeDamage {
            kappa: strength,
            damage: 0.0,
            lateral: f64::INFINITY,
            share: 1.0,
            strain: Sym3::ZERO,
            broken: false,
        }
    }

    /// What the cheap test compares with: never passed by a damaged edge.
    pub(crate) fn threshold(&self) -> f64 {
        if self.damage > 0.0 { f64::NEG_INFINITY } else { self.kappa }
    }
}

/// What the edges of a body share: the law but for the strength, of which each edge has its own.
#[derive(Clone, Debug)]
pub(crate) struct Softens {
    pub(crate) criterion: Criterion,
    pub(crate) hooke: Hooke,
    pub(crate) restraint: Restraint,
    softening: Softening,
    fracture_energy: f64,
    residual: f64,
    unilateral: bool,
    rate_time: f64,
    /// Damage comes from a phase field; histories only keep what it is driven by.
    pub(crate) regularised: bool,
}

impl Softens {
    pub(crate) fn new(body: &Body, zone: &DamageZone) -> Self {
        let &DamageLaw { criterion, softening, fracture_energy, residual, unilateral, rate_time, .. } = &zone.law;
        let regularised = zone.regularisation.is_some();
        Softens {
            criterion,
            hooke: Hooke::of(body),
            restraint: Restraint::of(body),
            softening,
            fracture_energy,
            residual,
            unilateral,
            rate_time,
            regularised,
        }
    }

    /// Whether cracks close, so that damage acts on a part of the stress only.
    pub(crate) fn is_unilateral(&self) -> bool {
        self.unilateral
    }

    /// Effective stress that damage acts on [Pa].
    pub(crate) fn opening_stress(&self, strain: Sym3) -> Sym3 {
        let stress = self.hooke.stress(strain);
        self.closed_stress(strain).map_or(stress, |closed| stress - closed)
    }

    /// What a step takes per volume of an edge whose damage grows [J/m³].
    ///
    /// The work of the step from ε⁰ to ε¹ less the change of the stored energy is ½ (σ⁰ : ε¹ - σ¹ : ε⁰). With the damage d⁰ and d¹ and the
    /// effective stresses s this is ½ (d¹ - d⁰) s¹ : ε⁰ where damage acts on all of the stress, and ½ (d¹ - d⁰) (s¹ - c¹) : ε⁰ +
    /// ½ d⁰ (c⁰ : ε¹ - c¹ : ε⁰) where it leaves the closed part c alone.
    ///
    /// - `damage`: d⁰; zero where it did not act at ε⁰; `strains`: ε⁰ and ε¹; `stress` s¹ and, where cracks close, `closed` c¹ [Pa]
    #[inline(always)]
    pub(crate) fn taken(&self, damage: f64, strains: [Sym3; 2], stress: Sym3, closed: Option<Sym3>) -> Taken {
        let [before, strain] = strains;
        let Some(closed) = closed else {
            return Taken::straight(0.5 * stress.dot(before));
        };
        let switched = match damage {
            0.0 => 0.0,
            _ => {
                let closed_before = compressive_stress(&self.hooke, before, before.negative_part());
                0.5 * damage * (closed_before.dot(strain) - closed.dot(before))
            }
        };
        Taken { per_damage: 0.5 * (stress - closed).dot(before), switched }
    }

    /// Part of the effective stress that damage leaves alone, where cracks close.
    #[inline]
    pub(crate) fn closed_stress(&self, strain: Sym3) -> Option<Sym3> {
        self.unilateral.then(|| compressive_stress(&self.hooke, strain, strain.negative_part()))
    }

    /// The same of four edges.
    #[inline]
    pub(crate) fn closed_stresses(&self, strains: &[Sym3; FOUR]) -> Option<[Sym3; FOUR]> {
        self.unilateral.then(|| {
            let negative = negative_parts(strains);
            std::array::from_fn(|k| compressive_stress(&self.hooke, strains[k], negative[k]))
        })
    }

    /// Equivalent stress of an edge [Pa]; zero without a search for eigenvalues where it stays below its history, or was searched before the forces of a step
    /// of motion, since the phase field has damaged it.
    #[inline(always)]
    pub(crate) fn equivalent(&self, edge: &EdgeDamage, stress: Sym3, dt: f64) -> f64 {
        if self.was_searched(edge, dt) { 0.0 } else { self.equivalent_at_all(edge, stress) }
    }

    /// The same whatever was searched before.
    #[inline(always)]
    pub(crate) fn equivalent_at_all(&self, edge: &EdgeDamage, stress: Sym3) -> f64 {
        let Softens { criterion, .. } = self;
        let below = criterion.surely_below(stress, edge.kappa) || criterion.is_below_by_minors(stress, edge.kappa);
        if below { 0.0 } else { criterion.equivalent_stress(stress) }
    }

    /// The same of four edges, of which `below` are of no interest.
    #[inline(always)]
    pub(crate) fn equivalent_of_four(
        &self,
        edges: &[EdgeDamage],
        stresses: &[Sym3; FOUR],
        below: [bool; FOUR],
        dt: f64,
    ) -> [f64; FOUR] {
        let mut threshold = Lane::ZERO;
        for k in 0..FOUR {
            threshold.0[k] = if below[k] || self.was_searched(&edges[k], dt) { ABOVE_ALL } else { edges[k].kappa };
        }
        equivalent_stresses(&self.criterion, stresses, &threshold)
    }

    /// Whether an edge was searched for eigenvalues before the forces of a step of motion.
    #[inline(always)]
    fn was_searched(&self, edge: &EdgeDamage, dt: f64) -> bool {
        dt > 0.0 && self.regularised && edge.damage > 0.0
    }

    /// Part of the strength that is left by the softening curve.
    pub(crate) fn residual_ratio(&self, kappa: f64, strength: f64, length: f64) -> f64 {
        self.softening.residual_ratio(kappa, strength, length, self.restraint.modulus, self.fracture_energy)
    }

    /// What an edge of this strength sees whose equivalent stress is `q` [Pa].
    #[inline(always)]
    pub(crate) fn see(&self, edge: &EdgeDamage, strength: f64, stress: Sym3, q: f64) -> Seen {
        self.restraint.seen(&self.criterion, [strength, edge.kappa, edge.lateral], stress, q)
    }

    /// Advances the history of an edge to what it sees; returns the growth of damage.
    #[inline(always)]
    pub(crate) fn load(&self, edge: &mut EdgeDamage, seen: Seen, strength: f64, length: f64, dt: f64) -> f64 {
        if seen.stress <= edge.kappa {
            return 0.0;
        }
        (edge.share, edge.lateral) = (seen.share, edge.lateral.min(seen.lateral));
        if self.regularised {
            edge.kappa = seen.stress;
            return 0.0;
        }
        edge.kappa +=
            (seen.stress - edge.kappa) * if self.rate_time > 0.0 { (dt / self.rate_time).min(1.0) } else { 1.0 };
        let chi = self.residual_ratio(edge.kappa, strength, length);
        let before = edge.damage;
        edge.damage = before.max(1.0 - seen.share * (strength / edge.kappa * chi));
        edge.broken = edge.broken || chi <= self.residual;
        edge.damage - before
    }
}

/// Damage of a set of edges: those of a block of smoothed cells, or all of a standard body.
#[derive(Clone, Debug)]
pub(crate) struct EdgeField {
    pub(crate) softens: Arc<Softens>,
    /// Numbers of the edges in their body.
    pub(crate) edges: Vec<u32>,
    /// Histories; empty where all edges are intact and another rank evaluates them, see [`EdgeField::keep_histories`].
    pub(crate) state: Vec<EdgeDamage>,
    /// Equivalent stress [Pa] below which an edge of a cell is known to stay intact; negative once it is damaged.
    pub(crate) threshold: Vec<f64>,
    /// Edges whose threshold is negative.
    damaged: usize,
    /// Strength [Pa] of each edge; infinite where damage may not occur.
    pub(crate) strength: Vec<f64>,
    /// Characteristic length [m] of each edge.
    pub(crate) length: Vec<f64>,
    /// Edges of this field that broke since removal last looked.
    pub(crate) fresh: Vec<u32>,
    /// An edge has passed its strength and has no damage yet, which the phase field must give it.
    pub(crate) woken: bool,
}

impl EdgeField {
    /// Intact edges of a body, without their histories.
    pub(crate) fn new(softens: Arc<Softens>, edges: Vec<u32>, threshold: &Threshold) -> Self {
        let strength = edges.iter().map(|&edge| threshold.strength(edge)).collect();
        let length = edges.iter().map(|&edge| threshold.length(edge)).collect();
        EdgeField::of_edges(softens, edges, strength, length)
    }

    /// The same with strength [Pa] and characteristic length [m] of each.
    pub(crate) fn of_edges(softens: Arc<Softens>, edges: Vec<u32>, strength: Vec<f64>, length: Vec<f64>) -> Self {
        EdgeField {
            softens,
            state: Vec::new(),
            threshold: Vec::new(),
            length,
            strength,
            edges,
            damaged: 0,
            fresh: Vec::new(),
            woken: false,
        }
    }

    /// Keeps the histories of its edges from now on.
    pub(crate) fn keep_histories(&mut self) {
        if self.state.is_empty() {
            self.state = self.strength.iter().map(|&strength| EdgeDamage::intact(strength)).collect();
            self.threshold.clone_from(&self.strength);
        }
    }

    /// Lets go of the histories of its edges where nothing has happened to any of them.
    pub(crate) fn forget_intact(&mut self) {
        let mut histories = self.state.iter().zip(&self.strength);
        if histories.all(|(edge, &strength)| *edge == EdgeDamage::intact(strength)) {
            (self.state, self.threshold) = Default::default();
        }
    }

    /// Gives an edge the history that another rank has found.
    pub(crate) fn put(&mut self, index: usize, history: EdgeDamage) {
        self.keep_histories();
        self.state[index] = history;
        self.note(index);
    }

    /// History of an edge.
    pub(crate) fn history(&self, index: usize) -> EdgeDamage {
        self.state.get(index).copied().unwrap_or_else(|| EdgeDamage::intact(self.strength[index]))
    }

    /// Advances the history of an edge to what it sees; returns the growth of damage.
    #[inline(always)]
    pub(crate) fn load(&mut self, index: usize, seen: Seen, dt: f64) -> f64 {
        let edge = &mut self.state[index];
        if seen.stress <= edge.kappa {
            return 0.0;
        }
        let was_broken = edge.broken;
        let growth = self.softens.load(edge, seen, self.strength[index], self.length[index], dt);
        self.woken |= edge.damage == 0.0;
        if edge.broken && !was_broken {
            self.fresh.push(index as u32);
        }
        self.note(index);
        growth
    }

    /// Edges of the body that have passed their strength.
    pub(crate) fn above_strength(&self) -> impl Iterator<Item = u32> + '_ {
        let histories = self.edges.iter().zip(&self.state).zip(&self.strength);
        histories.filter(|((_, state), strength)| state.kappa > **strength).map(|((&edge, _), _)| edge)
    }

    /// Lets an edge that the phase field has found already see this.
    pub(crate) fn see(&mut self, index: usize, seen: Seen) {
        self.softens.load(&mut self.state[index], seen, self.strength[index], self.length[index], 0.0);
        self.note(index);
    }

    /// Raises the damage of an edge to that of the phase field; returns the growth.
    ///
    /// - `stiffness`: ω(d)
    pub(crate) fn soften(&mut self, index: usize, stiffness: f64) -> f64 {
        let edge = &mut self.state[index];
        let growth = (1.0 - edge.share * stiffness - edge.damage).max(0.0);
        edge.damage += growth;
        // The stress across the crack never exceeds ω κ.
        let parted = stiffness * edge.kappa <= self.softens.residual * self.strength[index];
        if parted && !edge.broken {
            edge.broken = true;
            self.fresh.push(index as u32);
        }
        self.note(index);
        growth
    }

    /// Lets the cheap test know the history of an edge.
    #[inline]
    pub(crate) fn note(&mut self, index: usize) {
        let threshold = self.state[index].threshold();
        self.damaged += usize::from(threshold < 0.0 && self.threshold[index] >= 0.0);
        self.threshold[index] = threshold;
    }

    /// Whether an edge of a block is damaged; standard bodies do not count theirs.
    pub(crate) fn is_damaged(&self) -> bool {
        self.damaged > 0
    }

    /// Whether edges are damaged rather than intact, so that four at a time cost less.
    pub(crate) fn is_mostly_damaged(&self) -> bool {
        2 * self.damaged >= self.edges.len()
    }

    /// Has removal look at every broken edge.
    pub(crate) fn renew_fresh(&mut self) {
        let EdgeField { fresh, state, .. } = self;
        fresh.clear();
        fresh.extend((0..).zip(&*state).filter(|(_, edge)| edge.broken).map(|(index, _)| index));
    }

    /// Equivalent stress from which on damage grows [Pa].
    pub(crate) fn onset(&self, index: usize) -> f64 {
        self.state[index].kappa
    }

    /// Damage that an edge would have after what it sees.
    pub(crate) fn trial(&self, index: usize, seen: Seen) -> f64 {
        let mut edge = self.state[index];
        if seen.stress > self.onset(index) {
            self.softens.load(&mut edge, seen, self.strength[index], self.length[index], 0.0);
        }
        edge.damage
    }

    /// Takes over saved histories, by edge of the body. Removal looks at all of them once more, and finds nothing new.
    pub(crate) fn restore(&mut self, saved: &[EdgeDamage]) {
        let is_kept = !self.state.is_empty();
        self.keep_histories();
        for index in 0..self.edges.len() {
            self.state[index] = saved[self.edges[index] as usize];
            self.threshold[index] = self.state[index].threshold();
        }
        self.damaged = self.threshold.iter().filter(|&&threshold| threshold < 0.0).count();
        self.woken = true;
        self.renew_fresh();
        if !is_kept {
            self.forget_intact();
        }
    }
}

/// Stress of the compressive part of the strain, λ⟨tr ε⟩₋ + 2μ ε₋ (Miehe's spectral split).
///
/// - `negative`: ε₋
fn compressive_stress(hooke: &Hooke, strain: Sym3, negative: Sym3) -> Sym3 {
    let stress = negative * (2.0 * hooke.mu) + Sym3::isotropic(hooke.lambda * strain.trace().min(0.0));
    Sym3([stress.0[0], stress.0[1], hooke.zz * stress.0[2], stress.0[3], stress.0[4], stress.0[5]])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::body::{Body, ElementKind};
    use crate::material::Elastic;

    fn edge(unilateral: bool) -> Softens {
        let law = DamageLaw { unilateral, ..DamageLaw::rankine(3e6, 100.0) };
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body = Body::new("edge", ElementKind::T4, vec![[0, 1, 2, 3]], elastic).with_damage(law);
        Softens::new(&body, body.damage.as_ref().unwrap())
    }

    proptest! {
        /// Between any two strains, as damage grows from any value: the work of the mean force is what is stored, what is taken, and
        /// what the step brings where that is more than damage takes.
        #[test]
        fn a_growing_edge_takes_what_it_does_not_give_back_and_never_brings_energy(
            unilateral in any::<bool>(),
            [from, to] in prop::array::uniform2(prop::array::uniform6(-1e-3f64..1e-3)),
            [d0, d1] in prop::array::uniform2(0.0f64..1.0),
        ) {
            let softens = edge(unilateral);
            let (strains, damage) = ([Sym3(from), Sym3(to)], [d0.min(d1), d0.max(d1)]);
            let closed = strains.map(|e| softens.closed_stress(e).unwrap_or(Sym3::ZERO));
            let full = strains.map(|e| softens.hooke.stress(e));
            let nominal = [0, 1].map(|k| (full[k] - closed[k]) * (1.0 - damage[k]) + closed[k]);
            let stored = [0, 1].map(|k| 0.5 * nominal[k].dot(strains[k]));
            let work = 0.5 * (nominal[0] + nominal[1]).dot(strains[1] - strains[0]);
            let taken = softens.taken(damage[0], strains, full[1], unilateral.then_some(closed[1])).by(damage[1] - damage[0]);
            let scale = full[0].dot(strains[0]) + full[1].dot(strains[1]);
            prop_assert!(taken >= 0.0);
            prop_assert!((taken - (work + stored[0] - stored[1]).max(0.0)).abs() <= 1e-6 * scale);
        }

        #[test]
        fn an_open_unilateral_edge_takes_what_scalar_damage_takes(
            from in prop::array::uniform3(0.0f64..1e-3),
            to in prop::array::uniform3(0.0f64..1e-3),
        ) {
            let softens = edge(true);
            let strains = [from, to].map(|[a, b, c]| Sym3([a, b, c, 0.0, 0.0, 0.0]));
            let stress = softens.hooke.stress(strains[1]);
            let scalar = 0.5 * stress.dot(strains[0]);
            let taken = softens.taken(0.5, strains, stress, softens.closed_stress(strains[1])).by(0.25);
            prop_assert!((taken - 0.25 * scalar).abs() <= 1e-9 * scalar + 1e-12);
        }
    }
}
