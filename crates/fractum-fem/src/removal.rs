//! Elements that a crack has cut through leave; their mass stays on the nodes.

use std::collections::BTreeSet;

use fractum_kernels::damage::EdgeDamage;
use fractum_math::{Sym3, Vec3};

use crate::body::Formulation;
use crate::body::elasticity::Elasticity;
use crate::cells::cell::Geometry;
use crate::cells::kernel::{elastic_strain, total_strain};
use crate::damage::edge::EdgeField;
use crate::damage::edges_in_step::{Advance, EdgesInStep};
use crate::divided::ALONE;
use crate::element::cut_modes;
use crate::motion::inverted::crushed_element;
use crate::motion::phase_edges::refresh_phase;
use crate::motion::subcycled_solid::own_step;
use crate::solid::evaluate::{Block, BlockLaw};
use crate::solid::subcycling::forget_ahead;
use crate::solid::{BodyModel, Solid};

/// Removes every element for which all edges of one cut are broken, and a crushed one; returns the energy that went with them [J].
///
/// A crushed element has been turned inside out after it had lost most of its stiffness, one in a step.
///
/// The energy is what the forces of the touched cells do less work in the step that led here, and what these cells
/// store less after it: ½ σ : ε⁰ with the stress of now and the strain of the step before, as it was and as it is
/// without the elements. An edge that keeps some of its elements averages over these from now on; the damage that its
/// jump in strain brings is part of the energy, and so is the stiffness that it loses where it would store more than
/// before.
///
/// - `dt`: time since the forces were last computed, in which the nodes moved with their present velocities [s]
/// - `removed`: gets (body, element) of what was removed in this call
pub fn remove_cut_elements(solid: &mut Solid, dt: f64, removed: &mut Vec<(usize, u32)>) -> f64 {
    let first = removed.len();
    for body in 0..solid.bodies.len() {
        find_cut_elements(solid, body, removed);
    }
    if let Some(crushed) = crushed_element(solid).filter(|crushed| !removed[first..].contains(crushed)) {
        removed.push(crushed);
        removed[first..].sort_unstable();
    }
    take_out(solid, dt, &removed[first..])
}

/// Takes elements out and returns the energy that goes with them [J], as [`remove_cut_elements`] measures it.
///
/// - `removed`: body and element; `dt`: as there
pub fn take_out(solid: &mut Solid, dt: f64, removed: &[(usize, u32)]) -> f64 {
    let mut energy = 0.0;
    for body in 0..solid.bodies.len() {
        let elements: Vec<u32> = removed.iter().filter(|r| r.0 == body).map(|r| r.1).collect();
        if elements.is_empty() {
            continue;
        }
        let touched = cells_around(solid, body, &elements);
        solid.with_neighbours(|neighbours, solid| neighbours.bring_cells(solid, body, &elements, &touched));
        let stored: Vec<f64> = touched.iter().map(|&cell| stored_energy(solid, cell)).collect();
        energy += step_energy(solid, body, dt, &touched);
        forget_ahead(solid);
        elements.iter().for_each(|&e| solid.bodies[body].alive[e as usize] = false);
        rebuild_cells_around(solid, body, &elements);
        settle(solid, dt, &touched, &stored);
        energy -= step_energy(solid, body, dt, &touched);
        solid.with_neighbours(|neighbours, solid| neighbours.exchange_settled(solid, body, &touched));
    }
    energy
}

/// Takes a whole body out with its mass; returns the energy that goes with it [J]: what its cells store, and ½ m v² of what the nodes lose.
///
/// A node of no other body keeps its mass and stops. Others keep their velocity; what the body did to them by its stress and weight is
/// missing from then on.
///
/// - `dt`: time since the forces were last computed, in which the nodes moved with their present velocities; 0 at rest [s]
pub fn take_out_body(solid: &mut Solid, dt: f64, body: usize) -> f64 {
    let alive = (0..).zip(&solid.bodies[body].alive).filter(|(_, alive)| **alive);
    let elements: Vec<(usize, u32)> = alive.map(|(element, _)| (body, element)).collect();
    let energy = take_out(solid, dt, &elements);
    let corners = solid.bodies[body].body.shape.node_count();
    let touched = elements.iter().flat_map(|&(_, e)| solid.bodies[body].body.elements[e as usize][..corners].to_vec());
    let mut touched: Vec<u32> = touched.collect();
    touched.sort_unstable();
    touched.dedup();
    energy + leave_mass(solid, &touched)
}

