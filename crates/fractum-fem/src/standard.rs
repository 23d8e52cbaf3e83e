//! Damage in the standard formulation: edges average the stress of their elements, elements take the damage of the way
//! a plane cuts them (Oñate, Zárate et al. 2017, extended to three dimensions by the seven cuts of a tetrahedron).

use std::sync::Arc;

use fractum_math::{Lane, Ragged, Sym3, widest};
use rayon::prelude::*;

use crate::block::{BLOCK_NODES, Cells, Run};
use crate::body::ElementKind;
use crate::damage::{EdgeField, Softens};
use crate::element::cut_modes;
use crate::kernel::{CellLaw, add_cell_forces, gradient_columns, small_strain, symmetric_columns};

/// Damage state of a standard body.
#[derive(Clone, Debug)]
pub(crate) struct StandardDamage {
    pub(crate) field: EdgeField,
    pub(crate) shape: ElementKind,
    pub(crate) elements_of_edge: Ragged,
    /// Effective stress of the elements in the order of the body [Pa], which the edges gather.
    stress: Vec<Sym3>,
    /// What happened to runs of [`EDGES`] edges in the last step.
    runs: Vec<RunOfEdges>,
}

/// Edges that one task advances.
const EDGES: usize = 1024;

/// What happened to a run of edges in a step.
#[derive(Clone, Debug, Default)]
struct RunOfEdges {
    /// A bit for each edge whose damage grew: no list, which a step would have to lengthen.
    grown: [u64; EDGES / 64],
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
    pub(crate) dissipated: f64,
    pub(crate) energy: Option<f64>,
    /// Edges may have another damage than the elements know of.
    pub(crate) is_stale: bool,
}

impl StandardCells {
    /// Undamaged cells without stress.
    pub(crate) fn new(softens: Arc<Softens>, count: usize) -> Self {
        let (stress, damage, mixed_energy) = (vec![Sym3::ZERO; count], vec![0.0; count], vec![0.0; count]);
        StandardCells { softens, stress, damage, mixed_energy, dissipated: 0.0, energy: None, is_stale: true }
    }
}

impl StandardDamage {
    /// Damage of a body.
    ///
    /// - `elements`: number of elements
    pub(crate) fn new(field: EdgeField, shape: ElementKind, elements_of_edge: Ragged, elements: usize) -> Self {
        let runs = vec![RunOfEdges::default(); field.state.len().div_ceil(EDGES)];
        StandardDamage { field, shape, elements_of_edge, stress: vec![Sym3::ZERO; elements], runs }
    }

    /// Edge histories from the stresses of the elements.
    ///
    /// - `alive`: of the elements; `stress_of`: effective stress of an element [Pa]
    pub(crate) fn update_edges(&mut self, dt: f64, alive: &[bool], stress_of: impl Fn(u32) -> Sym3 + Sync) {
        let StandardDamage { field, elements_of_edge, stress, runs, .. } = self;
        stress.par_iter_mut().enumerate().with_min_len(EDGES).for_each(|(e, own)| *own = stress_of(e as u32));
        let EdgeField { softens, state, strength, length, woken, fresh, .. } = field;
        let all = state.par_chunks_mut(EDGES).zip(runs.par_iter_mut()).enumerate();
        all.for_each(|(number, (edges, run))| {
            run.clear();
            for (index, edge) in (number * EDGES..).zip(edges) {
                let (mut sum, mut count) = (Sym3::ZERO, 0);
                for &element in elements_of_edge.row(index).iter().filter(|&&e| alive[e as usize]) {
                    sum += stress[element as usize];
                    count += 1;
                }
                let mean = sum * (1.0 / f64::from(count));
                let criterion = &softens.criterion;
                let is_below =
                    || criterion.surely_below(mean, edge.kappa) || criterion.is_below_by_minors(mean, edge.kappa);
                if count == 0 || is_below() {
                    continue;
                }
                let was_broken = edge.broken;
                let q = softens.criterion.equivalent_stress(mean);
                let growth = softens.load(edge, q, strength[index], length[index], dt);
                run.loaded = true;
                let place = index % EDGES;
                run.grown[place / 64] |= u64::from(growth > 0.0) << (place % 64);
                run.broke.extend((edge.broken && !was_broken).then_some(index as u32));
            }
        });
        *woken |= runs.iter().any(|run| run.loaded);
        fresh.extend(runs.iter().flat_map(|run| &run.broke));
    }

    /// The elements around edges whose damage grew in the last step, some of them more than once.
    pub(crate) fn elements_of_growth(&self) -> impl Iterator<Item = u32> {
        let words = self.runs.iter().flat_map(|run| &run.grown).enumerate().filter(|(_, word)| **word != 0);
        let grown = words.flat_map(|(place, &word)| {
            (0..64).filter(move |bit| word >> bit & 1 == 1).map(move |bit| 64 * place + bit)
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
            2 => stresses_of_run::<2>(cells, run, displacement, law),
            _ => stresses_of_run::<3>(cells, run, displacement, law),
        }
    }
}

#[inline(always)]
fn stresses_of_run<const N: usize>(
    cells: &Cells,
    run: &Run,
    displacement: &[Lane; BLOCK_NODES],
    law: &mut StandardCells,
) {
    let start = cells.starts[run.begin] as usize;
    let gradients = cells.gradients[start..].as_chunks::<N>().0;
    let local = cells.local[start + run.begin..].chunks_exact(N + 1);
    let kept = law.stress[run.begin..run.end].iter_mut().zip(&mut law.mixed_energy[run.begin..run.end]);
    for (((stress, mixed), gradients), local) in kept.zip(gradients).zip(local) {
        let [x, y, z] = gradient_columns(displacement, local, gradients);
        let strain = small_strain(x, y, z);
        *mixed = 0.5 * stress.dot(strain);
        *stress = law.softens.hooke.stress(strain);
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
            2 => forces_of_run::<2>(cells, run, force, law),
            _ => forces_of_run::<3>(cells, run, force, law),
        }
    }
}

#[inline(always)]
fn forces_of_run<const N: usize>(cells: &Cells, run: &Run, force: &mut [Lane; BLOCK_NODES], law: &StandardCells) {
    let start = cells.starts[run.begin] as usize;
    let gradients = cells.gradients[start..].as_chunks::<N>().0;
    let local = cells.local[start + run.begin..].chunks_exact(N + 1);
    for ((cell, gradients), local) in (run.begin..run.end).zip(gradients).zip(local) {
        let volume = cells.volume[cell];
        // A removed element has none.
        if volume > 0.0 {
            let stress = law.stress[cell] * (1.0 - law.damage[cell]) * volume;
            add_cell_forces(force, local, gradients, symmetric_columns(stress));
        }
    }
}

impl RunOfEdges {
    /// Keeps the room of its lists, so that a step allocates nothing.
    fn clear(&mut self) {
        self.grown = [0; EDGES / 64];
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
