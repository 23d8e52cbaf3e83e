//! Thermal expansion of cells: their stress belongs to the strain beyond α (T - T₀).

use std::borrow::Cow;

use fractum_math::Sym3;
use rayon::prelude::*;

use crate::body::Formulation;
use crate::cells::block::Cells;
use crate::cells::cell::Geometry;
use crate::cells::kernel::elastic_strain;
use crate::cells::thermal_strain::ThermalStrain;
use crate::solid::Solid;
use crate::solid::body_model::BodyModel;
use crate::solid::evaluate::Block;

/// Lets bodies expand with temperature, before the first step.
///
/// - `coefficients`: α of each body [1/K]; 0 leaves it as it is
pub fn set_expansion(solid: &mut Solid, coefficients: &[f64]) {
    let Solid { blocks, bodies, reference, .. } = solid;
    blocks.par_iter_mut().filter(|block| coefficients[block.body] != 0.0).for_each(|block| {
        let model = &bodies[block.body];
        let geometry = Geometry { body: &model.body, nodes: reference };
        let zero = vec![0.0; block.cells.len()];
        block.cells.thermal = Some(Box::new(ThermalStrain {
            coefficient: coefficients[block.body],
            unit: Sym3([1.0, 1.0, model.elasticity.hooke.zz, 0.0, 0.0, 0.0]),
            weights: weights(block, model, &geometry),
            start: zero.clone(),
            change: zero,
            passed: [0.0; 2],
        }));
    });
}

/// Takes over temperatures T - T₀ of the nodes [K] as if they had always been so.
pub fn start_expanded(solid: &mut Solid, rise: &[f64]) {
    solid.blocks.par_iter_mut().for_each(|block| block.begin_change([rise; 2]));
}

/// Begins a change of temperatures, along which [`expand_to`] leads.
///
/// - `rises`: T - T₀ of the nodes now, and at the end of the change [K]
pub fn begin_expansion(solid: &mut Solid, rises: [&[f64]; 2]) {
    solid.blocks.par_iter_mut().for_each(|block| block.begin_change(rises));
    find_expansion_work(solid);
}

/// Finds [`expansion_work`] at the present displacements.
pub fn find_expansion_work(solid: &mut Solid) {
    let Solid { blocks, bodies, displacement, .. } = solid;
    blocks.par_iter_mut().for_each(|block| {
        let Some(own) = &block.cells.thermal else { return };
        let model = &bodies[block.body];
        let work = |cell: usize| {
            let strain = elastic_strain(&block.cells, cell, displacement, model.body.kinematics);
            let change = own.unit * own.change[cell];
            -block.cells.volume[cell] * block.nominal_stress(cell, &model.elasticity, strain).dot(change)
        };
        block.expansion_work = (0..block.cells.len()).map(work).sum();
    });
}

/// Leads thermal strains along the present change of temperatures.
///
/// - `passed`: parts of it that had passed at the step before, and now, 0 to 1
pub fn expand_to(solid: &mut Solid, passed: [f64; 2]) {
    for own in solid.blocks.iter_mut().filter_map(|block| block.cells.thermal.as_mut()) {
        own.passed = passed;
    }
}

/// Work that the whole of the present change of temperatures does at the stresses of the last step, -Σ V σ : Δεᵗ [J].
pub fn expansion_work(solid: &Solid) -> f64 {
    solid.blocks.iter().map(|block| block.expansion_work).sum()
}

/// Work of bodies that were brought from no stress at all to the thermal strains where the present change began, and to the present
/// stresses, in proportion: -½ Σ V σ : εᵗ [J].
pub fn starting_work(solid: &Solid) -> f64 {
    let of_block = |block: &Block| {
        let Some(own) = &block.cells.thermal else { return 0.0 };
        let model = &solid.bodies[block.body];
        let work = |cell: usize| {
            let strain = elastic_strain(&block.cells, cell, &solid.displacement, model.body.kinematics);
            let start = own.unit * own.start[cell];
            -0.5 * block.cells.volume[cell] * block.nominal_stress(cell, &model.elasticity, strain).dot(start)
        };
        (0..block.cells.len()).map(work).sum::<f64>()
    };
    solid.blocks.iter().map(of_block).sum()
}

/// Heat that an element conducts per conductivity, as its local edges and ∫ -∇Nᵢ·∇Nⱼ dV of each [m].
pub fn element_conduction(solid: &Solid, body: usize, element: u32) -> impl Iterator<Item = ([u32; 2], f64)> + use<> {
    let model = &solid.bodies[body];
    let geometry = Geometry { body: &model.body, nodes: &solid.reference };
    let (volume, gradients) = geometry.element(element as usize);
    let (nodes, count) = (model.body.elements[element as usize], model.body.shape.node_count());
    let pairs = (0..count).flat_map(move |i| (i + 1..count).map(move |j| (i, j)));
    pairs.map(move |(i, j)| ([nodes[i], nodes[j]], -volume * gradients[i].dot(&gradients[j])))
}

impl Block {
    fn begin_change(&mut self, rises: [&[f64]; 2]) {
        let Some(mut own) = self.cells.thermal.take() else { return };
        for cell in 0..self.cells.len() {
            let [start, end] = rises.map(|rise| strain_at(&own, &self.cells, cell, rise));
            (own.start[cell], own.change[cell]) = (start, end - start);
        }
        own.passed = [0.0; 2];
        self.cells.thermal = Some(own);
    }
}

