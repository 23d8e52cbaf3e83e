//! The part of a solid that one of several ranks has: cells of some blocks, and the nodes that it moves.
//!
//! A rank evaluates a run of blocks. For every node of them it gets the sums of the blocks of others, and adds all of them in
//! the order of the blocks, as a single process does. Forces on nodes that it moves without having a block there are sent by
//! a rank that has. So every rank that moves a node has the same bits. What needs all nodes or all cells (energies, output)
//! is gathered in full before; between such steps, what a rank has of the nodes and cells of others is out of date. Removal is
//! done by all ranks alike: they receive the edges that broke, and nodes and edges around the elements that leave, whose nodes
//! all of them move from then on.

use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

use fractum_math::{CHUNK, Vec3};
use fractum_parallel::{Exchange, Gathered, rank_of, runs_by_weight, runs_of};

use super::body_subdomain::BodySubdomain;
use super::events::Events;
use super::halo::{AllNodes, Halo, Senders};
use super::node_sums::NodeSums;
use super::phase::PhaseExchange;
use crate::cells::block::{Cells, NodeSlots, Slot};
use crate::damage::edge::EdgeField;
use crate::divided::{BlockOrder, RanksOfNodes};
use crate::solid::evaluate::Block;

/// The part of a rank.
#[derive(Clone, Debug)]
pub(crate) struct Subdomain {
    pub(super) exchange: Arc<dyn Exchange>,
    /// Whose block is which, and which of them every rank has, with their cells or without.
    pub(super) order: BlockOrder,
    /// What this rank has of each body; empty where it has all bodies whole.
    pub(super) bodies: Vec<BodySubdomain>,
    /// Sums that ranks with blocks around the same nodes exchange.
    pub(super) halo: Halo,
    /// All nodes.
    pub(super) all: AllNodes,
    /// Nodes that every rank moves in every step.
    pub(super) everywhere: Gathered,
    /// Whether a node is one of them.
    is_everywhere: Vec<bool>,
    /// Who sums over which nodes.
    pub(super) sums: NodeSums,
    moved: MovedRuns,
    /// Which nodes steps need, and which are up to date here.
    pub(super) needs: Needs,
    /// Steps in which every rank moved all nodes, and all steps.
    pub(super) steps: [u64; 2],
    /// What happened in blocks.
    pub(super) events: Events,
    pub(super) phase: PhaseExchange,
}

/// Nodes that a rank moves, or has up to date.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Nodes {
    /// Those of its blocks and those that every rank moves.
    Own,
    /// Those of the chunks too whose sums it takes.
    Summed,
    All,
}

/// Which nodes steps need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Needs {
    /// In every step.
    pub(super) always: Nodes,
    /// In the next one.
    pub(super) next: Nodes,
    /// In this one.
    pub(super) now: Nodes,
    /// Those whose displacements and velocities are the present ones.
    pub(super) present: Nodes,
}

/// How much a rank has to do and to send in a step in which nothing needs all nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SubdomainSize {
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

impl Subdomain {
    /// The part of a rank, by the blocks of all.
    pub(super) fn new(exchange: Arc<dyn Exchange>, blocks: &[Block], slots: &NodeSlots) -> Self {
        let weights: Vec<usize> = blocks.iter().map(|block| block.gradients.max(1)).collect();
        let first = runs_by_weight(&weights, exchange.size());
        let sums = NodeSums::new(slots, &first, exchange.rank());
        Subdomain::with(exchange, BlockOrder::of_whole(first), Vec::new(), sums, Senders::OfSlots, slots)
    }

    /// The part of a rank that has no more of the blocks of others than their numbers, but those of whole bodies.
    pub(super) fn divided(
        exchange: Arc<dyn Exchange>,
        order: BlockOrder,
        bodies: Vec<BodySubdomain>,
        ranks: RanksOfNodes,
        blocks: &[Block],
        slots: &NodeSlots,
    ) -> Self {
        let first = &order.first;
        let own = blocks[first[exchange.rank()]..first[exchange.rank() + 1]].iter();
        let nodes: BTreeSet<u32> = own.flat_map(|block| &block.cells.nodes).copied().collect();
        let sums = NodeSums::divided(&*exchange, &ranks, &nodes);
        Subdomain::with(exchange, order, bodies, sums, Senders::Known(ranks.lowest), slots)
    }

    fn with(
        exchange: Arc<dyn Exchange>,
        order: BlockOrder,
        bodies: Vec<BodySubdomain>,
        sums: NodeSums,
        senders: Senders,
        slots: &NodeSlots,
    ) -> Self {
        Subdomain {
            halo: Halo::new(slots, &order.first, exchange.rank()),
            bodies,
            sums,
            all: AllNodes::new(senders, slots, &order.first),
            everywhere: Gathered::new(vec![Vec::new(); exchange.size()]),
            is_everywhere: vec![false; slots.len()],
            moved: MovedRuns::default(),
            events: Events::default(),
            exchange,
            order,
            // Setting up looks at everything.
            needs: Needs { always: Nodes::All, next: Nodes::All, now: Nodes::Own, present: Nodes::All },
            steps: [0; 2],
            phase: PhaseExchange::default(),
        }
    }

