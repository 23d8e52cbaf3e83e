//! What a run has lost so far.

use fractum_scene::{Counts, Scene};

/// How many elements and bonds are gone: as none comes back, equal numbers are the same ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Gone {
    /// Removed elements, with those that have left the domain.
    pub(crate) elements: usize,
    bonds: usize,
}

impl Gone {
    /// At present.
    pub(crate) fn at(scene: &Scene, counts: &Counts) -> Self {
        Gone { elements: counts.removed_elements + scene.left().elements, bonds: counts.broken_bonds }
    }
}
