//! Exponentials, logarithms, powers and trigonometric functions: one implementation on every machine.
//!
//! Those of the standard library go to the C library, whose last bit depends on its version and on the instruction set
//! that it finds. These are the Rust port of musl's (crate `libm`): the same operations everywhere, with errors below
//! one unit in the last place. `sqrt`, `abs`, `floor`, `mul_add` and the other exactly rounded operations need no entry
//! here, nor does `powi`, which is a fixed sequence of products.

use crate::Number;

/// Arc cosine [rad], for −1 ≤ x ≤ 1; NaN outside.
#[inline]
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Arc sine [rad], for −1 ≤ x ≤ 1; NaN outside.
#[inline]
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Arc tangent [rad].
#[inline]
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// Angle of the point (x, y) with the x axis [rad], in [−π, π].
#[inline]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Cube root.
#[inline]
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// Cosine of an angle [rad].
#[inline]
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Chebyshev series of [`cos_of_third`] in t = √(2 + 2x) − 1, summed as a polynomial: coefficients of t⁴ᵏ to t⁴ᵏ⁺³ in row k.
const COS_OF_THIRD: [[f64; 4]; 5] = [
    [0.7660444431189779, 0.24740906632285342, -0.015509188436466538, 0.0024663528150652356],
    [-0.0005041246916553286, 0.00011642545332376988, -2.8919930996008654e-05, 7.541075528639302e-06],
    [-2.035896969136149e-06, 5.641644492145283e-07, -1.5946448920768576e-07, 4.5826101529351644e-08],
    [-1.3482454942697049e-08, 3.982274037822892e-09, -1.0522633347918922e-09, 3.092253983971399e-10],
    [-1.6368329253261365e-10, 5.1178745156550326e-11, 0.0, 0.0],
];

/// cos(⅓ arccos x) for −1 ≤ x ≤ 1: the largest root c of 4 c³ − 3 c = x, of which principal values are made.
///
/// It is analytic in √(1 + x) up to √(1 + x) = −√2: the Chebyshev series to t¹⁷ is exact to 5e-16, at a third of the cost of arc
/// cosine and cosine.
#[inline(always)]
pub fn cos_of_third<N: Number>(x: N) -> N {
    let two = N::splat(2.0);
    let t = (two + two * x).sqrt() - N::splat(1.0);
    let square = t * t;
    let fourth = square * square;
    let mut sum = [N::splat(0.0); 4];
    for row in COS_OF_THIRD.iter().rev() {
        for (sum, coefficient) in sum.iter_mut().zip(row) {
            *sum = *sum * fourth + N::splat(*coefficient);
        }
    }
    let [a, b, c, d] = sum;
    (a + b * t) + (c + d * t) * square
}

/// Hyperbolic cosine.
#[inline]
pub fn cosh(x: f64) -> f64 {
    libm::cosh(x)
}

/// eˣ.
#[inline]
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// eˣ − 1, accurate near zero.
#[inline]
pub fn exp_m1(x: f64) -> f64 {
    libm::expm1(x)
}

/// Gamma function Γ(x), for x > 0.
#[inline]
pub fn gamma(x: f64) -> f64 {
    libm::tgamma(x)
}

/// √(x² + y²) without overflow.
#[inline]
pub fn hypot(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}

/// Natural logarithm, for x > 0; NaN below zero.
#[inline]
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// Decimal logarithm, for x > 0; NaN below zero.
#[inline]
pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// xʸ.
#[inline]
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Sine of an angle [rad].
#[inline]
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Sine and cosine of an angle [rad].
#[inline]
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Hyperbolic sine.
#[inline]
pub fn sinh(x: f64) -> f64 {
    libm::sinh(x)
}

/// Tangent of an angle [rad].
#[inline]
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Hyperbolic tangent.
#[inline]
pub fn tanh(x: f64) -> f64 {
    libm::tanh(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    type OfOne = fn(f64) -> f64;
    type OfTwo = fn(f64, f64) -> f64;

    /// Against 60 digits, rounded to nearest: within one unit in the last place.
    #[test]
    fn values_are_exact_to_one_unit_in_the_last_place() {
        let of_one: [(OfOne, f64, f64); 14] = [
            (acos, 0.3, 1.2661036727794992),
            (asin, 0.7, 0.775397496610753),
            (atan, 2.5, 1.1902899496825317),
            (cbrt, 11.0, 2.2239800905693157),
            (cos, 1.1, 0.4535961214255773),
            (cosh, 1.7, 2.828315457889967),
            (exp, -3.3, 0.036883167401240015),
            (exp_m1, 0.001, 0.0010005001667083417),
            (ln, 7.7, 2.0412203288596382),
            (log10, 0.02, -1.6989700043360187),
            (sin, 22.0, -0.008851309290403876),
            (sinh, 0.4, 0.4107523258028155),
            (tan, 0.9, 1.2601582175503392),
            (tanh, 0.6, 0.5370495669980353),
        ];
        let of_two: [(OfTwo, [f64; 2], f64); 3] = [
            (pow, [0.37, 1.0 / 12.0], 0.9204852005013249),
            (hypot, [0.3, -0.7], 0.7615773105863908),
            (atan2, [0.3, -0.7], 2.7367008673047097),
        ];
        let close = |value: f64, exact: f64| value.to_bits().abs_diff(exact.to_bits()) <= 1;
        for (k, (f, x, exact)) in of_one.into_iter().enumerate() {
            assert!(close(f(x), exact), "row {k}: {} {exact}", f(x));
        }
        for (k, (f, [x, y], exact)) in of_two.into_iter().enumerate() {
            assert!(close(f(x, y), exact), "row {k}: {} {exact}", f(x, y));
        }
        assert_eq!(sin_cos(1.1), (sin(1.1), cos(1.1)));
        let of_third = [
            (-1.0, 0.5),
            (-0.9375, 0.5988565086814718),
            (-4095.0 / 4096.0, 0.5063653877828457),
            (-0.5, 0.766044443118978),
            (0.0, 0.8660254037844386),
            (0.3, 0.9122574389279367),
            (0.9, 0.9887198717411111),
            (1.0, 1.0),
        ];
        for (x, exact) in of_third {
            assert!((cos_of_third(x) - exact).abs() < 5e-16, "{x}: {} {exact}", cos_of_third(x));
        }
    }
}
