//! From positions in space to positions in the picture.

use super::{Picture, SUPERSAMPLING, View};

/// Empty border, as a share of the picture's smaller side.
const MARGIN: f64 = 0.03;

/// A parallel projection. Picture coordinates are in samples: x to the right, y downwards, depth away from the eye.
pub(super) struct Camera {
    right: [f64; 3],
    up: [f64; 3],
    forward: [f64; 3],
    /// Samples per metre.
    pub(super) scale: f64,
    shift: [f64; 2],
}

impl Camera {
    /// A camera that has the view's frame, or else all of the picture, in its image; `None` without a direction.
    pub(super) fn new(view: &View, picture: &Picture) -> Option<Self> {
        let forward = unit(view.direction)?;
        // Without a usable up, the axis most across the direction takes its place.
        let right = unit(cross(forward, view.up))
            .filter(|_| view.up.iter().all(|x| x.is_finite()) && sine(forward, view.up) > 1e-6)
            .or_else(|| {
                let across = (0..3).min_by(|&a, &b| forward[a].abs().total_cmp(&forward[b].abs()))?;
                let mut axis = [0.0; 3];
                axis[across] = 1.0;
                unit(cross(forward, axis))
            })?;
        let up = cross(right, forward);
        let mut camera = Self { right, up, forward, scale: 1.0, shift: [0.0; 2] };

        let mut bounds = Bounds::default();
        let mut include = |point: [f64; 3], radius: f64| {
            let [x, y, _] = camera.project(point);
            bounds.include(x - radius, y - radius);
            bounds.include(x + radius, y + radius);
        };
        match view.frame {
            Some((low, high)) => {
                for corner in 0..8 {
                    let pick = |axis: usize| if corner >> axis & 1 == 0 { low[axis] } else { high[axis] };
                    include([pick(0), pick(1), pick(2)], 0.0);
                }
            }
            None => {
                for surface in picture.surfaces {
                    for &node in surface.triangles.as_flattened() {
                        include(surface.points[node as usize], 0.0);
                    }
                }
                for spheres in picture.spheres {
                    spheres.centres.iter().zip(spheres.radii).for_each(|(&centre, &radius)| include(centre, radius));
                }
            }
        }
        let [width, height] = [view.width, view.height].map(|size| (size * SUPERSAMPLING) as f64);
        let border = MARGIN * width.min(height);
        let (centre, [extent_x, extent_y]) = bounds.centre_and_extent();
        let fit = |size: f64, extent: f64| (size - 2.0 * border) / extent;
        let scale = fit(width, extent_x).min(fit(height, extent_y));
        camera.scale = if scale.is_finite() && scale > 0.0 { scale } else { 1.0 };
        camera.shift = [0.5 * width - camera.scale * centre[0], 0.5 * height - camera.scale * centre[1]];
        Some(camera)
    }

    /// Where the axes point in the picture: right and down.
    pub(super) fn axes(&self) -> [[f64; 2]; 3] {
        [0, 1, 2].map(|axis| [self.right[axis], -self.up[axis]])
    }

    /// Position of `point` in the picture.
    pub(super) fn project(&self, point: [f64; 3]) -> [f64; 3] {
        let Self { right, up, forward, scale, shift } = self;
        [scale * dot(*right, point) + shift[0], shift[1] - scale * dot(*up, point), scale * dot(*forward, point)]
    }
}

struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Default for Bounds {
    fn default() -> Self {
        Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] }
    }
}

impl Bounds {
    fn include(&mut self, x: f64, y: f64) {
        if x.is_finite() && y.is_finite() {
            self.low = [self.low[0].min(x), self.low[1].min(y)];
            self.high = [self.high[0].max(x), self.high[1].max(y)];
        }
    }

    fn centre_and_extent(&self) -> ([f64; 2], [f64; 2]) {
        let Self { low, high } = self;
        if low[0] > high[0] {
            return ([0.0; 2], [0.0; 2]);
        }
        ([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])], [high[0] - low[0], high[1] - low[1]])
    }
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `a` with length one; `None` if it has no direction.
pub(super) fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    // Scaled first: the square of a tiny or huge length is out of range.
    let largest = a.iter().fold(0.0, |largest: f64, x| largest.max(x.abs()));
    let a = a.map(|x| x / largest);
    let length = dot(a, a).sqrt();
    (length.is_finite() && length > 0.0).then(|| a.map(|x| x / length))
}

fn sine(a: [f64; 3], b: [f64; 3]) -> f64 {
    let across = cross(a, b);
    (dot(across, across) / (dot(a, a) * dot(b, b))).sqrt()
}
