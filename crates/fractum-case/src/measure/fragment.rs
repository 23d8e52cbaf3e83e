//! Something about the fragment that holds the first of some nodes.

use fractum_math::Vec3;
use fractum_scene::{FragmentMeasure, FragmentProbe, Probe};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::choice::choice;
use crate::key_kind::{KeyDoc, KeyKind as K, key, names};
use crate::reader::Table;
use crate::reader::vectors::direction;
use crate::selection::{GroupUse, Selection, selection};
use crate::unit::Dimension as D;

choice!(FragmentMeasure { "mass" => Mass, "volume" => Volume, "size" => Size, "velocity" => Velocity });

/// Something about the fragment that holds the first of some nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct FragmentOf {
    /// The nodes.
    pub on: Selection,
    /// What about it.
    pub measure: FragmentMeasure,
    /// Unit vector of a velocity.
    pub along: Vec3,
}

impl Measure for FragmentOf {
    const KEY: &'static str = "fragment";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].fragment", K::Table, "", "The fragment with the first node of a group"),
        key("probes[].fragment.group", K::Text, "", "Mesh group; required without `where`"),
        key("probes[].fragment.where", K::Condition, "", "Which nodes, by their positions at the start"),
        key("probes[].fragment.measure", K::Choice(names::<FragmentMeasure>), "required", "Its mass, volume, size (diameter of the sphere of that volume, in 2D of the circle of that area), or the velocity of its centre of mass"),
        key("probes[].fragment.along", K::Direction, "", "Velocity only, required there: direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let on = selection(&table);
        let measure = table.choice("measure").required();
        let along = if measure == Some(FragmentMeasure::Velocity) {
            direction(&table, "along").required()
        } else {
            table.refuse("along", "with this measure");
            Some(Vec3::zeros())
        };
        table.finish("here");
        let measure = measure?;
        let dimension = match measure {
            FragmentMeasure::Mass => D::MASS,
            FragmentMeasure::Volume => D::VOLUME,
            FragmentMeasure::Size => D::LENGTH,
            FragmentMeasure::Velocity => D::VELOCITY,
        };
        Some((FragmentOf { on: on?, measure, along: along? }, dimension))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::ProbeNodes)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let nodes = scene.names.nodes(&self.on);
        Some(Box::new(FragmentProbe { nodes, measure: self.measure, along: self.along }))
    }
}
