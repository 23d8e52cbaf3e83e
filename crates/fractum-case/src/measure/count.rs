//! A count [-].

use fractum_scene::{CountKind, Probe, ProbeNeeds, ProbedScene, Scene};

use super::Measure;
use super::scenery::Scenery;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::unit::Dimension as D;

choice!(CountKind {
    "removed_elements" => RemovedElements, "broken_edges" => BrokenEdges, "damaged_edges" => DamagedEdges,
    "particles" => Particles, "fragments" => Fragments, "contacts" => Contacts,
    "bonds" => Bonds, "broken_bonds" => BrokenBonds, "entered_particles" => EnteredParticles,
    "waiting_particles" => WaitingParticles, "left_pieces" => LeftPieces,
});

/// A count [-].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Count(pub CountKind);

impl Measure for Count {
    const KEY: &'static str = "count";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].count", K::Choice(names::<CountKind>), "", "A count"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        Some((Count(probe.choice(Self::KEY).required()?), D::NONE))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(*self))
    }
}

impl Probe for Count {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        probed.count(self.0) as f64
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        match self.0 {
            CountKind::Fragments => ProbeNeeds::of_all(true),
            CountKind::BrokenEdges | CountKind::DamagedEdges => ProbeNeeds::of_damage(),
            CountKind::Contacts => ProbeNeeds { contacts: true, ..ProbeNeeds::default() },
            _ => ProbeNeeds::default(),
        }
    }
}
