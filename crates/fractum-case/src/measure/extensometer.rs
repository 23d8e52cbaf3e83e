//! Elongation between two places over their distance [-].

use fractum_math::Vec3;
use fractum_scene::{Extensometer, Probe};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::reader::presence::optional;
use crate::reader::vectors::point;
use crate::selection::{GroupUse, Selection, selection};
use crate::unit::Dimension as D;

/// Elongation between two places over their distance [-].
#[derive(Debug, Clone, PartialEq)]
pub struct ExtensometerBetween {
    /// The points.
    pub on: Selection,
    /// Places of its feet without load [m].
    pub ends: [Vec3; 2],
    /// Diameter of its feet [m]; the nearest point if absent.
    pub foot: Option<f64>,
}

impl Measure for ExtensometerBetween {
    const KEY: &'static str = "extensometer";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].extensometer", K::Table, "", "Elongation between two points of a body over their distance, as an extensometer or a strain gauge measures it. A rotation of the body is no elongation"),
        key("probes[].extensometer.group", K::Text, "", "Mesh group or set of particles that its feet are on; required without `where`"),
        key("probes[].extensometer.where", K::Condition, "", "Which nodes or particles, by their positions at the start; without `group`: which nodes of all solid bodies"),
        key("probes[].extensometer.from", K::Point(D::LENGTH), "required", "Place of one foot"),
        key("probes[].extensometer.to", K::Point(D::LENGTH), "required", "Place of the other foot"),
        key("probes[].extensometer.foot", K::Quantity(D::LENGTH), "", "Diameter of a foot, > 0: the mean over its nodes or particles; absent, or without any in it, means the nearest one"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let on = selection(&table);
        let [from, to] = ["from", "to"].map(|key| point(&table, key).required());
        let foot = optional(&table, "foot", |key| table.quantity(key).positive().given());
        table.finish("here");
        Some((ExtensometerBetween { on: on?, ends: [from?, to?], foot: foot? }, D::NONE))
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
        if points.is_empty() {
            return None; // told where they were chosen
        }
        let probe = Extensometer::new((scene.bonded, scene.solid), population, &points, self.ends, self.foot);
        if probe.is_none() {
            let found = format!("= \"{}\": both feet are on the same of its {} points", on.label(), points.len());
            scene.error_at(on, found, "places with points of their own");
        }
        Some(Box::new(probe?))
    }
}
