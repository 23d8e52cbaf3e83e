//! A box that repeats along its edges.

use fractum_math::Vec3;

/// A box that repeats along x, y and z.
#[derive(Clone, Copy, Debug)]
pub struct Period {
    lower: Vec3,
    size: Vec3,
}

impl Period {
    /// - `lower`, `upper` [m]: corners of the box
    pub(crate) fn new(lower: Vec3, upper: Vec3) -> Self {
        Period { lower, size: upper - lower }
    }

    /// The shortest of the vectors to the images of what is `apart` [m].
    #[inline]
    pub fn nearest(&self, apart: Vec3) -> Vec3 {
        Vec3::from_fn(|axis, _| apart[axis] - self.size[axis] * (apart[axis] / self.size[axis]).round())
    }

    /// The image of a place that lies in the box [m].
    pub fn within(&self, place: &Vec3) -> Vec3 {
        let inside = |axis: usize| {
            let part = (place[axis] - self.lower[axis]) / self.size[axis];
            place[axis] - self.size[axis] * part.floor()
        };
        Vec3::from_fn(|axis, _| inside(axis))
    }

    /// The images of a place in the box that come within a distance of the box, itself among them [m].
    pub(crate) fn images(&self, place: Vec3, reach: f64) -> impl Iterator<Item = Vec3> {
        let Period { lower, size } = *self;
        let shifts = move |axis: usize| {
            let depth = place[axis] - lower[axis];
            let [up, down] = [(depth < reach, 1.0), (depth > size[axis] - reach, -1.0)];
            [up, down].into_iter().filter(|(is_near, _)| *is_near).map(|(_, sign)| sign).chain([0.0])
        };
        shifts(0).flat_map(move |x| {
            shifts(1).flat_map(move |y| shifts(2).map(move |z| place + Vec3::new(x * size.x, y * size.y, z * size.z)))
        })
    }
}
