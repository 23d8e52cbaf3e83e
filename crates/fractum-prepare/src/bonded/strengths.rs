//! The strengths of a criterion that give a bonded body those of its material.

use fractum_calibrate::strength::{BondKind, Crushing, crushing, strength_factor};
use fractum_calibrate::{Micro, Sample};
use fractum_dem::FractureCriterion;
use fractum_io::case::Diagnostic;
use fractum_io::case::model::BondFailure;
use serde::Serialize;

use super::{Maker, Origin};
use crate::cache::key;

/// A criterion with its own strengths.
#[derive(Clone, Copy, Debug)]
pub struct FoundStrengths {
    /// The criterion.
    pub criterion: FractureCriterion,
    /// Where its strengths came from.
    pub origin: Origin,
    /// What was found in compression; none where that is not calibrated.
    pub crushing: Option<Crushing>,
}

/// What decides the strengths of a criterion.
#[derive(Serialize)]
struct StrengthKey {
    bonds: BondKind,
    asked: f64,
    criterion: FractureCriterion,
}

impl Maker<'_> {
    /// The criterion with its own strengths: given, kept, or found by breaking boxes of such bonds, and prisms in compression.
    pub(super) fn strengths(
        &self,
        failure: &BondFailure,
        sample: &Sample,
        micro: Micro,
        coordination: f64,
    ) -> Result<FoundStrengths, Box<Diagnostic>> {
        let Some(asked) = failure.tensile_strength else {
            return Ok(FoundStrengths { criterion: failure.criterion, origin: Origin::Given, crushing: None });
        };
        let (convention, dispersion) = (self.bonded.convention, sample.packing.dispersion);
        let criterion = failure.criterion;
        let bonds = BondKind { micro, coordination, convention, dispersion };
        let strength_key = key(&StrengthKey { bonds, asked, criterion });
        let kept = self.cache.find("strength", strength_key, |bytes| Some(f64::from_le_bytes(bytes.try_into().ok()?)));
        let (factor, origin) = match kept.filter(|factor| factor.is_finite() && *factor > 0.0) {
            Some(factor) => (factor, Origin::Cached),
            None => {
                let factor = strength_factor(&bonds, asked, criterion).map_err(|error| self.wrong(&error))?;
                self.cache.keep("strength", strength_key, &factor.to_le_bytes());
                (factor, Origin::Made)
            }
        };
        let scaled = criterion.scaled(factor);
        let Some(asked) = failure.compressive_strength.filter(|_| criterion.kind().slips) else {
            return Ok(FoundStrengths { criterion: scaled, origin, crushing: None });
        };
        let kept = self.cache.find("crushing", strength_key, |bytes| postcard::from_bytes::<Crushing>(bytes).ok());
        let (found, origin) = match kept.filter(|found| found.strength.is_finite() && found.strength > 0.0) {
            Some(found) => (found, origin),
            None => {
                let found = crushing(&bonds, asked, scaled).map_err(|error| self.wrong(&error))?;
                self.cache.keep("crushing", strength_key, &postcard::to_stdvec(&found).unwrap_or_default());
                (found, Origin::Made)
            }
        };
        let criterion = scaled.with_compressive_strength(found.strength);
        Ok(FoundStrengths { criterion, origin, crushing: Some(found) })
    }
}
