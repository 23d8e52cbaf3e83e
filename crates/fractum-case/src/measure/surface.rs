//! Area of facets as they are at present [m²], or the volume that they enclose [m³].

use fractum_scene::{HoleEnds, Probe, SurfaceMeasure, SurfaceProbe, SymmetryPlanes};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::selection::{GroupUse, Selection, selection};
use crate::unit::Dimension as D;

choice!(SurfaceMeasure { "area" => Area, "volume" => Volume });

/// Area of facets as they are at present [m²], or the volume that they enclose [m³].
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Facets by their group, by their nodes, or both.
    pub on: Selection,
    /// What about them.
    pub measure: SurfaceMeasure,
}

impl Measure for Surface {
    const KEY: &'static str = "surface";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].surface", K::Table, "", "Facets of a group as they are at present"),
        key("probes[].surface.group", K::Text, "", "Mesh group of facets; required without `where`"),
        key("probes[].surface.where", K::Condition, "", "Which facets, by the positions of all their nodes at the start"),
        key("probes[].surface.measure", K::Choice(names::<SurfaceMeasure>), "required", "Their area, in m^2, or the volume of the cavity that they enclose, in m^3"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let on = selection(&table);
        let measure = table.choice("measure").required();
        table.finish("here");
        let measure = measure?;
        let dimension = if measure == SurfaceMeasure::Area { D::AREA } else { D::VOLUME };
        Some((Surface { on: on?, measure }, dimension))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::Facets)
    }

    /// An error if a volume is asked for and the facets do not close around one.
    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let (on, measure) = (&self.on, self.measure);
        let facets = scene.names.facets(on);
        let closed = || HoleEnds::find(scene.solid, &facets, SymmetryPlanes::default(), false).is_ok();
        if measure == SurfaceMeasure::Volume && (facets.is_empty() || !closed()) {
            let found = format!("= \"{}\" encloses no volume", on.label());
            scene.error_at(on, found, "facets that close around a cavity");
        }
        Some(Box::new(SurfaceProbe { facets, measure }))
    }
}
