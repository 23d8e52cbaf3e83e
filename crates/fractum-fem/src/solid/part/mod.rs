//! The share of one of several ranks: cells of some blocks, and the nodes that it moves.
//!
//! A rank evaluates a run of blocks. For every node of them it gets the sums of the blocks of others, and adds all of them in
//! the order of the blocks, as a single process does. Forces on nodes that it moves without having a block there are told by
//! a rank that has. So every rank that moves a node has the same bits. What needs all nodes or all cells (energies, output)
//! is told in full before; between such steps, what a rank has of the nodes and cells of others is out of date. Removal is
//! done by all ranks alike: they are told the edges that broke, and nodes and edges around the elements that leave, whose nodes
//! all of them move from then on.

mod block_share;
mod chunks;
mod plan;
mod records;

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

use fractum_math::{CHUNK, Vec3};
use fractum_parallel::{Exchange, Told, gather, rank_of, runs_by_weight, runs_of};

use crate::cells::block::{Cells, NodeSlots, Slot};
use crate::damage::edge::EdgeField;
use crate::divided::told_edges::ToldEdge;
use crate::divided::{BlockOrder, RanksOfNodes};
use crate::solid::evaluate::Block;

use block_share::BlockShare;
use chunks::Chunks;
use plan::{AllNodes, Plan, Tellers};
pub(crate) use records::Events;
use records::Records;

/// The share of a rank.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    exchange: Arc<dyn Exchange>,
    /// Whose block is which, and which of them every rank has, with their cells or without.
    order: BlockOrder,
    /// Sums that ranks with blocks around the same nodes swap.
    plan: Plan,
    /// All nodes.
    all: AllNodes,
    /// Nodes that every rank moves in every step.
    everywhere: Told,
    /// Whether a node is one of them.
    is_everywhere: Vec<bool>,
    /// Who sums over which nodes.
    chunks: Chunks,
    moved: MovedRuns,
    pub(crate) needs: Needs,
    /// Every rank moves all nodes in this step.
    pub(crate) is_all: bool,
    /// This step needs sums over all nodes, and is not one in which every rank moves them: each moves those of its chunks too.
    pub(crate) sums: bool,
    /// Displacements and velocities of the nodes of own chunks are the present ones.
    pub(crate) has_chunks: bool,
    /// Displacements and velocities of all nodes are the present ones.
    pub(crate) is_whole: bool,
    /// Steps in which every rank moved all nodes, and all steps.
    pub(crate) steps: [u64; 2],
    /// Numbers of every block that all ranks need where something happens.
    pub(crate) records: Records,
}

/// What steps need of all nodes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Needs {
    /// Every rank moves all of them in every step.
    pub(crate) all: bool,
    /// Every rank does so in the next step.
    pub(crate) all_next: bool,
    /// Every step sums over all of them.
    pub(crate) sums: bool,
}

/// How much a rank has to do and to tell in a step in which nothing needs all nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// Blocks of cells.
    pub blocks: usize,
    /// Nodes that it moves.
    pub nodes: usize,
    /// Those of them that blocks of other ranks push too.
    pub shared_nodes: usize,
    /// Bytes of the sums that it sends.
    pub bytes: usize,
    /// Bytes of cells, their forces and viscous stresses that it keeps.
    pub memory: usize,
    /// Whether it keeps those of all ranks.
    pub keeps_all: bool,
}

/// What a rank moves.
#[derive(Clone, Debug, Default)]
struct MovedRuns {
    /// Runs of nodes that this rank moves where it does not move all of them, see [`runs_of`].
    of_chunks: Vec<Vec<Range<usize>>>,
    /// How often these have changed.
    changes: u64,
}

impl Part {
    /// The share of a rank, by the blocks of all.
    pub(crate) fn new(exchange: Arc<dyn Exchange>, blocks: &[Block], slots: &NodeSlots) -> Self {
        let weights: Vec<usize> = blocks.iter().map(|block| block.gradients.max(1)).collect();
        let first = runs_by_weight(&weights, exchange.size());
        let chunks = Chunks::new(slots, &first, exchange.rank());
        Part::with(exchange, BlockOrder::of_whole(first), chunks, Tellers::OfSlots, slots)
    }

