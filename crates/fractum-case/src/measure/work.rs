//! Work of a rigid body on what touches it [J].

use fractum_scene::{Probe, RigidBody};

use super::Measure;
use super::scenery::Scenery;
use crate::Spanned;
use crate::key_kind::{KeyDoc, KeyKind as K, key};
use crate::reader::Table;
use crate::selection::Selection;
use crate::unit::Dimension as D;

/// Work of a rigid body on what touches it [J].
#[derive(Debug, Clone, PartialEq)]
pub struct WorkOf {
    /// The rigid body.
    pub body: Spanned<String>,
}

impl Measure for WorkOf {
    const KEY: &'static str = "work";
    #[rustfmt::skip] // a table reads best with one row per line
    const KEYS: &'static [KeyDoc] = &[
        key("probes[].work", K::Table, "", "Work that a rigid body has done since the start on what touches it, by its forces and moments, in J"),
        key("probes[].work.group", K::Text, "required", "The rigid body"),
    ];

    fn read(probe: &Table<'_>) -> Option<(Self, D)> {
        let table = probe.table(Self::KEY)?;
        let body = table.text("group").spanned().required();
        table.finish("here");
        Some((WorkOf { body: body? }, D::ENERGY))
    }

    fn resolve(&self, scene: &mut Scenery<'_>) -> Option<Box<dyn Probe>> {
        let on = Selection::of_group(self.body.clone());
        scene.number_of_rigid(&on, |body: &RigidBody, _| body.work()).unwrap_or_else(|| {
            let found = format!("= \"{}\": no rigid body has this name", self.body.value);
            scene.names.error(
                &self.body.place,
                found,
                "a rigid body; the work of supports and loads is energy = \"external\"",
            );
            None
        })
    }
}
