//! Size below which a share of the mass of all fragments lies [m].

use fractum_scene::{Probe, ProbeNeeds, ProbedScene, Scene, passing_size};

use super::Measure;
use super::scenery::Scenery;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::unit::Dimension as D;

/// Size below which this share of the mass of all fragments lies [m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FragmentSize(pub f64);

impl Measure for FragmentSize {
    const KEY: &'static str = "fragment_size";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].fragment_size", K::Quantity(D::NONE), "", "Size below which this share of the mass of all fragments lies, in m: P50 for 0.5; within 0 and 1. Fragments that an absorbing or elastic boundary holds do not count"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let share = probe.quantity(Self::KEY).between(0.0, 1.0).required()?;
        Some((FragmentSize(share), D::LENGTH))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(*self))
    }
}

impl Probe for FragmentSize {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        passing_size(&probed.scene.solid, probed.fragments(), self.0)
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds::of_all(true)
    }
}