/// α (T - T₀) of a cell.
fn strain_at(own: &ThermalStrain, cells: &Cells, cell: usize, rise: &[f64]) -> f64 {
    let weights = &own.weights[cells.starts[cell] as usize + cell..];
    let sum: f64 = cells.global_nodes(cell).zip(weights).map(|(node, weight)| weight * rise[node]).sum();
    own.coefficient * sum
}

/// Parts of nodes in the temperatures of cells: means over elements, and over those around an edge by their volumes.
fn weights(block: &Block, model: &BodyModel, geometry: &Geometry<'_>) -> Vec<f64> {
    let corners = model.body.shape.node_count();
    let mut weights = vec![0.0; block.cells.local.len()];
    for (cell, &item) in block.items.iter().enumerate() {
        let own = &mut weights[block.cells.starts[cell] as usize + cell..];
        let one = [item];
        let of_edge = model.smoothed_edges().map_or(Cow::Borrowed(&[][..]), |edges| edges.around(item));
        let elements = match model.body.formulation {
            Formulation::Standard => &one[..],
            Formulation::Smoothed => &of_edge,
        };
        let volumes: Vec<f64> = elements.iter().map(|&e| geometry.element(e as usize).0).collect();
        let share = 1.0 / (corners as f64 * volumes.iter().sum::<f64>());
        for (&element, volume) in elements.iter().zip(volumes) {
            for &node in &model.body.elements[element as usize][..corners] {
                let place = block.cells.global_nodes(cell).position(|n| n == node as usize);
                own[place.expect("a cell holds the nodes of its elements")] += volume * share;
            }
        }
    }
    weights
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::Elastic;
    use fractum_math::Vec3;
    use fractum_mesh::generate::{Jitter, structured_box};

    use super::*;
    use crate::body::{Body, ElementKind};

    const ALPHA: f64 = 1e-5;

    fn cube(smoothed: bool) -> Solid {
        let mesh = structured_box([3; 3], Vec3::repeat(1.0), Some(Jitter { fraction: 0.15, seed: 3 }));
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body = Body::new("box", ElementKind::T4, mesh.tetrahedra, elastic);
        let mut solid = Solid::new(mesh.nodes, vec![if smoothed { body.smoothed() } else { body }]).unwrap();
        set_expansion(&mut solid, &[ALPHA]);
        solid
    }

    #[test]
    fn free_expansion_has_no_stress_and_held_one_that_of_the_closed_form() {
        for smoothed in [false, true] {
            let mut solid = cube(smoothed);
            let count = solid.reference.len();
            let [cold, hot] = [0.0, 100.0].map(|rise| vec![rise; count]);
            begin_expansion(&mut solid, [&cold, &hot]);
            let free = 0.5 * expansion_work(&solid);
            expand_to(&mut solid, [0.0, 1.0]);
            assert!(
                crate::fields::element_fields::owned_strains(&solid, 0).iter().all(|strain| strain.0 == [0.0; 6]),
                "nothing has moved yet"
            );
            // Held in all directions: σ = -E α ΔT/(1 - 2 ν), energy 3/2 V E (α ΔT)²/(1 - 2 ν).
            solid.update_internal_forces(0.0, true);
            let pressure = -30e9 * ALPHA * 100.0 / 0.6;
            let (stress, _) = crate::fields::element_fields::element_field(&solid, 0, 7, None);
            assert!((stress.0[0] / pressure - 1.0).abs() < 1e-12 && stress.0[3].abs() < 1.0, "{stress:?}");
            let energy = -1.5 * pressure * ALPHA * 100.0;
            assert!((solid.elastic_energy() / energy - 1.0).abs() < 1e-12);
            // Half of the work at no stress, half at the full one.
            let work = free + 0.5 * expansion_work(&solid);
            assert!(free == 0.0 && (work / energy - 1.0).abs() < 1e-12, "{work} {energy}");
            solid.displacement = solid.reference.iter().map(|x| x * (ALPHA * 100.0)).collect();
            solid.update_internal_forces(0.0, true);
            let largest = solid.force.iter().map(|f| f.norm()).fold(0.0, f64::max);
            assert!(largest < 1e-9 * pressure.abs() && solid.elastic_energy() < 1e-12 * energy, "{largest}");
            let off =
                |strain: &Sym3| (0..6).any(|k| (strain.0[k] - if k < 3 { ALPHA * 100.0 } else { 0.0 }).abs() > 1e-15);
            assert!(
                !crate::fields::element_fields::owned_strains(&solid, 0).iter().any(off),
                "all of it is thermal strain"
            );
        }
    }

    #[test]
    fn an_element_conducts_a_linear_temperature_as_its_continuum() {
        let solid = cube(false);
        let slope = Vec3::new(3.0, -2.0, 5.0);
        let temperature: Vec<f64> = solid.reference.iter().map(|x| slope.dot(x)).collect();
        let power: f64 = (0..solid.body(0).elements.len() as u32)
            .flat_map(|element| element_conduction(&solid, 0, element))
            .map(|([i, j], g)| g * (temperature[i as usize] - temperature[j as usize]).powi(2))
            .sum();
        assert!((power / slope.norm_squared() - 1.0).abs() < 1e-12, "{power}");
    }
}
