//! Sums over all nodes: each chunk of nodes has a rank that adds what its nodes have, in their order, and sends it to all others.

use std::collections::{BTreeMap, BTreeSet};

use fractum_math::{CHUNK, Vec3};
use fractum_parallel::{Exchange, Exchanged, gather, gather_by_owner, rank_of};

use crate::cells::block::NodeSlots;
use crate::divided::RanksOfNodes;

/// The chunks of every rank, and their nodes that other ranks have.
#[derive(Clone, Debug)]
pub(super) struct NodeSums {
    me: usize,
    /// The rank of each chunk: that which has most of its nodes, the lowest of these.
    owner: Vec<usize>,
    /// Nodes of own chunks that other ranks have, and the other way round.
    nodes: Exchanged<u32>,
}

impl NodeSums {
    /// - `first`: first block of each rank, and the end
    pub(super) fn new(slots: &NodeSlots, first: &[usize], me: usize) -> Self {
        let ranks_of = |node: usize| {
            let mut ranks: Vec<usize> = slots.of(node).map(|slot| rank_of(first, slot.block())).collect();
            ranks.dedup();
            ranks
        };
        let mut owner = Vec::with_capacity(slots.len().div_ceil(CHUNK));
        let mut between = BTreeMap::<usize, [Vec<u32>; 2]>::new();
        let mut count = vec![0; first.len() - 1];
        for begin in (0..slots.len()).step_by(CHUNK) {
            let chunk = begin..(begin + CHUNK).min(slots.len());
            count.fill(0);
            chunk.clone().flat_map(ranks_of).for_each(|rank| count[rank] += 1);
            let most = count.iter().copied().max().unwrap_or(0);
            let own = count.iter().position(|&count| count == most).unwrap_or(0);
            owner.push(own);
            for node in chunk {
                let ranks = ranks_of(node);
                // The lowest rank that has it sends a node.
                let Some(&teller) = ranks.first().filter(|_| !ranks.contains(&own)) else { continue };
                if teller == me {
                    between.entry(own).or_default()[0].push(node as u32);
                } else if own == me {
                    between.entry(teller).or_default()[1].push(node as u32);
                }
            }
        }
        NodeSums { me, owner, nodes: Exchanged::new(between) }
    }

    /// The same where a rank knows no more than which nodes it has, and who else has these. All ranks must call it.
    pub(super) fn divided(exchange: &dyn Exchange, ranks: &RanksOfNodes, nodes: &BTreeSet<u32>) -> Self {
        let me = exchange.rank();
        let count = ranks.lowest.len().div_ceil(CHUNK);
        let mut own = BTreeMap::<u32, u32>::new();
        nodes.iter().for_each(|&node| *own.entry(node / CHUNK as u32).or_default() += 1);
        let mut most = vec![(0, 0); count];
        for (rank, counts) in gather(exchange, &own).into_iter().enumerate() {
            for (chunk, nodes) in counts {
                let most = &mut most[chunk as usize];
                if nodes > most.1 {
                    *most = (rank, nodes);
                }
            }
        }
        let owner: Vec<usize> = most.into_iter().map(|(rank, _)| rank).collect();
        let mut between = BTreeMap::<usize, [Vec<u32>; 2]>::new();
        for (node, &teller) in (0..).zip(&ranks.lowest) {
            let (own, teller) = (owner[node as usize / CHUNK], teller as usize);
            let has = || ranks.shared.get(&node).is_some_and(|ranks| ranks.contains(&(own as u32)));
            if teller == me && own != me && !has() {
                between.entry(own).or_default()[0].push(node);
            } else if own == me && teller != me && !nodes.contains(&node) {
                between.entry(teller).or_default()[1].push(node);
            }
        }
        NodeSums { me, owner, nodes: Exchanged::new(between) }
    }

    /// Whether this rank adds what the nodes of a chunk have.
    pub(super) fn is_own(&self, chunk: usize) -> bool {
        self.owner[chunk] == self.me
    }

    /// Gets values of the nodes of own chunks that other ranks have.
    pub(super) fn fetch(&mut self, exchange: &dyn Exchange, values: &mut [Vec3]) {
        let get = |values: &[Vec3], node: u32| values[node as usize].into();
        self.nodes.exchange(exchange, values, get, |values, node, from: [f64; 3]| values[node as usize] = from.into());
    }

    /// Gives every rank the sums of all chunks, once each has those of its own.
    pub(super) fn exchange<const N: usize>(&self, exchange: &dyn Exchange, sums: &mut [[f64; N]]) {
        gather_by_owner(exchange, |chunk| self.owner[chunk], sums);
    }
}