    /// The share of a rank that has no more of the blocks of others than their numbers, but those of whole bodies.
    pub(crate) fn divided(
        exchange: Arc<dyn Exchange>,
        order: BlockOrder,
        ranks: RanksOfNodes,
        blocks: &[Block],
        slots: &NodeSlots,
    ) -> Self {
        let first = &order.first;
        let own = blocks[first[exchange.rank()]..first[exchange.rank() + 1]].iter();
        let nodes: BTreeSet<u32> = own.flat_map(|block| &block.cells.nodes).copied().collect();
        let chunks = Chunks::divided(&*exchange, &ranks, &nodes);
        Part::with(exchange, order, chunks, Tellers::Known(ranks.lowest), slots)
    }

    fn with(
        exchange: Arc<dyn Exchange>,
        order: BlockOrder,
        chunks: Chunks,
        tellers: Tellers,
        slots: &NodeSlots,
    ) -> Self {
        Part {
            plan: Plan::new(slots, &order.first, exchange.rank()),
            chunks,
            all: AllNodes::new(tellers, slots, &order.first),
            everywhere: Told::new(vec![Vec::new(); exchange.size()]),
            is_everywhere: vec![false; slots.len()],
            moved: MovedRuns::default(),
            records: Records::default(),
            exchange,
            order,
            // Setting up looks at everything.
            needs: Needs { all: true, all_next: true, sums: false },
            is_all: false,
            sums: false,
            has_chunks: true,
            is_whole: true,
            steps: [0; 2],
        }
    }

    /// What a stage of the run needs.
    ///
    /// - `everywhere`: nodes that every rank shall move
    /// - `needs`: of numbers of blocks, see [`Records::new`]
    pub(crate) fn begin_stage(&mut self, slots: &NodeSlots, everywhere: &[u32], needs: [bool; 2]) {
        self.everywhere = Told::new(vec![Vec::new(); self.exchange.size()]);
        self.is_everywhere.fill(false);
        self.moved.of_chunks.clone_from(&self.plan.runs);
        self.move_everywhere(slots, everywhere);
        let counts = self.order.first.windows(2).map(|first| first[1] - first[0]);
        self.records = Records::new(counts, self.exchange.rank(), needs);
        // What supports hold from now on may have moved before: they do work in the first step.
        self.needs = Needs { all: false, all_next: true, sums: false };
        (self.is_all, self.sums) = (false, false);
        (self.is_whole, self.has_chunks) = (true, true);
    }

    /// Has every rank move these nodes in every step; those of them that not every rank has moved before.
    fn move_everywhere(&mut self, slots: &NodeSlots, nodes: &[u32]) -> Told {
        self.moved.changes += 1;
        let new: BTreeSet<u32> = nodes.iter().copied().filter(|&node| !self.is_everywhere[node as usize]).collect();
        new.iter().for_each(|&node| self.is_everywhere[node as usize] = true);
        let chunks: BTreeSet<usize> = new.iter().map(|&node| node as usize / CHUNK).collect();
        for chunk in chunks {
            let mut moved: Vec<bool> = self.is_everywhere.chunks(CHUNK).nth(chunk).expect("of a node").to_vec();
            self.plan.runs[chunk].iter().for_each(|run| moved[run.clone()].fill(true));
            self.moved.of_chunks[chunk] = runs_of(&moved);
        }
        let told = self.all.tellers.told(slots, &self.order.first, new.into_iter());
        self.everywhere.append(&told);
        told
    }

    /// Tells all ranks displacements and velocities of nodes that not every rank moves, and has every rank move them from now on.
    pub(crate) fn follow(&mut self, slots: &NodeSlots, nodes: &[u32], [displacement, velocity]: [&mut [Vec3]; 2]) {
        let mut told = self.move_everywhere(slots, nodes);
        if !self.is_whole {
            tell(&mut told, &*self.exchange, displacement);
            tell(&mut told, &*self.exchange, velocity);
        }
    }

