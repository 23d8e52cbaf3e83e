use fractum_math::Sym3;
use serde::{Deserialize, Serialize};

use super::{
    BreakMode, CriterionNumbers, CriterionParameter, Level, NamedCriterion, Release, Strengths, StressCriterion,
    positive,
};
use crate::DemError;

/// Mean virial stress of a particle against a strength; the particle loses all its bonds (Jebahi et al. 2015, eqs.
/// 4.23–4.24, with the sphere's own volume).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hydrostatic {
    /// Strength [Pa].
    pub strength: f64,
}

impl NamedCriterion for Hydrostatic {
    const NAME: &'static str = "hydrostatic";
    const WORDS: &'static str = "the mean virial stress of the particle";
    const TAKES: &'static [CriterionParameter] = &[];

    fn from_numbers(numbers: &CriterionNumbers) -> Self {
        Hydrostatic { strength: numbers.tensile_strength }
    }

    fn numbers(&self) -> CriterionNumbers {
        CriterionNumbers::new(self.strength)
    }
}

impl Strengths for Hydrostatic {
    fn check(&self) -> Result<(), DemError> {
        positive("hydrostatic strength", self.strength)
    }

    fn scale(&mut self, factor: f64) {
        self.strength *= factor;
    }
}

impl StressCriterion for Hydrostatic {
    fn level(&self) -> Level {
        Level::Own
    }

    fn without_voids(&self) -> bool {
        true
    }

    #[inline]
    fn bound(&self, stress: &Sym3) -> f64 {
        self.ratio(stress)
    }

    #[inline]
    fn bound_between(&self, tension: f64, _: f64) -> f64 {
        tension / self.strength
    }

    #[inline]
    fn ratio(&self, stress: &Sym3) -> f64 {
        (stress.trace() / (3.0 * self.strength)).max(0.0)
    }

    fn release(&self, _: &Sym3) -> Release {
        Release::All(BreakMode::Tension)
    }
}
