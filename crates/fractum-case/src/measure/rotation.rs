//! Rotation of a set of points as a whole about an axis through its centre, for small angles [rad].

use fractum_math::Vec3;
use fractum_scene::{PointProbe, Population, Probe, ProbeOfPoints};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::reader::vectors::direction;
use crate::selection::{GroupUse, Selection, selection};
use crate::unit::Dimension as D;

/// Rotation of a set of points as a whole about an axis through its centre, for small angles [rad].
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// Of these nodes or particles.
    pub on: Selection,
    /// Unit vector.
    pub along: Vec3,
}

impl Measure for Rotation {
    const KEY: &'static str = "rotation";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].rotation", K::Table, "", "Rotation of a set of nodes or particles as a whole about an axis through its centre, for small angles, in rad"),
        key("probes[].rotation.group", K::Text, "", "Mesh group or set of particles; required without `where`"),
        key("probes[].rotation.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
        key("probes[].rotation.along", K::Direction, "required", "Direction of the axis"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let on = selection(&table);
        let along = direction(&table, "along").required();
        table.finish("here");
        Some((Rotation { on: on?, along: along? }, D::NONE))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::ProbeNodes)
    }

    fn may_be_particles(&self) -> Option<&Selection> {
        Some(&self.on)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let (population, points) = scene.points(&self.on);
        if population == Population::Nodes {
            scene.refuse_out_of_plane(&self.on, &self.along);
        }
        Some(ProbeOfPoints::boxed(population, PointProbe::Rotation { points, axis: self.along }))
    }
}
