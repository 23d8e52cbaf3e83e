//! What ranks send each other of the cells of a block, where all of them have these.

use fractum_kernels::damage::EdgeDamage;
use fractum_math::Sym3;
use serde::{Deserialize, Serialize};

use crate::solid::evaluate::Block;

/// What the other ranks need of a block whose cells all have.
#[derive(Serialize, Deserialize)]
pub(super) struct BlockState {
    energy: Option<f64>,
    dissipated: f64,
    rubbed: f64,
    fresh: Vec<u32>,
    /// Histories that are no longer those of the start.
    edges: Vec<(u32, EdgeDamage)>,
    /// Viscous stress, where asked for.
    viscous: Vec<Sym3>,
}

impl BlockState {
    pub(super) fn of(block: &Block, viscous: bool) -> Self {
        let field = block.edge_field();
        let changed =
            field.into_iter().flat_map(|field| field.changed().map(|place| (place as u32, field.state[place])));
        BlockState {
            energy: block.energy,
            dissipated: block.dissipated,
            rubbed: block.rubbed,
            fresh: field.map_or_else(Vec::new, |field| field.fresh.clone()),
            edges: changed.collect(),
            viscous: if viscous { block.viscous.stress.clone() } else { Vec::new() },
        }
    }

    pub(super) fn put(self, block: &mut Block, viscous: bool) {
        if viscous {
            block.viscous.stress = self.viscous;
        }
        (block.energy, block.dissipated, block.rubbed) = (self.energy, self.dissipated, self.rubbed);
        if let Some(field) = block.edge_field_mut() {
            field.fresh = self.fresh;
            self.edges.into_iter().for_each(|(index, edge)| field.put(index as usize, edge));
        }
    }
}
