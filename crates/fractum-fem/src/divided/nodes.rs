//! What all ranks know of the nodes of bodies that none of them has whole.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use fractum_parallel::{Exchange, Exchanged, Gathered, post};
use rayon::prelude::*;

use super::{BodyShare, NodesOfOthers};

/// Nodes by number: each rank looks after a run of them.
struct Runs<'a> {
    exchange: &'a dyn Exchange,
    count: usize,
}

impl Runs<'_> {
    fn first(&self, rank: usize) -> usize {
        (rank * self.count).div_ceil(self.exchange.size())
    }

    fn rank(&self, node: u32) -> usize {
        node as usize * self.exchange.size() / self.count
    }

    fn own(&self) -> Range<usize> {
        let rank = self.exchange.rank();
        self.first(rank)..self.first(rank + 1)
    }

    /// Gives every rank a value of every node, by who looks after it.
    fn gather(&self, own: &[f64]) -> Vec<f64> {
        let counts: Vec<usize> =
            (0..self.exchange.size()).map(|rank| self.first(rank + 1) - self.first(rank)).collect();
        let mut all = vec![0.0; self.count];
        self.exchange.gather(own, &counts, &mut all);
        all
    }
}

/// What the elements of a body give their nodes.
pub(crate) struct GivenToNodes<'a> {
    pub(crate) share: &'a BodyShare,
    /// Those of this rank.
    pub(crate) elements: &'a [[u32; 4]],
    /// What each of them gives each of its nodes.
    pub(crate) values: Vec<f64>,
}

/// What every node has of the elements around it: body by body in the order of their numbers. All ranks must call it.
///
/// - `count`: how many nodes there are
pub(crate) fn nodal_sums(exchange: &dyn Exchange, count: usize, bodies: &[GivenToNodes]) -> Vec<f64> {
    let owned = || {
        bodies.iter().enumerate().flat_map(|(index, GivenToNodes { share, elements, values })| {
            let owned = (0..values.len()).filter(|&element| share.is_owned[element]);
            owned.map(move |element| {
                let order = (index as u64) << 32 | u64::from(share.number(element));
                (elements[element], order, values[element])
            })
        })
    };
    let mut is_own = vec![false; count];
    owned().for_each(|(nodes, ..)| nodes.iter().for_each(|&node| is_own[node as usize] = true));
    let own: Vec<u32> = (0..count as u32).filter(|&node| is_own[node as usize]).collect();
    let ranks = RanksOfNodes::new(exchange, count, &own);
    let runs = Runs { exchange, count };
    // Where one rank owns all elements it has them in order; else who looks after the node puts them in order.
    let mut alone = vec![0.0; count];
    let mut words = vec![Vec::new(); exchange.size()];
    for (nodes, order, part) in owned() {
        for node in nodes {
            if ranks.shared.contains_key(&node) {
                words[runs.rank(node)].extend([u64::from(node), order, part.to_bits()]);
            } else {
                alone[node as usize] += part;
            }
        }
    }
    for node in own.into_iter().filter(|node| !ranks.shared.contains_key(node)) {
        words[runs.rank(node)].extend([u64::from(node), 0, alone[node as usize].to_bits()]);
    }
    drop(alone);
    let received = post(exchange, words);
    let mut parts: Vec<[u64; 3]> = received.iter().flat_map(|words| words.as_chunks().0).copied().collect();
    drop(received);
    parts.par_sort_unstable();
    let after = runs.own();
    let mut sums = vec![0.0; after.len()];
    parts.iter().for_each(|&[node, _, part]| sums[node as usize - after.start] += f64::from_bits(part));
    runs.gather(&sums)
}

/// Nodes of elements that several ranks own, for values that all elements around a node decide.
#[derive(Debug)]
pub struct SharedNodes {
    exchange: Arc<dyn Exchange>,
    swapped: Exchanged<u32>,
    gathered: Gathered,
}

