//! Moment of support reactions about an axis [N m].

use fractum_dem::crack_shape::Axis;
use fractum_fem::motion;
use fractum_scene::{PointProbe, Population, Probe, ProbeOfPoints};

use super::Measure;
use super::scenery::Scenery;
use super::tables::axis;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::selection::{Selection, selection};
use crate::unit::Dimension as D;

/// Moment of support reactions about an axis [N m].
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// On these nodes.
    pub on: Selection,
    /// The axis.
    pub about: Axis,
}

impl Measure for Moment {
    const KEY: &'static str = "moment";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].moment", K::Table, "", "Moment of the support reactions on a group about an axis, in N m; levers are those without load"),
        key("probes[].moment.group", K::Text, "", "Mesh group; required without `where`"),
        key("probes[].moment.where", K::Condition, "", "Which nodes, by their positions at the start; without `group`: which nodes of all solid bodies"),
        key("probes[].moment.about", K::Table, "", "The axis"),
        key("probes[].moment.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
        key("probes[].moment.about.axis", K::Direction, "\"z\"", "Its direction"),
    ];
    /// A moment is no energy, though its dimension is that of one.
    const UNIT: Option<&'static str> = Some("N m");

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let (on, about) = (selection(&table), axis(&table));
        table.finish("here");
        Some((Moment { on: on?, about: about? }, D::ENERGY))
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        scene.refuse_out_of_plane(&self.on, &self.about.direction);
        let nodes = scene.names.nodes(&self.on);
        let nodes = motion::with_copies(scene.solid, nodes);
        let places = scene.held_places(&self.on, &nodes, None);
        Some(ProbeOfPoints::boxed(Population::Nodes, PointProbe::Moment { places, about: self.about }))
    }
}
