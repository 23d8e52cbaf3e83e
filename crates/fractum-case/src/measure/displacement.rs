//! Mean displacement [m].

use fractum_scene::{Along, PointProbe, Probe, ProbeOfPoints};

use super::Measure;
use super::scenery::{OfRigid, Scenery};
use super::tables::on_along;
use crate::Spanned;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::selection::{GroupUse, Selection};
use crate::unit::Dimension as D;

/// Mean displacement [m].
#[derive(Debug, Clone, PartialEq)]
pub struct Displacement {
    /// Of these nodes or particles, or of this rigid body.
    pub on: Selection,
    /// Which component.
    pub along: Along,
}

impl Measure for Displacement {
    const KEY: &'static str = "displacement";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].displacement", K::Table, "", "Mean displacement of those of a group's nodes or particles that have not left solver.domain, in m"),
        key("probes[].displacement.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
        key("probes[].displacement.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
        key("probes[].displacement.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
        key("probes[].displacement.about", K::Table, "", "radial and tangential only: the axis"),
        key("probes[].displacement.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
        key("probes[].displacement.about.axis", K::Direction, "\"z\"", "Its direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        on_along(probe, Self::KEY).map(|(on, along)| (Displacement { on, along }, D::LENGTH))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::ProbeNodes)
    }

    fn may_be_particles(&self) -> Option<&Selection> {
        Some(&self.on)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        // Way of its reference point at the instant of the last step.
        let way: OfRigid = |body, dt| body.displacement() - body.frame.velocity * dt;
        if let Some(rigid) = scene.rigid_body(&self.on, self.along, way) {
            return rigid;
        }
        let (population, points) = scene.points(&self.on);
        scene.check_direction(&self.on, population, self.along);
        Some(ProbeOfPoints::boxed(population, PointProbe::Displacement { points, along: self.along }))
    }
}
