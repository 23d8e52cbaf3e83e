//! What a quasi-static run remembers, for a checkpoint.

use serde::{Deserialize, Serialize};

use super::super::body::{BodyMemory, StaticBody};
use super::{CriticalLoad, LoadPoint, QuasiStatic};
use crate::fracture::Crack;

/// How far the load has come, and what it has broken.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Progress {
    pub(super) factor: f64,
    pub(super) last: Option<LoadPoint>,
    pub(super) first: Option<CriticalLoad>,
    pub(super) peak: CriticalLoad,
    pub(super) effort_to_peak: (usize, usize),
    pub(super) event: usize,
    /// Ratio at load factor one at which the last search took a site for overloaded.
    pub(super) overload: f64,
    /// How far the load factor rose to the last failure, beside constant loads.
    pub(super) stride: f64,
    /// Whether sites fail at the present load already.
    pub(super) cascade: bool,
    pub(super) cracks: Vec<Crack>,
}

impl Default for Progress {
    fn default() -> Self {
        Progress {
            factor: 0.0,
            last: None,
            first: None,
            peak: CriticalLoad { displacement: 0.0, load: 0.0, broken: 0 },
            effort_to_peak: (0, 0),
            event: 0,
            overload: f64::INFINITY,
            stride: 0.0,
            cascade: false,
            cracks: Vec::new(),
        }
    }
}

/// Everything that changes from break to break, once the load has reached a failure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuasiStaticState {
    body: BodyMemory,
    constant: Option<BodyMemory>,
    progress: Progress,
}

impl QuasiStatic {
    /// What it remembers.
    pub fn state(&self) -> QuasiStaticState {
        let constant = self.constant().map(StaticBody::memory);
        QuasiStaticState { body: self.body.memory(), constant, progress: self.progress.clone() }
    }

    /// Goes on from a state of a run of the same body, in place of the first equilibrium.
    pub fn restore(&mut self, state: QuasiStaticState) {
        // Neighbourhoods follow the bonds that broke, in their order.
        for crack in &state.progress.cracks {
            self.graph.break_bond(crack.bond);
            self.search.bond_broken(crack.bond, &self.graph);
        }
        self.body.recall(state.body);
        self.progress = state.progress;
        match (&mut self.constant, state.constant) {
            (Some(constant), Some(memory)) => {
                constant.body.recall(memory);
                constant.update(&self.body);
                self.look(self.progress.factor);
            }
            _ => self.search.search(&self.body, &self.graph, self.progress.overload),
        }
    }
}