/// Lets a body that was out come in whole, without stress at the displacements that its nodes have; returns the energy that comes with it, ½ m v² of what
/// its nodes gain [J].
pub fn put_in_body(solid: &mut Solid, body: usize) -> f64 {
    forget_ahead(solid);
    solid.bodies[body].alive.fill(true);
    let elements: Vec<u32> = (0..solid.bodies[body].alive.len() as u32).collect();
    rebuild_cells_around(solid, body, &elements);
    let Solid { blocks, bodies, displacement, .. } = solid;
    let own = &bodies[body].body;
    for Block { cells, .. } in blocks.iter_mut().filter(|block| block.body == body) {
        let strain = |cell| total_strain(cells, cell, displacement, own.kinematics);
        cells.born = Some((0..cells.len()).map(strain).collect());
    }
    let nodes: BTreeSet<u32> = own.elements.iter().flat_map(|e| &e[..own.shape.node_count()]).copied().collect();
    let nodes: Vec<u32> = nodes.into_iter().collect();
    -leave_mass(solid, &nodes)
}

/// Leaves nodes the mass of the elements that are there; returns the kinetic energy that they lose [J].
fn leave_mass(solid: &mut Solid, nodes: &[u32]) -> f64 {
    let mut left = Vec::new();
    for (body, model) in solid.bodies.iter().enumerate() {
        let volumes = solid.element_volumes(body);
        let alive = (0..).zip(volumes).zip(&model.alive).filter(|(_, alive)| **alive);
        left.extend(alive.map(|((element, volume), _)| (body, element, model.body.elastic.density * volume)));
    }
    let mass = solid.lumped(left.into_iter());
    let mut energy = 0.0;
    for &node in nodes {
        let (node, left) = (node as usize, mass[node as usize]);
        let lost = solid.mass[node] - left;
        energy += 0.5 * lost * solid.velocity[node].norm_squared();
        if left > 0.0 {
            (solid.mass[node], solid.inverse_mass[node]) = (left, 1.0 / left);
        } else {
            solid.velocity[node] = Vec3::zeros();
        }
    }
    energy
}

/// Lets damage follow the strains that rebuilt edges jumped to, so that none stores more than before.
///
/// - `stored`: energy of each of these cells with the elements [J]
fn settle(solid: &mut Solid, dt: f64, cells: &[(u32, u32)], stored: &[f64]) {
    for (&(block, cell), &stored) in cells.iter().zip(stored).filter(|((block, _), _)| *block < ALONE) {
        let dt = own_step(solid, &solid.blocks[block as usize], dt);
        let Solid { blocks, bodies, displacement, velocity, .. } = solid;
        let Block { body, cells, law: BlockLaw::Edges(field), .. } = &mut blocks[block as usize] else { continue };
        let step = Advance { displacement, velocity, dt, kinematics: bodies[*body].body.kinematics };
        let mut edges = EdgesInStep { field, cells, step, energy: None, dissipated: 0.0, rubbed: 0.0 };
        edges.settle(cell as usize);
        edges.weaken(cell as usize, stored);
    }
}

/// Energy that a cell stores at present [J]; zero where this process does not have it.
fn stored_energy(solid: &Solid, (block, cell): (u32, u32)) -> f64 {
    if block >= ALONE {
        return 0.0;
    }
    let (block, cell) = (&solid.blocks[block as usize], cell as usize);
    let model = &solid.bodies[block.body];
    let strain = elastic_strain(&block.cells, cell, &solid.displacement, model.body.kinematics);
    block.energy_between(cell, &model.elasticity, [strain; 2])
}

