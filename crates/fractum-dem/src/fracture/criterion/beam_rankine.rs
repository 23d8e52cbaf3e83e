use serde::{Deserialize, Serialize};

use super::{
    BondLoad, BreakMode, CriterionNumbers, CriterionParameter, EndMoments, LoadCriterion, NamedCriterion, Strengths,
    positive,
};
use crate::DemError;
use crate::bond::LoadSizes;

/// Largest principal stress in a cohesive beam against its strength (Jebahi et al. 2015, eqs. 4.1–4.3):
/// σ = ½ (σ_n + √(σ_n² + 4 τ²)) with σ_n = N/S + M r/I and τ = r M_x/I₀.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BeamRankine {
    /// Strength of the beams [Pa].
    pub strength: f64,
    /// Which bending moment counts.
    #[serde(default)]
    pub moments: EndMoments,
}

impl NamedCriterion for BeamRankine {
    const NAME: &'static str = "beam";
    const WORDS: &'static str = "the largest principal stress in the beam";
    const TAKES: &'static [CriterionParameter] = &[CriterionParameter::Moments];

    fn from_numbers(numbers: &CriterionNumbers) -> Self {
        BeamRankine { strength: numbers.tensile_strength, moments: numbers.moments }
    }

    fn numbers(&self) -> CriterionNumbers {
        CriterionNumbers { moments: self.moments, ..CriterionNumbers::new(self.strength) }
    }
}

impl Strengths for BeamRankine {
    fn check(&self) -> Result<(), DemError> {
        positive("strength of the beams", self.strength)
    }

    fn scale(&mut self, factor: f64) {
        self.strength *= factor;
    }
}

impl LoadCriterion for BeamRankine {
    #[inline]
    fn ratio_of(&self, load: &LoadSizes) -> f64 {
        let (normal, bending, shear) = self.stresses(load);
        let sum = normal + bending;
        (0.5 * (sum + (sum * sum + 4.0 * shear * shear).sqrt()) / self.strength).max(0.0)
    }

    /// What contributes most.
    fn mode(&self, load: &BondLoad) -> BreakMode {
        let (normal, bending, shear) = self.stresses(&load.sizes());
        if normal >= bending && normal >= shear {
            BreakMode::Tension
        } else if bending >= shear {
            BreakMode::Bending
        } else {
            BreakMode::Torsion
        }
    }
}

impl BeamRankine {
    /// N/S, M r/I, and r M_x/I₀ [Pa].
    #[inline]
    fn stresses(&self, load: &LoadSizes) -> (f64, f64, f64) {
        let r = load.radius;
        let area = std::f64::consts::PI * r * r;
        let moment = match self.moments {
            EndMoments::Mean => load.mean_bending,
            EndMoments::Largest => load.largest_bending,
        };
        // I = S r²/4, I₀ = S r²/2.
        (load.normal / area, 4.0 * moment / (area * r), 2.0 * load.torsion.abs() / (area * r))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fractum_math::Vec3;
    use std::f64::consts::PI;

    #[test]
    fn pure_loads_have_the_stresses_of_the_textbook() {
        let beam = BeamRankine { strength: 1.0, moments: EndMoments::Largest };
        let (s, i) = (PI * 0.25, PI * 0.5f64.powi(4) / 4.0);
        let none = BondLoad { radius: 0.5, ..BondLoad::default() };
        let pull = BondLoad { normal: 3.0, ..none };
        assert!((beam.ratio(&pull) - 3.0 / s).abs() < 1e-12);
        assert_eq!(beam.ratio(&BondLoad { normal: -3.0, ..pull }), 0.0);
        let twist = BondLoad { torsion: -2.0, ..none };
        assert!((beam.ratio(&twist) - 2.0 * 0.5 / (2.0 * i)).abs() < 1e-12);
        // Uniform bending: opposite moments on the two ends.
        let bend = BondLoad { bending: [Vec3::y() * 2.0, Vec3::y() * -2.0], ..none };
        assert!((beam.ratio(&bend) - 2.0 * 0.5 / i).abs() < 1e-12);
        let mean = BeamRankine { moments: EndMoments::Mean, ..beam };
        assert!((mean.ratio(&bend) - 2.0 * 0.5 / i).abs() < 1e-12);
        // Ends that shift across each other: the moment runs from -M to M.
        let shift = BondLoad { bending: [Vec3::y() * 2.0; 2], ..none };
        assert_eq!(mean.ratio(&shift), 0.0);
        assert!((beam.ratio(&shift) - 2.0 * 0.5 / i).abs() < 1e-12);
        assert_eq!(
            [pull, bend, twist].map(|l| beam.mode(&l)),
            [BreakMode::Tension, BreakMode::Bending, BreakMode::Torsion]
        );
    }
}
