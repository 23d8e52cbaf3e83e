//! The cells of all ranks in one order, and which rank gets which.

use fractum_parallel::{Exchange, post, rank_of};
use rayon::prelude::*;

use crate::cells::cell::BLOCK_CELLS;

/// A cell in the order of all: its class (twice its body, or one more if it cannot be damaged where others can), its place along the curve, and what decides between cells at the same place (the nodes of an edge, the number of
/// an element).
pub(super) type Key = [u64; 3];

/// Keys that a rank shows of its own, for as many places at which the order is cut: the more, the more alike the shares.
const SHOWN: usize = 512;

/// Where the cells of this rank go.
pub(super) struct Order {
    /// Cells that this rank evaluates, in their order.
    pub(super) own: Vec<Key>,
    /// Cells that this rank has named, in their order, and the rank that evaluates each.
    named: Vec<Key>,
    ranks: Vec<u32>,
}

impl Order {
    /// Puts the cells that all ranks name in order and deals them out, in whole runs of [`BLOCK_CELLS`]. All ranks must call it.
    ///
    /// - `classes`: how many there are
    pub(super) fn new(exchange: &dyn Exchange, mut named: Vec<Key>, classes: usize) -> Self {
        named.par_sort_unstable();
        named.dedup();
        named.shrink_to_fit();
        let cuts = cuts(exchange, &named);
        let ends: Vec<usize> = cuts.iter().map(|cut| named.partition_point(|key| key < cut)).collect();
        let begins = std::iter::once(0).chain(ends.iter().copied());
        let to_rank = begins.zip(ends.iter().copied().chain([named.len()]));
        let words = to_rank.map(|(begin, end)| named[begin..end].as_flattened().to_vec()).collect();
        let asked = post(exchange, words);
        let mut held: Vec<Key> = asked.iter().flat_map(|words| words.as_chunks().0).copied().collect();
        held.par_sort_unstable();
        held.dedup();
        let ranks_of_held = ranks_of_runs(exchange, &held, classes);
        let reply = |words: &Vec<u64>| {
            let rank = |key: &Key| {
                let index = held.binary_search(key).expect("what is asked for is held");
                u64::from(ranks_of_held[index])
            };
            words.as_chunks().0.iter().map(rank).collect()
        };
        let replies = asked.iter().map(reply).collect();
        drop(asked);
        let ranks = post(exchange, replies).into_iter().flatten().map(|rank| rank as u32).collect();
        let mut to_owner = vec![Vec::new(); exchange.size()];
        held.iter().zip(&ranks_of_held).for_each(|(key, &rank)| to_owner[rank as usize].extend(key));
        drop(held);
        let received = post(exchange, to_owner);
        let mut own: Vec<Key> = received.iter().flat_map(|words| words.as_chunks().0).copied().collect();
        own.par_sort_unstable();
        Order { own, named, ranks }
    }

    /// The rank that evaluates a cell that this one has named.
    pub(super) fn rank(&self, key: &Key) -> u32 {
        self.ranks[self.named.binary_search(key).expect("one of those that were named")]
    }

    /// Cells of this rank in runs that make a block each.
    pub(super) fn runs(&self) -> impl Iterator<Item = &[Key]> {
        self.own.chunk_by(|a, b| a[0] == b[0]).flat_map(|of_class| of_class.chunks(BLOCK_CELLS))
    }
}

/// Keys at which the order of all is cut into shares of about the same length: those that the second rank and all further ones begin with.
fn cuts(exchange: &dyn Exchange, named: &[Key]) -> Vec<Key> {
    let size = exchange.size();
    let mut counts = vec![0.0; size];
    exchange.gather(&[named.len() as f64], &vec![1; size], &mut counts);
    let stride = (counts.iter().sum::<f64>() as usize / (SHOWN * size)).max(1);
    let shown: Vec<f64> = named.iter().step_by(stride).flatten().map(|&word| f64::from_bits(word)).collect();
    let of_rank: Vec<usize> = counts.iter().map(|&count| 3 * (count as usize).div_ceil(stride)).collect();
    let mut all = vec![0.0; of_rank.iter().sum()];
    exchange.gather(&shown, &of_rank, &mut all);
    let mut all: Vec<Key> = all.as_chunks::<3>().0.iter().map(|key| key.map(f64::to_bits)).collect();
    all.sort_unstable();
    (1..size).map(|rank| all.get(rank * all.len() / size).copied().unwrap_or([u64::MAX; 3])).collect()
}

/// The rank of each cell that this one holds: that which holds the first of its run.
fn ranks_of_runs(exchange: &dyn Exchange, held: &[Key], classes: usize) -> Vec<u32> {
    let (me, size) = (exchange.rank(), exchange.size());
    let mut counts = vec![0.0; classes];
    held.iter().for_each(|key| counts[key[0] as usize] += 1.0);
    let mut all = vec![0.0; classes * size];
    exchange.gather(&counts, &vec![classes; size], &mut all);
    let mut ranks = Vec::with_capacity(held.len());
    for of_class in held.chunk_by(|a, b| a[0] == b[0]) {
        let class = of_class[0][0] as usize;
        let mut first = vec![0];
        (0..size).for_each(|rank| first.push(first[rank] + all[rank * classes + class] as usize));
        let rank = |index: usize| rank_of(&first[..size], (first[me] + index) / BLOCK_CELLS * BLOCK_CELLS) as u32;
        ranks.extend((0..of_class.len()).map(rank));
    }
    ranks
}
