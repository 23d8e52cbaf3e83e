use fractum_math::Sym3;
use serde::{Deserialize, Serialize};

use super::{
    BreakMode, CriterionNumbers, CriterionParameter, Level, NamedCriterion, Release, Strengths, StressCriterion,
    positive,
};
use crate::DemError;

/// Drucker–Prager on the virial stress: (α I₁ + √J₂)/k with α = (f_c − f_t)/(√3 (f_c + f_t)) and
/// k = 2 f_c f_t/(√3 (f_c + f_t)), which has both uniaxial strengths. The bond nearest to the first principal
/// direction breaks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct DruckerPrager {
    /// Tensile strength f_t [Pa].
    pub tensile_strength: f64,
    /// Uniaxial compressive strength f_c, a positive number [Pa].
    pub compressive_strength: f64,
    /// Over which particles stress is taken.
    #[serde(default)]
    pub level: Level,
}

impl NamedCriterion for DruckerPrager {
    const NAME: &'static str = "drucker-prager";
    const WORDS: &'static str = "Drucker-Prager on the virial stress";
    const TAKES: &'static [CriterionParameter] = &[CriterionParameter::CompressiveStrength, CriterionParameter::Level];

    fn from_numbers(numbers: &CriterionNumbers) -> Self {
        let &CriterionNumbers { tensile_strength, level, .. } = numbers;
        DruckerPrager { tensile_strength, compressive_strength: numbers.compressive_or_usual(), level }
    }

    fn numbers(&self) -> CriterionNumbers {
        let compressive_strength = Some(self.compressive_strength);
        CriterionNumbers { compressive_strength, level: self.level, ..CriterionNumbers::new(self.tensile_strength) }
    }
}

impl Strengths for DruckerPrager {
    fn check(&self) -> Result<(), DemError> {
        positive("tensile strength", self.tensile_strength)?;
        positive("compressive strength", self.compressive_strength)
    }

    fn scale(&mut self, factor: f64) {
        self.tensile_strength *= factor;
        self.compressive_strength *= factor;
    }
}

impl StressCriterion for DruckerPrager {
    fn level(&self) -> Level {
        self.level
    }

    #[inline]
    fn bound(&self, stress: &Sym3) -> f64 {
        self.ratio(stress)
    }

    #[inline]
    fn bound_between(&self, tension: f64, compression: f64) -> f64 {
        // The ratio is convex in the stress: over the cube of principal values it is largest at a corner, where some of
        // them are tensions and the others compressions.
        let corner = |values: [f64; 3]| self.ratio(&Sym3::new(values[0], values[1], values[2], 0.0, 0.0, 0.0));
        let (high, low) = (tension, -compression);
        corner([high, low, low]).max(corner([high, high, low])).max(corner([high; 3])).max(corner([low; 3]))
    }

    #[inline]
    fn ratio(&self, stress: &Sym3) -> f64 {
        let (ft, fc) = (self.tensile_strength, self.compressive_strength);
        let root = 3f64.sqrt();
        let alpha_over_k = (fc - ft) / (2.0 * fc * ft);
        let one_over_k = root * (fc + ft) / (2.0 * fc * ft);
        (alpha_over_k * stress.trace() + one_over_k * stress.j2().sqrt()).max(0.0)
    }

    fn release(&self, stress: &Sym3) -> Release {
        let (values, axes) = stress.eigen();
        let mode = if values[0] + values[2] > 0.0 { BreakMode::Tension } else { BreakMode::Shear };
        Release::Nearest([axes.column(0).into_owned(); 2], mode)
    }
}
