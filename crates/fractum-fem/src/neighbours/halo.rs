//! Sums of blocks that neighbours exchange, and nodes whose values all receive.

use std::collections::BTreeMap;
use std::ops::Range;

use fractum_math::CHUNK;
use fractum_parallel::{Exchanged, Gathered, rank_of, runs_of};

use crate::cells::block::{NodeSlots, Slot};

/// Who sends which sums to whom.
#[derive(Clone, Debug)]
pub(super) struct Halo {
    /// Slots of the sums.
    pub(super) sums: Exchanged<Slot>,
    /// Which blocks have sums that others wait for.
    pub(super) is_outer: Vec<bool>,
    /// Nodes of the blocks of this rank, in runs of each chunk, counted from its first.
    pub(super) runs: Vec<Vec<Range<usize>>>,
}

impl Halo {
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
        let sums = Exchanged::new(between);
        let mut is_outer = vec![false; *first.last().expect("runs of blocks have an end")];
        sums.sent().for_each(|slot| is_outer[slot.block()] = true);
        Halo { sums, is_outer, runs: is_own.chunks(CHUNK).map(runs_of).collect() }
    }
}

/// All nodes, with those that each rank sends.
#[derive(Clone, Debug)]
pub(super) struct AllNodes {
    pub(super) senders: Senders,
    pub(super) gathered: Gathered,
}

impl AllNodes {
    /// - `first`: first block of each rank, and the end
    pub(super) fn new(senders: Senders, slots: &NodeSlots, first: &[usize]) -> Self {
        AllNodes { gathered: senders.gathered(slots, first, 0..slots.len() as u32), senders }
    }

    /// Whether no rank knows the blocks of all.
    pub(super) fn are_divided(&self) -> bool {
        matches!(self.senders, Senders::Known(_))
    }
}

/// Who sends a node to all others: the lowest rank that has a block there.
#[derive(Clone, Debug)]
pub(super) enum Senders {
    /// As the blocks of all ranks show.
    OfSlots,
    /// The rank of every node.
    Known(Vec<u32>),
}

impl Senders {
    /// Nodes that each rank sends to all others.
    ///
    /// - `first`: first block of each rank, and the end
    pub(super) fn gathered(&self, slots: &NodeSlots, first: &[usize], nodes: impl Iterator<Item = u32>) -> Gathered {
        let mut of_rank = vec![Vec::new(); first.len() - 1];
        for node in nodes {
            let rank = match self {
                Senders::OfSlots => {
                    let slot = slots.of(node as usize).next().expect("a node has mass, and so a cell");
                    rank_of(first, slot.block())
                }
                Senders::Known(ranks) => ranks[node as usize] as usize,
            };
            of_rank[rank].push(node);
        }
        Gathered::new(of_rank)
    }
}
