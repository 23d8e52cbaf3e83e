//! Steps of conduction.

use fractum_fem::Solid;

use super::Heat;
use crate::bonded::Bonded;
use crate::interfaces::Interfaces;

/// Relative difference of two times that is rounding.
pub(super) const SAME_TIME: f64 = 1e-9;

impl Heat {
    /// Advances temperatures to a time [s] in equal steps of at most the stable one.
    pub(crate) fn conduct_to(
        &mut self,
        time: f64,
        solid: &Solid,
        bonded: &Bonded,
        interfaces: &Interfaces,
    ) -> Result<(), String> {
        let changed = self.pairs.look(solid, interfaces);
        if self.stale || changed || self.pairs.has_lost_bonds(bonded) {
            self.find_conductances(solid, bonded);
        }
        let start = self.field.time();
        let span = time - start;
        let count = (span / self.step * (1.0 - SAME_TIME)).ceil().max(1.0) as u64;
        for step in 1..=count {
            match &mut self.solver {
                Some(solver) => {
                    let to = if step == count { time } else { start + span * (step as f64 / count as f64) };
                    self.field.step_implicitly(solver, to).map_err(|error| error.to_string())?;
                }
                None => self.field.step(span / count as f64),
            }
        }
        match self.field.temperature().iter().all(|t| t.is_finite()) {
            true => Ok(()),
            false => Err("a temperature is not finite".into()),
        }
    }

    pub(super) fn find_conductances(&mut self, solid: &Solid, bonded: &Bonded) {
        self.pairs.update(solid, bonded);
        self.field.set_conductances(self.pairs.conductances());
        if let Some(solver) = &mut self.solver {
            solver.renew();
        }
        self.stale = false;
    }

    /// Conducts for the step of motion from `time` to `target` [s], where a step of conduction is due; whether it was.
    ///
    /// Where temperatures expand bodies they are found ahead, so that they can change in proportion to time until then.
    ///
    /// - `end`: of the run [s]
    pub(crate) fn conduct_for(
        &mut self,
        [time, target, end]: [f64; 3],
        solid: &mut Solid,
        bonded: &Bonded,
        interfaces: &Interfaces,
    ) -> Result<bool, String> {
        let own = self.field.time();
        let Some(expansion) = &self.expansion else {
            let waits = target + (target - time) <= own + self.step * (1.0 + SAME_TIME);
            if waits && target < end * (1.0 - SAME_TIME) {
                return Ok(false);
            }
            return self.conduct_to(target, solid, bonded, interfaces).map(|()| true);
        };
        if !expansion.ends_before(target) {
            return Ok(false);
        }
        let ahead = (own + self.step).min(end).max(target);
        self.conduct_to(ahead, solid, bonded, interfaces)?;
        if let Some(expansion) = &mut self.expansion {
            expansion.begin([time, ahead], solid, self.field.temperature());
        }
        Ok(true)
    }

    /// Expands bodies by the temperatures of a time [s], for the step that follows; returns half of the work [J].
    pub(crate) fn expand(&mut self, time: f64, solid: &mut Solid, bonded: &mut Bonded) -> f64 {
        let Heat { expansion, field, .. } = self;
        expansion.as_mut().map_or(0.0, |expansion| expansion.lead(time, solid, bonded, field.temperature()))
    }

    /// Has bodies that expand in equilibrium at `target`: conducts to the end of a step of equilibria at most.
    ///
    /// - `time`: of the last equilibrium [s]
    pub(crate) fn warm_to(
        &mut self,
        [time, target]: [f64; 2],
        solid: &mut Solid,
        bonded: &Bonded,
        interfaces: &Interfaces,
    ) -> Result<(), String> {
        if self.expansion.is_none() {
            return Ok(());
        }
        // A shorter step than was tried finds its temperatures between those of the longer one.
        let is_new = target > self.field.time() * (1.0 + SAME_TIME);
        if is_new {
            self.conduct_to(target, solid, bonded, interfaces)?;
        }
        if let Some(expansion) = &mut self.expansion {
            if is_new {
                expansion.begin([time, target], solid, self.field.temperature());
            }
            expansion.try_at(target, solid, self.field.temperature());
        }
        Ok(())
    }

    /// Takes the temperatures of an equilibrium at `time`; returns half of the work of the expansion that was tried, at the stresses of before [J].
    ///
    /// - `first`: whether no equilibrium came before
    pub(crate) fn settle(
        &mut self,
        time: f64,
        solid: &mut Solid,
        bonded: &mut Bonded,
        interfaces: &Interfaces,
        first: bool,
    ) -> Result<f64, String> {
        match &mut self.expansion {
            Some(expansion) => Ok(expansion.settle(solid, bonded, first)),
            None => self.conduct_to(time, solid, bonded, interfaces).map(|()| 0.0),
        }
    }

    /// The other half [J]; nothing expands from here to there any more.
    pub(crate) fn finish_settled_expansion(&mut self, solid: &Solid, bonded: &mut Bonded, first: bool) -> f64 {
        self.expansion.as_mut().map_or(0.0, |expansion| expansion.finish_settled(solid, bonded, first))
    }

    /// The other half of the work of the last expansion [J].
    pub(crate) fn finish_expansion(&mut self, solid: &Solid, bonded: &mut Bonded) -> f64 {
        self.expansion.as_mut().map_or(0.0, |expansion| expansion.finish(solid, bonded))
    }

    /// Whether temperatures expand bodies.
    pub(crate) fn expands(&self) -> bool {
        self.expansion.is_some()
    }

    /// Elements have left.
    pub(crate) fn lose_elements(&mut self) {
        self.stale = true;
    }
}
