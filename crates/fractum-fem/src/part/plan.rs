//! What ranks tell each other of nodes: sums of blocks between neighbours, values of some nodes to all.

use std::collections::BTreeMap;
use std::ops::Range;

use fractum_math::{CHUNK, Vec3};
use fractum_parallel::{Exchange, Message};

use crate::block::{NodeSlots, Slot};

/// Who sends which sums to whom.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    pub(super) messages: Vec<Message>,
    /// Slots to send and to receive, message by message; three numbers each.
    pub(super) slots: Vec<[Vec<Slot>; 2]>,
    /// Which blocks have sums that others wait for.
    pub(super) is_outer: Vec<bool>,
    /// Nodes of the blocks of this rank, in runs of each chunk, counted from its first.
    pub(super) runs: Vec<Vec<Range<usize>>>,
}

/// Nodes of which each rank tells all others some: those of its blocks that no lower rank has.
#[derive(Clone, Debug)]
pub(super) struct Told {
    pub(super) nodes: Vec<Vec<u32>>,
    counts: Vec<usize>,
    own: Vec<f64>,
    all: Vec<f64>,
}

impl Plan {
    /// - `first`: first block of each rank, and the end
    pub(super) fn new(slots: &NodeSlots, first: &[usize], me: usize) -> Self {
        let mut between = BTreeMap::<usize, [Vec<Slot>; 2]>::new();
        let mut is_own = vec![false; slots.len()];
        for (node, is_own) in is_own.iter_mut().enumerate() {
            let (own, others): (Vec<Slot>, Vec<Slot>) =
                slots.of(node).partition(|slot| rank_of(first, slot.block()) == me);
            *is_own = !own.is_empty();
            if own.is_empty() {
                continue;
            }
            for of_rank in others.chunk_by(|a, b| rank_of(first, a.block()) == rank_of(first, b.block())) {
                let [send, receive] = between.entry(rank_of(first, of_rank[0].block())).or_default();
                send.extend(&own);
                receive.extend(of_rank);
            }
        }
        let message = |(&rank, slots): (&usize, &[Vec<Slot>; 2])| {
            let [send, receive] = slots.each_ref().map(|slots| vec![0.0; 3 * slots.len()]);
            Message { rank, send, receive }
        };
        let mut is_outer = vec![false; *first.last().expect("runs of blocks have an end")];
        between.values().flat_map(|[send, _]| send).for_each(|slot| is_outer[slot.block()] = true);
        Plan {
            messages: between.iter().map(message).collect(),
            is_outer,
            slots: between.into_values().collect(),
            runs: is_own.chunks(CHUNK).map(runs_of).collect(),
        }
    }
}

impl Told {
    /// - `first`: first block of each rank, and the end
    pub(super) fn new(slots: &NodeSlots, first: &[usize], nodes: &mut dyn Iterator<Item = u32>) -> Self {
        let mut of_rank = vec![Vec::new(); first.len() - 1];
        for node in nodes {
            let slot = slots.of(node as usize).next().expect("a node has mass, and so a cell");
            of_rank[rank_of(first, slot.block())].push(node);
        }
        let counts = of_rank.iter().map(|nodes| 3 * nodes.len()).collect();
        Told { nodes: of_rank, counts, own: Vec::new(), all: Vec::new() }
    }

    /// No nodes of so many ranks.
    pub(super) fn none(ranks: usize) -> Self {
        Told { nodes: vec![Vec::new(); ranks], counts: vec![0; ranks], own: Vec::new(), all: Vec::new() }
    }

    /// Tells these nodes too.
    pub(super) fn append(&mut self, more: &Told) {
        self.nodes.iter_mut().zip(&more.nodes).for_each(|(nodes, more)| nodes.extend(more));
        self.counts.iter_mut().zip(&more.counts).for_each(|(count, more)| *count += more);
    }

    /// Gives every rank the values at these nodes.
    pub(super) fn tell(&mut self, exchange: &dyn Exchange, values: &mut [Vec3]) {
        let Told { nodes, counts, own, all } = self;
        let total = counts.iter().sum();
        if total == 0 {
            return;
        }
        own.clear();
        own.extend(nodes[exchange.rank()].iter().flat_map(|&node| <[f64; 3]>::from(values[node as usize])));
        all.resize(total, 0.0);
        exchange.gather(own, counts, all);
        for (&node, from) in nodes.iter().flatten().zip(all.chunks_exact(3)) {
            values[node as usize] = Vec3::new(from[0], from[1], from[2]);
        }
    }
}

/// The rank of a block, by the first blocks of all.
pub(super) fn rank_of(first: &[usize], block: usize) -> usize {
    first.partition_point(|&first| first <= block) - 1
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
