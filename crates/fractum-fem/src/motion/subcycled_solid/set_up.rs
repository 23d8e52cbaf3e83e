//! A solid with steps of two sizes: its fine cells, and the nodes that stand twice.

use fractum_math::{CHUNK, HalfSteps, Vec3};
use fractum_parallel::runs_of;

use super::fine_elements::fine_elements;
use crate::body::{Body, Formulation};
use crate::cells::block::NodeSlots;
use crate::error::SolidError;
use crate::solid::Solid;
use crate::solid::neighbours::Alone;
use crate::solid::subcycling::Subcycling;

impl Solid {
    /// As [`Solid::new`], with short steps for the elements that need them and long ones for the others, where that pays.
    ///
    /// # Errors
    /// As [`Solid::new`].
    pub fn subcycled(nodes: Vec<Vec3>, bodies: Vec<Body>) -> Result<Self, SolidError> {
        let fine = fine_elements(&nodes, &bodies);
        let mut solid = Solid::with_fine(nodes, bodies, fine.as_deref().unwrap_or_default(), |_, _| Box::new(Alone))?;
        if let Some(fine) = fine {
            link(&mut solid, fine)?;
        }
        Ok(solid)
    }
}

/// Lets shared nodes stand twice.
fn link(solid: &mut Solid, fine_elements: Vec<Vec<bool>>) -> Result<(), SolidError> {
    let count = solid.reference.len();
    let mut touched = [vec![false; count], vec![false; count]];
    for block in &solid.blocks {
        let touched = &mut touched[usize::from(block.is_fine)];
        block.cells.nodes.iter().for_each(|&node| touched[node as usize] = true);
    }
    let [coarse, is_fine] = touched;
    let linked: Vec<u32> = (0..count).filter(|&n| coarse[n] && is_fine[n]).map(|n| n as u32).collect();
    let copy_of = |node: u32| linked.binary_search(&node).map(|link| (count + link) as u32);
    let mut near = Vec::new();
    for (index, block) in solid.blocks.iter_mut().enumerate().filter(|(_, block)| !block.is_fine) {
        let mut holds = false;
        for node in &mut block.cells.nodes {
            if let Ok(copy) = copy_of(*node) {
                (*node, holds) = (copy, true);
            }
        }
        if holds {
            near.push(index);
        }
    }
    let shares = coarse_mass(solid);
    for &node in &linked {
        let share = shares[node as usize];
        solid.mass.push(share);
        solid.mass[node as usize] -= share;
    }
    solid.inverse_mass = solid.mass.iter().map(|m| 1.0 / m).collect();
    let all = count + linked.len();
    for of_nodes in [&mut solid.displacement, &mut solid.velocity, &mut solid.force] {
        of_nodes.resize(all, Vec3::zeros());
    }
    solid.chunk_work.resize(all.div_ceil(CHUNK), HalfSteps::default());
    solid.slots = NodeSlots::new(all, solid.blocks.iter().map(|block| block.cells.nodes.as_slice()))?;
    let is_linked = |node: usize| node >= count || linked.binary_search(&(node as u32)).is_ok();
    let runs = [false, true].map(|fine| {
        let moved: Vec<bool> = (0..all).map(|node| !is_linked(node) && is_fine[node] == fine).collect();
        moved.chunks(CHUNK).map(runs_of).collect()
    });
    solid.subcycling = Some(Box::new(Subcycling {
        fine_elements,
        runs,
        near,
        is_ahead: false,
        energies: [0.0; 3],
        parts: [1; 2],
        outer: vec![Vec3::zeros(); all],
        has_outer: false,
        power: vec![0.0; all.div_ceil(CHUNK)],
        accelerations: vec![Vec3::zeros(); linked.len()],
        ends: vec![[Vec3::zeros(); 2]; linked.len()],
        is_fine,
    }));
    solid.copies = linked;
    Ok(())
}

/// Mass of every node that belongs to cells with long steps [kg]. The mass of an element goes with its edges in equal parts where
/// these are the cells, so that the bound of the step by elements holds for either side.
fn coarse_mass(solid: &Solid) -> Vec<f64> {
    let mut mass = vec![0.0; solid.reference.len()];
    for (index, model) in solid.bodies.iter().enumerate() {
        let corners = model.body.shape.node_count();
        let is_coarse = |item: u32| f64::from(u8::from(!solid.blocks[model.location.of(item).0 as usize].is_fine));
        for (element, nodes) in (0..).zip(&*model.body.elements) {
            let share = match (&model.edges, model.body.formulation) {
                (Some(edges), Formulation::Smoothed) => {
                    let of = edges.of_element(element);
                    let of = &of[..model.body.shape.edge_count()];
                    of.iter().map(|&edge| is_coarse(edge)).sum::<f64>() / of.len() as f64
                }
                _ => is_coarse(element),
            };
            let of_element = model.body.elastic.density * solid.element_volume(index, element) / corners as f64;
            nodes[..corners].iter().for_each(|&node| mass[node as usize] += share * of_element);
        }
    }
    mass
}
