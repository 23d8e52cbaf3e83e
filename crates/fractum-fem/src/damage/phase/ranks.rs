//! The active edges of a phase field that several ranks advance: each sweeps those of its own blocks, and all know every d.

use std::sync::Arc;

use fractum_parallel::Exchange;

use super::ActiveEdge;

/// What the ranks tell each other of the active edges of a body.
#[derive(Clone, Debug)]
pub(super) struct Told {
    exchange: Arc<dyn Exchange>,
    /// Active edges of each rank.
    counts: Vec<usize>,
    /// Where the next edge of each rank is in `all`.
    places: Vec<usize>,
    own: Vec<f64>,
    all: Vec<f64>,
}

impl Told {
    pub(super) fn new(exchange: Arc<dyn Exchange>) -> Self {
        let zeros = vec![0; exchange.size()];
        Told { exchange, counts: zeros.clone(), places: zeros, own: Vec::new(), all: Vec::new() }
    }

    pub(super) fn rank(&self) -> u32 {
        self.exchange.rank() as u32
    }

    /// Gives every rank the d that the others have found.
    pub(super) fn tell(&mut self, active: &mut [ActiveEdge]) {
        let Told { exchange, counts, places, own, all } = self;
        counts.fill(0);
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
