//! Damage in the standard formulation: edges average the stress of their elements, elements take the damage of the way
//! a plane cuts them (Oñate, Zárate et al. 2017, extended to three dimensions by the seven cuts of a tetrahedron).

use std::sync::Arc;

use fractum_kernels::damage::{EdgeDamage, EdgeRate, Softens, Taken};
use fractum_math::{Lane, Ragged, Sym3, widest};
use rayon::prelude::*;

use crate::body::ElementKind;
use crate::cells::block::{BLOCK_NODES, Cells, Run};
use crate::cells::kernel::{add_cell_forces, gradient_columns, small_strain, symmetric_columns};
use crate::cells::law::CellLaw;
use crate::damage::edge::EdgeField;
use crate::damage::rate::RateInStep;
use crate::element::cut_modes;

/// Damage state of a standard body.
#[derive(Clone, Debug)]
pub(crate) struct StandardDamage {
    pub(crate) field: EdgeField,
    pub(crate) shape: ElementKind,
    pub(crate) elements_of_edge: Ragged,
    /// Which elements [may load](StandardCells::may_load) an edge, in the order of the body.
    may_load: Vec<bool>,
    /// The elements around each [`GROUP`] of edges.
    elements_of_group: Ragged,
    /// What happened to runs of [`EDGES`] edges in the last step.
    runs: Vec<RunOfEdges>,
}

/// Edges that one task advances.
const EDGES: usize = 1024;
/// Edges that are left alone together where none of their elements may load them.
const GROUP: usize = 64;

/// What happened to a run of edges in a step.
#[derive(Clone, Debug, Default)]
struct RunOfEdges {
    /// A bit for each edge whose damage grew: no list, which a step would have to lengthen.
    grown: [u64; EDGES / GROUP],
    /// Edges that broke.
    broke: Vec<u32>,
    /// Whether an edge has seen more than ever before.
    loaded: bool,
}

/// The element cells of one block of a standard body with damage.
#[derive(Clone, Debug)]
pub(crate) struct StandardCells {
    pub(crate) softens: Arc<Softens>,
    /// Effective stress of each cell [Pa]; written by the first pass, read by the edges.
    pub(crate) stress: Vec<Sym3>,
    pub(crate) damage: Vec<f64>,
    /// ½ σ : ε between the stress before and the strain after the step: what damage dissipates per volume [J/m³].
    pub(crate) mixed_energy: Vec<f64>,
    /// Elastic energy of the present step, where it is asked for [J].
    pub(crate) energy: Option<f64>,
    /// Least stress that the edges of each cell had seen when it last took over their damage, less [`DOUBT`] [Pa]; they may have seen more.
    least_seen: Vec<f64>,
    /// Whether the stress of a cell may be above [`StandardCells::least_seen`]. An edge around which there are no such cells sees no
    /// more than it has, since every criterion is convex.
    pub(crate) may_load: Vec<bool>,
    /// A bit for each cell whose edges may have another damage than it knows of.
    stale: Vec<u64>,
}

/// Share of a stress by which rounding of a mean is less.
const DOUBT: f64 = 1e-9;

impl StandardCells {
    /// Undamaged cells without stress.
    pub(crate) fn new(softens: Arc<Softens>, count: usize) -> Self {
        let zeros = vec![0.0; count];
        let mut cells = StandardCells {
            softens,
            stress: vec![Sym3::ZERO; count],
            damage: zeros.clone(),
            mixed_energy: zeros.clone(),
            energy: None,
            least_seen: zeros,
            may_load: vec![true; count],
            stale: vec![0; count.div_ceil(64)],
        };
        cells.expect_any_damage();
        cells
    }

    /// Has a cell take over the damage of its edges once more.
    pub(crate) fn expect_damage(&mut self, cell: usize) {
        self.stale[cell / 64] |= 1 << (cell % 64);
    }

    /// Has all cells do so, and edges look at their stress: histories may be others than before.
    pub(crate) fn expect_any_damage(&mut self) {
        self.least_seen.fill(0.0);
        self.stale.fill(u64::MAX);
    }

    /// Replaces the effective stress of a cell by that of its strain.
    #[inline(always)]
    pub(crate) fn see(&mut self, cell: usize, strain: Sym3) {
        let Softens { hooke, criterion, .. } = &*self.softens;
        let stress = hooke.stress(strain);
        self.mixed_energy[cell] = 0.5 * self.stress[cell].dot(strain);
        self.stress[cell] = stress;
        let least = self.least_seen[cell];
        self.may_load[cell] =
            !(criterion.surely_below(stress, least) || least > 0.0 && criterion.is_below_by_minors(stress, least));
    }

    /// Gives a cell what its edges have: their damage and the least stress that one of them has seen; returns what the damage dissipates per volume
    /// [J/m³].
    pub(crate) fn take(&mut self, cell: usize, (damage, least_seen): (f64, f64)) -> f64 {
        let damage = damage.max(self.damage[cell]);
        let taken = Taken::straight(self.mixed_energy[cell]).by(damage - self.damage[cell]);
        self.damage[cell] = damage;
        self.least_seen[cell] = least_seen * (1.0 - DOUBT);
        taken
    }

