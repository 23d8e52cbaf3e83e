//! What one of several ranks has of the state of a solid, for checkpoints in parts.

use fractum_math::{Sym3, Vec3};
use serde::{Deserialize, Serialize};

use crate::damage::edge::{EdgeDamage, EdgeField};
use crate::solid::Solid;
use crate::solid::state::{BodyState, SolidState};

/// What changes in the cells and nodes of a rank. The parts of all ranks have every node and cell once.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolidPart {
    /// Nodes with displacement [m] and velocity [m/s].
    nodes: Vec<(u32, [Vec3; 2])>,
    /// Edges (body, edge) whose histories are no longer those of the start.
    edges: Vec<(u32, u32, EdgeDamage)>,
    /// Energy dissipated by damage in each block [J].
    dissipated: Vec<(u32, f64)>,
    /// Viscous stress times volume of the cells of each block.
    viscous: Vec<(u32, Vec<Sym3>)>,
}

impl Solid {
    /// What this rank knows best; none where there is one process.
    pub fn state_part(&self) -> Option<SolidPart> {
        let part = self.part.as_ref()?;
        let own = part.own();
        let blocks = || own.clone().zip(&self.blocks[own.clone()]).map(|(index, block)| (index as u32, block));
        let of_blocks = blocks().filter_map(|(_, block)| Some((block.body, block.edge_field()?)));
        // Known to all ranks, and told by the first.
        let standard =
            (0..).zip(&self.bodies).filter_map(|(body, model)| Some((body, &model.standard.as_ref()?.field)));
        let fields = of_blocks.chain(standard.filter(|_| part.exchange().rank() == 0));
        Some(SolidPart {
            nodes: part.told_nodes().iter().map(|&node| (node, self.motion(node))).collect(),
            edges: fields.flat_map(|(body, field)| changed(body, field)).collect(),
            dissipated: blocks().map(|(index, block)| (index, block.dissipated())).collect(),
            viscous: blocks().map(|(index, block)| (index, block.viscous.stress.clone())).collect(),
        })
    }

    fn motion(&self, node: u32) -> [Vec3; 2] {
        [self.displacement[node as usize], self.velocity[node as usize]]
    }

    /// [`Solid::state`] without what the parts of all ranks hold.
    pub fn state_beside_parts(&self) -> SolidState {
        SolidState {
            displacement: Vec::new(),
            velocity: Vec::new(),
            bodies: (0..self.bodies.len()).map(|body| self.body_state(body, Vec::new())).collect(),
            dissipated: Vec::new(),
            viscous_dissipation: self.viscous_dissipation,
            viscous: Vec::new(),
        }
    }

    /// The whole state, by [`Solid::state_beside_parts`] and the parts of all ranks. The solid must be as it was built.
    ///
    /// - returns none if they belong to another solid, or some are missing
    pub fn joined(&self, beside: SolidState, parts: &[SolidPart]) -> Option<SolidState> {
        let nodes = self.displacement.len();
        let mut state = SolidState {
            displacement: vec![Vec3::zeros(); nodes],
            velocity: vec![Vec3::zeros(); nodes],
            dissipated: vec![0.0; self.blocks.len()],
            viscous: vec![Vec::new(); self.blocks.len()],
            ..beside
        };
        let whole = |body: (usize, &mut BodyState)| body.1.edges = self.edge_damage(body.0);
        state.bodies.iter_mut().enumerate().for_each(whole);
        let (mut told, mut blocks) = (0, 0);
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
            (told, blocks) = (told + nodes.len(), blocks + dissipated.len());
        }
        (told == nodes && blocks == self.blocks.len()).then_some(state)
    }
}

fn changed(body: usize, field: &EdgeField) -> impl Iterator<Item = (u32, u32, EdgeDamage)> + '_ {
    field.changed().map(move |place| (body as u32, field.edges[place], field.state[place]))
}
