//! Stress, strain and damage of elements.

use std::borrow::Cow;
use std::collections::BTreeMap;

use fractum_math::{Sym3, Vec3};
use rayon::prelude::*;

use crate::body::edges::BodyEdges;
use crate::cells::block::Cells;
use crate::cells::kernel;
use crate::damage::edge::EdgeField;
use crate::divided::{ALONE, ELSEWHERE, EdgeValue};
use crate::element::{measure_and_gradients, regular_edge};
use crate::solid::Solid;
use crate::solid::body_model::BodyModel;
use crate::solid::evaluate::Block;

/// Nominal stress [Pa] and damage of every element of a body: means over its edges where it is smoothed.
///
/// - `earlier`: displacements of the nodes at the instant of the last step [m], to which the damage belongs; without them the stress is that
///   of the present ones
pub fn element_fields(solid: &Solid, index: usize, earlier: Option<&[Vec3]>) -> Vec<(Sym3, f64)> {
    let model = &solid.bodies[index];
    means(model, |at| cell_field(solid, index, at, earlier))
}

/// Displacements of all nodes a time `dt` [s] earlier, at their present velocities [m].
pub fn displacements_before(solid: &Solid, dt: f64) -> Vec<Vec3> {
    let nodes = solid.displacement.iter().zip(&solid.velocity);
    nodes.map(|(displacement, velocity)| displacement - velocity * dt).collect()
}

/// What cells hold, as means over the edges of each element where the body is smoothed.
fn means(model: &BodyModel, of_cell: impl Fn((u32, u32)) -> (Sym3, f64) + Sync + Send) -> Vec<(Sym3, f64)> {
    let count = model.smoothed_edges().map_or(model.alive.len(), BodyEdges::len) as u32;
    let cells: Vec<(Sym3, f64)> = (0..count).into_par_iter().map(|cell| of_cell(model.location.of(cell))).collect();
    match model.smoothed_edges() {
        None => cells,
        Some(edges) => {
            let mean = |element| model.mean_of_edges(&edges.of_element(element), |edge| cells[edge as usize]);
            (0..model.alive.len() as u32).into_par_iter().map(mean).collect()
        }
    }
}

/// Live elements of a body that this process owns, ascending.
pub fn owned_elements(solid: &Solid, index: usize) -> Vec<u32> {
    let alive = (0..).zip(&solid.bodies[index].alive).filter(|(_, alive)| **alive).map(|(element, _)| element);
    alive.filter(|&element: &u32| solid.owns(index, element)).collect()
}

/// As [`element_fields`], of [`owned_elements`] at the present displacements.
pub fn owned_fields(solid: &Solid, index: usize) -> Vec<(Sym3, f64)> {
    owned_means(solid, index, |at| cell_field(solid, index, at, None))
}

/// Strain of [`owned_elements`], that of thermal expansion included: the mean over its edges where the body is smoothed.
pub fn owned_strains(solid: &Solid, index: usize) -> Vec<Sym3> {
    let means = owned_means(solid, index, |at| (cell_strain(solid, index, at), 0.0));
    means.into_iter().map(|(strain, _)| strain).collect()
}

/// Means of the elements that this process owns, from the cells alone that they need.
fn owned_means(
    solid: &Solid,
    index: usize,
    of_cell: impl Fn((u32, u32)) -> (Sym3, f64) + Sync + Send,
) -> Vec<(Sym3, f64)> {
    let (model, owned) = (&solid.bodies[index], owned_elements(solid, index));
    let alive = model.alive.iter().filter(|alive| **alive).count();
    if owned.len() == alive && model.location.keeps_all() {
        let all = means(model, of_cell);
        return if alive == all.len() { all } else { owned.into_iter().map(|e| all[e as usize]).collect() };
    }
    let Some(edges) = model.smoothed_edges() else {
        return owned.par_iter().map(|&element| of_cell(model.location.of(element))).collect();
    };
    let mut needed: Vec<u32> = owned.par_iter().flat_map_iter(|&element| edges.of_element(element)).collect();
    needed.par_sort_unstable();
    needed.dedup();
    let place = |edge: u32| needed.binary_search(&edge).expect("one of those of its elements");
    let cells: Vec<(Sym3, f64)> = needed.par_iter().map(|&edge| of_cell(model.location.of(edge))).collect();
    let mean = |&element: &u32| model.mean_of_edges(&edges.of_element(element), |edge| cells[place(edge)]);
    owned.par_iter().map(mean).collect()
}

/// As [`element_fields`] of one element.
pub fn element_field(solid: &Solid, index: usize, element: u32, earlier: Option<&[Vec3]>) -> (Sym3, f64) {
    let model = &solid.bodies[index];
    let cell = |cell: u32| cell_field(solid, index, model.location.of(cell), earlier);
    match model.smoothed_edges() {
        None => cell(element),
        Some(edges) => model.mean_of_edges(&edges.of_element(element), cell),
    }
}