    /// Runs of nodes of a chunk that this rank moves in this step, counted from the first of the chunk; none where it moves all.
    pub(crate) fn moved(&self, chunk: usize) -> Option<&[Range<usize>]> {
        let moves_all = self.is_all || self.sums && self.chunks.is_own(chunk);
        (!moves_all).then(|| &self.moved.of_chunks[chunk][..])
    }

    /// How often it has changed which nodes this rank moves.
    pub(crate) fn changes(&self) -> u64 {
        self.moved.changes
    }

    /// Whether this rank moves a node in steps in which it does not move all.
    ///
    /// - `sums`: in those with sums over all nodes
    pub(crate) fn moves(&self, node: u32, sums: bool) -> bool {
        let (chunk, place) = (node as usize / CHUNK, node as usize % CHUNK);
        sums && self.chunks.is_own(chunk) || self.moved.of_chunks[chunk].iter().any(|run| run.contains(&place))
    }

    /// Runs of nodes of a chunk that blocks of this rank push, counted from the first of the chunk.
    pub(crate) fn pushed(&self, chunk: usize) -> &[Range<usize>] {
        &self.plan.runs[chunk]
    }

    /// What this rank does of the work.
    pub(crate) fn share(&self, blocks: &[Block]) -> Share {
        let Part { plan, everywhere, .. } = self;
        let nodes = self.received().map(|slot| blocks[slot.block()].cells.nodes[slot.local()]);
        Share {
            blocks: self.own().len(),
            nodes: self.moved.of_chunks.iter().flatten().map(Range::len).sum(),
            shared_nodes: nodes.collect::<BTreeSet<u32>>().len(),
            bytes: 3 * size_of::<f64>() * (plan.sums.sent().count() + everywhere.of(self.exchange.rank()).len()),
            memory: blocks.iter().map(Block::memory).sum(),
            keeps_all: self.exchange.size() > 1
                && !self.is_divided()
                && blocks.iter().all(|block| block.cells.len() > 0),
        }
    }

