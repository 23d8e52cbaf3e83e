//! How a crack lies, by its edges that have lost half of their strength and its broken bonds; or how much has separated.

use fractum_dem::crack_shape::Axis;
use fractum_math::Vec3;
use fractum_scene::{CrackMeasure, CrackProbe, Probe};

use super::Measure;
use super::scenery::Scenery;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::{condition, direction, point};
use crate::unit::Dimension as D;
use crate::{Field, Spanned};

choice!(CrackMeasure {
    "angle" => Angle, "centre" => Centre, "front" => Front, "helix" => Helix, "cone" => Cone,
    "cone_share" => ConeShare, "area" => Area, "length" => Length, "count" => Count, "tip" => Tip,
});

/// How a crack lies, by its edges that have lost half of their strength and its broken bonds; or how much has separated.
#[derive(Debug, Clone, PartialEq)]
pub struct Crack {
    /// What about it.
    pub measure: CrackMeasure,
    /// Unit vector.
    pub along: Vec3,
    /// A point of the axis of a helix or cone [m].
    pub point: Vec3,
    /// Where edges and elements count, by the position of their middles; everywhere if absent.
    pub within: Option<Spanned<Field>>,
}

impl Measure for Crack {
    const KEY: &'static str = "crack";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].crack", K::Table, "", "How a crack lies, by its edges that have lost half of their strength and its broken bonds (not a number before there are any); or how much has separated, by removed elements and broken bonds"),
        key("probes[].crack.measure", K::Choice(names::<CrackMeasure>), "required", "Angle between the direction and the plane of the crack (its line in 2D), in rad; or position of its centre or its foremost edge or bond along the direction, in m; or the angle of the helix to its axis, or of the cone's flank to the plane across its axis, in rad; or the part of the crack that lies on that cone. Of what has separated: area, in m^2; length in the plane, in m; number of separate cracks; or position of the foremost place along the direction, the tip, in m"),
        key("probes[].crack.along", K::Direction, "", "Direction; required but for area, length and count"),
        key("probes[].crack.point", K::Point(D::LENGTH), "[0, 0, 0]", "helix, cone and cone_share only: a point of the axis; for a cone the one in the surface, with the direction out of it"),
        key("probes[].crack.where", K::Condition, "", "Condition on the middles of the edges, elements and bonds that count; absent means all"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let measure = table.choice("measure").required();
        let along = if measure.is_none_or(CrackMeasure::has_direction) {
            direction(&table, "along").required()
        } else {
            table.refuse("along", "with this measure");
            Some(Vec3::zeros())
        };
        let within = optional(&table, "where", |name| condition(&table, name).spanned().given());
        let about_axis = matches!(measure, Some(CrackMeasure::Helix | CrackMeasure::Cone | CrackMeasure::ConeShare));
        let point = if about_axis {
            point(&table, "point").or_if_absent(Vec3::zeros())
        } else {
            table.refuse("point", "with this measure");
            Some(Vec3::zeros())
        };
        table.finish("here");
        let measure = measure?;
        let dimension = match measure {
            CrackMeasure::Area => D::AREA,
            CrackMeasure::Centre | CrackMeasure::Front | CrackMeasure::Length | CrackMeasure::Tip => D::LENGTH,
            _ => D::NONE,
        };
        Some((Crack { measure, along: along?, point: point?, within: within? }, dimension))
    }

    fn instead_in_space(&self) -> Option<&'static str> {
        (self.measure == CrackMeasure::Length).then_some("measure = \"area\": cracks in space have no length")
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let inside = scene.inside_cracks(self.within.as_ref());
        let axis = Axis { point: self.point, direction: self.along };
        Some(Box::new(CrackProbe { measure: self.measure, axis, inside }))
    }
}
