//! Tension tests to the load peak.

use fractum_dem::FractureCriterion;
use fractum_dem::criterion::{BeamRankine, EndMoments, Hydrostatic, Level, Principal};
use serde::Serialize;

use crate::{CalibrateError, Sample, lab};

/// Criteria whose one strength can be calibrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum StrengthCriterion {
    /// Largest principal virial stress of a particle and its neighbours.
    Principal,
    /// Largest principal stress in the beams.
    Beam,
    /// Mean virial stress of a particle.
    Hydrostatic,
}

impl StrengthCriterion {
    /// The criterion with a strength [Pa].
    pub fn with(self, strength: f64) -> FractureCriterion {
        match self {
            StrengthCriterion::Principal => FractureCriterion::Principal(Principal {
                tensile_strength: strength,
                compressive_strength: None,
                level: Level::Neighbours,
            }),
            StrengthCriterion::Beam => {
                FractureCriterion::BeamRankine(BeamRankine { strength, moments: EndMoments::default() })
            }
            StrengthCriterion::Hydrostatic => FractureCriterion::Hydrostatic(Hydrostatic { strength }),
        }
    }
}

/// A tension test to the load peak.
pub(crate) fn pull(sample: &Sample, asked: f64, criterion: FractureCriterion) -> Result<lab::Broken, CalibrateError> {
    if !(asked.is_finite() && asked > 0.0) {
        let expected = "a positive number of pascals";
        return Err(CalibrateError::Material { what: "tensile strength", value: asked, expected });
    }
    // Strength is asked, not the whole fall of the load.
    let test = lab::Failure::Tension;
    lab::break_sample(sample, test, &lab::FailureOptions { stop: 0.9, ..lab::FailureOptions::new(test, criterion) })
}