/// Elements of a body that are newly cut through; only edges that broke since the last look matter.
fn find_cut_elements(solid: &mut Solid, body: usize, removed: &mut Vec<(usize, u32)>) {
    if solid.bodies[body].body.damage.is_none() {
        return;
    }
    let mut candidates: Vec<u32> = Vec::new();
    let Solid { bodies, blocks, .. } = solid;
    let BodyModel { standard, edges: Some(edges), .. } = &mut bodies[body] else { return };
    let cells = blocks.iter_mut().filter(|b| b.body == body).filter_map(Block::edge_field_mut);
    for field in cells.chain(standard.as_mut().map(|standard| &mut standard.field)) {
        let broken = field.fresh.drain(..).map(|index| field.edges[index as usize]);
        broken.for_each(|edge| candidates.extend(&*edges.around(edge)));
    }
    let model = &solid.bodies[body];
    let Some(edges) = &model.edges else { return };
    let modes = cut_modes(model.body.shape);
    candidates.retain(|&e| model.alive[e as usize]);
    candidates.sort_unstable();
    candidates.dedup();
    let is_broken = |edge: u32| solid.edge(body, edge).is_some_and(|(field, index)| field.history(index).broken);
    let is_cut = |element: u32| {
        let of = edges.of_element(element);
        modes.iter().any(|mode| mode.iter().all(|&local| is_broken(of[local])))
    };
    removed.extend(candidates.into_iter().filter(|&e| is_cut(e)).map(|e| (body, e)));
}

/// Blocks and cells that the elements take part in.
fn cells_around(solid: &Solid, body: usize, elements: &[u32]) -> Vec<(u32, u32)> {
    let model = &solid.bodies[body];
    match (&model.edges, model.body.formulation) {
        (Some(_), Formulation::Smoothed) => {
            touched_edges(model, elements).into_iter().map(|edge| model.location.of(edge)).collect()
        }
        _ => elements.iter().map(|&e| model.location.of(e)).collect(),
    }
}

/// ½ σ : ε⁰ over these cells of a body, with the present stress and the strain of the step before [J].
fn step_energy(solid: &Solid, body: usize, dt: f64, cells: &[(u32, u32)]) -> f64 {
    let Solid { displacement, velocity, .. } = solid;
    let of = |&(block, cell): &(u32, u32)| {
        let (block, cell) = (&solid.blocks[block as usize], cell as usize);
        let model = &solid.bodies[block.body];
        let dt = own_step(solid, block, dt);
        let step = Advance { displacement, velocity, dt, kinematics: model.body.kinematics };
        let strains = [step.strain_before(&block.cells, cell), step.strain_now(&block.cells, cell)];
        block.energy_between(cell, &model.elasticity, strains)
    };
    let own = (0..).zip(cells).filter(|(_, (block, _))| *block < ALONE).map(|(place, at)| (place, of(at)));
    let mut all = vec![0.0; cells.len()];
    let values = solid.neighbours.gather_cells(body, own.collect());
    values.into_iter().for_each(|(place, value)| all[place as usize] = value);
    all.into_iter().sum()
}

