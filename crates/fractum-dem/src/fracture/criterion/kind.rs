//! Criteria as users name them, and the numbers that they take.

use super::{EndMoments, FractureCriterion, Level};

/// Compressive over tensile strength where a criterion needs one that nobody gives.
const STRENGTH_RATIO: f64 = 10.0;
/// Share of a compression that chains of particles turn into tension across it, where none was measured.
const CHAINS: f64 = 0.2;

/// A number that some criteria take beside their strength in tension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CriterionParameter {
    /// Strength in compression.
    CompressiveStrength,
    /// Angle of internal friction.
    FrictionAngle,
    /// Over which particles stress is taken.
    Level,
    /// Which bending moment of a beam counts.
    Moments,
}

/// The numbers of any criterion; each takes its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriterionNumbers {
    /// Strength in tension [Pa].
    pub tensile_strength: f64,
    /// Strength in compression, a positive number [Pa].
    pub compressive_strength: Option<f64>,
    /// Friction angle [rad].
    pub friction_angle: f64,
    /// Share of a compression that chains of particles turn into tension across it.
    pub chains: f64,
    /// Over which particles stress is taken.
    pub level: Level,
    /// Which bending moment counts.
    pub moments: EndMoments,
}

impl CriterionNumbers {
    /// A strength in tension [Pa], and nothing else.
    pub fn new(tensile_strength: f64) -> Self {
        let (level, moments) = (Level::default(), EndMoments::default());
        CriterionNumbers {
            tensile_strength,
            compressive_strength: None,
            friction_angle: 0.0,
            chains: CHAINS,
            level,
            moments,
        }
    }

    /// The strength in compression, ten times that in tension where none is given [Pa].
    pub fn compressive_or_usual(&self) -> f64 {
        self.compressive_strength.unwrap_or(STRENGTH_RATIO * self.tensile_strength)
    }
}

/// A criterion that users can name.
pub trait NamedCriterion: Sized {
    /// Its name.
    const NAME: &'static str;
    /// What it compares with its strength, in words.
    const WORDS: &'static str;
    /// What it takes beside its strength in tension.
    const TAKES: &'static [CriterionParameter];
    /// Whether a body under compression fails by slip, so that a compression test can tell the strength in compression.
    const SLIPS: bool = false;

    /// The criterion of these numbers.
    fn from_numbers(numbers: &CriterionNumbers) -> Self;

    /// Its numbers.
    fn numbers(&self) -> CriterionNumbers;
}

/// A kind of criterion.
#[derive(Clone, Copy, Debug)]
pub struct BondCriterionKind {
    /// Its name.
    pub name: &'static str,
    /// What it compares with its strength, in words.
    pub words: &'static str,
    /// What it takes beside its strength in tension.
    pub takes: &'static [CriterionParameter],
    /// See [`NamedCriterion::SLIPS`].
    pub slips: bool,
    /// The criterion of these numbers.
    pub make: fn(&CriterionNumbers) -> FractureCriterion,
}

impl BondCriterionKind {
    /// Whether it takes a number.
    pub fn takes(&self, parameter: CriterionParameter) -> bool {
        self.takes.contains(&parameter)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_criterion_gives_its_numbers_back() {
        for kind in FractureCriterion::KINDS {
            let numbers = CriterionNumbers {
                compressive_strength: kind.takes(CriterionParameter::CompressiveStrength).then_some(9.0),
                friction_angle: if kind.takes(CriterionParameter::FrictionAngle) { 0.5 } else { 0.0 },
                level: if kind.takes(CriterionParameter::Level) { Level::Second } else { Level::default() },
                moments: if kind.takes(CriterionParameter::Moments) { EndMoments::Largest } else { EndMoments::Mean },
                ..CriterionNumbers::new(2.0)
            };
            let criterion = (kind.make)(&numbers);
            assert_eq!((criterion.numbers(), criterion.kind().name), (numbers, kind.name));
            assert!(criterion.check().is_ok());
        }
    }
}
