//! Cracks that run away from a hole.

use fractum_dem::crack_shape::Axis;
use fractum_math::Vec3;
use fractum_output::number::quantity;
use fractum_scene::{Probe, RadialCracks, RadialMeasure};

use super::Measure;
use super::scenery::Scenery;
use super::tables::axis;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::condition;
use crate::unit::Dimension as D;
use crate::{Field, Spanned};

choice!(RadialMeasure { "count" => Count, "longest" => Longest, "crushed_radius" => CrushedRadius });

/// Cracks that run away from a hole.
#[derive(Debug, Clone, PartialEq)]
pub struct RadialCracksAbout {
    /// What about them.
    pub measure: RadialMeasure,
    /// Axis of the hole.
    pub about: Axis,
    /// Radius of the circle on which they are counted [m], where they are counted.
    pub radius: Option<Spanned<f64>>,
    /// Where elements count, by the position of their middles; everywhere if absent.
    pub within: Option<Spanned<Field>>,
}

impl Measure for RadialCracksAbout {
    const KEY: &'static str = "radial_cracks";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].radial_cracks", K::Table, "", "Cracks that run away from a hole, by removed elements"),
        key("probes[].radial_cracks.measure", K::Choice(names::<RadialMeasure>), "required", "Number of cracks that cross a circle about the axis; largest extent of one connected crack away from the axis, in m; or radius about the axis up to which all is crushed, in m, zero if nothing is"),
        key("probes[].radial_cracks.about", K::Table, "", "Axis of the hole"),
        key("probes[].radial_cracks.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
        key("probes[].radial_cracks.about.axis", K::Direction, "\"z\"", "Its direction"),
        key("probes[].radial_cracks.radius", K::Quantity(D::LENGTH), "", "count only, required there: radius of the circle, > 0"),
        key("probes[].radial_cracks.where", K::Condition, "", "Condition on the middles of the elements that count, such as those of a slice across the hole; absent means all"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let measure = table.choice("measure").required();
        let about = axis(&table);
        let radius = if measure == Some(RadialMeasure::Count) {
            table.quantity("radius").positive().spanned().required().map(Some)
        } else {
            table.refuse("radius", "with this measure");
            Some(None)
        };
        let within = optional(&table, "where", |name| condition(&table, name).spanned().given());
        table.finish("here");
        let measure = measure?;
        let dimension = if measure == RadialMeasure::Count { D::NONE } else { D::LENGTH };
        Some((RadialCracksAbout { measure, about: about?, radius: radius?, within: within? }, dimension))
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let inside = scene.inside_cracks(self.within.as_ref());
        let distance = |place: &Vec3| {
            let way = place - self.about.point;
            (way - self.about.direction * way.dot(&self.about.direction)).norm()
        };
        let (near, far) = scene
            .solid
            .reference
            .iter()
            .map(distance)
            .fold((f64::INFINITY, 0.0), |(near, far), own| (f64::min(near, own), f64::max(far, own)));
        if let Some(radius) = self.radius.as_ref().filter(|own| near < far && !(near..=far).contains(&own.value)) {
            let found = format!("= {}: no solid is that far from the axis", quantity(radius.value, "m"));
            let expected = format!("between {} and {}, where solids are", quantity(near, "m"), quantity(far, "m"));
            scene.names.error(&radius.place, found, &expected);
        }
        let radius = self.radius.as_ref().map_or(0.0, |radius| radius.value);
        Some(Box::new(RadialCracks::new(scene.solid, self.measure, self.about, radius, inside)))
    }
}
