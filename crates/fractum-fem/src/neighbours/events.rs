//! Numbers of blocks that all ranks need, in every step or where something happens.

use std::ops::Range;

use fractum_parallel::{Exchange, gather};

use crate::element::InvertedElement;
use crate::solid::evaluate::Block;

/// What happened in a step, on any rank.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Happened {
    /// A cell was turned inside out.
    pub(super) inverted: bool,
    /// An edge broke.
    pub(super) broken: bool,
}

/// What the ranks send each other of their blocks, see [`record`].
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    /// Something can happen in a block that all ranks must know.
    has_events: bool,
    /// Numbers of all blocks and of own ones, where all ranks need them in every step; else empty.
    all: Vec<f64>,
    own: Vec<f64>,
    counts: Vec<usize>,
    /// An element that the last forces found turned inside out, where no rank has all elements.
    pub(super) inverted: Option<InvertedElement>,
}

/// Numbers of a block in [`Events`].
const RECORD: usize = 4;
/// In a record: edges have passed their strength, edges broke.
const WOKEN: f64 = 1.0;
const BROKEN: f64 = 2.0;

impl Events {
    /// - `counts`: blocks of each rank
    /// - `has_events`: whether something can happen in a block that all ranks must know; `always`: whether all need the numbers of
    ///   every block in every step
    pub(super) fn new(counts: impl Iterator<Item = usize>, rank: usize, [has_events, always]: [bool; 2]) -> Self {
        if !always {
            return Events { has_events, ..Events::default() };
        }
        let counts: Vec<usize> = counts.map(|count| RECORD * count).collect();
        Events { has_events, all: vec![0.0; counts.iter().sum()], own: vec![0.0; counts[rank]], counts, inverted: None }
    }

    /// From now on something can happen that all ranks must know.
    pub(super) fn expect(&mut self) {
        self.has_events = true;
    }

    /// Gives all ranks what they need of every block, or of those alone in which something has happened.
    pub(super) fn exchange(&mut self, exchange: &dyn Exchange, own: Range<usize>, blocks: &mut [Block]) -> Happened {
        if !self.all.is_empty() {
            let records = self.own.chunks_exact_mut(RECORD).zip(&blocks[own.clone()]);
            records.for_each(|(to, block)| to.copy_from_slice(&record(block)));
            exchange.gather(&self.own, &self.counts, &mut self.all);
            let all = self.all.as_chunks().0;
            return take_over(all.iter().copied().enumerate(), own, blocks);
        }
        let happened = || blocks[own.clone()].iter().any(Block::has_event);
        if !self.has_events || exchange.any(u64::from(happened())) == 0 {
            return Happened::default();
        }
        let with_event = own.clone().filter(|&index| blocks[index].has_event());
        let mine: Vec<(usize, [f64; RECORD])> = with_event.map(|index| (index, record(&blocks[index]))).collect();
        take_over(gather(exchange, &mine).into_iter().flatten(), own, blocks)
    }
}

/// Takes over what the ranks have sent of blocks; what has happened on any of them.
fn take_over(
    records: impl Iterator<Item = (usize, [f64; RECORD])>,
    own: Range<usize>,
    blocks: &mut [Block],
) -> Happened {
    let mut happened = Happened::default();
    for (index, [power, shock, inverted, edges]) in records {
        happened.inverted |= inverted >= 0.0;
        happened.broken |= edges >= BROKEN;
        let block = &mut blocks[index];
        if !own.contains(&index) {
            (block.viscous_power, block.viscous.shock) = (power, shock);
            block.inverted = (inverted >= 0.0).then_some(inverted as usize);
            if let Some(field) = block.edge_field_mut() {
                field.woken |= edges % BROKEN >= WOKEN;
            }
        }
    }
    happened
}

/// What all ranks need of a block: viscous power [W], part of the shock, a cell that is turned inside out or
/// -1, and what became of its edges.
fn record(block: &Block) -> [f64; RECORD] {
    let edges = block.edge_field().map_or(0.0, |field| {
        let woken = if field.woken { WOKEN } else { 0.0 };
        if field.fresh.is_empty() { woken } else { woken + BROKEN }
    });
    [block.viscous_power, block.viscous.shock, block.inverted.map_or(-1.0, |cell| cell as f64), edges]
}
