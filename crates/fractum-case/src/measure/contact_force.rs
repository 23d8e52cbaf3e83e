//! Force of contact of one body on another [N].

use fractum_scene::{Along, ContactProbe, Probe, ProbedScene};

use super::Measure;
use super::scenery::Scenery;
use super::tables::along_or_about;
use crate::Spanned;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::unit::Dimension as D;

/// Force of contact of one body on another [N].
#[derive(Debug, Clone, PartialEq)]
pub struct ContactForce {
    /// Name of the body that feels it.
    pub on: Spanned<String>,
    /// Name of the body that it comes from.
    pub from: Spanned<String>,
    /// Which component, at each place of contact.
    pub along: Along,
}

impl Measure for ContactForce {
    const KEY: &'static str = "contact_force";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].contact_force", K::Table, "", "Force of contact of one body on another, in N; of solids with their discrete elements"),
        key("probes[].contact_force.on", K::Text, "required", "Name of the body that feels it"),
        key("probes[].contact_force.from", K::Text, "required", "Name of the body that it comes from"),
        key("probes[].contact_force.along", K::DirectionOrAbout, "required", "Direction; or \"radial\" or \"tangential\": away from the axis, or around it by the right hand, at each place of contact"),
        key("probes[].contact_force.about", K::Table, "", "radial and tangential only: the axis"),
        key("probes[].contact_force.about.point", K::Point(D::LENGTH), "[0, 0, 0]", "A point of it"),
        key("probes[].contact_force.about.axis", K::Direction, "\"z\"", "Its direction"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let [on, from] = ["on", "from"].map(|name| table.text(name).spanned().required());
        let along = along_or_about(&table);
        table.finish("here");
        Some((ContactForce { on: on?, from: from?, along: along? }, D::FORCE))
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let [on, from] = [&self.on, &self.from].map(|name| scene.names.contact_body(&name.value));
        Some(Box::new(Between(ContactProbe { on: on?, from: from?, along: self.along })))
    }
}

#[derive(Debug)]
struct Between(ContactProbe);

impl Probe for Between {
    fn value(&self, probed: &ProbedScene<'_>) -> f64 {
        probed.scene.contacts.force_between(&self.0).unwrap_or(f64::NAN)
    }

    fn contact(&self) -> Option<ContactProbe> {
        Some(self.0)
    }
}
