//! What ranks tell each other of the cells of a block, where these are told in full.

use fractum_math::Sym3;
use serde::{Deserialize, Serialize};

use crate::damage::edge::EdgeDamage;
use crate::solid::evaluate::{Block, BlockLaw};

/// What the other ranks need of a block where cells are told in full.
#[derive(Serialize, Deserialize)]
pub(super) struct BlockShare {
    energy: Option<f64>,
    dissipated: f64,
    fresh: Vec<u32>,
    /// Histories that are no longer those of the start.
    edges: Vec<(u32, EdgeDamage)>,
    /// Viscous stress, where asked for.
    viscous: Vec<Sym3>,
}

impl BlockShare {
    pub(super) fn of(block: &Block, viscous: bool) -> Self {
        let (energy, field) = match &block.law {
            BlockLaw::Elastic { energy } => (*energy, None),
            BlockLaw::Told(told) => (told.energy, None),
            BlockLaw::Edges(law) => (law.energy, Some(&law.field)),
            BlockLaw::Standard(law) => (law.energy, None),
        };
        let changed =
            field.into_iter().flat_map(|field| field.changed().map(|place| (place as u32, field.state[place])));
        BlockShare {
            energy,
            dissipated: block.dissipated(),
            fresh: field.map_or_else(Vec::new, |field| field.fresh.clone()),
            edges: changed.collect(),
            viscous: if viscous { block.viscous.stress.clone() } else { Vec::new() },
        }
    }

    pub(super) fn put(self, block: &mut Block, viscous: bool) {
        if viscous {
            block.viscous.stress = self.viscous;
        }
        match &mut block.law {
            BlockLaw::Elastic { energy } => *energy = self.energy,
            BlockLaw::Told(told) => (told.energy, told.dissipated) = (self.energy, self.dissipated),
            BlockLaw::Standard(law) => (law.energy, law.dissipated) = (self.energy, self.dissipated),
            BlockLaw::Edges(law) => {
                (law.energy, law.dissipated) = (self.energy, self.dissipated);
                law.field.fresh = self.fresh;
                self.edges.into_iter().for_each(|(index, edge)| law.field.put(index as usize, edge));
            }
        }
    }
}
