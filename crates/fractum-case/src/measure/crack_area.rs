//! Area of the cracks, over the damaged edges by the strength that they have lost, and that of broken interfaces [m²].

use fractum_scene::{Probe, ProbeNeeds, ProbedScene, Scene};

use super::Measure;
use super::scenery::Scenery;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::unit::Dimension as D;

/// Area of the cracks [m²].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CrackArea;

impl Measure for CrackArea {
    const KEY: &'static str = "crack_area";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].crack_area", K::Flag, "", "true records the area of the cracks, in m^2"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        probe.flag(Self::KEY).check(|on| *on, "true; leave the probe out where it is not wanted").required()?;
        Some((CrackArea, D::AREA))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(*self))
    }
}

impl Probe for CrackArea {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let broken: f64 = probed.scene.interfaces().broken().map(|(_, part, area)| part * area).sum();
        probed.crack_edges().iter().map(|edge| edge.cracked).sum::<f64>() + broken
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::of_damage()
    }
}
