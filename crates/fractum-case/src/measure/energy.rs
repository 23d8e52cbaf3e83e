//! An entry of the energy ledger, or its residual [J].

use fractum_scene::{EnergyProbe, Probe, ProbedScene};

use super::Measure;
use super::scenery::Scenery;
use crate::Choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::unit::Dimension as D;

impl Choice for EnergyProbe {
    const NAMES: &'static [(&'static str, Self)] = &EnergyProbe::NAMES;
}

/// An entry of the energy ledger, or its residual [J].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energy(pub EnergyProbe);

impl Measure for Energy {
    const KEY: &'static str = "energy";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].energy", K::Choice(names::<EnergyProbe>), "", "An entry of the energy ledger, in J"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        Some((Energy(probe.choice(Self::KEY).required()?), D::ENERGY))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(*self))
    }
}

impl Probe for Energy {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        probed.scene.ledger().probe(self.0)
    }
}
