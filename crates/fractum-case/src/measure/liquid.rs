//! Something about the liquid in interfaces.

use fractum_scene::{LiquidMeasure, NeededPoints, Probe, ProbeNeeds, ProbedScene, Scene, liquid_of};

use super::Measure;
use super::scenery::Scenery;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::unit::Dimension as D;

choice!(LiquidMeasure {
    "pressure" => Pressure, "aperture" => Aperture, "rate" => Rate, "injected" => Injected, "volume" => Volume,
    "leaked" => Leaked, "wetted_area" => WettedArea, "front" => Front,
});

/// Something about the liquid.
#[derive(Debug, Clone, PartialEq)]
pub struct LiquidIn {
    /// What about it.
    pub measure: LiquidMeasure,
}

impl Measure for LiquidIn {
    const KEY: &'static str = "liquid";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].liquid", K::Choice(names::<LiquidMeasure>), "", "A number about the liquid in interfaces. Where it is put in, over all injections: mean pressure, mean aperture, or rate. Of all of it: volume injected so far, volume in the interfaces, volume that has leaked, area that is wet, the process zone included, or distance of the front from the injections. NaN without liquid"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let measure = probe.choice(Self::KEY).required()?;
        let dimension = match measure {
            LiquidMeasure::Pressure => D::PRESSURE,
            LiquidMeasure::Aperture | LiquidMeasure::Front => D::LENGTH,
            LiquidMeasure::Rate => D::VOLUME_RATE,
            LiquidMeasure::Injected | LiquidMeasure::Volume | LiquidMeasure::Leaked => D::VOLUME,
            LiquidMeasure::WettedArea => D::AREA,
        };
        Some((LiquidIn { measure }, dimension))
    }

    fn resolve(&self, _: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(OfLiquid(self.measure)))
    }
}

/// Not a number where there is no liquid.
#[derive(Debug)]
struct OfLiquid(LiquidMeasure);

impl Probe for OfLiquid {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        liquid_of(probed.scene).map_or(f64::NAN, |liquid| liquid.measure(probed.scene.interfaces(), self.0))
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds { nodes: NeededPoints::Any, ..ProbeNeeds::default() }
    }
}
