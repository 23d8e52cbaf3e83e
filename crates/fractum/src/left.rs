//! What has left the domain of a run, as columns of the history.

use fractum_scene::Left;

/// Values of the columns, in their order.
pub(crate) fn values(left: &Left) -> [f64; 5] {
    [left.pieces as f64, left.mass, left.momentum.x, left.momentum.y, left.momentum.z]
}
