//! Numbers of blocks that all ranks need where something happens.

use std::ops::Range;

use fractum_parallel::Exchange;

use crate::evaluate::Block;

/// What happened in a step, on any rank.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Events {
    /// A cell was turned inside out.
    pub(crate) inverted: bool,
    /// An edge broke.
    pub(crate) broken: bool,
}

/// What the ranks tell each other of their blocks, see [`record`]; empty where nothing can happen.
#[derive(Clone, Debug, Default)]
pub(super) struct Records {
    all: Vec<f64>,
    own: Vec<f64>,
    counts: Vec<usize>,
    /// All ranks need them in every step.
    always: bool,
}

/// Numbers of a block in [`Records`].
const RECORD: usize = 4;
/// In a record: edges have passed their strength, edges broke.
const WOKEN: f64 = 1.0;
const BROKEN: f64 = 2.0;

impl Records {
    /// - `counts`: blocks of each rank
    /// - `has_events`: whether something can happen in a block that all ranks must know; `always`: whether all need the numbers of
    ///   every block in every step
    pub(super) fn new(counts: impl Iterator<Item = usize>, rank: usize, [has_events, always]: [bool; 2]) -> Self {
        if !has_events && !always {
            return Records::default();
        }
        let counts: Vec<usize> = counts.map(|count| RECORD * count).collect();
        Records { all: vec![0.0; counts.iter().sum()], own: vec![0.0; counts[rank]], counts, always }
    }

    /// Tells all ranks what they need of every block, where something has happened.
    pub(super) fn tell(&mut self, exchange: &dyn Exchange, own: Range<usize>, blocks: &mut [Block]) -> Events {
        let mut events = Events::default();
        let happened = || blocks[own.clone()].iter().any(Block::has_event);
        if self.all.is_empty() || !self.always && exchange.any(u64::from(happened())) == 0 {
            return events;
        }
        let records = self.own.chunks_exact_mut(RECORD).zip(&blocks[own.clone()]);
        records.for_each(|(to, block)| to.copy_from_slice(&record(block)));
        exchange.gather(&self.own, &self.counts, &mut self.all);
        for (index, (block, from)) in blocks.iter_mut().zip(self.all.chunks_exact(RECORD)).enumerate() {
            let &[power, shock, inverted, edges] = from else { continue };
            events.inverted |= inverted >= 0.0;
            events.broken |= edges >= BROKEN;
            if !own.contains(&index) {
                (block.viscous_power, block.viscous.shock) = (power, shock);
                block.inverted = (inverted >= 0.0).then_some(inverted as usize);
                if let Some(field) = block.edge_field_mut() {
                    field.woken |= edges % BROKEN >= WOKEN;
                }
            }
        }
        events
    }
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