    /// What a stage of the run needs.
    ///
    /// - `everywhere`: nodes that every rank shall move; `always`: those that every step needs
    /// - `events`: whether something can happen in a block, and whether all need the numbers of all blocks, see [`Events::new`]
    pub(super) fn begin_stage(&mut self, slots: &NodeSlots, everywhere: &[u32], always: Nodes, events: [bool; 2]) {
        self.everywhere = Gathered::new(vec![Vec::new(); self.exchange.size()]);
        self.is_everywhere.fill(false);
        self.moved.of_chunks.clone_from(&self.halo.runs);
        self.move_everywhere(slots, everywhere);
        let counts = self.order.first.windows(2).map(|first| first[1] - first[0]);
        self.events = Events::new(counts, self.exchange.rank(), events);
        // What supports hold from now on may have moved before: they do work in the first step.
        self.needs = Needs { always, next: Nodes::All, now: Nodes::Own, present: Nodes::All };
    }

    /// Has every rank move these nodes in every step; those of them that not every rank has moved before.
    fn move_everywhere(&mut self, slots: &NodeSlots, nodes: &[u32]) -> Gathered {
        self.moved.changes += 1;
        let new: BTreeSet<u32> = nodes.iter().copied().filter(|&node| !self.is_everywhere[node as usize]).collect();
        new.iter().for_each(|&node| self.is_everywhere[node as usize] = true);
        let chunks: BTreeSet<usize> = new.iter().map(|&node| node as usize / CHUNK).collect();
        for chunk in chunks {
            let mut moved: Vec<bool> = self.is_everywhere.chunks(CHUNK).nth(chunk).expect("of a node").to_vec();
            self.halo.runs[chunk].iter().for_each(|run| moved[run.clone()].fill(true));
            self.moved.of_chunks[chunk] = runs_of(&moved);
        }
        let gathered = self.all.senders.gathered(slots, &self.order.first, new.into_iter());
        self.everywhere.append(&gathered);
        gathered
    }

    /// Sends all ranks displacements and velocities of nodes that not every rank moves, and has every rank move them from now on.
    pub(super) fn follow(&mut self, slots: &NodeSlots, nodes: &[u32], [displacement, velocity]: [&mut [Vec3]; 2]) {
        let mut gathered = self.move_everywhere(slots, nodes);
        if self.needs.present < Nodes::All {
            gather_vectors(&mut gathered, &*self.exchange, displacement);
            gather_vectors(&mut gathered, &*self.exchange, velocity);
        }
    }

    /// Runs of nodes of a chunk that this rank moves in this step, counted from the first of the chunk; none where it moves all.
    pub(super) fn moved_runs(&self, chunk: usize) -> Option<&[Range<usize>]> {
        let moves_all = match self.needs.now {
            Nodes::Own => false,
            Nodes::Summed => self.sums.is_own(chunk),
            Nodes::All => true,
        };
        (!moves_all).then(|| &self.moved.of_chunks[chunk][..])
    }

    /// How often it has changed which nodes this rank moves.
    pub(super) fn changes(&self) -> u64 {
        self.moved.changes
    }

    /// Whether this rank moves a node in steps in which it does not move all.
    ///
    /// - `sums`: in those with sums over all nodes
    pub(super) fn moves(&self, node: u32, sums: bool) -> bool {
        let (chunk, place) = (node as usize / CHUNK, node as usize % CHUNK);
        sums && self.sums.is_own(chunk) || self.moved.of_chunks[chunk].iter().any(|run| run.contains(&place))
    }

    /// What this rank does of the work.
    pub(super) fn size(&self, blocks: &[Block]) -> SubdomainSize {
        let Subdomain { halo, everywhere, .. } = self;
        let nodes = halo.sums.received().map(|slot| blocks[slot.block()].cells.nodes[slot.local()]);
        SubdomainSize {
            blocks: self.own().len(),
            nodes: self.moved.of_chunks.iter().flatten().map(Range::len).sum(),
            shared_nodes: nodes.collect::<BTreeSet<u32>>().len(),
            bytes: 3 * size_of::<f64>() * (halo.sums.sent().count() + everywhere.of(self.exchange.rank()).len()),
            memory: blocks.iter().map(Block::memory).sum(),
            keeps_all: self.exchange.size() > 1
                && !self.is_divided()
                && blocks.iter().all(|block| block.cells.len() > 0),
        }
    }

    /// Blocks whose cells this rank evaluates.
    pub(super) fn own(&self) -> Range<usize> {
        let rank = self.exchange.rank();
        self.order.first[rank]..self.order.first[rank + 1]
    }

    /// The rank whose block this is.
    pub(super) fn rank_of(&self, block: usize) -> u32 {
        rank_of(&self.order.first, block) as u32
    }

    /// Whether this rank has no more of some blocks of others than their numbers.
    pub(super) fn is_divided(&self) -> bool {
        self.all.are_divided()
    }

    /// Nodes that this rank sends to the others, where all get all.
    pub(super) fn sent_nodes(&self) -> &[u32] {
        self.all.gathered.of(self.exchange.rank())
    }

    /// Lets go of what only the rank needs that evaluates a block: cells, and sums at nodes that this rank does not have.
    ///
    /// - `is_needed`: whether this rank needs a block all the same
    pub(super) fn keep_own(&self, blocks: &mut [Block], is_needed: impl Fn(&Block) -> bool) {
        let near: BTreeSet<usize> = self.halo.sums.received().map(Slot::block).collect();
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
pub(super) fn gather_vectors(gathered: &mut Gathered, exchange: &dyn Exchange, values: &mut [Vec3]) {
    let put = |values: &mut [Vec3], node: usize, from: [f64; 3]| values[node] = from.into();
    gathered.gather(exchange, values, |values, node| values[node].into(), put);
}
