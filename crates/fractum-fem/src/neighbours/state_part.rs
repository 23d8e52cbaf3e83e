//! What one of several ranks has of the state of a solid: checkpoints in parts, and the whole state a few values at a time.

use fractum_kernels::damage::EdgeDamage;
use fractum_math::{Sym3, Vec3};
use fractum_parallel::gather;
use serde::{Deserialize, Serialize};

use super::subdomain;
use crate::damage::edge::EdgeField;
use crate::solid::Solid;
use crate::solid::evaluate::Block;
use crate::state::{BodyState, SolidState, body_state, taken_count, taken_energies};

/// What changes in the cells and nodes of a rank. The parts of all ranks have every node and cell once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolidPart {
    /// Nodes with displacement [m] and velocity [m/s].
    nodes: Vec<(u32, [Vec3; 2])>,
    /// Edges (body, edge) whose histories are no longer those of the start.
    edges: Vec<(u32, u32, EdgeDamage)>,
    /// Places and values of [`SolidState::dissipated`] of its blocks.
    dissipated: Vec<(u32, f64)>,
    /// Viscous stress times volume of the cells of each block.
    viscous: Vec<(u32, Vec<Sym3>)>,
}

/// Edges whose histories ranks send each other at a time.
const SENT_AT_ONCE: usize = 1 << 17;

/// What this rank knows best; none where there is one process.
pub fn state_part(solid: &Solid) -> Option<SolidPart> {
    let subdomain = subdomain(solid)?;
    let own = subdomain.own();
    let blocks = || own.clone().zip(&solid.blocks[own.clone()]).map(|(index, block)| (index as u32, block));
    let of_blocks = blocks().filter_map(|(_, block)| Some((block.body, block.edge_field()?)));
    // Known to all ranks, and sent by the first.
    let standard = (0..).zip(&solid.bodies).filter_map(|(body, model)| Some((body, &model.standard.as_ref()?.field)));
    let motion = |node: u32| [solid.displacement[node as usize], solid.velocity[node as usize]];
    let fields = of_blocks.chain(standard.filter(|_| subdomain.exchange.rank() == 0));
    Some(SolidPart {
        nodes: subdomain.sent_nodes().iter().map(|&node| (node, motion(node))).collect(),
        edges: fields.flat_map(|(body, field)| changed(body, field)).collect(),
        dissipated: taken_energies(solid, own.clone()).collect(),
        viscous: blocks().map(|(index, block)| (index, block.viscous.stress.clone())).collect(),
    })
}

/// [`Solid::state`] without what the parts of all ranks hold.
pub fn state_beside_parts(solid: &Solid) -> SolidState {
    SolidState {
        displacement: Vec::new(),
        velocity: Vec::new(),
        bodies: (0..solid.bodies.len()).map(|body| body_state(solid, body, Vec::new())).collect(),
        dissipated: Vec::new(),
        viscous_dissipation: solid.viscous_dissipation,
        viscous: Vec::new(),
        born: Vec::new(),
    }
}

/// The whole state, by [`state_beside_parts`] and the parts of all ranks. The solid must be as it was built.
///
/// - returns none if they belong to another solid, or some are missing
pub fn joined(solid: &Solid, beside: SolidState, parts: &[SolidPart]) -> Option<SolidState> {
    let nodes = solid.displacement.len();
    let mut state = SolidState {
        displacement: vec![Vec3::zeros(); nodes],
        velocity: vec![Vec3::zeros(); nodes],
        dissipated: vec![0.0; taken_count(solid)],
        viscous: vec![Vec::new(); solid.blocks.len()],
        ..beside
    };
    let whole = |body: (usize, &mut BodyState)| body.1.edges = solid.edge_damage(body.0);
    state.bodies.iter_mut().enumerate().for_each(whole);
    let (mut joined, mut blocks) = (0, 0);
    for SolidPart { nodes, edges, dissipated, viscous } in parts {
        for &(node, [displacement, velocity]) in nodes {
            *state.displacement.get_mut(node as usize)? = displacement;
            *state.velocity.get_mut(node as usize)? = velocity;
        }
        for &(body, edge, history) in edges {
            *state.bodies.get_mut(body as usize)?.edges.get_mut(edge as usize)? = history;
        }
        for &(block, energy) in dissipated {
            *state.dissipated.get_mut(block as usize)? = energy;
        }
        for (block, stress) in viscous {
            state.viscous.get_mut(*block as usize)?.clone_from(stress);
        }
        (joined, blocks) = (joined + nodes.len(), blocks + dissipated.len());
    }
    (joined == nodes && blocks == state.dissipated.len()).then_some(state)
}

/// Edge histories of a body in the order of its edges, with their number first, those of all ranks a few at a time.
pub fn each_history(solid: &Solid, body: usize, see_count: impl FnOnce(usize), mut see: impl FnMut(&EdgeDamage)) {
    let model = &solid.bodies[body];
    let (Some(subdomain), Some(edges), false) = (subdomain(solid), &model.edges, model.location.keeps_all()) else {
        let all = solid.edge_damage(body);
        see_count(all.len());
        return all.iter().for_each(see);
    };
    see_count(edges.len());
    let own = model.location.own();
    for begin in (0..edges.len()).step_by(SENT_AT_ONCE) {
        let at = |edge: usize| own.partition_point(|(own, _)| (*own as usize) < edge);
        let history = |&(edge, (block, cell)): &(u32, (u32, u32))| {
            let field = solid.blocks[block as usize].edge_field();
            let unbroken = EdgeDamage::intact(f64::INFINITY);
            (edge, field.map_or(unbroken, |field| field.history(cell as usize)))
        };
        let mine: Vec<(u32, EdgeDamage)> = own[at(begin)..at(begin + SENT_AT_ONCE)].iter().map(history).collect();
        let mut all = gather(&*subdomain.exchange, &mine).concat();
        all.sort_unstable_by_key(|(edge, _)| *edge);
        all.iter().for_each(|(_, history)| see(history));
    }
}

/// Viscous stress times volume of the cells of all blocks in their order, those of a rank at a time.
pub fn each_viscous_block(solid: &Solid, mut see: impl FnMut(&[Sym3])) {
    let of = |block: &Block| block.viscous.stress.clone();
    let Some(subdomain) = subdomain(solid).filter(|subdomain| subdomain.is_divided()) else {
        return solid.blocks.iter().for_each(|block| see(&block.viscous.stress));
    };
    let exchange = &*subdomain.exchange;
    for rank in 0..exchange.size() {
        let own: Vec<Vec<Sym3>> =
            if rank == exchange.rank() { solid.blocks[subdomain.own()].iter().map(of).collect() } else { Vec::new() };
        gather(exchange, &own).concat().iter().for_each(|stress| see(stress));
    }
}

fn changed(body: usize, field: &EdgeField) -> impl Iterator<Item = (u32, u32, EdgeDamage)> + '_ {
    field.changed().map(move |place| (body as u32, field.edges[place], field.state[place]))
}
