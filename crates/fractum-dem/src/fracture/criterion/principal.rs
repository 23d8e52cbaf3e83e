use fractum_math::Sym3;
use serde::{Deserialize, Serialize};

use super::{
    BreakMode, CriterionNumbers, CriterionParameter, Level, NamedCriterion, Release, Strengths, StressCriterion,
    first_bound, last_bound, positive,
};
use crate::DemError;

/// Largest principal virial stress against a strength; the bond of the particle nearest to that principal direction
/// breaks (Nguyen et al. 2019, eqs. 5–8). With a compressive strength also the smallest principal stress (4.5).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Principal {
    /// Tensile strength σ_m [Pa].
    pub tensile_strength: f64,
    /// Compressive strength, a positive number; none for particles that cannot be crushed [Pa].
    pub compressive_strength: Option<f64>,
    /// Over which particles stress is taken.
    #[serde(default)]
    pub level: Level,
}

impl Principal {
    #[inline]
    fn crushing(&self, last: f64) -> f64 {
        self.compressive_strength.map_or(0.0, |strength| -last / strength)
    }
}

impl NamedCriterion for Principal {
    const NAME: &'static str = "principal";
    const WORDS: &'static str = "principal virial stresses";
    const TAKES: &'static [CriterionParameter] = &[CriterionParameter::CompressiveStrength, CriterionParameter::Level];

    fn from_numbers(numbers: &CriterionNumbers) -> Self {
        let &CriterionNumbers { tensile_strength, compressive_strength, level, .. } = numbers;
        Principal { tensile_strength, compressive_strength, level }
    }

    fn numbers(&self) -> CriterionNumbers {
        let (compressive_strength, level) = (self.compressive_strength, self.level);
        CriterionNumbers { compressive_strength, level, ..CriterionNumbers::new(self.tensile_strength) }
    }
}

impl Strengths for Principal {
    fn check(&self) -> Result<(), DemError> {
        positive("tensile strength", self.tensile_strength)?;
        self.compressive_strength.map_or(Ok(()), |strength| positive("compressive strength", strength))
    }

    fn scale(&mut self, factor: f64) {
        self.tensile_strength *= factor;
        self.compressive_strength = self.compressive_strength.map(|strength| strength * factor);
    }
}

impl StressCriterion for Principal {
    fn level(&self) -> Level {
        self.level
    }

    #[inline]
    fn bound(&self, stress: &Sym3) -> f64 {
        (first_bound(stress) / self.tensile_strength).max(self.crushing(last_bound(stress)))
    }

    #[inline]
    fn bound_between(&self, tension: f64, compression: f64) -> f64 {
        (tension / self.tensile_strength).max(self.crushing(-compression))
    }

    #[inline]
    fn ratio(&self, stress: &Sym3) -> f64 {
        let [first, _, last] = stress.principal_values();
        (first / self.tensile_strength).max(self.crushing(last)).max(0.0)
    }

    fn release(&self, stress: &Sym3) -> Release {
        let ([first, _, last], axes) = stress.eigen();
        let (direction, mode) = if first / self.tensile_strength >= self.crushing(last) {
            (axes.column(0).into_owned(), BreakMode::Tension)
        } else {
            (axes.column(2).into_owned(), BreakMode::Compression)
        };
        Release::Nearest([direction; 2], mode)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_math::Vec3;

    #[test]
    fn the_direction_is_that_of_the_stress_that_fails() {
        let criterion = Principal { tensile_strength: 1.0, compressive_strength: Some(10.0), level: Level::Neighbours };
        let pulled = criterion.release(&Sym3::new(0.1, 2.0, 0.0, 0.0, 0.0, 0.0));
        let Release::Nearest([d, _], BreakMode::Tension) = pulled else { panic!("{pulled:?}") };
        assert!((d.dot(&Vec3::y()).abs() - 1.0).abs() < 1e-12);
        let crushed = criterion.release(&Sym3::new(0.1, 0.0, -12.0, 0.0, 0.0, 0.0));
        let Release::Nearest([d, _], BreakMode::Compression) = crushed else { panic!("{crushed:?}") };
        assert!((d.dot(&Vec3::z()).abs() - 1.0).abs() < 1e-12);
    }
}
