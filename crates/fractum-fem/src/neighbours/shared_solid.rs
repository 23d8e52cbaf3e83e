//! A solid of which several ranks advance a share each, see [`crate::solid::part`].

use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

use fractum_math::{HalfSteps, Vec3};
use fractum_parallel::{Exchange, gather};
use rayon::prelude::*;

use crate::body::Kinematics;
use crate::cells::block::{Cells, Scratch};
use crate::cells::cell::Geometry;
use crate::damage::edge::EdgeField;
use crate::divided::told_edges::ToldEdge;
use crate::solid::evaluate::Block;
use crate::solid::part::{Events, Part, Share};
use crate::solid::{BodyModel, Solid};

impl Solid {
    /// Leaves a share of the work to each rank of an exchange. Every rank must have the same solid in the same state.
    ///
    /// - `everywhere`: nodes that every rank shall move, whatever it has of them
    /// - `sums`: whether every step needs sums over all nodes, as those of damping
    pub fn share_out(&mut self, exchange: Arc<dyn Exchange>, everywhere: &[u32], sums: bool) {
        let has_events = self
            .bodies
            .iter()
            .any(|model| model.body.damage.is_some() || model.body.kinematics == Kinematics::Corotational);
        let always_records = self.bodies.iter().any(|model| model.viscosity.is_some());
        let mut part = self.part.take().unwrap_or_else(|| Box::new(Part::new(exchange, &self.blocks, &self.slots)));
        part.begin_stage(&self.slots, everywhere, [has_events, always_records]);
        part.needs.all = self.bodies.iter().any(BodyModel::needs_all_cells);
        part.needs.sums = sums;
        let Solid { bodies, blocks, .. } = self;
        part.keep_own(blocks, |block| bodies[block.body].needs_all_cells());
        for model in self.bodies.iter_mut().filter(|model| model.standard.is_none()) {
            let BodyModel { phase, location, .. } = model;
            let rank_of = |edge: u32| part.rank_of(location.of(edge).0 as usize) as u32;
            phase.iter_mut().for_each(|field| field.share_out(part.exchange(), rank_of));
        }
        self.part = Some(part);
    }

    /// Gives the cells that this process needs a geometry.
    pub(crate) fn make_cells(&mut self) {
        let own = self.own_blocks();
        let Solid { blocks, bodies, reference, part, .. } = self;
        let is_needed = |index: usize, block: &Block| own.contains(&index) || bodies[block.body].needs_all_cells();
        let needed = blocks.par_iter_mut().enumerate().filter(|(index, block)| is_needed(*index, block));
        needed.for_each(|(_, block)| {
            block.cells = bodies[block.body].cells(reference, &block.items);
            block.scratch = Some(Scratch::new());
            block.edge_field_mut().into_iter().for_each(EdgeField::keep_histories);
        });
        let received = part.iter().flat_map(|part| part.received());
        received.for_each(|slot| _ = blocks[slot.block()].scratch.get_or_insert_with(Scratch::new));
    }

    /// Rank whose cell an edge is; 0 where each rank finds all edges of the body.
    pub(crate) fn rank_of_edge(&self, model: &BodyModel, edge: u32) -> u32 {
        let of_cell = |part: &Part| part.rank_of(model.location.of(edge).0 as usize) as u32;
        self.part.as_deref().filter(|_| model.standard.is_none()).map_or(0, of_cell)
    }

    /// Has every rank move all nodes in the next step, where something needs all of them.
    pub fn move_all_nodes_next(&mut self, needed: bool) {
        self.part.iter_mut().for_each(|part| part.needs.all_next |= needed);
    }

    /// Whether several ranks advance it.
    pub fn is_shared(&self) -> bool {
        self.part.is_some()
    }

    /// Brings displacements and velocities of nodes up to date on every rank, which all move them from now on. All ranks must name
    /// the same nodes.
    pub fn follow_nodes(&mut self, nodes: &[u32]) {
        let Solid { part, slots, displacement, velocity, .. } = self;
        part.iter_mut().for_each(|part| part.follow(slots, nodes, [displacement, velocity]));
    }

    /// Gives every rank the sums over chunks of nodes, once each has those of its own; nothing where every rank has all.
    pub fn tell_sums(&self, sums: &mut [Vec3]) {
        let Some(part) = self.part.as_ref().filter(|part| part.sums) else { return };
        let mut numbers: Vec<[f64; 3]> = sums.iter().map(|&sum| sum.into()).collect();
        part.tell_sums(&mut numbers);
        sums.iter_mut().zip(numbers).for_each(|(sum, numbers)| *sum = numbers.into());
    }

