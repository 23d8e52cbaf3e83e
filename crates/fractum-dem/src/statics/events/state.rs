//! What a quasi-static run remembers, for a checkpoint.

use serde::{Deserialize, Serialize};

use super::super::body::BodyMemory;
use super::{CriticalLoad, LoadPoint, QuasiStatic};
use crate::fracture::Crack;

/// Everything that changes from break to break, once the load has reached a failure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuasiStaticState {
    body: BodyMemory,
    factor: f64,
    last: Option<LoadPoint>,
    first: Option<CriticalLoad>,
    peak: CriticalLoad,
    effort_to_peak: (usize, usize),
    event: usize,
    overload: f64,
    cascade: bool,
    cracks: Vec<Crack>,
}

impl QuasiStatic {
    /// What it remembers.
    pub fn state(&self) -> QuasiStaticState {
        QuasiStaticState {
            body: self.body.memory(),
            factor: self.factor,
            last: self.last,
            first: self.first,
            peak: self.peak,
            effort_to_peak: self.effort_to_peak,
            event: self.event,
            overload: self.overload,
            cascade: self.cascade,
            cracks: self.cracks.clone(),
        }
    }

    /// Goes on from a state of a run of the same body, in place of the first equilibrium.
    pub fn restore(&mut self, state: QuasiStaticState) {
        // Neighbourhoods and stiffness follow the bonds that broke, in their order.
        for crack in &state.cracks {
            self.graph.break_bond(crack.bond);
            self.body.break_bond(crack.bond);
            self.search.bond_broken(crack.bond, &self.graph);
        }
        self.body.recall(state.body);
        self.search.search(&self.body, &self.graph, state.overload);
        (self.factor, self.last, self.first, self.peak) = (state.factor, state.last, state.first, state.peak);
        (self.effort_to_peak, self.event, self.overload) = (state.effort_to_peak, state.event, state.overload);
        (self.cascade, self.cracks) = (state.cascade, state.cracks);
    }
}