impl SharedNodes {
    /// - `own`: nodes of the elements that this rank owns, ascending; all ranks must call it
    pub(crate) fn new(exchange: Arc<dyn Exchange>, count: usize, own: &[u32]) -> Self {
        let ranks = RanksOfNodes::new(&*exchange, count, own);
        let mut between = BTreeMap::<usize, [Vec<u32>; 2]>::new();
        for (&node, others) in &ranks.shared {
            for &other in others {
                between.entry(other as usize).or_default().iter_mut().for_each(|nodes| nodes.push(node));
            }
        }
        let mut owned = vec![Vec::new(); exchange.size()];
        (0..).zip(&ranks.lowest).for_each(|(node, &rank)| owned[rank as usize].push(node));
        SharedNodes { exchange, swapped: Exchanged::new(between), gathered: Gathered::new(owned) }
    }

    /// Leaves the least value of all ranks at each node. All ranks must call it.
    pub fn take_least(&mut self, values: &mut [f64]) {
        self.swapped.fill(|node| [values[node as usize]]);
        self.swapped.swap(&*self.exchange, &mut || ());
        self.swapped.read(|node, [value]: [f64; 1]| values[node as usize] = values[node as usize].min(value));
    }

    /// Gives every rank the values of all nodes. All ranks must call it.
    pub fn gather(&mut self, values: &mut [f64]) {
        let put = |values: &mut [f64], node: usize, [value]: [f64; 1]| values[node] = value;
        self.gathered.gather(&*self.exchange, values, |values, node| [values[node]], put);
    }
}

/// Which ranks have cells at a node.
#[derive(Clone, Debug)]
pub(crate) struct RanksOfNodes {
    /// The lowest of them, of every node.
    pub(crate) lowest: Vec<u32>,
    /// Nodes of this rank that others have too, with these, ascending.
    pub(crate) shared: BTreeMap<u32, Vec<u32>>,
}

impl RanksOfNodes {
    /// - `own`: nodes of the cells of this rank, ascending
    pub(crate) fn new(exchange: &dyn Exchange, count: usize, own: &[u32]) -> Self {
        let runs = Runs { exchange, count };
        let mut words = vec![Vec::new(); exchange.size()];
        own.iter().for_each(|&node| words[runs.rank(node)].push(u64::from(node)));
        let after = runs.own();
        let mut ranks: Vec<Vec<u32>> = vec![Vec::new(); after.len()];
        for (rank, nodes) in post(exchange, words).iter().enumerate() {
            nodes.iter().for_each(|&node| ranks[node as usize - after.start].push(rank as u32));
        }
        let lowest: Vec<f64> = ranks.iter().map(|ranks| f64::from(ranks.first().copied().unwrap_or(0))).collect();
        let lowest = runs.gather(&lowest).into_iter().map(|rank| rank as u32).collect();
        let mut words = vec![Vec::new(); exchange.size()];
        for (node, ranks) in (after.start as u64..).zip(&ranks) {
            for &rank in ranks {
                let others = ranks.iter().filter(|&&other| other != rank);
                words[rank as usize].extend(others.map(|&other| node << 32 | u64::from(other)));
            }
        }
        let mut shared = BTreeMap::<u32, Vec<u32>>::new();
        for word in post(exchange, words).concat() {
            shared.entry((word >> 32) as u32).or_default().push(word as u32);
        }
        RanksOfNodes { lowest, shared }
    }

    /// Nodes of this rank in the blocks of others.
    ///
    /// - `blocks`: number and nodes of the blocks of this rank
    pub(crate) fn of_others<'a>(
        &self,
        exchange: &dyn Exchange,
        blocks: impl Iterator<Item = (usize, &'a [u32])>,
    ) -> NodesOfOthers {
        let mut words = vec![Vec::new(); exchange.size()];
        for (block, nodes) in blocks {
            for &node in nodes {
                for &other in self.shared.get(&node).into_iter().flatten() {
                    words[other as usize].push((block as u64) << 32 | u64::from(node));
                }
            }
        }
        let mut found = NodesOfOthers::new();
        for word in post(exchange, words).concat() {
            found.entry((word >> 32) as usize).or_default().push(word as u32);
        }
        found
    }
}
