//! Damage in the standard formulation: edges average the stress of their elements, elements take the damage of the way
//! a plane cuts them (Oñate, Zárate et al. 2017, extended to three dimensions by the seven cuts of a tetrahedron).

use std::sync::Arc;

use fractum_math::{Ragged, Sym3};
use rayon::prelude::*;

use crate::body::ElementKind;
use crate::damage::{EdgeField, Softens};
use crate::element::cut_modes;
use crate::kernel::CellLaw;

/// Damage state of a standard body.
#[derive(Clone, Debug)]
pub(crate) struct StandardDamage {
    pub(crate) field: EdgeField,
    pub(crate) shape: ElementKind,
    pub(crate) elements_of_edge: Ragged,
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
}

impl StandardCells {
    /// Undamaged cells without stress.
    pub(crate) fn new(softens: Arc<Softens>, count: usize) -> Self {
        let (stress, damage, mixed_energy) = (vec![Sym3::ZERO; count], vec![0.0; count], vec![0.0; count]);
        StandardCells { softens, stress, damage, mixed_energy, dissipated: 0.0, energy: None }
    }
}

impl StandardDamage {
    /// Edge histories from the stresses of the elements (`stress_of`, none for a removed one).
    pub(crate) fn update_edges(&mut self, dt: f64, stress_of: impl Fn(u32) -> Option<Sym3> + Sync) {
        let StandardDamage {
            field: EdgeField { softens, state, strength, length, woken, fresh, .. },
            elements_of_edge,
            ..
        } = self;
        let (broke, loaded): (Vec<u32>, bool) = state
            .par_iter_mut()
            .enumerate()
            .with_min_len(1024)
            .map(|(index, edge)| {
                let (mut sum, mut count) = (Sym3::ZERO, 0);
                for stress in elements_of_edge.row(index).iter().filter_map(|&e| stress_of(e)) {
                    sum += stress;
                    count += 1;
                }
                if count == 0 {
                    return (None, false);
                }
                let mean = sum * (1.0 / f64::from(count));
                if softens.criterion.surely_below(mean, edge.kappa) {
                    return (None, false);
                }
                let was_broken = edge.broken;
                let q = softens.criterion.equivalent_stress(mean);
                softens.load(edge, q, strength[index], length[index], dt);
                ((edge.broken && !was_broken).then_some(index as u32), true)
            })
            .fold(Default::default, |(mut broke, loaded): (Vec<u32>, bool), (own, own_loaded)| {
                broke.extend(own);
                (broke, loaded || own_loaded)
            })
            .reduce(Default::default, |(mut broke, loaded), (others, others_loaded)| {
                broke.extend(others);
                (broke, loaded || others_loaded)
            });
        *woken |= loaded;
        fresh.extend(broke);
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
