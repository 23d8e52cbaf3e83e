//! Damage on the edges of a body.

use std::sync::Arc;

use fractum_math::{Sym3, Vec3, negative_parts};
use serde::{Deserialize, Serialize};

use crate::block::Cells;
use crate::body::{DamageZone, Kinematics};
use crate::hooke::Hooke;
use crate::kernel::{self, CellLaw, FOUR};
use crate::material::{Criterion, DamageLaw, Softening};
use crate::taken::Taken;
use crate::threshold::Threshold;

/// History of one edge.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EdgeDamage {
    /// Largest equivalent stress so far [Pa]; starts at the strength.
    pub kappa: f64,
    /// Damage d, 0 to 1.
    pub damage: f64,
    /// Strain at the last step, kept from the onset of damage on.
    pub strain: Sym3,
    /// Whether the residual stress ratio has fallen to the limit.
    pub broken: bool,
}

impl EdgeDamage {
    /// An edge that nothing has happened to yet.
    pub(crate) fn intact(strength: f64) -> Self {
        EdgeDamage { kappa: strength, damage: 0.0, strain: Sym3::ZERO, broken: false }
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
    young_modulus: f64,
    softening: Softening,
    fracture_energy: f64,
    residual: f64,
    unilateral: bool,
    rate_time: f64,
    /// Damage comes from a phase field; histories only keep what it is driven by.
    pub(crate) regularised: bool,
}

impl Softens {
    pub(crate) fn new(zone: &DamageZone, hooke: Hooke, young_modulus: f64) -> Self {
        let &DamageLaw { criterion, softening, fracture_energy, residual, unilateral, rate_time, .. } = &zone.law;
        let regularised = zone.regularisation.is_some();
        Softens {
            criterion,
            hooke,
            young_modulus,
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
        self.hooke.stress(strain) - self.closed_stress(strain)
    }

    /// What a step takes per volume of an edge whose damage grows [J/m³].
    ///
    /// The work of the step from ε⁰ to ε¹ less the change of the stored energy is ½ (σ⁰ : ε¹ - σ¹ : ε⁰). With the damage d⁰ and d¹ and the
    /// effective stresses s this is ½ (d¹ - d⁰) s¹ : ε⁰ where damage acts on all of the stress, and ½ (d¹ - d⁰) (s¹ - c¹) : ε⁰ +
    /// ½ d⁰ (c⁰ : ε¹ - c¹ : ε⁰) where it leaves the closed part c alone.
    ///
    /// - `damage`: d⁰; zero where it did not act at ε⁰; `strains`: ε⁰ and ε¹; `now`: s¹ and c¹ [Pa]
    pub(crate) fn taken(&self, damage: f64, strains: [Sym3; 2], now: [Sym3; 2]) -> Taken {
        let [stress, closed] = now;
        let [before, strain] = strains;
        let switched = match damage {
            _ if !self.unilateral => None,
            0.0 => Some(0.0),
            _ => Some(0.5 * damage * (self.closed_stress(before).dot(strain) - closed.dot(before))),
        };
        Taken { per_damage: 0.5 * (stress - closed).dot(before), switched }
    }

    /// Part of the effective stress that damage leaves alone.
    pub(crate) fn closed_stress(&self, strain: Sym3) -> Sym3 {
        if self.unilateral { compressive_stress(&self.hooke, strain, strain.negative_part()) } else { Sym3::ZERO }
    }

    /// The same of four edges.
    fn closed_stresses(&self, strains: &[Sym3; FOUR]) -> [Sym3; FOUR] {
        if !self.unilateral {
            return [Sym3::ZERO; FOUR];
        }
        let negative = negative_parts(strains);
        std::array::from_fn(|k| compressive_stress(&self.hooke, strains[k], negative[k]))
    }

    /// Whether an edge needs no eigenvalues: below its history it only unloads, and one that the phase field has damaged was searched before the forces of
    /// a step of motion.
    #[inline(always)]
    fn needs_no_search(&self, edge: &EdgeDamage, stress: Sym3, dt: f64) -> bool {
        dt > 0.0 && self.regularised && edge.damage > 0.0 || self.criterion.surely_below(stress, edge.kappa)
    }

    /// Part of the strength that is left by the softening curve.
    pub(crate) fn residual_ratio(&self, kappa: f64, strength: f64, length: f64) -> f64 {
        self.softening.residual_ratio(kappa, strength, length, self.young_modulus, self.fracture_energy)
    }

    /// Advances the history of an edge to the equivalent stress `q`; returns the growth of damage.
    pub(crate) fn load(&self, edge: &mut EdgeDamage, q: f64, strength: f64, length: f64, dt: f64) -> f64 {
        if q <= edge.kappa {
            return 0.0;
        }
        if self.regularised {
            edge.kappa = q;
            return 0.0;
        }
        edge.kappa += (q - edge.kappa) * if self.rate_time > 0.0 { (dt / self.rate_time).min(1.0) } else { 1.0 };
        let chi = self.residual_ratio(edge.kappa, strength, length);
        let before = edge.damage;
        edge.damage = before.max(1.0 - strength / edge.kappa * chi);
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
    pub(crate) state: Vec<EdgeDamage>,
    /// Equivalent stress [Pa] below which an edge of a cell is known to stay intact; negative once it is damaged.
    pub(crate) threshold: Vec<f64>,
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
    /// Intact edges of a body.
    pub(crate) fn new(softens: Arc<Softens>, edges: Vec<u32>, threshold: &Threshold) -> Self {
        let strength: Vec<f64> = edges.iter().map(|&e| threshold.strength[e as usize]).collect();
        EdgeField {
            softens,
            state: strength.iter().map(|&s| EdgeDamage::intact(s)).collect(),
            threshold: strength.clone(),
            length: edges.iter().map(|&e| threshold.length[e as usize]).collect(),
            strength,
            edges,
            fresh: Vec::new(),
            woken: false,
        }
    }

    /// Advances the history of an edge to the equivalent stress `q` [Pa]; returns the growth of damage.
    pub(crate) fn load(&mut self, index: usize, q: f64, dt: f64) -> f64 {
        let edge = &mut self.state[index];
        let was_broken = edge.broken;
        let growth = self.softens.load(edge, q, self.strength[index], self.length[index], dt);
        self.threshold[index] = edge.threshold();
        self.woken |= edge.damage == 0.0;
        if edge.broken && !was_broken {
            self.fresh.push(index as u32);
        }
        growth
    }

    /// Raises the damage of an edge to that of the phase field; returns the growth.
    pub(crate) fn soften(&mut self, index: usize, damage: f64) -> f64 {
        let edge = &mut self.state[index];
        let growth = (damage - edge.damage).max(0.0);
        edge.damage += growth;
        self.threshold[index] = edge.threshold();
        // The stress never exceeds (1 - d) κ.
        let parted = (1.0 - edge.damage) * edge.kappa <= self.softens.residual * self.strength[index];
        if parted && !edge.broken {
            edge.broken = true;
            self.fresh.push(index as u32);
        }
        growth
    }

    /// Has removal look at every broken edge.
    fn renew_fresh(&mut self) {
        let EdgeField { fresh, state, .. } = self;
        fresh.clear();
        fresh.extend((0..).zip(&*state).filter(|(_, edge)| edge.broken).map(|(index, _)| index));
    }

    /// Equivalent stress from which on damage grows [Pa].
    pub(crate) fn onset(&self, index: usize) -> f64 {
        self.state[index].kappa
    }

    /// Damage that an edge would have after the equivalent stress `q` [Pa].
    pub(crate) fn trial(&self, index: usize, q: f64) -> f64 {
        let mut edge = self.state[index];
        if q > self.onset(index) {
            self.softens.load(&mut edge, q, self.strength[index], self.length[index], 0.0);
        }
        edge.damage
    }

    /// Takes over saved histories, by edge of the body. Removal looks at all of them once more, and finds nothing new.
    pub(crate) fn restore(&mut self, saved: &[EdgeDamage]) {
        let EdgeField { edges, state, threshold, .. } = self;
        for ((edge, state), threshold) in edges.iter().zip(state).zip(threshold) {
            *state = saved[*edge as usize];
            *threshold = state.threshold();
        }
        self.woken = true;
        self.renew_fresh();
    }
}

/// The edges of one block of smoothed cells.
#[derive(Clone, Debug)]
pub(crate) struct EdgeCells {
    pub(crate) field: EdgeField,
    /// Energy dissipated in this block so far [J].
    pub(crate) dissipated: f64,
    /// Elastic energy of the last step, where it was asked for [J].
    pub(crate) energy: Option<f64>,
}

/// The step that led to the present displacements.
#[derive(Clone, Copy)]
pub(crate) struct Advance<'a> {
    /// Displacements now [m].
    pub(crate) displacement: &'a [Vec3],
    /// Velocities since the step before [m/s].
    pub(crate) velocity: &'a [Vec3],
    /// Time since the step before [s]; 0 if nothing has moved.
    pub(crate) dt: f64,
    pub(crate) kinematics: Kinematics,
}

impl Advance<'_> {
    /// Elastic strain of a cell now.
    pub(crate) fn strain_now(&self, cells: &Cells, cell: usize) -> Sym3 {
        let strain = kernel::strain(&cells.gradient(cell, |node| self.displacement[node]), self.kinematics);
        cells.elastic_strain(cell, strain)
    }

