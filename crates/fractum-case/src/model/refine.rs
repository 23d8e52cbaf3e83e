//! Where the mesh is refined.

use crate::choice::choice;
use crate::{Field, Place, Spanned};

/// What becomes of rows of elements in a refined zone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rows {
    /// Inner nodes move at random, so that cracks find no rows to follow.
    Break,
    /// All nodes of the file stay, and new ones lie in the middle of edges.
    Keep,
}

choice!(Rows { "break" => Break, "keep" => Keep });

/// A part of the mesh in which elements become smaller.
#[derive(Debug, Clone, PartialEq)]
pub struct RefineZone {
    /// Where it stands in the case.
    pub place: Place,
    /// Where elements become smaller; everywhere where it is absent.
    pub condition: Option<Spanned<Field>>,
    /// The longest edge [m].
    pub size: f64,
    /// Seed of random moves of inner nodes, which break up rows; none where they stay.
    pub seed: Option<u64>,
}
