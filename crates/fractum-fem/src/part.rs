//! The share of one of several ranks: cells of some blocks, and the nodes that it moves.
//!
//! A rank evaluates a run of blocks. For every node that it moves it gets the sums of the blocks of others, and adds all of
//! them in the order of the blocks, as a single process does: every rank that moves a node has the same bits. What needs all
//! nodes or all cells (energies, removal, output) is told in full before; between such steps, what a rank has of the nodes and
//! cells of others is out of date.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

use fractum_math::{CHUNK, Sym3, Vec3};
use fractum_parallel::{Exchange, Message, gather};
use serde::{Deserialize, Serialize};

use crate::block::NodeSlots;
use crate::damage::EdgeDamage;
use crate::evaluate::{Block, BlockLaw};

/// The share of a rank.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    exchange: Arc<dyn Exchange>,
    /// Blocks of every rank: from `first[rank]` up to `first[rank + 1]`.
    first: Vec<usize>,
    /// Nodes whose motion each rank tells the others: those of its blocks that no lower rank has.
    told: Vec<Vec<u32>>,
    /// For steps in which every rank moves the nodes of its own blocks, and those that all move.
    near: Plan,
    /// For steps in which every rank moves all nodes.
    all: Plan,
    /// Every rank moves all nodes in every step.
    pub(crate) always_all: bool,
    /// Every rank moves all nodes in the next step.
    pub(crate) next_all: bool,
    /// Every rank moves all nodes in this step.
    pub(crate) is_all: bool,
    /// Displacements and velocities of all nodes are the present ones.
    pub(crate) is_whole: bool,
    /// Numbers of every block that all ranks need in every step, see [`record`]; empty where none does.
    records: Vec<f64>,
    own_records: Vec<f64>,
    record_counts: Vec<usize>,
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
}

/// Who sends which sums to whom, and which nodes are moved.
#[derive(Clone, Debug)]
struct Plan {
    messages: Vec<Message>,
    /// Slots to send and to receive, message by message; three numbers each.
    slots: Vec<[Vec<u32>; 2]>,
    /// Runs of nodes in each chunk, counted from its first.
    runs: Vec<Vec<Range<usize>>>,
}

/// Numbers of a block in [`Part::records`].
const RECORD: usize = 4;
/// In a record: edges have passed their strength, edges broke.
const WOKEN: f64 = 1.0;
const BROKEN: f64 = 2.0;

/// What the other ranks need of a block where cells are told in full.
#[derive(Serialize, Deserialize)]
struct BlockShare {
    energy: Option<f64>,
    dissipated: f64,
    fresh: Vec<u32>,
    /// Histories that are no longer those of the start.
    edges: Vec<(u32, EdgeDamage)>,
    /// Viscous stress, where asked for.
    viscous: Vec<Sym3>,
}

impl Part {
    /// The share of a rank, by the blocks of all.
    ///
    /// - `everywhere`: nodes that every rank shall move
    /// - `needs_records`: whether all ranks need numbers of every block in every step
    pub(crate) fn new(
        exchange: Arc<dyn Exchange>,
        blocks: &[Block],
        slots: &NodeSlots,
        everywhere: &[u32],
        needs_records: bool,
    ) -> Self {
        let weights: Vec<usize> = blocks.iter().map(|block| block.cells.gradients.len().max(1)).collect();
        let first = runs_of_blocks(&weights, exchange.size());
        let (me, size) = (exchange.rank(), exchange.size());
        let mut moved = vec![vec![false; slots.len()]; size];
        let mut told = vec![Vec::new(); size];
        let mut is_told = vec![false; slots.len()];
        for rank in 0..size {
            for &node in blocks[first[rank]..first[rank + 1]].iter().flat_map(|block| &block.cells.nodes) {
                moved[rank][node as usize] = true;
                if !std::mem::replace(&mut is_told[node as usize], true) {
                    told[rank].push(node);
                }
            }
            everywhere.iter().for_each(|&node| moved[rank][node as usize] = true);
        }
        let near = Plan::new(slots, &first, me, &moved);
        moved.iter_mut().for_each(|of| of.fill(true));
        let all = Plan::new(slots, &first, me, &moved);
        let numbers = |rank: usize| if needs_records { RECORD * (first[rank + 1] - first[rank]) } else { 0 };
        let record_counts: Vec<usize> = (0..size).map(numbers).collect();
        Part {
            records: vec![0.0; record_counts.iter().sum()],
            own_records: vec![0.0; record_counts[me]],
            record_counts,
            exchange,
            first,
            told,
            near,
            all,
            always_all: false,
            // What supports hold from now on may have moved before: they do work in the first step.
            next_all: true,
            is_all: false,
            is_whole: true,
        }
    }

    /// Runs of nodes of a chunk that this rank moves in this step, counted from the first of the chunk.
    pub(crate) fn runs(&self, chunk: usize) -> &[Range<usize>] {
        let plan = if self.is_all { &self.all } else { &self.near };
        &plan.runs[chunk]
    }