    /// Elastic strain of a cell at the step before.
    pub(crate) fn strain_before(&self, cells: &Cells, cell: usize) -> Sym3 {
        let h = cells.gradient(cell, |node| self.displacement[node] - self.velocity[node] * self.dt);
        cells.elastic_strain_before(cell, kernel::strain(&h, self.kinematics))
    }
}

/// The edges of one block in one step, as the law of their cells; four at a time where cracks close.
pub(crate) struct EdgesInStep<'a, const BY_FOURS: bool> {
    pub(crate) edges: &'a mut EdgeCells,
    pub(crate) cells: &'a Cells,
    pub(crate) step: Advance<'a>,
}

impl<const BY_FOURS: bool> EdgesInStep<'_, BY_FOURS> {
    /// Takes over the strain that an edge has all at once because elements around it left.
    ///
    /// Nothing is booked as damage: the energy belongs to the removal.
    pub(crate) fn settle(&mut self, cell: usize) {
        let strain = self.step.strain_now(self.cells, cell);
        let field = &self.edges.field;
        let stress = field.softens.hooke.stress(strain);
        if field.softens.criterion.surely_below(stress, field.threshold[cell]) {
            return;
        }
        let booked = (self.edges.dissipated, self.edges.energy);
        self.loaded_stress(cell, strain, stress);
        (self.edges.dissipated, self.edges.energy) = booked;
        // The next forces belong to the same step.
        self.edges.field.state[cell].strain = self.step.strain_before(self.cells, cell);
    }

    /// Takes from an edge the stiffness with which it would store more than `most` [J]; damage of a phase field has no value
    /// of its own.
    pub(crate) fn weaken(&mut self, cell: usize, most: f64) {
        let field = &mut self.edges.field;
        if field.softens.regularised {
            return;
        }
        let strain = self.step.strain_now(self.cells, cell);
        let (opening, full) = (field.softens.opening_stress(strain), field.softens.hooke.stress(strain));
        let [open, closed] = [opening, full - opening].map(|s| 0.5 * s.dot(strain) * self.cells.volume[cell]);
        let needed = 1.0 - ((most - closed) / open).max(0.0);
        if open > 0.0 && needed > field.state[cell].damage {
            let before = self.step.strain_before(self.cells, cell);
            let edge = &mut field.state[cell];
            (edge.damage, edge.strain) = (needed, before);
            field.threshold[cell] = edge.threshold();
        }
    }

    /// Stress times volume of an edge that is damaged or may become so.
    #[inline(never)]
    fn loaded_stress(&mut self, cell: usize, strain: Sym3, stress: Sym3) -> Sym3 {
        let EdgeField { softens, state, .. } = &self.edges.field;
        let below = softens.needs_no_search(&state[cell], stress, self.step.dt);
        let q = if below { 0.0 } else { softens.criterion.equivalent_stress(stress) };
        let closed = softens.closed_stress(strain);
        self.advance(cell, strain, [stress, closed], q)
    }

    /// The same of four edges.
    ///
    /// - `below`: which are intact, or have no elements; `stresses`: effective ones
    #[inline(never)]
    fn loaded_stresses(
        &mut self,
        first: usize,
        below: [bool; FOUR],
        strains: &[Sym3; FOUR],
        stresses: [Sym3; FOUR],
    ) -> [Sym3; FOUR] {
        let EdgeField { softens, state, .. } = &self.edges.field;
        let closed = softens.closed_stresses(strains);
        let unloads: [bool; FOUR] =
            std::array::from_fn(|k| below[k] || softens.needs_no_search(&state[first + k], stresses[k], self.step.dt));
        let all_unload = unloads == [true; FOUR];
        let q = if all_unload { [0.0; FOUR] } else { softens.criterion.equivalent_stresses(&stresses) };
        std::array::from_fn(|k| {
            if below[k] {
                return self.intact_stress(first + k, strains[k], stresses[k]);
            }
            self.advance(first + k, strains[k], [stresses[k], closed[k]], if unloads[k] { 0.0 } else { q[k] })
        })
    }

    /// Stress times volume of an edge without damage.
    #[inline(always)]
    fn intact_stress(&mut self, cell: usize, strain: Sym3, stress: Sym3) -> Sym3 {
        let volume = self.cells.volume[cell];
        if let Some(energy) = &mut self.edges.energy {
            *energy += 0.5 * stress.dot(strain) * volume;
        }
        stress * volume
    }

    /// Lets an edge see its equivalent stress `q`; returns its stress times volume.
    ///
    /// - `closed`: part of the effective `stress` that damage leaves alone
    #[inline]
    fn advance(&mut self, cell: usize, strain: Sym3, [stress, closed]: [Sym3; 2], q: f64) -> Sym3 {
        let EdgeCells { field, dissipated, energy } = &mut *self.edges;
        let (opening, volume) = (stress - closed, self.cells.volume[cell]);
        let EdgeDamage { damage: damage_before, strain: kept, .. } = field.state[cell];
        let growth = field.load(cell, q, self.step.dt);
        let edge = &mut field.state[cell];
        if growth > 0.0 {
            // An edge that was intact has kept no strain.
            let before = if damage_before == 0.0 { self.step.strain_before(self.cells, cell) } else { kept };
            let taken = field.softens.taken(damage_before, [before, strain], [stress, closed]);
            *dissipated += taken.by(growth) * volume;
        }
        edge.strain = strain;
        let nominal = opening * (1.0 - edge.damage) + closed;
        if let Some(energy) = energy {
            *energy += 0.5 * nominal.dot(strain) * volume;
        }
        nominal * volume
    }
}

