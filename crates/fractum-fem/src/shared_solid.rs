//! A solid of which several ranks advance a share each, see [`crate::part`].

use std::ops::Range;
use std::sync::Arc;

use fractum_parallel::Exchange;

use crate::body::Kinematics;
use crate::part::{Part, Share};
use crate::solid::{BodyModel, Solid};

impl Solid {
    /// Leaves a share of the work to each rank of an exchange. Every rank must have the same solid in the same state.
    ///
    /// - `everywhere`: nodes that every rank shall move, whatever it has of them
    /// - `all`: whether every rank shall move all nodes
    pub fn share_out(&mut self, exchange: Arc<dyn Exchange>, everywhere: &[u32], all: bool) {
        let needs_records = self.bodies.iter().any(|model| {
            let can_break = model.body.damage.is_some();
            can_break || model.viscosity.is_some() || model.body.kinematics == Kinematics::Corotational
        });
        let mut part = Part::new(exchange, &self.blocks, &self.slots, everywhere, needs_records);
        // Edges of the standard formulation gather stresses of elements, which every rank finds of all nodes.
        part.always_all = all || self.bodies.iter().any(|model| model.standard.is_some());
        for model in self.bodies.iter_mut().filter(|model| model.standard.is_none()) {
            let BodyModel { phase, location, .. } = model;
            let rank_of = |edge: u32| part.rank_of(location[edge as usize].0 as usize) as u32;
            phase.iter_mut().for_each(|field| field.share_out(part.exchange(), rank_of));
        }
        self.part = Some(Box::new(part));
    }

    /// Rank whose cell an edge is; 0 where each rank finds all edges of the body.
    pub(crate) fn rank_of_edge(&self, model: &BodyModel, edge: u32) -> u32 {
        let of_cell = |part: &Part| part.rank_of(model.location[edge as usize].0 as usize) as u32;
        self.part.as_deref().filter(|_| model.standard.is_none()).map_or(0, of_cell)
    }

    /// Has every rank move all nodes in the next step, where something needs all of them.
    pub fn move_all_nodes_next(&mut self, needed: bool) {
        self.part.iter_mut().for_each(|part| part.next_all |= needed);
    }

    /// Has every rank move all nodes from now on.
    pub fn move_all_nodes(&mut self) {
        self.part.iter_mut().for_each(|part| part.always_all = true);
    }

    /// Brings what this rank has of the nodes and cells of others up to date. All ranks must call it.
    pub fn gather_ranks(&mut self) {
        let Some(mut part) = self.part.take() else { return };
        part.tell_nodes(&mut self.displacement, &mut self.velocity);
        part.tell_cells(&mut self.blocks, true);
        self.part = Some(part);
    }

    /// What this rank does of the work; none where there is one process.
    pub fn share(&self) -> Option<Share> {
        Some(self.part.as_ref()?.share(&self.blocks))
    }

    /// Blocks whose cells this process evaluates.
    pub(crate) fn own_blocks(&self) -> Range<usize> {
        self.part.as_ref().map_or(0..self.blocks.len(), |part| part.own())
    }

    /// Gets the sums of the blocks of other ranks for the nodes that this one moves, once its own are there.
    ///
    /// - `measure`: whether the energies of all cells are needed
    pub(crate) fn exchange_forces(&mut self, measure: bool) {
        let Some(mut part) = self.part.take() else { return };
        // Every rank finds the edges of the standard formulation.
        let mut standard = self.bodies.iter().filter_map(|model| model.standard.as_ref());
        let breaks = part.tell_records(&mut self.blocks) | standard.any(|standard| !standard.field.fresh.is_empty());
        part.is_all = measure | breaks | part.always_all | std::mem::take(&mut part.next_all);
        if part.is_all {
            part.tell_nodes(&mut self.displacement, &mut self.velocity);
        }
        if measure || breaks {
            part.tell_cells(&mut self.blocks, false);
        }
        part.swap_sums(&mut self.blocks);
        self.part = Some(part);
    }

    /// After a step: what is known of the nodes of others.
    pub(crate) fn note_motion(&mut self) {
        self.part.iter_mut().for_each(|part| part.is_whole = part.is_all);
    }
}