    /// The same of what damping has taken from the nodes of each chunk, and of their kinetic energy.
    pub(crate) fn tell_work(&mut self) {
        let Some(part) = self.part.as_ref().filter(|part| part.sums) else { return };
        let mut all: Vec<[f64; 4]> = self.chunk_work.iter().map(HalfSteps::of_motion).collect();
        part.tell_sums(&mut all);
        self.chunk_work.iter_mut().zip(all).for_each(|(work, numbers)| work.set_motion(numbers));
    }

    /// Brings displacements and velocities of all nodes up to date on every rank. All ranks must call it.
    pub fn gather_nodes(&mut self) {
        let Solid { part, displacement, velocity, .. } = self;
        part.iter_mut().for_each(|part| part.tell_nodes(displacement, velocity));
    }

    /// Brings what this rank has of the damage of others up to date. All ranks must call it.
    pub fn gather_damage(&mut self) {
        let Some(mut part) = self.part.take() else { return };
        let told = part.tell_cells(&mut self.blocks, false);
        note_told(&mut self.bodies, &self.blocks, &told);
        self.part = Some(part);
    }

    /// Brings what this rank has of the nodes and cells of others up to date. All ranks must call it.
    pub fn gather_ranks(&mut self) {
        let Some(mut part) = self.part.take() else { return };
        part.tell_nodes(&mut self.displacement, &mut self.velocity);
        let told = part.tell_cells(&mut self.blocks, true);
        note_told(&mut self.bodies, &self.blocks, &told);
        self.part = Some(part);
        self.gather_edge_values();
    }

    /// What this rank does of the work; none where there is one process.
    pub fn share(&self) -> Option<Share> {
        Some(self.part.as_ref()?.share(&self.blocks))
    }

    /// Steps in which every rank moved all nodes, and all steps that ranks have done together; none where there is one process.
    pub fn steps_of_ranks(&self) -> Option<[u64; 2]> {
        Some(self.part.as_ref()?.steps)
    }

    /// The geometry of a cell (block, number), with its number there: by itself where this process does not keep its block.
    pub(crate) fn cells_with(&self, (block, cell): (u32, u32)) -> (Cow<'_, Cells>, usize) {
        let block = &self.blocks[block as usize];
        let cell = cell as usize;
        if cell < block.cells.len() {
            return (Cow::Borrowed(&block.cells), cell);
        }
        (Cow::Owned(self.bodies[block.body].cells(&self.reference, &block.items[cell..=cell])), 0)
    }

    /// Brings cells of a body that several ranks are about to look at up to date, with their histories and nodes. This process keeps
    /// their blocks from now on; of a body of which it has its own cells alone no more than the nodes.
    ///
    /// - `elements`: those that the cells take part in
    pub(crate) fn bring_cells(&mut self, body: usize, elements: &[u32], cells: &[(u32, u32)]) {
        if self.bodies[body].known.is_some() {
            let nodes = self.bodies[body].nodes_around(elements);
            return self.follow_nodes(&nodes);
        }
        let Solid { blocks, bodies, reference, part, .. } = self;
        let Some(part) = part else { return };
        part.tell_edges(blocks, cells);
        for &(block, _) in cells {
            let block = &mut blocks[block as usize];
            if block.cells.len() == 0 {
                block.cells = bodies[block.body].cells(reference, &block.items);
                block.edge_field_mut().into_iter().for_each(EdgeField::keep_histories);
            }
        }
        let nodes = |&(block, cell): &(u32, u32)| blocks[block as usize].cells.global_nodes(cell as usize);
        let nodes: Vec<u32> = cells.iter().flat_map(nodes).map(|node| node as u32).collect();
        self.follow_nodes(&nodes);
    }

    /// Tells all ranks the histories of cells that removal has changed, where not every rank has found them.
    pub(crate) fn tell_settled(&mut self, body: usize, cells: &[(u32, u32)]) {
        if self.bodies[body].known.is_none() {
            return;
        }
        let Solid { blocks, bodies, part, .. } = self;
        let Some(part) = part else { return };
        let told = part.tell_edges(blocks, cells);
        note_told(bodies, blocks, &told);
    }

    /// Tells all ranks the histories of edges of others that a saved state has changed, and has removal look at those that broke.
    pub(crate) fn tell_restored(&mut self) {
        let Solid { blocks, bodies, part, .. } = self;
        let Some(part) = part.as_ref().filter(|_| bodies.iter().any(|model| model.known.is_some())) else { return };
        bodies.iter_mut().filter_map(|model| model.known.as_mut()).for_each(|known| known.told.clear());
        let told = part.tell_changed(blocks);
        note_told(bodies, blocks, &told);
        let of_others = blocks.iter_mut().filter(|block| block.told_edges().is_some());
        of_others.filter_map(Block::edge_field_mut).for_each(EdgeField::renew_fresh);
    }

