//! Exactly rounded operations of numbers that `core` lacks, under the names that the standard library gives them.

/// What the standard library adds to `f64`.
pub(crate) trait Exact {
    /// Square root.
    fn sqrt(self) -> Self;
    /// `self · a + b`, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// A power with a whole exponent ≥ 0, by the squares in which compilers write it.
    fn powi(self, exponent: i32) -> Self;
}

impl Exact for f64 {
    #[inline(always)]
    fn sqrt(self) -> f64 {
        libm::sqrt(self)
    }

    #[inline(always)]
    fn mul_add(self, a: f64, b: f64) -> f64 {
        libm::fma(self, a, b)
    }

    #[inline(always)]
    fn powi(self, exponent: i32) -> f64 {
        let (mut power, mut square, mut left) = (1.0, self, exponent.unsigned_abs());
        while left > 0 {
            if left & 1 == 1 {
                power *= square;
            }
            square *= square;
            left >>= 1;
        }
        power
    }
}
