//! Sum of support reactions [N], or the force of a rigid body.

use fractum_fem::motion;
use fractum_scene::{Along, PointProbe, Population, Probe, ProbeOfPoints};

use super::Measure;
use super::scenery::{Scenery, is_held};
use super::tables::on_along;
use crate::Spanned;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::selection::{GroupUse, Selection};
use crate::unit::Dimension as D;

/// Sum of support reactions [N], or the force of a rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct Reaction {
    /// On these nodes or particles, or of this rigid body.
    pub on: Selection,
    /// Which component.
    pub along: Along,
}

impl Measure for Reaction {
    const KEY: &'static str = "reaction";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].reaction", K::Table, "", "Sum of the support reactions on a group, or force of a rigid body on particles, in N"),
        key("probes[].reaction.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
        key("probes[].reaction.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
        key("probes[].reaction.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
        key("probes[].reaction.about", K::Table, "", "radial and tangential only: the axis"),
        key("probes[].reaction.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
        key("probes[].reaction.about.axis", K::Direction, "\"z\"", "Its direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        on_along(probe, Self::KEY).map(|(on, along)| (Reaction { on, along }, D::FORCE))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::ProbeNodes)
    }

    fn may_be_particles(&self) -> Option<&Selection> {
        Some(&self.on)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let (on, along) = (&self.on, self.along);
        if let (Some(particles), Some(group)) = (scene.names.particles(on), &on.group) {
            let places = scene.bonded.supports().places(&particles);
            if !particles.is_empty() && !is_held(&places, &along) {
                let found = format!("= \"{}\": nothing holds it along the direction of the probe", group.value);
                scene.names.error(&group.place, found, "a set that a support prescribes");
            }
            return Some(ProbeOfPoints::boxed(Population::Particles, PointProbe::Reaction { places, along }));
        }
        if let Some(rigid) = scene.rigid_body(on, along, |body, _| -body.contact_force()) {
            return rigid;
        }
        let nodes = scene.names.nodes(on);
        let nodes = motion::with_copies(scene.solid, nodes);
        let places = scene.held_places(on, &nodes, Some(&along));
        Some(ProbeOfPoints::boxed(Population::Nodes, PointProbe::Reaction { places, along }))
    }
}