/// [`element_damages`] of a body of which this process has its own cells alone, by what it has received of others.
pub(crate) fn damages_around(solid: &Solid, index: usize) -> Vec<f64> {
    let model = &solid.bodies[index];
    let mut damages: Vec<f64> = model.alive.iter().map(|alive| f64::from(u8::from(!alive))).collect();
    let Some(edges) = &model.edges else { return damages };
    let fields = solid.damaged_fields().filter(|(body, _)| *body == index).map(|(_, field)| field);
    let damaged = fields.flat_map(|field| {
        let histories = field.edges.iter().zip(&field.state).filter(|(_, history)| history.damage > 0.0);
        histories.map(|(&edge, history)| (edge, history.damage))
    });
    let damage: BTreeMap<u32, f64> = damaged.collect();
    let mut around: Vec<u32> = damage.keys().flat_map(|&edge| edges.around(edge).into_owned()).collect();
    around.sort_unstable();
    around.dedup();
    for element in around.into_iter().filter(|&element| model.alive[element as usize]) {
        let of_edge = |edge: u32| (Sym3::ZERO, damage.get(&edge).copied().unwrap_or(0.0));
        damages[element as usize] = model.mean_of_edges(&edges.of_element(element), of_edge).1;
    }
    damages
}

/// Nominal stress [Pa] and damage of a cell; see [`element_fields`].
pub(crate) fn cell_field(solid: &Solid, index: usize, at: (u32, u32), earlier: Option<&[Vec3]>) -> (Sym3, f64) {
    let model = &solid.bodies[index];
    let displacement = earlier.unwrap_or(&solid.displacement);
    match at.0 {
        ELSEWHERE => {
            let EdgeValue { stress, earlier_stress, damage, .. } = solid.neighbours.received_value(index, at.1);
            return (if earlier.is_some() { earlier_stress } else { stress }, damage);
        }
        ALONE => {
            let strain = strain_alone(solid, model, at.1, displacement);
            let received =
                solid.edge(index, at.1).map(|(field, place)| field.nominal_stress(place, &model.elasticity, strain));
            return received.unwrap_or_else(|| (model.elasticity.stress(strain), 0.0));
        }
        _ => {}
    }
    let (cells, place) = cells_with(solid, at);
    let strain = kernel::elastic_strain(&cells, place, displacement, model.body.kinematics);
    let (block, cell) = (&solid.blocks[at.0 as usize], at.1 as usize);
    (block.nominal_stress(cell, &model.elasticity, strain), block.damage_of(cell))
}

/// Strain of a cell, that of thermal expansion included.
pub(crate) fn cell_strain(solid: &Solid, index: usize, at: (u32, u32)) -> Sym3 {
    let model = &solid.bodies[index];
    match at.0 {
        ELSEWHERE => return solid.neighbours.received_value(index, at.1).strain,
        ALONE => return strain_alone(solid, model, at.1, &solid.displacement),
        _ => {}
    }
    let (cells, cell) = cells_with(solid, at);
    kernel::total_strain(&cells, cell, &solid.displacement, model.body.kinematics)
}

/// Strain of a cell of which this process has no more than the elements around it.
fn strain_alone(solid: &Solid, model: &BodyModel, cell: u32, displacement: &[Vec3]) -> Sym3 {
    let cells = model.cells(&solid.reference, &[cell]);
    kernel::total_strain(&cells, 0, displacement, model.body.kinematics)
}

/// The geometry of a cell (block, number), with its number there: by itself where this process does not keep its block.
pub(crate) fn cells_with(solid: &Solid, (block, cell): (u32, u32)) -> (Cow<'_, Cells>, usize) {
    let block = &solid.blocks[block as usize];
    let cell = cell as usize;
    if cell < block.cells.len() {
        return (Cow::Borrowed(&block.cells), cell);
    }
    (Cow::Owned(solid.bodies[block.body].cells(&solid.reference, &block.items[cell..=cell])), 0)
}

/// Elements of a body with more damage than that: centre in the undeformed body, and edge of the regular element of the same size [m].
pub fn damaged_elements(solid: &Solid, index: usize, above: f64) -> Vec<(Vec3, f64, f64)> {
    let body = &solid.bodies[index].body;
    let count = body.shape.node_count();
    let of_element = |(element, damage): (&[u32; 4], f64)| {
        let corners = element.map(|node| solid.reference[node as usize]);
        let centre = corners[..count].iter().sum::<Vec3>() / count as f64;
        let (measure, _) = measure_and_gradients(body.shape, &corners);
        (damage > above).then(|| (centre, regular_edge(body.shape, measure), damage))
    };
    body.elements.iter().zip(element_damages(solid, index)).filter_map(of_element).collect()
}

/// Damage of the elements of a body: the mean over its edges where it is smoothed, 1 where one has been removed.
pub fn element_damages(solid: &Solid, index: usize) -> Vec<f64> {
    let model = &solid.bodies[index];
    if !model.location.keeps_all() {
        return damages_around(solid, index);
    }
    let mut damage = vec![0.0; model.location.all().len()];
    let may_be_damaged = |block: &&Block| block.edge_field().is_none_or(EdgeField::is_damaged);
    for block in solid.blocks.iter().filter(|block| block.body == index).filter(may_be_damaged) {
        for (cell, &item) in block.items.iter().enumerate() {
            damage[item as usize] = block.damage_of(cell);
        }
    }
    let of_cell = |cell: u32| (Sym3::ZERO, damage[cell as usize]);
    let of_element = |(element, &alive): (u32, &bool)| match model.smoothed_edges() {
        _ if !alive => 1.0,
        None => damage[element as usize],
        Some(edges) => model.mean_of_edges(&edges.of_element(element), of_cell).1,
    };
    (0..).zip(&model.alive).map(of_element).collect()
}
