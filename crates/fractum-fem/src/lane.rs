//! Four doubles side by side: a vector padded to the width of an AVX register.

use fractum_math::Vec3;

#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub(crate) struct Lane(pub(crate) [f64; 4]);

impl Lane {
    pub(crate) const ZERO: Lane = Lane([0.0; 4]);

    #[inline(always)]
    pub(crate) fn from_vec(v: &Vec3) -> Lane {
        Lane([v.x, v.y, v.z, 0.0])
    }

    #[inline(always)]
    pub(crate) fn to_vec(self) -> Vec3 {
        Vec3::new(self.0[0], self.0[1], self.0[2])
    }

    #[inline(always)]
    pub(crate) fn add(self, b: Lane) -> Lane {
        Lane(std::array::from_fn(|i| self.0[i] + b.0[i]))
    }

    #[inline(always)]
    pub(crate) fn sub(self, b: Lane) -> Lane {
        Lane(std::array::from_fn(|i| self.0[i] - b.0[i]))
    }

    /// `self + a · factor`, rounded once: the same bits whether the processor or the C library does it.
    #[inline(always)]
    pub(crate) fn plus(self, a: Lane, factor: f64) -> Lane {
        Lane(std::array::from_fn(|i| a.0[i].mul_add(factor, self.0[i])))
    }
}
