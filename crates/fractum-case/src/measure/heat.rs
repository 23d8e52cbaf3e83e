//! Something about the heat of everything [J].

use fractum_scene::{HeatMeasure, Probe, ProbedScene};

use super::Measure;
use super::scenery::Scenery;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::unit::Dimension as D;

choice!(HeatMeasure {
    "stored" => Stored, "held" => Held, "supplied" => Supplied, "convection" => Convection, "residual" => Residual,
    "expansion_work" => ExpansionWork,
});

/// Something about the heat of everything [J]; not a number without heat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatOfAll(pub HeatMeasure);

impl Measure for HeatOfAll {
    const KEY: &'static str = "heat";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].heat", K::Choice(names::<HeatMeasure>), "", "Heat in J: stored since the start; brought in by prescribed temperatures (held), by fluxes, powers and sources (supplied), by convection; residual of this balance; or the mechanical work of thermal expansion"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        Some((HeatOfAll(probe.choice(Self::KEY).required()?), D::ENERGY))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(*self))
    }
}

impl Probe for HeatOfAll {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        probed.scene.heat().map_or(f64::NAN, |heat| heat.measure(self.0))
    }
}
