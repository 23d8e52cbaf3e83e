//! The active edges of a phase field that several ranks advance: each sweeps those of its own blocks, and all know every d.

use fractum_parallel::Exchange;

use crate::damage::phase::ActiveEdge;

/// What the ranks send each other of the active edges of a body.
#[derive(Clone, Debug, Default)]
pub(super) struct PhaseExchange {
    /// Active edges of each rank.
    counts: Vec<usize>,
    /// Where the next edge of each rank is in `all`.
    places: Vec<usize>,
    own: Vec<f64>,
    all: Vec<f64>,
}

impl PhaseExchange {
    /// Gives every rank the d that the others have found.
    pub(super) fn gather(&mut self, exchange: &dyn Exchange, active: &mut [ActiveEdge]) {
        let PhaseExchange { counts, places, own, all } = self;
        for counts in [&mut *counts, places] {
            counts.clear();
            counts.resize(exchange.size(), 0);
        }
        own.clear();
        for edge in &*active {
            counts[edge.rank as usize] += 1;
            if edge.rank as usize == exchange.rank() {
                own.push(edge.next);
            }
        }
        let mut begin = 0;
        for (place, count) in places.iter_mut().zip(&*counts) {
            *place = begin;
            begin += count;
        }
        all.resize(active.len(), 0.0);
        exchange.gather(own, counts, all);
        for edge in active {
            let place = &mut places[edge.rank as usize];
            edge.next = all[*place];
            *place += 1;
        }
    }
}
