//! Ties between bonded bodies and solids.

use crate::Spanned;

/// Particles of a bonded body that follow the surface of a solid where they touch it.
#[derive(Debug, Clone, PartialEq)]
pub struct Tie {
    /// A solid body, or a mesh group of facets on the surface of one.
    pub solid: Spanned<String>,
    /// A bonded body, or a set of its particles.
    pub bonded: Spanned<String>,
    /// Largest gap between particle and facet [m], > 0; `None` = a tenth of the mean radius.
    pub within: Option<f64>,
}
