//! The slowest vibrations beside rigid motions and mechanisms, whatever vibrates.

use fractum_math::Vec3;
use fractum_sparse::{Search, SparseError};

/// Residuals at which a vibration is accepted: with a factorisation, and with an iterative solver.
pub(super) const TOLERANCES: [f64; 2] = [1e-6, 1e-5];
/// Shift of a singular stiffness over the square of the time that a wave takes across the bodies: far below the slowest
/// vibration of any but the most slender body, and far above the rounding of the largest one.
const SHIFT: f64 = 1e-6;
/// Eigenvalue over the same square below which a motion counts as one without stiffness.
const NO_STIFFNESS: f64 = 1e-10;
/// Extensions of the basis after which the search ends.
const MOST_EXTENSIONS: usize = 400;

/// Eigenpairs with the motion of every node or particle.
pub(super) struct Found<Shape> {
    pub(super) values: Vec<f64>,
    pub(super) shapes: Vec<Shape>,
    pub(super) residuals: Vec<f64>,
    pub(super) extensions: usize,
    pub(super) converged: bool,
}

/// Vibrations in a second.
pub(super) fn frequency(square: f64) -> f64 {
    square.max(0.0).sqrt() / (2.0 * std::f64::consts::PI)
}

/// The slowest vibrations beside motions without stiffness, and how many of these there are beside the rigid ones.
///
/// - `rigid`: rigid motions
/// - `rate`: square of the speed of a wave over the size of the bodies [1/s²]
/// - `wanted`: number of vibrations, tolerance, and whether to give up
/// - `lowest`: the slowest ones beside known motions, with a shift [1/s²]
pub(super) fn find_with_stiffness<Shape>(
    mut rigid: Vec<Shape>,
    rate: f64,
    (count, tolerance, stop): (usize, f64, fn() -> bool),
    mut lowest: impl FnMut(&[Shape], f64, Search) -> Result<Found<Shape>, SparseError>,
) -> Result<(Found<Shape>, usize), SparseError> {
    let known = rigid.len();
    let search = Search { count, tolerance, small: SHIFT * rate, most: MOST_EXTENSIONS, stop };
    loop {
        let shift = if rigid.is_empty() { 0.0 } else { SHIFT * rate };
        let found = match lowest(&rigid, shift, search) {
            Err(SparseError::Indefinite { .. }) if shift == 0.0 => lowest(&rigid, SHIFT * rate, search)?,
            found => found?,
        };
        let loose = found.values.iter().take_while(|value| **value < NO_STIFFNESS * rate).count();
        if loose == 0 || !found.converged {
            return Ok((found, rigid.len() - known));
        }
        rigid.extend(found.shapes.into_iter().take(loose));
    }
}

/// Diagonal of the box around points [m].
pub(super) fn size(points: &[Vec3]) -> f64 {
    let low = points.iter().fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
    let high = points.iter().fold(Vec3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
    (high - low).norm()
}
