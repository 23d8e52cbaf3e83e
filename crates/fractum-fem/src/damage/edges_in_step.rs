//! The edges of a block of smoothed cells in a step: their strains, the growth of their damage, the stress that is left.

use fractum_kernels::damage::{Beds, CrackFriction, EdgeDamage, Rubbed, RubbingStep, Seen, Taken};
use fractum_math::{FOUR, Sym3, Vec3, widest};

use crate::body::Kinematics;
use crate::cells::block::Cells;
use crate::cells::kernel;
use crate::cells::law::CellLaw;
use crate::damage::edge::EdgeField;

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
    #[inline(always)]
    pub(crate) fn strain_now(&self, cells: &Cells, cell: usize) -> Sym3 {
        kernel::elastic_strain(cells, cell, self.displacement, self.kinematics)
    }

    /// Elastic strain of a cell at the step before.
    pub(crate) fn strain_before(&self, cells: &Cells, cell: usize) -> Sym3 {
        let h = cells.gradient(cell, |node| self.displacement[node] - self.velocity[node] * self.dt);
        cells.elastic_strain_before(cell, kernel::strain(&h, self.kinematics))
    }
}

/// The edges of one block in one step, as the law of their cells.
pub(crate) struct EdgesInStep<'a> {
    pub(crate) field: &'a mut EdgeField,
    pub(crate) cells: &'a Cells,
    pub(crate) step: Advance<'a>,
    /// Elastic energy, where it is asked for [J].
    pub(crate) energy: Option<f64>,
    /// Energy dissipated by damage [J].
    pub(crate) dissipated: f64,
    /// Energy taken by the friction of closed cracks [J].
    pub(crate) rubbed: f64,
}