/// Recomputes the cells in which elements have a share that have left or come in, from the elements that are alive.
pub(crate) fn rebuild_cells_around(solid: &mut Solid, body: usize, elements: &[u32]) {
    let Solid { bodies, blocks, reference, copies, .. } = solid;
    let model = &bodies[body];
    if model.body.formulation == Formulation::Standard {
        let geometry = Geometry { body: &model.body, nodes: reference };
        for &element in elements {
            let (block, cell) = model.location.of(element);
            let own = if model.alive[element as usize] { geometry.element(element as usize).0 } else { 0.0 };
            blocks[block as usize].cells.volume.get_mut(cell as usize).into_iter().for_each(|volume| *volume = own);
        }
        if model.phase.is_some() {
            refresh_phase(solid, body, &touched_edges(&solid.bodies[body], elements));
        }
        return;
    }
    let Some(edges) = &model.edges else { return };
    let geometry = Geometry { body: &model.body, nodes: reference };
    let mut nodes = Vec::new();
    let touched = touched_edges(model, elements);
    for &edge in &touched {
        let Some((block, cell)) = model.location.kept(edge) else { continue };
        let cells = &mut blocks[block as usize].cells;
        if cells.len() == 0 {
            continue; // another process has it
        }
        nodes.clear();
        // Copies lie where their nodes do.
        let original = |node: usize| node.checked_sub(reference.len()).map_or(node as u32, |copy| copies[copy]);
        nodes.extend(cells.global_nodes(cell as usize).map(original));
        let range = cells.range(cell as usize);
        let alive = |element: u32| model.alive[element as usize];
        let around = edges.around(edge);
        let [volume, hoop] = geometry.edge_domain(&nodes, &around, alive, &mut cells.gradients[range]);
        cells.volume[cell as usize] = volume;
        cells.hoop.iter_mut().for_each(|own| own[cell as usize] = hoop);
    }
    refresh_phase(solid, body, &touched);
}

/// Elements that have been removed so far: body and number.
pub fn removed_elements(solid: &Solid) -> Vec<(usize, u32)> {
    let of_body = |(body, model): (usize, &BodyModel)| {
        let gone = (0..).zip(&model.alive).filter(|(_, alive)| !**alive);
        gone.map(|(element, _)| (body, element)).collect::<Vec<_>>()
    };
    solid.bodies.iter().enumerate().flat_map(of_body).collect()
}

/// Edges of removed elements that no element of any body joins any more, ascending.
pub fn edges_without_elements(solid: &Solid, removed: &[(usize, u32)]) -> Vec<[u32; 2]> {
    let mut edges: Vec<[u32; 2]> = removed
        .iter()
        .filter_map(|&(body, element)| {
            let model = &solid.bodies[body];
            let edges = model.edges.as_ref()?;
            let of = edges.of_element(element).into_iter().take(model.body.shape.edge_count());
            Some(of.map(|edge| edges.nodes(edge)))
        })
        .flatten()
        .collect();
    edges.sort_unstable();
    edges.dedup();
    edges.retain(|&edge| !is_live_edge(solid, edge));
    edges
}

/// Whether an element that is still there joins two nodes (ascending), in a body that has edges.
pub fn is_live_edge(solid: &Solid, nodes: [u32; 2]) -> bool {
    solid.bodies.iter().any(|model| {
        let Some(edges) = &model.edges else { return false };
        let is_alive = |element: &u32| model.alive[*element as usize];
        edges.find(nodes).is_some_and(|edge| edges.around(edge).iter().any(is_alive))
    })
}

impl Block {
    /// Stress of one cell with its damage [Pa].
    pub(crate) fn nominal_stress(&self, cell: usize, elasticity: &Elasticity, strain: Sym3) -> Sym3 {
        let full = elasticity.stress(strain);
        match &self.law {
            BlockLaw::Edges(field) => field.nominal_stress(cell, elasticity, strain).0,
            _ => full * (1.0 - self.damage_of(cell)),
        }
    }

    /// ½ σ : ε⁰ of one cell, with the stress at ε and its damage [J]; the broken share of cracks that rub has the strain beyond its slip.
    ///
    /// - `strains`: ε⁰ and ε
    pub(crate) fn energy_between(&self, cell: usize, elasticity: &Elasticity, strains: [Sym3; 2]) -> f64 {
        let ([before, strain], volume) = (strains, self.cells.volume[cell]);
        if let BlockLaw::Edges(field) = &self.law
            && let Some(friction) = &field.softens.friction
        {
            let EdgeDamage { damage, strain: slip, .. } = field.history(cell);
            let whole = elasticity.stress(strain).dot(before);
            let broken = friction.stress(strain - slip).dot(before - slip);
            return 0.5 * ((1.0 - damage) * whole + damage * broken) * volume;
        }
        0.5 * self.nominal_stress(cell, elasticity, strain).dot(before) * volume
    }
}

