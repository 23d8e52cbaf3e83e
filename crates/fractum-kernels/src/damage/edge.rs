//! Damage of one edge, of which a body keeps many.

use serde::{Deserialize, Serialize};

use crate::damage::{Band, Beds, CrackFriction, Restraint, Seen, Taken};
use crate::material::{Criterion, DamageLaw, Hooke, Softening, equivalent_stresses};
use crate::{FOUR, Lane, Sym3, Vec3, negative_parts};

/// An equivalent stress beyond all that occur [Pa], of which the square is a number.
pub const ABOVE_ALL: f64 = 1e100;

/// Volume strain over κ/E' from which on a crack that rubs counts as open: 1 where a crack opens straight. Parts of a crack that slides open and close.
const OPENED: f64 = 0.5;

/// Characteristic length of an edge of bedded rock over the one at which its softening snaps back, at most.
const MOST_OF_LENGTH: f64 = 0.95;

/// History of one edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EdgeDamage {
    /// Largest equivalent stress so far [Pa]; starts at the strength.
    pub kappa: f64,
    /// Damage d, 0 to 1.
    pub damage: f64,
    /// Sum of the lateral principal stresses at the onset of damage [Pa]; infinite before.
    pub lateral: f64,
    /// Part of the largest effective principal stress that belonged to the opening when κ last grew; where cracks rub, what their friction allows
    /// ([`CrackFriction::limit`]), 1 before the onset.
    pub share: f64,
    /// Strain at the last step, kept from the onset of damage on; where cracks rub, the slip that friction has taken since then; in bedded rock what
    /// [`EdgeDamage::band`] reads.
    pub strain: Sym3,
    /// Whether the residual stress ratio has fallen to the limit.
    pub broken: bool,
}

impl EdgeDamage {
    /// An edge that nothing has happened to yet.
    #[inline]
    pub fn intact(strength: f64) -> Self {
        EdgeDamage {
            kappa: strength,
            damage: 0.0,
            lateral: f64::INFINITY,
            share: 1.0,
            strain: Sym3::ZERO,
            broken: false,
        }
    }

    /// What an edge of bedded rock has kept of the onset of its damage.
    #[inline]
    pub fn band(&self) -> Band {
        let [pull, longer, x, y, z, held] = self.strain.0;
        Band { pull, longer, direction: Vec3::new(x, y, z), held }
    }

    /// What the cheap test compares with: never passed by a damaged edge.
    #[inline]
    pub fn threshold(&self) -> f64 {
        if self.damage > 0.0 { f64::NEG_INFINITY } else { self.kappa }
    }
}

/// What the edges of a body share: the law but for the strength, of which each edge has its own.
#[derive(Clone, Debug)]
pub struct Softens {
    /// Equivalent stress that drives damage.
    pub criterion: Criterion,
    /// Elastic law.
    pub hooke: Hooke,
    /// Lateral restraint of the crack.
    pub restraint: Restraint,
    softening: Softening,
    fracture_energy: f64,
    residual: f64,
    unilateral: bool,
    /// Friction of closed cracks, where they rub.
    pub friction: Option<CrackFriction>,
    rate_time: f64,
    /// Beds of the rock; their elasticity stands in place of `hooke`.
    pub beds: Option<Beds>,
    /// Damage comes from a phase field; histories only keep what it is driven by.
    pub regularised: bool,
}

impl Softens {
    /// What a law gives in a body.
    pub fn new(law: &DamageLaw, hooke: Hooke, restraint: Restraint) -> Self {
        let &DamageLaw { criterion, softening, fracture_energy, residual, unilateral, friction, rate_time, .. } = law;
        Softens {
            criterion,
            hooke,
            restraint,
            softening,
            fracture_energy,
            residual,
            unilateral,
            friction: friction.map(|coefficient| CrackFriction::new(coefficient, &hooke)),
            rate_time,
            beds: None,
            regularised: restraint.is_spread,
        }
    }

    /// The same in bedded rock.
    pub fn bedded(self, beds: Beds) -> Self {
        Softens { beds: Some(beds), ..self }
    }

    /// Effective stress of a strain [Pa].
    #[inline]
    pub fn stress(&self, strain: Sym3) -> Sym3 {
        self.beds.as_ref().map_or_else(|| self.hooke.stress(strain), |beds| beds.stiffness.stress(strain))
    }

    /// Whether cracks close, so that damage acts on a part of the stress only.
    #[inline]
    pub fn is_unilateral(&self) -> bool {
        self.unilateral
    }

