//! The strengths of a criterion that give a bonded body those of its material.

use fractum_calibrate::crushing::{Crushing, Use, crushing};
use fractum_calibrate::strength::{BondKind, Pulling, pulling};
use fractum_calibrate::{CalibrateError, Micro, Sample};
use fractum_dem::FractureCriterion;
use fractum_output::warning::Code;
use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{Maker, Origin};
use crate::asked::{BondStrength, Doubt, Fault};
use crate::cache::key;

/// A criterion with its own strengths, and what bodies bear with it.
#[derive(Clone, Copy, Debug)]
pub struct FoundStrengths {
    /// The criterion.
    pub criterion: FractureCriterion,
    /// Whether the stress of particles at walls is that of the wall.
    pub at_walls: bool,
    /// Where its strengths came from.
    pub origin: Origin,
    /// What was found in tension, with the strength of bodies [Pa]; none where the strengths are given.
    pub pulling: Option<(f64, Pulling)>,
    /// What was found in compression; none where that is not calibrated.
    pub crushing: Option<Crushing>,
}

/// Difference from the asked strength in compression that is told.
const ACCEPTED: f64 = 0.05;

/// What decides the strength of a criterion in tension.
#[derive(Clone, Copy, Serialize)]
struct PullingKey {
    bonds: BondKind,
    asked: f64,
    criterion: FractureCriterion,
}

/// What decides that in compression.
#[derive(Serialize)]
struct CrushingKey {
    pulling: PullingKey,
    asked: f64,
    use_of_body: Use,
}

impl Maker<'_> {
    /// The criterion with its own strengths: given, kept, or found by breaking boxes of such bonds in tension, and prisms in compression.
    pub(super) fn strengths(
        &self,
        strength: &BondStrength,
        sample: &Sample,
        micro: Micro,
        coordination: f64,
    ) -> Result<FoundStrengths, Fault> {
        let (criterion, at_walls) = (strength.criterion, strength.at_walls);
        let Some(asked) = strength.tensile_strength else {
            return Ok(FoundStrengths { criterion, at_walls, origin: Origin::Given, pulling: None, crushing: None });
        };
        let (convention, dispersion) = (self.asked.convention, sample.packing.dispersion);
        let wall_stiffening = self.asked.wall_stiffening;
        let bonds = BondKind { micro, coordination, convention, dispersion, wall_stiffening, at_walls };
        let pulling_key = PullingKey { bonds, asked, criterion };
        let (pulled, origin) = self.kept("strength", key(&pulling_key), || {
            self.tell("three boxes of such bonds are broken in tension to find the strength of the criterion");
            pulling(&bonds, asked, criterion)
        })?;
        let scaled = criterion.scaled(pulled.factor);
        let pulled = Some((asked, pulled));
        let Some(asked) = strength.compressive_strength.filter(|_| criterion.kind().slips) else {
            return Ok(FoundStrengths { criterion: scaled, at_walls, origin, pulling: pulled, crushing: None });
        };
        let use_of_body = Use { at_rest: self.asked.at_rest, faces: self.material().faces };
        let crushing_key = CrushingKey { pulling: pulling_key, asked, use_of_body };
        let tell = |trial: usize, before: Option<f64>| {
            let before = before.map_or(String::new(), |b| format!(", the last one bore {b:.2} of what is asked"));
            self.tell(&format!(
                "three prisms of such bonds are crushed to find the strength in compression (trial {trial}{before})"
            ));
        };
        let (found, origin) =
            self.kept("crushing", key(&crushing_key), || crushing(&bonds, asked, scaled, use_of_body, &tell))?;
        let criterion = scaled.with_chains(found.chains).with_compressive_strength(found.strength);
        Ok(FoundStrengths { criterion, at_walls, origin, pulling: pulled, crushing: Some(found) })
    }

    /// Tells where bodies of such bonds cannot have the strength in compression that is asked.
    pub(super) fn doubt_strength(&self, found: &FoundStrengths) -> Option<Doubt> {
        let asked = self.material().strength?.compressive_strength?;
        let Crushing { reached, .. } = found.crushing.filter(|found| (found.reached / asked - 1.0).abs() > ACCEPTED)?;
        let found = format!(
            "bodies of such bonds bear {reached:.4e} Pa in compression, the nearest to the {asked:.4e} Pa asked beside this tensile strength"
        );
        let remedy = "change one of the two strengths, Poisson's ratio or the coordination";
        Some(Doubt { code: Code::BondStrength, found, remedy })
    }

    /// What the cache has, or what is found now and kept.
    fn kept<T: Serialize + DeserializeOwned>(
        &self,
        kind: &str,
        key: u128,
        find: impl FnOnce() -> Result<T, CalibrateError>,
    ) -> Result<(T, Origin), Fault> {
        if let Some(found) = self.cache.find(kind, key, |bytes| postcard::from_bytes(bytes).ok()) {
            return Ok((found, Origin::Cached));
        }
        let found = find().map_err(|error| self.wrong(&error))?;
        // Serialising plain numbers into memory has no way to fail.
        self.cache.keep(kind, key, &postcard::to_stdvec(&found).unwrap_or_default());
        Ok((found, Origin::Made))
    }
}