impl<const BY_FOURS: bool> CellLaw for EdgesInStep<'_, BY_FOURS> {
    const BY_FOURS: bool = BY_FOURS;

    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, _volume: f64) -> Sym3 {
        let softens = &self.edges.field.softens;
        let stress = softens.hooke.stress(strain);
        if softens.criterion.surely_below(stress, self.edges.field.threshold[cell]) {
            return self.intact_stress(cell, strain, stress);
        }
        self.loaded_stress(cell, strain, stress)
    }

    #[inline(always)]
    fn scaled_stresses(&mut self, first: usize, strains: &[Sym3; FOUR], volumes: &[f64; FOUR]) -> [Sym3; FOUR] {
        let EdgeField { softens, threshold, .. } = &self.edges.field;
        let threshold = &threshold[first..first + FOUR];
        let (mut stresses, mut below, mut all_below) = ([Sym3::ZERO; FOUR], [true; FOUR], true);
        for k in 0..FOUR {
            stresses[k] = softens.hooke.stress(strains[k]);
            below[k] = volumes[k] == 0.0 || softens.criterion.surely_below(stresses[k], threshold[k]);
            all_below &= below[k];
        }
        if !all_below {
            return self.loaded_stresses(first, below, strains, stresses);
        }
        for k in 0..FOUR {
            stresses[k] = self.intact_stress(first + k, strains[k], stresses[k]);
        }
        stresses
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        1.0 - self.edges.field.state[cell].damage
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

    fn unilateral() -> Softens {
        let law = DamageLaw { unilateral: true, ..DamageLaw::rankine(3e6, 100.0) };
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body = Body::new("edge", ElementKind::T4, vec![[0, 1, 2, 3]], elastic).with_damage(law);
        Softens::new(body.damage.as_ref().unwrap(), Hooke::of(&body), elastic.young_modulus)
    }

    proptest! {
        /// Between any two strains, as damage grows from any value: the work of the mean force is what is stored, what is taken, and
        /// what a crack that closes or opens brings where that is more than damage takes.
        #[test]
        fn a_growing_unilateral_edge_takes_what_it_does_not_give_back(
            [from, to] in prop::array::uniform2(prop::array::uniform6(-1e-3f64..1e-3)),
            [d0, d1] in prop::array::uniform2(0.0f64..1.0),
        ) {
            let softens = unilateral();
            let (strains, damage) = ([Sym3(from), Sym3(to)], [d0.min(d1), d0.max(d1)]);
            let closed = strains.map(|e| softens.closed_stress(e));
            let full = strains.map(|e| softens.hooke.stress(e));
            let nominal = [0, 1].map(|k| (full[k] - closed[k]) * (1.0 - damage[k]) + closed[k]);
            let stored = [0, 1].map(|k| 0.5 * nominal[k].dot(strains[k]));
            let work = 0.5 * (nominal[0] + nominal[1]).dot(strains[1] - strains[0]);
            let taken = softens.taken(damage[0], strains, [full[1], closed[1]]).by(damage[1] - damage[0]);
            let scale = full[0].dot(strains[0]) + full[1].dot(strains[1]);
            prop_assert!(taken >= 0.0);
            prop_assert!((taken - (work + stored[0] - stored[1]).max(0.0)).abs() <= 1e-6 * scale);
        }

        #[test]
        fn an_open_unilateral_edge_takes_what_scalar_damage_takes(
            from in prop::array::uniform3(0.0f64..1e-3),
            to in prop::array::uniform3(0.0f64..1e-3),
        ) {
            let softens = unilateral();
            let strains = [from, to].map(|[a, b, c]| Sym3([a, b, c, 0.0, 0.0, 0.0]));
            let stress = softens.hooke.stress(strains[1]);
            let scalar = 0.5 * stress.dot(strains[0]);
            let taken = softens.taken(0.5, strains, [stress, softens.closed_stress(strains[1])]).by(0.25);
            prop_assert!((taken - 0.25 * scalar).abs() <= 1e-9 * scalar + 1e-12);
        }
    }
}
