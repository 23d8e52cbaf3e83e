//! Something about the gas.

use fractum_scene::{GasMeasure, NeededPoints, Probe, ProbeNeeds, ProbedScene, Scene};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::unit::Dimension as D;

choice!(GasMeasure {
    "pressure" => Pressure, "temperature" => Temperature, "mass" => Mass, "energy" => Energy, "volume" => Volume,
    "wetted_area" => WettedArea, "leaked_mass" => LeakedMass,
});

/// Something about the gas.
#[derive(Debug, Clone, PartialEq)]
pub struct GasIn {
    /// What about it.
    pub measure: GasMeasure,
    /// Group of the hole; everything if absent.
    pub group: Option<Spanned<String>>,
}

impl Measure for GasIn {
    const KEY: &'static str = "gas";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].gas", K::Table, "", "A number about the gas; NaN in static stages"),
        key("probes[].gas.measure", K::Choice(names::<GasMeasure>), "required", "Pressure, in Pa (of everything: mean over the volume); temperature, in K (mean over the mass); mass, in kg; internal energy, in J; room for gas, in m^3; area of the walls under pressure without load, in m^2; or mass that has leaked, in kg"),
        key("probes[].gas.group", K::Text, "", "Group of a hole: its gas, or the area that gas from it wets. Absent means all gas, also in cracks. Not with leaked_mass"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let measure = table.choice("measure").required();
        if measure == Some(GasMeasure::LeakedMass) {
            table.refuse("group", "with leaked_mass, which is that of everything");
        }
        let group = optional(&table, "group", |name| table.text(name).spanned().given());
        table.finish("here");
        let measure = measure?;
        let dimension = match measure {
            GasMeasure::Pressure => D::PRESSURE,
            GasMeasure::Temperature => D::TEMPERATURE,
            GasMeasure::Mass | GasMeasure::LeakedMass => D::MASS,
            GasMeasure::Energy => D::ENERGY,
            GasMeasure::Volume => D::LENGTH.power(3.0)?,
            GasMeasure::WettedArea => D::AREA,
        };
        Some((GasIn { measure, group: group? }, dimension))
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let hole = self.group.as_ref().and_then(|group| {
            let hole = scene.names.hole(&group.value);
            if hole.is_none() {
                let found = format!("= \"{}\"", group.value);
                scene.names.error(&group.place, found, "the group of one of gas.holes");
            }
            hole
        });
        Some(Box::new(OfHole { measure: self.measure, hole }))
    }
}

/// Not a number where there is no gas.
#[derive(Debug)]
struct OfHole {
    measure: GasMeasure,
    /// Of everything if absent.
    hole: Option<usize>,
}

impl Probe for OfHole {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        let solid = &probed.scene.solid;
        probed.scene.gas().map_or(f64::NAN, |gas| gas.measure(solid, self.measure, self.hole))
    }

    fn needs(&self, _: &Scene) -> ProbeNeeds {
        ProbeNeeds { nodes: NeededPoints::Any, ..ProbeNeeds::default() }
    }
}
