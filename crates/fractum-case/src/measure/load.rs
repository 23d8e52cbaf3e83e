//! Sum of the loads on nodes [N].

use fractum_scene::{Along, Probe, ProbedScene};

use super::Measure;
use super::scenery::Scenery;
use super::tables::on_along;
use crate::Spanned;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::selection::{GroupUse, Selection};
use crate::unit::Dimension as D;

/// Sum of the loads on nodes [N].
#[derive(Debug, Clone, PartialEq)]
pub struct LoadOn {
    /// On these nodes.
    pub on: Selection,
    /// Which component.
    pub along: Along,
}

impl Measure for LoadOn {
    const KEY: &'static str = "load";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].load", K::Table, "", "Sum of the loads on the nodes of a group, weight aside, in N"),
        key("probes[].load.group", K::Text, "", "Mesh group; required without `where`"),
        key("probes[].load.where", K::Condition, "", "Which nodes, by their positions at the start"),
        key("probes[].load.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand"),
        key("probes[].load.about", K::Table, "", "radial and tangential only: the axis"),
        key("probes[].load.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
        key("probes[].load.about.axis", K::Direction, "\"z\"", "Its direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        on_along(probe, Self::KEY).map(|(on, along)| (LoadOn { on, along }, D::FORCE))
    }

    fn group(&self) -> Option<(&Spanned<String>, GroupUse)> {
        self.on.used_as(GroupUse::ProbeNodes)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        Some(Box::new(OnNodes { nodes: scene.names.nodes(&self.on), along: self.along }))
    }
}

#[derive(Debug)]
struct OnNodes {
    /// Ascending.
    nodes: Vec<u32>,
    /// Which component; directions about an axis are those of the places without load.
    along: Along,
}

impl Probe for OnNodes {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        probed.scene.load_on(&self.nodes, &self.along)
    }
}
