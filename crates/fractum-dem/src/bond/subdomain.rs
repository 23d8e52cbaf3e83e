//! What ranks send each other of the sums of blocks of bonds.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use fractum_kernels::bond::BondLaw;
use fractum_parallel::{Exchange, Exchanged, rank_of};

use super::block::Block;
use crate::particles::{ParticleSubdomain, SHARED};

/// The share of a rank.
#[derive(Clone, Debug)]
pub(super) struct BondSubdomain {
    exchange: Arc<dyn Exchange>,
    /// First block of each rank, and the end.
    first: Vec<usize>,
    /// Sums (block, slot) of own blocks at particles of others, and the other way round.
    sums: Exchanged<[u32; 2]>,
    /// Blocks with sums that others wait for.
    is_outer: Vec<bool>,
}

impl BondSubdomain {
    pub(super) fn new<L: BondLaw>(part: &ParticleSubdomain, blocks: &[Block<L>]) -> Self {
        let exchange = Arc::clone(part.exchange());
        let first: Vec<usize> = part.first().iter().map(|first| first.div_ceil(SHARED)).collect();
        let mut between = BTreeMap::<usize, [Vec<[u32; 2]>; 2]>::new();
        let mut is_outer = vec![false; blocks.len()];
        let me = exchange.rank();
        for (index, block) in blocks.iter().enumerate() {
            let from = rank_of(&first, index);
            for (slot, &partner) in block.partners.iter().enumerate() {
                let to = rank_of(&first, partner as usize / SHARED);
                let place = [index as u32, (block.count + slot) as u32];
                if from == me && to != me {
                    between.entry(to).or_default()[0].push(place);
                    is_outer[index] = true;
                } else if from != me && to == me {
                    between.entry(from).or_default()[1].push(place);
                }
            }
        }
        BondSubdomain { exchange, first, sums: Exchanged::new(between), is_outer }
    }

    /// Own blocks.
    pub(super) fn own(&self) -> Range<usize> {
        let rank = self.exchange.rank();
        self.first[rank]..self.first[rank + 1]
    }

    pub(super) fn exchange(&self) -> &dyn Exchange {
        &*self.exchange
    }

    /// Whether others wait for sums of each block.
    pub(super) fn is_outer(&self) -> &[bool] {
        &self.is_outer
    }

    /// Sums (block, slot) that come from others.
    pub(super) fn received(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.sums.received()
    }

    /// Values of all blocks, by those of own ones.
    pub(super) fn of_all<const N: usize>(&self, own: &[[f64; N]], blocks: usize) -> Vec<[f64; N]> {
        let counts: Vec<usize> = self.first.windows(2).map(|first| N * (first[1] - first[0])).collect();
        let mut all = vec![[0.0; N]; blocks];
        self.exchange.gather(own.as_flattened(), &counts, all.as_flattened_mut());
        all
    }

    /// Swaps what the blocks have summed, and does some work meanwhile.
    pub(super) fn swap<L: BondLaw, const N: usize>(
        &mut self,
        blocks: &mut [Block<L>],
        get: impl Fn(&Block<L>, usize) -> [f64; N],
        put: impl Fn(&mut Block<L>, usize, [f64; N]),
        mut work: impl FnMut(&mut [Block<L>], &[bool]),
    ) {
        let BondSubdomain { exchange, sums, is_outer, .. } = self;
        sums.fill(|[block, slot]| get(&blocks[block as usize], slot as usize));
        sums.swap(&**exchange, &mut || work(blocks, is_outer));
        sums.read(|[block, slot], from| put(&mut blocks[block as usize], slot as usize, from));
    }
}
