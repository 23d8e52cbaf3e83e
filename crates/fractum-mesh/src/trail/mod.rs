//! The trail of a crack through a plane mesh: the ridge of damage that a run has left, and a mesh whose edges follow it.

mod chain;
mod ridge;
mod ways;

pub use chain::SplitError;
pub use ridge::{Ridge, RidgeError, Spot, ridge};

/// A place in the plane.
type Place = [f64; 2];

fn minus(a: Place, b: Place) -> Place {
    [a[0] - b[0], a[1] - b[1]]
}

/// The place a way along a direction.
fn ahead(from: Place, direction: Place, way: f64) -> Place {
    [from[0] + way * direction[0], from[1] + way * direction[1]]
}

fn dot(a: Place, b: Place) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: Place, b: Place) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn length(a: Place) -> f64 {
    dot(a, a).sqrt()
}

/// The direction of a vector; none where it has no length.
fn unit(a: Place) -> Option<Place> {
    let long = length(a);
    (long > 0.0).then(|| [a[0] / long, a[1] / long])
}

/// Lengths of a line of points up to each of them.
fn lengths(points: &[Place]) -> Vec<f64> {
    let mut sum = 0.0;
    let steps = points.windows(2).map(|pair| length(minus(pair[1], pair[0])));
    std::iter::once(0.0)
        .chain(steps.map(|step| {
            sum += step;
            sum
        }))
        .collect()
}

/// The point of a line that is nearest to a place, and how far away it is.
fn nearest(points: &[Place], at: Place) -> (Place, f64) {
    let on = |pair: &[Place]| {
        let along = minus(pair[1], pair[0]);
        let square = dot(along, along);
        let share = if square > 0.0 { (dot(minus(at, pair[0]), along) / square).clamp(0.0, 1.0) } else { 0.0 };
        let on = ahead(pair[0], along, share);
        (on, length(minus(at, on)))
    };
    points.windows(2).map(on).min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((at, f64::INFINITY))
}