    /// What this rank does of the work.
    pub(crate) fn share(&self, blocks: &[Block]) -> Share {
        let Part { near, .. } = self;
        let received = near.slots.iter().flat_map(|[_, receive]| receive);
        let nodes = received.map(|&slot| blocks[(slot >> 16) as usize].cells.nodes[(slot & 0xffff) as usize]);
        Share {
            blocks: self.own().len(),
            nodes: near.runs.iter().flatten().map(Range::len).sum(),
            shared_nodes: nodes.collect::<BTreeSet<u32>>().len(),
            bytes: near.messages.iter().map(|message| size_of_val(&message.send[..])).sum(),
        }
    }

    /// Blocks whose cells this process evaluates.
    pub(crate) fn own(&self) -> Range<usize> {
        let rank = self.exchange.rank();
        self.first[rank]..self.first[rank + 1]
    }

    pub(crate) fn exchange(&self) -> Arc<dyn Exchange> {
        Arc::clone(&self.exchange)
    }

    /// The rank whose block this is.
    pub(crate) fn rank_of(&self, block: usize) -> usize {
        self.first.partition_point(|&first| first <= block) - 1
    }

    /// The edges that all ranks name, rank after rank.
    pub(crate) fn tell_edges(&self, own: &Vec<u32>) -> Vec<u32> {
        gather(&*self.exchange, own).concat()
    }

    /// Tells all ranks what they need of every block in every step; whether an edge broke or a cell was turned inside out,
    /// so that all nodes and cells are needed.
    pub(crate) fn tell_records(&mut self, blocks: &mut [Block]) -> bool {
        if self.records.is_empty() {
            return false;
        }
        let own = self.own();
        let records = self.own_records.chunks_exact_mut(RECORD).zip(&blocks[own.clone()]);
        records.for_each(|(to, block)| to.copy_from_slice(&record(block)));
        self.exchange.gather(&self.own_records, &self.record_counts, &mut self.records);
        let mut breaks = false;
        for (index, (block, from)) in blocks.iter_mut().zip(self.records.chunks_exact(RECORD)).enumerate() {
            let &[power, shock, inverted, edges] = from else { continue };
            breaks |= inverted >= 0.0 || edges >= BROKEN;
            if !own.contains(&index) {
                (block.viscous_power, block.viscous.shock) = (power, shock);
                block.inverted = (inverted >= 0.0).then_some(inverted as usize);
                if let Some(field) = block.edge_field_mut() {
                    field.woken |= edges % BROKEN >= WOKEN;
                }
            }
        }
        breaks
    }

    /// Tells all ranks displacements and velocities of all nodes.
    pub(crate) fn tell_nodes(&mut self, displacement: &mut [Vec3], velocity: &mut [Vec3]) {
        if std::mem::replace(&mut self.is_whole, true) {
            return;
        }
        let rank = self.exchange.rank();
        let of = |&node: &u32| [displacement[node as usize], velocity[node as usize]];
        let own: Vec<f64> = self.told[rank].iter().flat_map(of).flat_map(<[f64; 3]>::from).collect();
        let counts: Vec<usize> = self.told.iter().map(|nodes| 6 * nodes.len()).collect();
        let mut all = vec![0.0; counts.iter().sum()];
        self.exchange.gather(&own, &counts, &mut all);
        for (&node, from) in self.told.iter().flatten().zip(all.chunks_exact(6)) {
            displacement[node as usize] = Vec3::new(from[0], from[1], from[2]);
            velocity[node as usize] = Vec3::new(from[3], from[4], from[5]);
        }
    }

    /// Tells all ranks energies and histories of all cells.
    ///
    /// - `viscous`: viscous stresses too
    pub(crate) fn tell_cells(&mut self, blocks: &mut [Block], viscous: bool) {
        let own = self.own();
        let mine: Vec<BlockShare> = blocks[own.clone()].iter().map(|block| BlockShare::of(block, viscous)).collect();
        let shares = gather(&*self.exchange, &mine).into_iter().flatten();
        for (_, (block, share)) in blocks.iter_mut().zip(shares).enumerate().filter(|(index, _)| !own.contains(index)) {
            share.put(block, viscous);
        }
    }

    pub(crate) fn swap_sums(&mut self, blocks: &mut [Block]) {
        let plan = if self.is_all { &mut self.all } else { &mut self.near };
        for (message, [send, _]) in plan.messages.iter_mut().zip(&plan.slots) {
            for (to, &slot) in message.send.chunks_exact_mut(3).zip(send) {
                to.copy_from_slice(&blocks[(slot >> 16) as usize].forces()[(slot & 0xffff) as usize].0[..3]);
            }
        }
        self.exchange.swap(&mut plan.messages);
        for (message, [_, receive]) in plan.messages.iter().zip(&plan.slots) {
            for (from, &slot) in message.receive.chunks_exact(3).zip(receive) {
                blocks[(slot >> 16) as usize].scratch.force[(slot & 0xffff) as usize].0[..3].copy_from_slice(from);
            }
        }
    }
}