impl EdgesInStep<'_> {
    /// Takes over the strain that an edge has all at once because elements around it left.
    ///
    /// What it books is not damage: the energy belongs to the removal.
    pub(crate) fn settle(&mut self, cell: usize) {
        let strain = self.step.strain_now(self.cells, cell);
        let EdgeField { softens, threshold, .. } = &*self.field;
        let stress = softens.stress(strain);
        if softens.beds.is_none() && softens.criterion.surely_below(stress, threshold[cell]) {
            return;
        }
        loaded_stress(self, cell, strain, stress);
        // The next forces belong to the same step.
        self.keep_strain_before(cell);
    }

    /// Keeps the strain of the step before; cracks that rub keep their slip instead, and edges of bedded rock their band.
    fn keep_strain_before(&mut self, cell: usize) {
        if self.field.softens.friction.is_none() && self.field.softens.beds.is_none() {
            self.field.state[cell].strain = self.step.strain_before(self.cells, cell);
        }
    }

    /// Takes from an edge the stiffness with which it would store more than `most` [J]; damage of a phase field has no value
    /// of its own.
    pub(crate) fn weaken(&mut self, cell: usize, most: f64) {
        let field = &mut *self.field;
        if field.softens.regularised {
            return;
        }
        let strain = self.step.strain_now(self.cells, cell);
        let volume = self.cells.volume[cell];
        let [open, closed] = if let Some(friction) = &field.softens.friction {
            let elastic = strain - field.state[cell].strain;
            let closed = friction.stress(elastic).dot(elastic);
            [field.softens.hooke.stress(strain).dot(strain) - closed, closed].map(|energy| 0.5 * energy * volume)
        } else {
            let (opening, full) = (field.softens.opening_stress(strain), field.softens.stress(strain));
            [opening, full - opening].map(|s| 0.5 * s.dot(strain) * volume)
        };
        let needed = 1.0 - ((most - closed) / open).max(0.0);
        if open > 0.0 && needed > field.state[cell].damage {
            field.state[cell].damage = needed;
            field.note(cell);
            self.keep_strain_before(cell);
        }
    }

    /// Stress times volume of an edge without damage.
    #[inline(always)]
    fn intact_stress(&mut self, cell: usize, strain: Sym3, stress: Sym3) -> Sym3 {
        let volume = self.cells.volume[cell];
        if let Some(energy) = &mut self.energy {
            *energy += 0.5 * stress.dot(strain) * volume;
        }
        stress * volume
    }

    /// Lets an edge see its equivalent stress `q`; returns its stress times volume.
    ///
    /// - `closed`: part of the effective `stress` that damage leaves alone, where cracks close
    #[inline(always)]
    fn advance(&mut self, cell: usize, strain: Sym3, (stress, closed): (Sym3, Option<Sym3>), q: f64) -> Sym3 {
        let EdgesInStep { field, dissipated, energy, .. } = self;
        let volume = self.cells.volume[cell];
        let EdgeDamage { damage: damage_before, strain: kept, .. } = field.state[cell];
        let seen = field.softens.see(&field.state[cell], field.strength[cell], stress, q);
        let growth = field.load(cell, seen, stress, self.step.dt);
        if growth > 0.0 {
            // An edge that was intact has kept no strain.
            let before = if damage_before == 0.0 { self.step.strain_before(self.cells, cell) } else { kept };
            let taken = field.softens.taken(damage_before, [before, strain], stress, closed);
            *dissipated += taken.by(growth) * volume;
        }
        let edge = &mut field.state[cell];
        edge.strain = strain;
        let left = 1.0 - edge.damage;
        let nominal = closed.map_or(stress * left, |closed| (stress - closed) * left + closed);
        if let Some(energy) = energy {
            *energy += 0.5 * nominal.dot(strain) * volume;
        }
        nominal * volume
    }

    /// The same in bedded rock, whose edges keep no strain.
    fn part(&mut self, cell: usize, strain: Sym3, stress: Sym3, seen: Seen) -> Sym3 {
        let EdgesInStep { field, dissipated, energy, cells, step, .. } = self;
        let volume = cells.volume[cell];
        let growth = field.load(cell, seen, stress, step.dt);
        if growth > 0.0 {
            let before = step.strain_before(cells, cell);
            *dissipated += Taken::straight(0.5 * stress.dot(before)).by(growth) * volume;
        }
        let nominal = stress * (1.0 - field.state[cell].damage);
        if let Some(energy) = energy {
            *energy += 0.5 * nominal.dot(strain) * volume;
        }
        nominal * volume
    }

    /// The same where closed cracks rub.
    fn rub(&mut self, cell: usize, strain: Sym3, stress: Sym3, friction: &CrackFriction) -> Sym3 {
        let q = self.field.softens.equivalent(&self.field.state[cell], stress, self.step.dt);
        let EdgesInStep { field, dissipated, rubbed, energy, cells, step } = self;
        let volume = cells.volume[cell];
        let EdgeDamage { damage, strain: slip, share: limit, .. } = field.state[cell];
        let seen = field.softens.see(&field.state[cell], field.strength[cell], stress, q);
        let growth = field.load(cell, seen, stress, step.dt);
        if field.state[cell].damage == 0.0 {
            field.state[cell].share = limit;
            return self.intact_stress(cell, strain, stress);
        }
        let limit = if limit < 1.0 { limit } else { friction.limit(stress.first_principal_value(), q) };
        let strains = [step.strain_before(cells, cell), strain];
        let rubbing = RubbingStep { strains, slip, limit, damage };
        let Rubbed { closed, slip, per_damage, taken } = friction.step(&rubbing, stress);
        *dissipated += Taken::straight(per_damage).by(growth) * volume;
        *rubbed += taken * volume;
        (field.state[cell].strain, field.state[cell].share) = (slip, limit);
        field.let_open(cell, strain);
        let broken = field.state[cell].damage;
        if let Some(energy) = energy {
            *energy += 0.5 * ((1.0 - broken) * stress.dot(strain) + broken * closed.dot(strain - slip)) * volume;
        }
        (stress * (1.0 - broken) + closed * broken) * volume
    }
}

impl CellLaw for EdgesInStep<'_> {
    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, _volume: f64) -> Sym3 {
        let softens = &self.field.softens;
        let stress = softens.hooke.stress(strain);
        if softens.criterion.surely_below(stress, self.field.threshold[cell]) {
            return self.intact_stress(cell, strain, stress);
        }
        loaded_stress(self, cell, strain, stress)
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        1.0 - self.field.state[cell].damage
    }
}

/// The same where closed cracks rub, whose stress has axes of its own.
pub(crate) struct RubbingEdges<'a>(pub(crate) EdgesInStep<'a>);

impl CellLaw for RubbingEdges<'_> {
    const IS_COAXIAL: bool = false;

    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, volume: f64) -> Sym3 {
        self.0.scaled_stress(cell, strain, volume)
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        self.0.integrity(cell)
    }
}

