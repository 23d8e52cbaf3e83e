//! Steps of conduction.

use fractum_fem::Solid;

use super::Heat;
use crate::bonded::Bonded;

/// Relative difference of two times that is rounding.
const SAME_TIME: f64 = 1e-9;

impl Heat {
    /// Advances temperatures to a time [s] in equal steps of at most the stable one.
    pub(crate) fn conduct_to(&mut self, time: f64, solid: &Solid, bonded: &Bonded) -> Result<(), String> {
        if self.stale || self.pairs.has_lost_bonds(bonded) {
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

    /// Whether a step is due before the time `later` [s].
    pub(crate) fn is_due(&self, later: f64) -> bool {
        later > self.field.time() + self.step * (1.0 + SAME_TIME)
    }

    /// Expands bodies by the present temperatures, see [`Solid::expand`]; returns half of the work [J].
    pub(crate) fn expand(&mut self, solid: &mut Solid, bonded: &mut Bonded) -> f64 {
        let Heat { expansion, field, .. } = self;
        expansion.as_mut().map_or(0.0, |expansion| expansion.expand(solid, bonded, field.temperature()))
    }

    /// The other half of the work of the last expansion [J].
    pub(crate) fn finish_expansion(&mut self, solid: &mut Solid, bonded: &mut Bonded) -> f64 {
        let Heat { expansion, field, .. } = self;
        expansion.as_mut().map_or(0.0, |expansion| expansion.finish(solid, bonded, field.temperature()))
    }

    /// Elements have left.
    pub(crate) fn lose_elements(&mut self) {
        self.stale = true;
    }
}