impl Plan {
    /// - `first`: as in [`Part`]
    /// - `moved`: which nodes each rank moves
    fn new(slots: &NodeSlots, first: &[usize], me: usize, moved: &[Vec<bool>]) -> Self {
        let count = moved[me].len();
        let is_of = |rank: usize, slot: u32| (first[rank]..first[rank + 1]).contains(&((slot >> 16) as usize));
        let between = |from: usize, to: usize| -> Vec<u32> {
            let nodes = (0..count).filter(|&node| moved[to][node]);
            nodes.flat_map(|node| slots.of(node)).copied().filter(|&slot| is_of(from, slot)).collect()
        };
        let (mut messages, mut all) = (Vec::new(), Vec::new());
        for rank in (0..moved.len()).filter(|&rank| rank != me) {
            let (send, receive) = (between(me, rank), between(rank, me));
            if !send.is_empty() || !receive.is_empty() {
                let [for_it, from_it] = [&send, &receive].map(|slots| vec![0.0; 3 * slots.len()]);
                messages.push(Message { rank, send: for_it, receive: from_it });
                all.push([send, receive]);
            }
        }
        Plan { messages, slots: all, runs: moved[me].chunks(CHUNK).map(runs_of).collect() }
    }
}

impl BlockShare {
    fn of(block: &Block, viscous: bool) -> Self {
        let (energy, field) = match &block.law {
            BlockLaw::Elastic { energy } => (*energy, None),
            BlockLaw::Edges(law) => (law.energy, Some(&law.field)),
            BlockLaw::Standard(law) => (law.energy, None),
        };
        let changed = field.into_iter().flat_map(|field| {
            let edges = (0..).zip(&field.state).zip(&field.strength);
            edges
                .filter(|((_, edge), strength)| **edge != EdgeDamage::intact(**strength))
                .map(|((i, edge), _)| (i, *edge))
        });
        BlockShare {
            energy,
            dissipated: block.dissipated(),
            fresh: field.map_or_else(Vec::new, |field| field.fresh.clone()),
            edges: changed.collect(),
            viscous: if viscous { block.viscous.stress.clone() } else { Vec::new() },
        }
    }

    fn put(self, block: &mut Block, viscous: bool) {
        if viscous {
            block.viscous.stress = self.viscous;
        }
        match &mut block.law {
            BlockLaw::Elastic { energy } => *energy = self.energy,
            BlockLaw::Standard(law) => (law.energy, law.dissipated) = (self.energy, self.dissipated),
            BlockLaw::Edges(law) => {
                (law.energy, law.dissipated) = (self.energy, self.dissipated);
                law.field.fresh = self.fresh;
                for (index, edge) in self.edges {
                    law.field.state[index as usize] = edge;
                    law.field.note(index as usize);
                }
            }
        }
    }
}

/// What all ranks need of a block in every step: viscous power [W], part of the shock, a cell that is turned inside out or
/// -1, and what became of its edges.
fn record(block: &Block) -> [f64; RECORD] {
    let edges = block.edge_field().map_or(0.0, |field| {
        let woken = if field.woken { WOKEN } else { 0.0 };
        if field.fresh.is_empty() { woken } else { woken + BROKEN }
    });
    [block.viscous_power, block.viscous.shock, block.inverted.map_or(-1.0, |cell| cell as f64), edges]
}

/// First block of each rank, and the end: runs of about the same weight.
fn runs_of_blocks(weights: &[usize], ranks: usize) -> Vec<usize> {
    let total: usize = weights.iter().sum();
    let (mut first, mut sum) = (vec![0], 0);
    for (block, weight) in weights.iter().enumerate() {
        // A block belongs to the rank in whose share its middle lies.
        while first.len() < ranks && (2 * sum + weight) * ranks >= 2 * total * first.len() {
            first.push(block);
        }
        sum += weight;
    }
    first.resize(ranks, weights.len());
    first.push(weights.len());
    first
}

/// The runs of what is true.
pub(crate) fn runs_of(moved: &[bool]) -> Vec<Range<usize>> {
    let mut begin = 0;
    let mut runs = Vec::new();
    for run in moved.chunk_by(|a, b| a == b) {
        let end = begin + run.len();
        if run[0] {
            runs.push(begin..end);
        }
        begin = end;
    }
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_shared_by_weight_and_every_one_has_a_rank() {
        assert_eq!(runs_of_blocks(&[1; 8], 4), [0, 2, 4, 6, 8]);
        assert_eq!(runs_of_blocks(&[6, 1, 1, 1, 1, 2], 2), [0, 1, 6]);
        assert_eq!(runs_of_blocks(&[5, 5], 4).len(), 5);
        for ranks in 1..9 {
            let first = runs_of_blocks(&[3, 1, 4, 1, 5], ranks);
            assert!(first.is_sorted() && first[0] == 0 && first[ranks] == 5 && first.len() == ranks + 1);
        }
    }

    #[test]
    fn runs_are_those_of_what_is_moved() {
        assert_eq!(runs_of(&[true, true, false, true]), [0..2, 3..4]);
        assert_eq!(runs_of(&[false]), []);
    }
}