/// The same in bedded rock.
pub(crate) struct BeddedEdges<'a>(pub(crate) EdgesInStep<'a>);

impl CellLaw for BeddedEdges<'_> {
    const IS_COAXIAL: bool = false;

    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, _volume: f64) -> Sym3 {
        let EdgeField { softens, threshold, .. } = &*self.0.field;
        let stress = softens.stress(strain);
        let is_below = |beds: &Beds| beds.surely_below(&softens.criterion, stress, threshold[cell]);
        if softens.beds.as_ref().is_some_and(is_below) {
            return self.0.intact_stress(cell, strain, stress);
        }
        loaded_stress(&mut self.0, cell, strain, stress)
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        self.0.integrity(cell)
    }
}

/// The same four at a time, with the bits that each edge has alone.
pub(crate) struct FourEdgesInStep<'a>(pub(crate) EdgesInStep<'a>);

impl CellLaw for FourEdgesInStep<'_> {
    const BY_FOURS: bool = true;

    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, volume: f64) -> Sym3 {
        self.0.scaled_stress(cell, strain, volume)
    }

    #[inline(always)]
    fn scaled_stresses(&mut self, first: usize, strains: &[Sym3; FOUR], volumes: &[f64; FOUR]) -> [Sym3; FOUR] {
        let EdgeField { softens, threshold, .. } = &*self.0.field;
        let threshold = &threshold[first..first + FOUR];
        let (mut stresses, mut below, mut all_below) = ([Sym3::ZERO; FOUR], [true; FOUR], true);
        for k in 0..FOUR {
            stresses[k] = softens.hooke.stress(strains[k]);
            below[k] = volumes[k] == 0.0 || softens.criterion.surely_below(stresses[k], threshold[k]);
            all_below &= below[k];
        }
        if !all_below {
            return loaded_stresses(&mut self.0, first, below, strains, &stresses);
        }
        for k in 0..FOUR {
            stresses[k] = self.0.intact_stress(first + k, strains[k], stresses[k]);
        }
        stresses
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        self.0.integrity(cell)
    }
}

widest! {
    /// Stress times volume of an edge that is damaged or may become so; out of the way of those that are not.
    #[inline(never)]
    fn loaded_stress(edges: &mut EdgesInStep<'_>, cell: usize, strain: Sym3, stress: Sym3) -> Sym3 = loaded_one;
}

#[inline(always)]
fn loaded_one(edges: &mut EdgesInStep<'_>, cell: usize, strain: Sym3, stress: Sym3) -> Sym3 {
    let EdgeField { softens, state, strength, .. } = &*edges.field;
    if let Some(friction) = softens.friction {
        return edges.rub(cell, strain, stress, &friction);
    }
    if let Some(beds) = &softens.beds {
        let seen = softens.see_with_beds(beds, &state[cell], strength[cell], stress);
        return edges.part(cell, strain, stress, seen);
    }
    let q = softens.equivalent(&state[cell], stress, edges.step.dt);
    let closed = softens.closed_stress(strain);
    edges.advance(cell, strain, (stress, closed), q)
}

widest! {
    /// The same of four edges.
    ///
    /// - `below`: which are intact, or have no elements; `stresses`: effective ones
    #[inline(never)]
    fn loaded_stresses(
        edges: &mut EdgesInStep<'_>,
        first: usize,
        below: [bool; FOUR],
        strains: &[Sym3; FOUR],
        stresses: &[Sym3; FOUR],
    ) -> [Sym3; FOUR] = loaded_four;
}

#[inline(always)]
fn loaded_four(
    edges: &mut EdgesInStep<'_>,
    first: usize,
    below: [bool; FOUR],
    strains: &[Sym3; FOUR],
    stresses: &[Sym3; FOUR],
) -> [Sym3; FOUR] {
    let EdgeField { softens, state, .. } = &*edges.field;
    let q = softens.equivalent_of_four(&state[first..first + FOUR], stresses, below, edges.step.dt);
    let closed = softens.closed_stresses(strains);
    let mut scaled = [Sym3::ZERO; FOUR];
    for k in 0..FOUR {
        scaled[k] = if below[k] {
            edges.intact_stress(first + k, strains[k], stresses[k])
        } else {
            edges.advance(first + k, strains[k], (stresses[k], closed.as_ref().map(|closed| closed[k])), q[k])
        };
    }
    scaled
}
