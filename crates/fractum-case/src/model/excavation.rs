//! Bodies that stages take out.

use crate::{Place, Spanned};

/// What a stage takes out, and how the forces that it bore fade.
#[derive(Debug, Clone, PartialEq)]
pub struct Excavation {
    /// Where it stands in the case.
    pub place: Place,
    /// Names of the solids that leave as the stage begins.
    pub bodies: Vec<Spanned<String>>,
    /// Time over which the forces fade [s], ≥ 0; to the end of the stage where none is given.
    pub release: Option<Spanned<f64>>,
    /// Part of the forces that fades in this stage, within 0..=1; the rest goes in the next one.
    pub share: f64,
    /// Names of all solids that have left by then.
    pub gone: Vec<String>,
}

impl Excavation {
    /// That of a stage in which nothing leaves.
    pub(crate) fn nothing(place: Place) -> Self {
        Excavation { place, bodies: Vec::new(), release: None, share: 1.0, gone: Vec::new() }
    }
}
