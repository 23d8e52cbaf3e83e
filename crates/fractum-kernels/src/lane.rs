use core::ops::{Add, Div, Mul, Sub};

use crate::Vec3;
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// How many cells, edges or tensors go side by side: as many as a [`Lane`] has values.
pub const FOUR: usize = 4;

/// Four doubles side by side, as wide as an AVX register: a padded vector, or one number of each of four tensors.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C, align(32))]
pub struct Lane(pub [f64; FOUR]);

impl Lane {
    /// Zeros.
    pub const ZERO: Lane = Lane([0.0; 4]);

    /// The same value four times.
    #[inline(always)]
    pub fn splat(value: f64) -> Lane {
        Lane([value; 4])
    }

    /// A vector, and a zero.
    #[inline(always)]
    pub fn from_vec(v: &Vec3) -> Lane {
        Lane([v.x, v.y, v.z, 0.0])
    }

    /// The first three values.
    #[inline(always)]
    pub fn to_vec(self) -> Vec3 {
        Vec3::new(self.0[0], self.0[1], self.0[2])
    }

    /// `self + a · factor`, rounded once: the same bits whether the processor or the C library does it.
    #[inline(always)]
    pub fn plus(self, a: Lane, factor: f64) -> Lane {
        Lane(core::array::from_fn(|i| a.0[i].mul_add(factor, self.0[i])))
    }

    /// `self + a · b`, rounded once.
    #[inline(always)]
    pub fn plus_product(self, a: Lane, b: Lane) -> Lane {
        Lane(core::array::from_fn(|i| a.0[i].mul_add(b.0[i], self.0[i])))
    }

    /// Square roots.
    #[inline(always)]
    pub fn sqrt(self) -> Lane {
        Lane(self.0.map(f64::sqrt))
    }

    /// The smaller values; the other ones where one is no number.
    #[inline(always)]
    pub fn min(self, other: Lane) -> Lane {
        Lane(core::array::from_fn(|i| if self.0[i] < other.0[i] { self.0[i] } else { other.0[i] }))
    }

    /// The larger values; the other ones where one is no number.
    #[inline(always)]
    pub fn max(self, other: Lane) -> Lane {
        Lane(core::array::from_fn(|i| if self.0[i] > other.0[i] { self.0[i] } else { other.0[i] }))
    }

    /// Values of `yes` where `condition` holds, of `no` elsewhere.
    #[inline(always)]
    pub fn choose(condition: [bool; 4], yes: Lane, no: Lane) -> Lane {
        Lane(core::array::from_fn(|i| if condition[i] { yes.0[i] } else { no.0[i] }))
    }
}

macro_rules! lane_by_lane {
    ($($trait:ident $method:ident $operator:tt),*) => {$(
        impl $trait for Lane {
            type Output = Lane;
            #[inline(always)]
            fn $method(self, other: Lane) -> Lane {
                Lane(core::array::from_fn(|i| self.0[i] $operator other.0[i]))
            }
        }
    )*};
}

lane_by_lane!(Add add +, Sub sub -, Mul mul *, Div div /);
