//! What has left the domain of a run, as columns of the history.

use fractum_scene::Left;

/// Names and units.
pub(crate) const COLUMNS: [(&str, &str); 5] = [
    ("left_pieces", "1"),
    ("left_mass", "kg"),
    ("left_momentum_x", "N s"),
    ("left_momentum_y", "N s"),
    ("left_momentum_z", "N s"),
];

/// Their values.
pub(crate) fn values(left: &Left) -> [f64; 5] {
    [left.pieces as f64, left.mass, left.momentum.x, left.momentum.y, left.momentum.z]
}
