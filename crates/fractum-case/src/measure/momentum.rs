//! Linear momentum of the scene along a direction [kg m/s].

use fractum_math::Vec3;
use fractum_scene::{Probe, ProbeNeeds, ProbedScene, Scene};

use super::Measure;
use super::scenery::Scenery;
use super::tables::along;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::unit::Dimension as D;

/// Linear momentum of the scene along a direction [kg m/s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Momentum {
    /// Unit vector.
    pub along: Vec3,
}

impl Measure for Momentum {
    const KEY: &'static str = "momentum";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].momentum", K::Table, "", "Linear momentum of the scene, in kg m/s"),
        key("probes[].momentum.along", K::Direction, "required", "Direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        Some((Momentum { along: along(probe, Self::KEY)? }, D::MOMENTUM))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(*self))
    }
}

impl Probe for Momentum {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        probed.scene.momentum_along(&self.along)
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::of_all(false)
    }
}
