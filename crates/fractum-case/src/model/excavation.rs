//! Bodies that stages take out and put in.

use crate::{Place, Spanned};

/// What a stage takes out and puts in, and how the forces that it bore fade.
#[derive(Debug, Clone, PartialEq)]
pub struct Excavation {
    /// Where it stands in the case.
    pub place: Place,
    /// Names of the solids that leave as the stage begins.
    pub bodies: Vec<Spanned<String>>,
    /// Names of the solids that come in then.
    pub installed: Vec<Spanned<String>>,
    /// Time over which the forces fade [s], ≥ 0; to the end of the stage where none is given.
    pub release: Option<Spanned<f64>>,
    /// Part of the forces that fades in this stage, within 0..=1; the rest goes in the next one.
    pub share: f64,
    /// Names of all solids that have left by then, or have not come in yet.
    pub gone: Vec<String>,
    /// Names of the solids that come in then or later.
    pub to_come: Vec<String>,
}

impl Excavation {
    /// That of a stage in which nothing leaves or comes in.
    pub(crate) fn nothing(place: Place) -> Self {
        Excavation {
            place,
            bodies: Vec::new(),
            installed: Vec::new(),
            release: None,
            share: 1.0,
            gone: Vec::new(),
            to_come: Vec::new(),
        }
    }
}
