//! Mean strain of nodes or particles [-].

use fractum_dem::StrainMeasure;
use fractum_scene::{Along, Population, Probe, RegionStrain};

use super::Measure;
use super::scenery::Scenery;
use super::tables::{StressComponent, stress_or_strain};
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::selection::{GroupUse, Selection};
use crate::unit::Dimension as D;
use crate::{Choice, Spanned};

choice!(StrainMeasure { "cundall" => Cundall, "bagi" => Bagi, "satake" => Satake });

/// Mean strain of nodes or particles [-].
#[derive(Debug, Clone, PartialEq)]
pub struct Strain {
    /// The points.
    pub on: Selection,
    /// How it is defined.
    pub measure: StrainMeasure,
    /// The two directions of the component.
    pub between: [Along; 2],
}

impl Measure for Strain {
    const KEY: &'static str = "strain";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].strain", K::Table, "", "Mean strain of nodes or particles, as a strain gauge or a region of image correlation measures it; rotation of the whole is no strain"),
        key("probes[].strain.group", K::Text, "", "Mesh group or set of particles; required without `where`"),
        key("probes[].strain.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
        key("probes[].strain.measure", K::Choice(names::<StrainMeasure>), "\"cundall\"", "Affine field closest to the displacements; particles only: mean over the space cells between the centres (bagi), or of the relative displacements at contact points, rotations included (satake)"),
        key("probes[].strain.component", K::Choice(names::<StressComponent>), "required", "Component; elongation is positive, xy is half the change of the right angle"),
        key("probes[].strain.about", K::Table, "", "radial, tangential and radial_tangential only: the axis; directions are those at the centre of the points"),
        key("probes[].strain.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
        key("probes[].strain.about.axis", K::Direction, "\"z\"", "Its direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let measure = |table: &Table<'_>| table.choice("measure").or_if_absent(StrainMeasure::default());
        let (on, between, measure) = stress_or_strain(probe.table(Self::KEY)?, measure)?;
        Some((Strain { on, measure, between }, D::NONE))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::ProbeNodes)
    }

    fn may_be_particles(&self) -> Option<&Selection> {
        Some(&self.on)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let on = &self.on;
        let (population, points) = scene.points(on);
        if population == Population::Nodes && self.measure != StrainMeasure::Cundall {
            let name = self.measure.name();
            let found = format!("= \"{}\", which are nodes, with measure = \"{name}\"", on.label());
            scene.error_at(on, found, "particles of a bonded body; or measure = \"cundall\"");
            return None;
        }
        let probe = RegionStrain::new((scene.bonded, scene.solid), population, &points, self.measure, self.between);
        if probe.is_none() && !points.is_empty() {
            let found = format!("= \"{}\": its {} points do not span the strain", on.label(), points.len());
            let expected = "points that span a volume, or a plane with both directions of the component in it";
            scene.error_at(on, found, expected);
        }
        Some(Box::new(probe?))
    }
}
