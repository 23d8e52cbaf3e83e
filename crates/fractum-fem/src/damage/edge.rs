//! Damage on the edges of a body.

use std::sync::Arc;

use fractum_kernels::Sym3;
use fractum_kernels::damage::{EdgeDamage, EdgeRate, Seen, Softens};

use crate::damage::rate::RateField;
use crate::damage::threshold::Threshold;

/// Damage of a set of edges: those of a block of smoothed cells, or all of a standard body.
#[derive(Clone, Debug)]
pub(crate) struct EdgeField {
    pub(crate) softens: Arc<Softens>,
    /// Numbers of the edges in their body.
    pub(crate) edges: Vec<u32>,
    /// Histories; empty where all edges are intact and another rank evaluates them, see [`EdgeField::keep_histories`].
    pub(crate) state: Vec<EdgeDamage>,
    /// Equivalent stress [Pa] below which an edge of a cell is known to stay intact; negative once it is damaged.
    pub(crate) threshold: Vec<f64>,
    /// Edges whose threshold is negative.
    damaged: usize,
    /// Strength [Pa] of each edge; infinite where damage may not occur.
    pub(crate) strength: Vec<f64>,
    /// Characteristic length [m] of each edge.
    pub(crate) length: Vec<f64>,
    /// Edges of this field that broke since removal last looked.
    pub(crate) fresh: Vec<u32>,
    /// An edge has passed its strength and has no damage yet, which the phase field must give it.
    pub(crate) woken: bool,
    /// Rates of strain, where strength grows with them.
    pub(crate) rate: Option<Box<RateField>>,
}

impl EdgeField {
    /// Intact edges of a body, without their histories.
    pub(crate) fn new(softens: Arc<Softens>, edges: Vec<u32>, threshold: &Threshold) -> Self {
        let strength = edges.iter().map(|&edge| threshold.strength(edge)).collect();
        let length = edges.iter().map(|&edge| threshold.length(edge)).collect();
        let mut field = EdgeField::of_edges(softens, edges, strength, length);
        field.rate = threshold.rate.clone().map(|curves| Box::new(RateField::new(curves, &field.strength)));
        field
    }

    /// The same with strength [Pa] and characteristic length [m] of each.
    pub(crate) fn of_edges(softens: Arc<Softens>, edges: Vec<u32>, strength: Vec<f64>, length: Vec<f64>) -> Self {
        EdgeField {
            softens,
            state: Vec::new(),
            threshold: Vec::new(),
            length,
            strength,
            edges,
            damaged: 0,
            fresh: Vec::new(),
            woken: false,
            rate: None,
        }
    }

    /// Keeps the histories of its edges from now on.
    pub(crate) fn keep_histories(&mut self) {
        if self.state.is_empty() {
            self.state = self.strength.iter().map(|&strength| self.intact(strength)).collect();
            self.threshold = self.state.iter().map(|edge| edge.kappa).collect();
        }
    }

    /// Lets go of the histories of its edges where nothing has happened to any of them.
    pub(crate) fn forget_intact(&mut self) {
        let mut histories = self.state.iter().zip(&self.strength);
        if histories.all(|(edge, &strength)| *edge == self.intact(strength)) {
            (self.state, self.threshold) = Default::default();
        }
    }

    /// Gives an edge the history that another rank has found.
    pub(crate) fn put(&mut self, index: usize, history: EdgeDamage) {
        self.keep_histories();
        self.state[index] = history;
        self.note(index);
    }

    /// History of an edge.
    pub(crate) fn history(&self, index: usize) -> EdgeDamage {
        self.state.get(index).copied().unwrap_or_else(|| self.intact(self.strength[index]))
    }

    /// History of an edge of this strength that nothing has happened to yet.
    fn intact(&self, strength: f64) -> EdgeDamage {
        self.rate.as_ref().map_or_else(|| EdgeDamage::intact(strength), |rate| rate.intact(strength))
    }

    /// Advances the history of an edge to what it sees under its effective stress; returns the growth of damage.
    #[inline(always)]
    pub(crate) fn load(&mut self, index: usize, mut seen: Seen, stress: Sym3, dt: f64) -> f64 {
        let EdgeField { softens, state, strength, length, rate, .. } = self;
        let (edge, mut length) = (&mut state[index], length[index]);
        if seen.stress <= edge.kappa {
            return 0.0;
        }
        if let Some(rate) = rate {
            let (step, rates) = rate.in_step(dt);
            if !step.lets_grow(softens, &mut rates[index], (edge, &mut seen), (&mut strength[index], length), stress) {
                return 0.0;
            }
            length /= rates[index].energy;
        }
        let was_broken = edge.broken;
        let growth = softens.load(edge, seen, strength[index], length, dt);
        self.woken |= edge.damage == 0.0;
        if edge.broken && !was_broken {
            self.fresh.push(index as u32);
        }
        self.note(index);
        growth
    }

