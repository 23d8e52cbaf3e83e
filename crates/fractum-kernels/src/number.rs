use core::ops::{Add, Div, Mul, Sub};

use crate::{FOUR, Lane};

/// A number, or four side by side: formulas for both are written once and give each number the same bits.
pub trait Number: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> {
    /// The same value everywhere.
    fn splat(value: f64) -> Self;

    /// Square roots.
    fn sqrt(self) -> Self;

    /// A function of each value.
    fn map(self, of: impl Fn(f64) -> f64) -> Self;

    /// A function of each value and its like in `other`.
    fn with(self, other: Self, of: impl Fn(f64, f64) -> f64) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn splat(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        #[cfg(feature = "std")]
        return f64::sqrt(self);
        #[cfg(not(feature = "std"))]
        return crate::exact::Exact::sqrt(self);
    }

    #[inline(always)]
    fn map(self, of: impl Fn(f64) -> f64) -> f64 {
        of(self)
    }

    #[inline(always)]
    fn with(self, other: f64, of: impl Fn(f64, f64) -> f64) -> f64 {
        of(self, other)
    }
}

impl Number for Lane {
    #[inline(always)]
    fn splat(value: f64) -> Lane {
        Lane::splat(value)
    }

    #[inline(always)]
    fn sqrt(self) -> Lane {
        Lane::sqrt(self)
    }

    #[inline(always)]
    fn map(self, of: impl Fn(f64) -> f64) -> Lane {
        let mut out = [0.0; FOUR];
        for k in 0..FOUR {
            out[k] = of(self.0[k]);
        }
        Lane(out)
    }

    #[inline(always)]
    fn with(self, other: Lane, of: impl Fn(f64, f64) -> f64) -> Lane {
        let mut out = [0.0; FOUR];
        for k in 0..FOUR {
            out[k] = of(self.0[k], other.0[k]);
        }
        Lane(out)
    }
}