impl EdgeField {
    /// Stress of one edge with its damage [Pa], and its damage.
    pub(crate) fn nominal_stress(&self, place: usize, elasticity: &Elasticity, strain: Sym3) -> (Sym3, f64) {
        let full = elasticity.stress(strain);
        let EdgeDamage { damage, strain: mut slip, share: limit, .. } = self.history(place);
        // With unilateral damage the closed part keeps its stress; an intact edge needs no search for it.
        match (damage, &self.softens.friction) {
            (0.0, _) => (full, 0.0),
            (damage, None) if elasticity.bedded.is_some() => (full * (1.0 - damage), damage),
            (damage, None) => (full - self.softens.opening_stress(strain) * damage, damage),
            (damage, Some(friction)) => {
                (full * (1.0 - damage) + friction.load(strain, &mut slip, limit) * damage, damage)
            }
        }
    }
}

fn touched_edges(model: &BodyModel, elements: &[u32]) -> Vec<u32> {
    let count = model.body.shape.edge_count();
    let edges = model.edges.as_ref().expect("a smoothed body and one with damage have edges");
    let mut edges: Vec<u32> = elements.iter().flat_map(|&e| edges.of_element(e).into_iter().take(count)).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic};
    use fractum_mesh::generate::{Jitter, structured_box, structured_rectangle};
    use proptest::prelude::*;

    use super::*;
    use crate::body::{Body, ElementKind};
    use crate::solid::Solid;

    /// A patch of triangles or tetrahedra under random displacements, with random damage; one edge in three is broken.
    fn torn_patch(plane: bool, random: &[f64]) -> Solid {
        let jitter = Some(Jitter { fraction: 0.15, seed: 3 });
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let law = DamageLaw::rankine(3e6, 100.0);
        let (nodes, shape, elements) = if plane {
            let mesh = structured_rectangle([3, 3], [0.03; 2], jitter);
            (mesh.nodes, ElementKind::T3, mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect())
        } else {
            let mesh = structured_box([2; 3], Vec3::repeat(0.02), jitter);
            (mesh.nodes, ElementKind::T4, mesh.tetrahedra)
        };
        let body = Body::new("patch", shape, elements, elastic).smoothed().with_damage(law);
        let mut solid = Solid::new(nodes, vec![body]).unwrap();
        let mut next = random.iter().cycle();
        let mut random = || *next.next().unwrap();
        for u in &mut solid.displacement {
            *u = Vec3::new(random() - 0.5, random() - 0.5, if plane { 0.0 } else { random() - 0.5 }) * 1e-5;
        }
        let mut state = solid.state();
        for edge in &mut state.bodies[0].edges {
            edge.broken = random() < 0.34;
            edge.damage = if edge.broken { 0.999 } else { (random() - 0.3).max(0.0) };
            edge.kappa *= 1.0 + 10.0 * edge.damage;
        }
        solid.restore(state);
        solid
    }

    proptest! {
        #[test]
        fn removal_never_brings_energy(plane in any::<bool>(), random in prop::collection::vec(0.0f64..1.0, 101..102)) {
            let mut solid = torn_patch(plane, &random);
            solid.update_internal_forces(0.0, true);
            let before = solid.elastic_energy();
            let mut removed = Vec::new();
            let taken = remove_cut_elements(&mut solid, 0.0, &mut removed);
            prop_assert!(taken >= -1e-12 * before, "{taken} J of {before} J by {} elements", removed.len());
            solid.update_internal_forces(0.0, true);
            let after = solid.elastic_energy();
            prop_assert!((before - after - taken).abs() <= 1e-9 * before, "{before} {after} {taken}");
        }
    }
}