    /// The next cell that [is to take over](StandardCells::expect_damage) the damage of its edges, ascending; it is so no longer.
    ///
    /// - `word`: where to look first; 0 at the start
    pub(crate) fn next_stale(&mut self, word: &mut usize) -> Option<usize> {
        while let Some(bits) = self.stale.get_mut(*word) {
            if *bits != 0 {
                let bit = bits.trailing_zeros() as usize;
                *bits &= *bits - 1;
                let cell = 64 * *word + bit;
                return (cell < self.damage.len()).then_some(cell);
            }
            *word += 1;
        }
        None
    }
}

impl StandardDamage {
    /// Damage of a body.
    ///
    /// - `elements`: number of elements
    pub(crate) fn new(field: EdgeField, shape: ElementKind, elements_of_edge: Ragged, elements: usize) -> Self {
        let edges = field.state.len();
        let group = |first: usize| {
            let own = (first..edges.min(first + GROUP)).flat_map(|edge| elements_of_edge.row(edge));
            let mut elements: Vec<u32> = own.copied().collect();
            elements.sort_unstable();
            elements.dedup();
            elements
        };
        let elements_of_group = Ragged::from_rows((0..edges).step_by(GROUP).map(group));
        let runs = vec![RunOfEdges::default(); edges.div_ceil(EDGES)];
        StandardDamage { field, shape, elements_of_edge, elements_of_group, may_load: vec![true; elements], runs }
    }

    /// Edge histories from the stresses of the elements.
    ///
    /// - `alive`: of the elements; `of`: the cells and the cell that an element is
    pub(crate) fn update_edges<'a>(
        &mut self,
        dt: f64,
        alive: &[bool],
        of: impl Fn(u32) -> (&'a StandardCells, usize) + Sync,
    ) {
        let StandardDamage { field, elements_of_edge, elements_of_group, may_load, runs, .. } = self;
        may_load.par_iter_mut().enumerate().with_min_len(EDGES).for_each(|(element, may_load)| {
            let (cells, cell) = of(element as u32);
            *may_load = alive[element] && cells.may_load[cell];
        });
        let may_load = |elements: &[u32]| elements.iter().any(|&element| may_load[element as usize]);
        let mean_stress = |elements: &[u32]| {
            let (mut sum, mut count) = (Sym3::ZERO, 0);
            for &element in elements.iter().filter(|&&element| alive[element as usize]) {
                let (cells, cell) = of(element);
                sum += cells.stress[cell];
                count += 1;
            }
            sum * (1.0 / f64::from(count))
        };
        let EdgeField { softens, state, strength, length, woken, fresh, rate, .. } = field;
        let advance = |number: usize,
                       (edges, run): (&mut [EdgeDamage], &mut RunOfEdges),
                       strength: &mut [f64],
                       mut rates: Option<(RateInStep<'_>, &mut [EdgeRate])>| {
            run.clear();
            for (word, group) in edges.chunks_mut(GROUP).enumerate() {
                let first = number * EDGES + word * GROUP;
                if !may_load(elements_of_group.row(first / GROUP)) {
                    continue;
                }
                for (place, edge) in group.iter_mut().enumerate() {
                    let index = first + place;
                    let elements = elements_of_edge.row(index);
                    if !may_load(elements) {
                        continue;
                    }
                    let stress = mean_stress(elements);
                    let q = softens.equivalent_at_all(edge, stress);
                    if q == 0.0 {
                        continue;
                    }
                    let at = index - number * EDGES;
                    let (was_broken, strength, mut length) = (edge.broken, &mut strength[at], length[index]);
                    let mut seen = softens.see(edge, *strength, stress, q);
                    if let Some((step, rates)) = &mut rates {
                        let rate = &mut rates[at];
                        if seen.stress <= edge.kappa
                            || !step.lets_grow(softens, rate, (edge, &mut seen), (strength, length), stress)
                        {
                            continue;
                        }
                        length /= rate.energy;
                    }
                    let growth = softens.load(edge, seen, *strength, length, dt);
                    run.loaded = true;
                    run.grown[word] |= u64::from(growth > 0.0) << place;
                    run.broke.extend((edge.broken && !was_broken).then_some(index as u32));
                }
            }
        };
        let all = state.par_chunks_mut(EDGES).zip(runs.par_iter_mut()).zip(strength.par_chunks_mut(EDGES)).enumerate();
        match rate {
            None => all.for_each(|(number, (edges, strength))| advance(number, edges, strength, None)),
            Some(rate) => {
                rate.pass(dt);
                let (step, rates) = rate.in_step(dt);
                let all = all.zip(rates.par_chunks_mut(EDGES));
                all.for_each(|((n, (edges, strength)), rates)| advance(n, edges, strength, Some((step, rates))));
            }
        }
        *woken |= runs.iter().any(|run| run.loaded);
        fresh.extend(runs.iter().flat_map(|run| &run.broke));
    }

