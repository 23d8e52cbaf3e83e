//! What is damaged.

use fractum_scene::{DamagedMeasure, DamagedPart, Probe};

use super::Measure;
use super::scenery::Scenery;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::condition;
use crate::selection::GroupUse;
use crate::unit::Dimension as D;
use crate::{Field, Spanned};

choice!(DamagedMeasure { "volume" => Volume, "area" => Area, "share" => Share });

/// What is damaged.
#[derive(Debug, Clone, PartialEq)]
pub struct Damaged {
    /// What about it.
    pub measure: DamagedMeasure,
    /// Damage from which on an element counts [-].
    pub threshold: f64,
    /// Mesh group of elements; all elements that may be damaged if absent.
    pub group: Option<Spanned<String>>,
    /// Where elements count, by the position of their middles; everywhere if absent.
    pub within: Option<Spanned<Field>>,
}

impl Measure for Damaged {
    const KEY: &'static str = "damaged";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].damaged", K::Table, "", "Elements that are damaged; removed ones are"),
        key("probes[].damaged.measure", K::Choice(names::<DamagedMeasure>), "required", "Their volume, in m^3; their area in 2D, in m^2; or their share of the volume of all selected elements"),
        key("probes[].damaged.threshold", K::Quantity(D::NONE), "0.5", "Mean damage over its edges from which on an element is damaged, within 0 and 1"),
        key("probes[].damaged.group", K::Text, "", "Mesh group of elements; absent means all that may be damaged"),
        key("probes[].damaged.where", K::Condition, "", "Condition on the middles of the elements that count; absent means all"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let measure = table.choice("measure").required();
        let threshold =
            table.quantity("threshold").check(|share| *share > 0.0 && *share <= 1.0, "above 0, up to 1").or(0.5);
        let group = optional(&table, "group", |name| table.text(name).spanned().given());
        let within = optional(&table, "where", |name| condition(&table, name).spanned().given());
        table.finish("here");
        let measure = measure?;
        let dimension = match measure {
            DamagedMeasure::Volume => D::VOLUME,
            DamagedMeasure::Area => D::AREA,
            DamagedMeasure::Share => D::NONE,
        };
        Some((Damaged { measure, threshold, group: group?, within: within? }, dimension))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        Some((self.group.as_ref()?, GroupUse::ProbeElements))
    }

    fn instead_in_space(&self) -> Option<&'static str> {
        (self.measure == DamagedMeasure::Area).then_some("measure = \"volume\": bodies in space have no area")
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let (solid, elements) = (scene.solid, self.elements(scene));
        Some(Box::new(DamagedPart::new(solid, self.measure, self.threshold, &elements)))
    }
}

impl Damaged {
    /// Bodies and elements of the group, or all, that may be damaged and fulfil the condition; an error if there are none.
    fn elements(&self, scene: &mut Scenery<'_>) -> Vec<(usize, u32)> {
        let (group, within, solid) = (self.group.as_ref(), self.within.as_ref(), scene.solid);
        let mut elements = scene.names.elements_of(group);
        let named = elements.len();
        elements.retain(|&(body, element)| {
            let inside = within.is_none_or(|within| within.value.holds_at(solid.element_middle(body, element)));
            inside && solid.body(body).damage.is_some()
        });
        if elements.is_empty() && (named > 0 || group.is_none()) {
            let place = within.map(|within| &within.place).or(group.map(|group| &group.place));
            let place = place.cloned().unwrap_or_else(|| scene.names.whole_case());
            let expected = "elements of a body whose material has damage";
            scene.names.error(&place, ": nothing there may be damaged".to_owned(), expected);
        }
        elements
    }
}
