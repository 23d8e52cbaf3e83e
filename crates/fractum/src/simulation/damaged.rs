//! Where damage came in a run.

use std::fs;
use std::path::Path;

use fractum_case::Case;
use fractum_case::model::BodyKind;
use fractum_fem::crack_scale;
use fractum_fem::fields::damaged_elements;
use fractum_output::atomic;
use fractum_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::error::Failure;

/// File of a run with where damage came.
const FILE: &str = "damaged.json";

/// Mean damage of the edges of an element from which on it is damaged: a crack through an element has more.
const DAMAGED: f64 = 0.3;

/// Where damage came in a run.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Damaged {
    /// Process zone and smallest extent in series, the least of the bodies that are damaged [m].
    pub(crate) length: f64,
    /// Centres and sizes of the damaged elements [m], and their damage.
    pub(crate) elements: Vec<[f64; 5]>,
}

impl Damaged {
    /// What the last state of a run tells.
    ///
    /// - `case`: any stage of it
    pub(crate) fn of(scene: &Scene, case: &Case) -> Self {
        let mut found = Damaged { length: f64::INFINITY, elements: Vec::new() };
        for index in 0..scene.solid.body_count() {
            let body = scene.solid.body(index);
            let elements = damaged_elements(&scene.solid, index, DAMAGED);
            if elements.is_empty() {
                continue;
            }
            let own = case.bodies.iter().find(|own| own.name.value == body.name);
            let zone = own.and_then(|own| match &own.kind {
                BodyKind::Solid(solid) => case.materials[solid.material].process_zone(),
                _ => None,
            });
            let extent = body.smallest_extent(&scene.solid.reference);
            let length = crack_scale(zone.unwrap_or(f64::INFINITY), extent);
            found.length = found.length.min(length);
            found.elements.extend(elements.into_iter().map(|(at, size, damage)| [at.x, at.y, at.z, size, damage]));
        }
        found
    }

    pub(crate) fn write(&self, folder: &Path) -> Result<(), Failure> {
        let text = serde_json::to_string(self).unwrap_or_default();
        Ok(atomic::write(&folder.join(FILE), text.as_bytes())?)
    }

    /// That of a run that has ended; nothing where it has left none.
    pub(crate) fn read(folder: &Path) -> Self {
        fs::read(folder.join(FILE)).ok().and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default()
    }

    /// Mean size of the elements [m]; NaN where there are none.
    pub(crate) fn size(&self) -> f64 {
        self.elements.iter().map(|element| element[3]).sum::<f64>() / self.elements.len() as f64
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.elements.is_empty()
    }
}
