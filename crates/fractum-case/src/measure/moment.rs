//! Moment of support reactions, or of a rigid body, about an axis [N m].

use fractum_dem::crack_shape::Axis;
use fractum_fem::motion;
use fractum_scene::{PointProbe, Population, Probe, ProbeOfPoints, RigidBody};

use super::Measure;
use super::scenery::Scenery;
use super::tables::axis;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::selection::{Selection, selection};
use crate::unit::Dimension as D;

/// Moment of support reactions, or of a rigid body, about an axis [N m].
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// On these nodes, or of this rigid body.
    pub on: Selection,
    /// The axis.
    pub about: Axis,
}

impl Measure for Moment {
    const KEY: &'static str = "moment";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].moment", K::Table, "", "Moment of the support reactions on a group or a set of bonded particles, or of a rigid body on what touches it, about an axis, in N m; levers of supports are those without load, those of rigid bodies those of the moment"),
        key("probes[].moment.group", K::Text, "", "Mesh group, set of particles or rigid body; required without `where`"),
        key("probes[].moment.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
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

    fn may_be_particles(&self) -> Option<&Selection> {
        Some(&self.on)
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let Axis { point, direction } = self.about;
        if let (Some(particles), Some(group)) = (scene.names.particles(&self.on), &self.on.group) {
            let places = scene.bonded.supports().places(&particles);
            let still = scene.bonded.still(&particles);
            if !particles.is_empty() && places.is_empty() && still.is_empty() {
                let found = format!("= \"{}\": nothing holds it", group.value);
                scene.names.error(&group.place, found, "a set that a support prescribes");
            }
            let about = self.about;
            return Some(ProbeOfPoints::boxed(Population::Particles, PointProbe::Moment { places, still, about }));
        }
        // Levers at the instant of the forces: the body has moved on since.
        let moment = move |body: &RigidBody, dt: f64| {
            let place = body.frame.origin - body.frame.velocity * dt;
            -(body.contact_moment() + (place - point).cross(&body.contact_force())).dot(&direction)
        };
        if let Some(rigid) = scene.number_of_rigid(&self.on, moment) {
            return rigid;
        }
        scene.refuse_out_of_plane(&self.on, &self.about.direction);
        let nodes = scene.names.nodes(&self.on);
        let nodes = motion::with_copies(scene.solid, nodes);
        let places = scene.held_places(&self.on, &nodes, None);
        Some(ProbeOfPoints::boxed(
            Population::Nodes,
            PointProbe::Moment { places, still: Vec::new(), about: self.about },
        ))
    }
}