    /// The elements around edges whose damage grew in the last step, some of them more than once.
    pub(crate) fn elements_of_growth(&self) -> impl Iterator<Item = u32> {
        let words = self.runs.iter().flat_map(|run| &run.grown).enumerate().filter(|(_, word)| **word != 0);
        let grown = words.flat_map(|(place, &word)| {
            (0..GROUP).filter(move |bit| word >> bit & 1 == 1).map(move |bit| GROUP * place + bit)
        });
        grown.flat_map(|edge| self.elements_of_edge.row(edge)).copied()
    }

    /// Damage of an element with these edges: the largest mean over the ways a crack cuts it; under a phase field, whose band is
    /// wider than the element, the mean of all.
    ///
    /// - `damage`: of an edge of the body
    pub(crate) fn element_damage(&self, edges: &[u32], damage: impl Fn(u32) -> f64) -> f64 {
        let of = |local: usize| damage(edges[local]);
        if self.field.softens.regularised {
            let count = self.shape.edge_count();
            return (0..count).map(of).sum::<f64>() / count as f64;
        }
        cut_modes(self.shape)
            .iter()
            .map(|mode| mode.iter().map(|&local| of(local)).sum::<f64>() / mode.len() as f64)
            .fold(0.0, f64::max)
    }
}

widest! {
    /// Effective stress of elements that neither turn nor expand, from the displacements of their nodes, and what damage would
    /// dissipate.
    pub(crate) fn stresses(cells: &Cells, displacement: &[Lane; BLOCK_NODES], law: &mut StandardCells) = stresses_by_runs;
}

#[inline(always)]
fn stresses_by_runs(cells: &Cells, displacement: &[Lane; BLOCK_NODES], law: &mut StandardCells) {
    for run in &cells.runs {
        match run.gradients {
            2 if cells.hoop.is_some() => stresses_of_run::<2, true>(cells, run, displacement, law),
            2 => stresses_of_run::<2, false>(cells, run, displacement, law),
            _ => stresses_of_run::<3, false>(cells, run, displacement, law),
        }
    }
}

#[inline(always)]
fn stresses_of_run<const N: usize, const HOOP: bool>(
    cells: &Cells,
    run: &Run,
    displacement: &[Lane; BLOCK_NODES],
    law: &mut StandardCells,
) {
    let start = cells.starts[run.begin] as usize;
    let gradients = cells.gradients[start..].as_chunks::<N>().0;
    let local = cells.local[start + run.begin..].chunks_exact(N + 1);
    for ((cell, gradients), local) in (run.begin..run.end).zip(gradients).zip(local) {
        let hoop = if HOOP { cells.hoop(cell) } else { None };
        let [x, y, z] = gradient_columns(displacement, local, gradients, hoop);
        law.see(cell, small_strain(x, y, z));
    }
}

widest! {
    /// Adds the forces of elements whose [`stresses`] have just been found.
    pub(crate) fn forces(cells: &Cells, force: &mut [Lane; BLOCK_NODES], law: &StandardCells) = forces_by_runs;
}

#[inline(always)]
fn forces_by_runs(cells: &Cells, force: &mut [Lane; BLOCK_NODES], law: &StandardCells) {
    for run in &cells.runs {
        match run.gradients {
            2 if cells.hoop.is_some() => forces_of_run::<2, true>(cells, run, force, law),
            2 => forces_of_run::<2, false>(cells, run, force, law),
            _ => forces_of_run::<3, false>(cells, run, force, law),
        }
    }
}

#[inline(always)]
fn forces_of_run<const N: usize, const HOOP: bool>(
    cells: &Cells,
    run: &Run,
    force: &mut [Lane; BLOCK_NODES],
    law: &StandardCells,
) {
    let start = cells.starts[run.begin] as usize;
    let gradients = cells.gradients[start..].as_chunks::<N>().0;
    let local = cells.local[start + run.begin..].chunks_exact(N + 1);
    for ((cell, gradients), local) in (run.begin..run.end).zip(gradients).zip(local) {
        let volume = cells.volume[cell];
        // A removed element has none.
        if volume > 0.0 {
            let stress = law.stress[cell] * (1.0 - law.damage[cell]) * volume;
            let hoop = if HOOP { cells.hoop(cell) } else { None };
            add_cell_forces(force, local, gradients, symmetric_columns(stress), hoop);
        }
    }
}

impl RunOfEdges {
    /// Keeps the room of its lists, so that a step allocates nothing.
    fn clear(&mut self) {
        self.grown = [0; EDGES / GROUP];
        self.broke.clear();
        self.loaded = false;
    }
}

impl CellLaw for StandardCells {
    #[inline(always)]
    fn scaled_stress(&mut self, cell: usize, strain: Sym3, volume: f64) -> Sym3 {
        let nominal = self.softens.hooke.stress(strain) * (1.0 - self.damage[cell]);
        if let Some(energy) = &mut self.energy {
            *energy += 0.5 * nominal.dot(strain) * volume;
        }
        nominal * volume
    }

    #[inline(always)]
    fn integrity(&self, cell: usize) -> f64 {
        1.0 - self.damage[cell]
    }
}
