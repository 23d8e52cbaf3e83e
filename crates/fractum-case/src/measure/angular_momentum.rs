//! Angular momentum of the scene about the origin, along a direction [kg m²/s].

use fractum_math::Vec3;
use fractum_scene::{Probe, ProbeNeeds, ProbedScene, Scene};

use super::Measure;
use super::scenery::Scenery;
use super::tables::along;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::unit::Dimension as D;

/// Angular momentum of the scene about the origin, along a direction [kg m²/s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngularMomentum {
    /// Unit vector.
    pub along: Vec3,
}

impl Measure for AngularMomentum {
    const KEY: &'static str = "angular_momentum";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].angular_momentum", K::Table, "", "Angular momentum of the scene about the origin, in kg m^2/s"),
        key("probes[].angular_momentum.along", K::Direction, "required", "Direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        Some((AngularMomentum { along: along(probe, Self::KEY)? }, D::ANGULAR_MOMENTUM))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(*self))
    }
}

impl Probe for AngularMomentum {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        probed.scene.angular_momentum_along(&self.along)
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::of_all(false)
    }
}
