//! Something about the liquid in interfaces.

use fractum_scene::{LiquidMeasure, NeededPoints, Probe, ProbeNeeds, ProbedScene, Scene, liquid_of};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::unit::Dimension as D;

choice!(LiquidMeasure {
    "pressure" => Pressure, "aperture" => Aperture, "rate" => Rate, "injected" => Injected, "volume" => Volume,
    "leaked" => Leaked, "wetted_area" => WettedArea, "front" => Front, "hole_pressure" => HolePressure,
    "hole_volume" => HoleVolume,
});

/// Something about the liquid.
#[derive(Debug, Clone, PartialEq)]
pub struct LiquidIn {
    /// What about it.
    pub measure: LiquidMeasure,
    /// Group of the hole that is meant; all of them if absent.
    pub hole: Option<Spanned<String>>,
}

impl Measure for LiquidIn {
    const KEY: &'static str = "liquid";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].liquid", K::Choice(names::<LiquidMeasure>), "", "A number about the liquid. Where it is put in, over all injections: mean pressure, mean aperture (of a hole that of interfaces on its wall), or rate. Of all of it: volume injected so far, volume in the interfaces, volume that has leaked, area that is wet, the process zone included, or distance of the front from the injections. Pressure in a hole, or the volume of its liquid, as it is without pressure. NaN without liquid"),
        key("probes[].hole", K::Text, "all holes", "liquid = \"hole_pressure\" and \"hole_volume\" only: group of one of liquid.holes. Of all holes the pressure is the mean over their volumes, the volume the sum"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let measure = probe.choice(Self::KEY).required()?;
        let dimension = match measure {
            LiquidMeasure::Pressure | LiquidMeasure::HolePressure => D::PRESSURE,
            LiquidMeasure::Aperture | LiquidMeasure::Front => D::LENGTH,
            LiquidMeasure::Rate => D::VOLUME_RATE,
            LiquidMeasure::Injected | LiquidMeasure::Volume | LiquidMeasure::Leaked => D::VOLUME,
            LiquidMeasure::HoleVolume => D::VOLUME,
            LiquidMeasure::WettedArea => D::AREA,
        };
        if !matches!(measure, LiquidMeasure::HolePressure | LiquidMeasure::HoleVolume) {
            probe.refuse("hole", "with this number, which is of no hole");
        }
        let hole = optional(probe, "hole", |name| probe.text(name).spanned().given())?;
        Some((LiquidIn { measure, hole }, dimension))
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let hole = self.hole.as_ref().and_then(|group| {
            let hole = scene.names.hole(&group.value);
            if hole.is_none() {
                let found = format!("= \"{}\"", group.value);
                scene.names.error(&group.place, found, "the group of one of liquid.holes");
            }
            hole
        });
        Some(Box::new(OfLiquid(self.measure, hole)))
    }
}

/// Not a number where there is no liquid.
#[derive(Debug)]
struct OfLiquid(LiquidMeasure, Option<usize>);

impl Probe for OfLiquid {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        liquid_of(probed.scene).map_or(f64::NAN, |liquid| liquid.measure(probed.scene.interfaces(), self.0, self.1))
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds { nodes: NeededPoints::Any, ..ProbeNeeds::default() }
    }
}