    /// Effective stress that damage acts on [Pa].
    #[inline]
    pub fn opening_stress(&self, strain: Sym3) -> Sym3 {
        let stress = self.stress(strain);
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
    pub fn taken(&self, damage: f64, strains: [Sym3; 2], stress: Sym3, closed: Option<Sym3>) -> Taken {
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
    pub fn closed_stress(&self, strain: Sym3) -> Option<Sym3> {
        self.unilateral.then(|| compressive_stress(&self.hooke, strain, strain.negative_part()))
    }

    /// The same of four edges.
    #[inline]
    pub fn closed_stresses(&self, strains: &[Sym3; FOUR]) -> Option<[Sym3; FOUR]> {
        self.unilateral.then(|| {
            let negative = negative_parts(strains);
            core::array::from_fn(|k| compressive_stress(&self.hooke, strains[k], negative[k]))
        })
    }

    /// Equivalent stress of an edge [Pa]; zero without a search for eigenvalues where it stays below its history, or was searched before the forces of a step
    /// of motion, since the phase field has damaged it.
    #[inline(always)]
    pub fn equivalent(&self, edge: &EdgeDamage, stress: Sym3, dt: f64) -> f64 {
        if self.was_searched(edge, dt) { 0.0 } else { self.equivalent_at_all(edge, stress) }
    }

    /// The same whatever was searched before.
    #[inline(always)]
    pub fn equivalent_at_all(&self, edge: &EdgeDamage, stress: Sym3) -> f64 {
        let Softens { criterion, .. } = self;
        let below = criterion.surely_below(stress, edge.kappa) || criterion.is_below_by_minors(stress, edge.kappa);
        if below { 0.0 } else { criterion.equivalent_stress(stress) }
    }

    /// The same of four edges, of which `below` are of no interest.
    #[inline(always)]
    pub fn equivalent_of_four(
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
    #[inline]
    pub fn residual_ratio(&self, kappa: f64, strength: f64, length: f64) -> f64 {
        self.softening.residual_ratio(kappa, strength, length, self.restraint.modulus, self.fracture_energy)
    }

    /// Part of its fracture energy that an edge has spent, 0 to 1.
    pub fn spent_ratio(&self, kappa: f64, strength: f64, length: f64) -> f64 {
        self.softening.spent_ratio(kappa, strength, length, self.restraint.modulus, self.fracture_energy)
    }

    /// Characteristic length of an edge over the one at which its softening snaps back.
    pub fn length_ratio(&self, strength: f64, length: f64) -> f64 {
        length / self.softening.largest_length(self.restraint.modulus, strength, self.fracture_energy)
    }

    /// What an edge of this strength sees whose equivalent stress is `q` [Pa].
    #[inline(always)]
    pub fn see(&self, edge: &EdgeDamage, strength: f64, stress: Sym3, q: f64) -> Seen {
        self.restraint.seen(&self.criterion, [strength, edge.kappa, edge.lateral], stress, q)
    }

    /// The same in bedded rock.
    pub fn see_with_beds(&self, beds: &Beds, edge: &EdgeDamage, strength: f64, stress: Sym3) -> Seen {
        beds.seen(&self.criterion, [strength, edge.kappa, edge.lateral], edge.band(), stress)
    }

    /// Characteristic length by which an edge of bedded rock softens, below the one at which it would snap back.
    fn length_of(&self, band: Band, strength: f64, length: f64) -> f64 {
        let longest = self.softening.largest_length(self.restraint.modulus, strength, self.fracture_energy);
        (length * band.longer).min(MOST_OF_LENGTH * longest)
    }

    /// Advances the history of an edge to what it sees; returns the growth of damage.
    #[inline(always)]
    pub fn load(&self, edge: &mut EdgeDamage, seen: Seen, strength: f64, length: f64, dt: f64) -> f64 {
        if seen.stress <= edge.kappa {
            return 0.0;
        }
        let mut length = length;
        if self.beds.is_some() {
            if edge.lateral == f64::INFINITY {
                let Band { pull, longer, direction, held } = seen.band;
                let [x, y, z] = direction.into();
                edge.strain = Sym3([pull, longer, x, y, z, held]);
            }
            length = self.length_of(edge.band(), strength, length);
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
        edge.broken = edge.broken || chi <= self.residual && self.friction.is_none();
        edge.damage - before
    }

    /// Whether an edge whose cracks rub is now broken: nothing to speak of is left of its strength, and its crack is open by a part of what broke it.
    #[inline]
    pub fn is_open(&self, edge: &EdgeDamage, strain: Sym3, strength: f64) -> bool {
        let is_cut = (1.0 - edge.damage) * edge.kappa <= self.residual * strength;
        is_cut && strain.trace() * self.restraint.modulus >= OPENED * edge.kappa
    }

    /// Raises the damage of an edge to that of the phase field; returns the growth.
    ///
    /// - `stiffness`: ω(d)
    #[inline]
    pub fn soften(&self, edge: &mut EdgeDamage, stiffness: f64, strength: f64) -> f64 {
        let growth = (1.0 - edge.share * stiffness - edge.damage).max(0.0);
        edge.damage += growth;
        // The stress across the crack never exceeds ω κ.
        edge.broken = edge.broken || stiffness * edge.kappa <= self.residual * strength;
        growth
    }
}

/// Stress of the compressive part of the strain, λ⟨tr ε⟩₋ + 2μ ε₋ (Miehe's spectral split).
///
/// - `negative`: ε₋
#[inline]
fn compressive_stress(hooke: &Hooke, strain: Sym3, negative: Sym3) -> Sym3 {
    let stress = negative * (2.0 * hooke.mu) + Sym3::isotropic(hooke.lambda * strain.trace().min(0.0));
    Sym3([stress.0[0], stress.0[1], hooke.zz * stress.0[2], stress.0[3], stress.0[4], stress.0[5]])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::material::Elastic;

    fn edge(unilateral: bool) -> Softens {
        let law = DamageLaw { unilateral, ..DamageLaw::rankine(3e6, 100.0) };
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        Softens::new(&law, Hooke::new(&elastic, None), Restraint::new(&elastic, None, false))
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
