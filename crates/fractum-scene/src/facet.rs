//! Facets under pressure.

use fractum_math::Vec3;

/// Area of a facet under pressure over that without load, at most. Facets of a crushed wall join particles that fly apart: they would grow, be
/// pushed the more and grow the faster, without any limit. Sound rock breaks far below such strains.
const LARGEST_STRETCH: f64 = 2.0;

/// The part of a facet's area that pressure acts on: all of it up to twice that without load, and no more than this beyond.
///
/// - `area`, `reference`: area vectors at present and without load [m²]
pub(crate) fn share_of_torn(area: &Vec3, reference: &Vec3) -> f64 {
    (LARGEST_STRETCH * reference.norm() / area.norm()).min(1.0)
}