    /// Values of cells of a body, each by the rank that has it where not every rank has all.
    ///
    /// - `count`: of the cells; `own`: place among them and value of each that this rank has
    pub(crate) fn of_all_ranks(&self, body: usize, count: usize, own: impl Iterator<Item = (u32, f64)>) -> Vec<f64> {
        let mut all = vec![0.0; count];
        let mut put = |(place, value): (u32, f64)| all[place as usize] = value;
        match self.part.as_ref().filter(|_| self.bodies[body].known.is_some()) {
            Some(part) => gather(&*part.exchange(), &own.collect::<Vec<_>>()).into_iter().flatten().for_each(put),
            None => own.for_each(&mut put),
        }
        all
    }

    /// Blocks whose cells this process evaluates.
    pub(crate) fn own_blocks(&self) -> Range<usize> {
        self.part.as_ref().map_or(0..self.blocks.len(), |part| part.own())
    }

    /// Has `evaluate(bodies, index, block)` done to the blocks of this process, and gets the sums of others at its nodes.
    pub(crate) fn evaluate_own(&mut self, evaluate: impl Fn(&[BodyModel], usize, &mut Block) + Sync) {
        let own = self.own_blocks();
        let Solid { blocks, bodies, part, .. } = self;
        let evaluate = |blocks: &mut [Block], is_meant: &(dyn Fn(usize) -> bool + Sync)| {
            let blocks = blocks[own.clone()].par_iter_mut().zip(own.clone());
            blocks.filter(|(_, index)| is_meant(*index)).for_each(|(block, index)| evaluate(bodies, index, block));
        };
        match part {
            Some(part) => part.swap_sums(blocks, evaluate),
            None => evaluate(blocks, &|_| true),
        }
    }

    /// Tells all ranks what they need of the cells of others, once its own are evaluated.
    ///
    /// - `measure`: whether the energies of all cells are needed
    pub(crate) fn exchange_cells(&mut self, measure: bool) {
        let Some(mut part) = self.part.take() else { return };
        let Events { inverted, broken } = part.tell_records(&mut self.blocks);
        part.is_all = inverted | part.needs.all | std::mem::take(&mut part.needs.all_next);
        part.sums = !part.is_all && (measure || part.needs.sums);
        if part.is_all {
            part.tell_nodes(&mut self.displacement, &mut self.velocity);
        } else if part.sums {
            part.fetch_chunks(&mut self.displacement, &mut self.velocity);
        }
        if measure {
            part.tell_energies(&mut self.blocks);
        }
        if broken {
            let told = part.tell_broken(&mut self.blocks);
            note_told(&mut self.bodies, &self.blocks, &told);
        }
        part.records.inverted = None;
        if inverted {
            let own = self.inverted_of(&self.blocks[part.own()]);
            part.records.inverted = gather(&*part.exchange(), &own).into_iter().flatten().next();
        }
        self.part = Some(part);
    }

    /// After a step: what is known of the nodes of others.
    pub(crate) fn note_motion(&mut self) {
        let Some(part) = &mut self.part else { return };
        part.is_whole = part.is_all;
        part.has_chunks = part.is_all || part.sums;
        part.steps = [part.steps[0] + u64::from(part.is_all), part.steps[1] + 1];
    }
}

/// Notes where to find edges of others that were told, by their blocks.
fn note_told(bodies: &mut [BodyModel], blocks: &[Block], told: &[(u32, ToldEdge)]) {
    for &(block, ToldEdge { edge, cell, .. }) in told {
        let other = &blocks[block as usize];
        if let Some(known) = bodies[other.body].known.as_mut().filter(|_| other.told_edges().is_some()) {
            known.told.insert(edge, (block, cell));
        }
    }
}

impl BodyModel {
    /// Nodes of all elements, alive or not, around the edges of some elements, ascending.
    fn nodes_around(&self, elements: &[u32]) -> Vec<u32> {
        let edges = self.edges.iter().flat_map(|edges| {
            let of = elements.iter().flat_map(|&element| edges.of_element(element));
            of.flat_map(|edge| edges.around(edge).into_owned())
        });
        let mut nodes: Vec<u32> = edges.flat_map(|element| self.body.elements[element as usize]).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Whether every rank needs the cells of all: edges of the standard formulation gather stresses of elements, which every rank
    /// finds of all nodes.
    fn needs_all_cells(&self) -> bool {
        self.standard.is_some()
    }

    /// Cells of some items of the body (elements, or edges if smoothed), of the elements that are there.
    pub(crate) fn cells(&self, nodes: &[Vec3], items: &[u32]) -> Cells {
        Geometry { body: &self.body, nodes }.cells(items, self.smoothed_edges(), |element| self.alive[element as usize])
    }
}