    /// Where the sums lie that this rank gets.
    pub(crate) fn received(&self) -> impl Iterator<Item = Slot> + '_ {
        self.plan.sums.received()
    }

    /// Blocks whose cells this process evaluates.
    pub(crate) fn own(&self) -> Range<usize> {
        let rank = self.exchange.rank();
        self.order.first[rank]..self.order.first[rank + 1]
    }

    /// Whether this rank has no more of some blocks of others than their numbers.
    pub(crate) fn is_divided(&self) -> bool {
        self.all.are_divided()
    }

    pub(crate) fn exchange(&self) -> Arc<dyn Exchange> {
        Arc::clone(&self.exchange)
    }

    /// Nodes that this rank tells the others of, where all are told of all.
    pub(crate) fn told_nodes(&self) -> &[u32] {
        self.all.told.of(self.exchange.rank())
    }

    /// The rank whose block this is.
    pub(crate) fn rank_of(&self, block: usize) -> usize {
        rank_of(&self.order.first, block)
    }

    /// The edges that all ranks name, rank after rank.
    pub(crate) fn name_edges(&self, own: &Vec<u32>) -> Vec<u32> {
        gather(&*self.exchange, own).concat()
    }

    /// Tells all ranks what they need of every block, where something has happened.
    pub(crate) fn tell_records(&mut self, blocks: &mut [Block]) -> Events {
        let own = self.own();
        self.records.tell(&*self.exchange, own, blocks)
    }

    /// Tells all ranks the edges that have just broken, with their blocks.
    pub(crate) fn tell_broken(&mut self, blocks: &mut [Block]) -> Vec<(u32, ToldEdge)> {
        let own = self.own();
        let of_block = |index: usize| {
            let fresh = blocks[index].edge_field().map_or(&[][..], |field| &field.fresh);
            fresh.iter().map(move |&edge| (index as u32, edge))
        };
        let edges: Vec<(u32, u32)> = own.clone().flat_map(of_block).collect();
        let told = self.tell_edges(blocks, &edges);
        for (block, edge) in told.iter().filter(|(block, _)| !own.contains(&(*block as usize))) {
            let block = &mut blocks[*block as usize];
            let place = block.place_of(edge.cell).expect("it was told") as u32;
            block.edge_field_mut().into_iter().for_each(|field| field.fresh.push(place));
        }
        told
    }

    /// Tells all ranks the histories of some edges (block, number), which they may name or not; those that any rank of them has.
    pub(crate) fn tell_edges(&self, blocks: &mut [Block], edges: &[(u32, u32)]) -> Vec<(u32, ToldEdge)> {
        let own = self.own();
        let mine = edges.iter().filter(|(block, _)| own.contains(&(*block as usize)));
        let told =
            |&(block, cell): &(u32, u32)| Some((block, blocks[block as usize].edge_field()?.told(cell as usize)));
        let mine: Vec<(u32, ToldEdge)> = mine.filter_map(told).collect();
        let all = gather(&*self.exchange, &mine).concat();
        for (block, edge) in all.iter().filter(|(block, _)| !own.contains(&(*block as usize))) {
            blocks[*block as usize].put_edge(edge);
        }
        all
    }

    /// Tells all ranks displacements and velocities of all nodes.
    pub(crate) fn tell_nodes(&mut self, displacement: &mut [Vec3], velocity: &mut [Vec3]) {
        if !std::mem::replace(&mut self.is_whole, true) {
            self.tell_all(displacement);
            self.tell_all(velocity);
        }
    }

    /// Tells all ranks the forces on the nodes that they move beside their own, once each has those on its own.
    pub(crate) fn tell_forces(&mut self, force: &mut [Vec3]) {
        let told = if self.is_all { &mut self.all.told } else { &mut self.everywhere };
        tell(told, &*self.exchange, force);
        if self.sums {
            self.chunks.fetch(&*self.exchange, force);
        }
    }

    /// Gets displacements and velocities of the nodes of own chunks.
    pub(crate) fn fetch_chunks(&mut self, displacement: &mut [Vec3], velocity: &mut [Vec3]) {
        if !self.has_chunks {
            self.chunks.fetch(&*self.exchange, displacement);
            self.chunks.fetch(&*self.exchange, velocity);
        }
    }

    /// Gives every rank the sums over the nodes of all chunks, once each has those of its own.
    pub(crate) fn tell_sums<const N: usize>(&self, sums: &mut [[f64; N]]) {
        self.chunks.tell(&*self.exchange, sums);
    }

    /// Tells all ranks the energies of all blocks, which have been summed.
    pub(crate) fn tell_energies(&mut self, blocks: &mut [Block]) {
        let own = self.own();
        let energies = |block: &Block| [block.elastic(), block.dissipated()];
        let mine: Vec<f64> = blocks[own.clone()].iter().flat_map(energies).collect();
        let counts: Vec<usize> = self.order.first.windows(2).map(|first| 2 * (first[1] - first[0])).collect();
        let mut all = vec![0.0; 2 * blocks.len()];
        self.exchange.gather(&mine, &counts, &mut all);
        for (index, (block, energies)) in blocks.iter_mut().zip(all.chunks_exact(2)).enumerate() {
            if !own.contains(&index) {
                block.put_energies([energies[0], energies[1]]);
            }
        }
    }

    /// Tells all ranks energies and histories of all cells; of blocks of which others have no more than their number energies, and
    /// what [`Part::tell_changed`] tells and returns.
    ///
    /// - `viscous`: viscous stresses too
    pub(crate) fn tell_cells(&mut self, blocks: &mut [Block], viscous: bool) -> Vec<(u32, ToldEdge)> {
        let (own, whole) = (self.own(), || self.order.whole.iter().cloned().flatten());
        let mine = whole().filter(|index| own.contains(index));
        let mine: Vec<BlockShare> = mine.map(|index| BlockShare::of(&blocks[index], viscous)).collect();
        let shares = gather(&*self.exchange, &mine).into_iter().flatten();
        for (index, share) in whole().zip(shares).filter(|(index, _)| !own.contains(index)) {
            share.put(&mut blocks[index], viscous);
        }
        if !self.is_divided() {
            return Vec::new();
        }
        self.tell_energies(blocks);
        self.tell_changed(blocks)
    }

    /// Tells all ranks the histories that are no longer those of the start, of blocks of which others have no more than their number.
    pub(crate) fn tell_changed(&self, blocks: &mut [Block]) -> Vec<(u32, ToldEdge)> {
        let is_whole = |index: &usize| self.order.whole.iter().any(|whole| whole.contains(index));
        let changed = self.own().filter(|index| !is_whole(index)).flat_map(|index| {
            let changed = blocks[index].edge_field().into_iter().flat_map(EdgeField::changed);
            changed.map(move |cell| (index as u32, cell as u32))
        });
        let changed: Vec<(u32, u32)> = changed.collect();
        self.tell_edges(blocks, &changed)
    }

    /// Tells all ranks a value of every node, once each has those of its own blocks.
    pub(crate) fn tell_all(&mut self, values: &mut [Vec3]) {
        tell(&mut self.all.told, &*self.exchange, values);
        if self.is_divided() {
            // Where memory is short this is more than a share of it.
            self.all.told.release();
        }
    }

    /// Has the blocks of this rank evaluated, and gets the sums of the blocks of others at its nodes. What others wait for comes first;
    /// the rest is done while messages travel.
    ///
    /// - `evaluate`: of the blocks that it is told
    pub(crate) fn swap_sums(
        &mut self,
        blocks: &mut [Block],
        evaluate: impl Fn(&mut [Block], &(dyn Fn(usize) -> bool + Sync)),
    ) {
        let Part { exchange, plan: Plan { sums, is_outer, .. }, .. } = self;
        evaluate(blocks, &|block| is_outer[block]);
        let force = |slot: Slot| {
            let [x, y, z, ..] = blocks[slot.block()].forces()[slot.local()].0;
            [x, y, z]
        };
        sums.fill(force);
        sums.swap(&**exchange, &mut || evaluate(blocks, &|block| !is_outer[block]));
        sums.read(|slot, from: [f64; 3]| {
            let scratch = blocks[slot.block()].scratch.as_mut();
            let force = &mut scratch.expect("kept, since this rank has nodes of the block").force;
            force[slot.local()].0[..3].copy_from_slice(&from);
        });
    }

    /// Lets go of what only the rank needs that evaluates a block: cells, and sums at nodes that this rank does not have.
    ///
    /// - `is_needed`: whether this rank needs a block all the same
    pub(crate) fn keep_own(&self, blocks: &mut [Block], is_needed: impl Fn(&Block) -> bool) {
        let near: BTreeSet<usize> = self.received().map(Slot::block).collect();
        let own = self.own();
        let others = blocks.iter_mut().enumerate().filter(|(index, block)| !own.contains(index) && !is_needed(block));
        for (index, block) in others {
            let nodes = std::mem::take(&mut block.cells.nodes);
            block.cells = Cells { nodes, ..Cells::default() };
            block.viscous.forget();
            block.edge_field_mut().into_iter().for_each(EdgeField::forget_intact);
            block.scratch.take_if(|_| !near.contains(&index));
        }
    }
}

/// Gives every rank the vectors at some nodes.
fn tell(told: &mut Told, exchange: &dyn Exchange, values: &mut [Vec3]) {
    let put = |values: &mut [Vec3], node: usize, from: [f64; 3]| values[node] = from.into();
    told.tell(exchange, values, |values, node| values[node].into(), put);
}