    /// Lets an edge whose cracks rub break where its crack is open: elements that closed cracks cut through stay.
    pub(crate) fn let_open(&mut self, index: usize, strain: Sym3) {
        let edge = &mut self.state[index];
        if !edge.broken && self.softens.is_open(edge, strain, self.strength[index]) {
            edge.broken = true;
            self.fresh.push(index as u32);
        }
    }

    /// [`EdgeField::load`] at rest, where no body is whose strength grows with the rate of strain.
    pub(crate) fn load_at_rest(&mut self, index: usize, seen: Seen) -> f64 {
        self.load(index, seen, Sym3::ZERO, 0.0)
    }

    /// Edges of the body that have passed their strength.
    pub(crate) fn above_strength(&self) -> impl Iterator<Item = u32> + '_ {
        let histories = self.edges.iter().zip(&self.state).zip(&self.strength);
        histories.filter(|((_, state), strength)| state.kappa > **strength).map(|((&edge, _), _)| edge)
    }

    /// Lets an edge that the phase field has found already see this.
    pub(crate) fn see(&mut self, index: usize, seen: Seen) {
        self.softens.load(&mut self.state[index], seen, self.strength[index], self.length[index], 0.0);
        self.note(index);
    }

    /// Raises the damage of an edge to that of the phase field; returns the growth.
    ///
    /// - `stiffness`: ω(d)
    pub(crate) fn soften(&mut self, index: usize, stiffness: f64) -> f64 {
        let edge = &mut self.state[index];
        let was_broken = edge.broken;
        let growth = self.softens.soften(edge, stiffness, self.strength[index]);
        if edge.broken && !was_broken {
            self.fresh.push(index as u32);
        }
        self.note(index);
        growth
    }

    /// Lets the cheap test know the history of an edge.
    #[inline]
    pub(crate) fn note(&mut self, index: usize) {
        let threshold = self.state[index].threshold();
        self.damaged += usize::from(threshold < 0.0 && self.threshold[index] >= 0.0);
        self.threshold[index] = threshold;
    }

    /// Whether an edge of a block is damaged; standard bodies do not count theirs.
    pub(crate) fn is_damaged(&self) -> bool {
        self.damaged > 0
    }

    /// Whether edges are damaged rather than intact, so that four at a time cost less.
    pub(crate) fn is_mostly_damaged(&self) -> bool {
        2 * self.damaged >= self.edges.len()
    }

    /// Has removal look at every broken edge.
    pub(crate) fn renew_fresh(&mut self) {
        let EdgeField { fresh, state, .. } = self;
        fresh.clear();
        fresh.extend((0..).zip(&*state).filter(|(_, edge)| edge.broken).map(|(index, _)| index));
    }

    /// Equivalent stress from which on damage grows [Pa].
    pub(crate) fn onset(&self, index: usize) -> f64 {
        let edge = &self.state[index];
        // Where the rate counts, an intact edge is looked at before.
        if edge.damage == 0.0 { edge.kappa.max(self.strength[index]) } else { edge.kappa }
    }

    /// Damage that an edge would have after what it sees.
    pub(crate) fn trial(&self, index: usize, seen: Seen) -> f64 {
        let mut edge = self.state[index];
        if seen.stress > self.onset(index) {
            self.softens.load(&mut edge, seen, self.strength[index], self.length[index], 0.0);
        }
        edge.damage
    }

    /// Takes over saved histories, by edge of the body. Removal looks at all of them once more, and finds nothing new.
    pub(crate) fn restore(&mut self, saved: &[EdgeDamage], rates: &[(f64, EdgeRate)]) {
        let is_kept = !self.state.is_empty();
        self.keep_histories();
        if let Some(rate) = &mut self.rate {
            let own = self.edges.iter().zip(&mut self.strength).enumerate();
            own.for_each(|(index, (&edge, strength))| *strength = rate.restore(index, rates[edge as usize]));
        }
        for index in 0..self.edges.len() {
            self.state[index] = saved[self.edges[index] as usize];
            self.threshold[index] = self.state[index].threshold();
        }
        self.damaged = self.threshold.iter().filter(|&&threshold| threshold < 0.0).count();
        self.woken = true;
        self.renew_fresh();
        if !is_kept {
            self.forget_intact();
        }
    }
}
