//! Exponentials, logarithms, powers and trigonometric functions: one implementation on every machine.
//!
//! Those of the standard library go to the C library, whose last bit depends on its version and on the instruction set
//! that it finds. These are the Rust port of musl's (crate `libm`): the same operations everywhere, with errors below
//! one unit in the last place. `sqrt`, `abs`, `floor`, `mul_add` and the other exactly rounded operations need no entry
//! here, nor does `powi`, which is a fixed sequence of products.

/// Arc cosine [rad], for −1 ≤ x ≤ 1; NaN outside.
pub fn acos(x: f64) -> f64 {
    libm::acos(x)
}

/// Arc sine [rad], for −1 ≤ x ≤ 1; NaN outside.
pub fn asin(x: f64) -> f64 {
    libm::asin(x)
}

/// Arc tangent [rad].
pub fn atan(x: f64) -> f64 {
    libm::atan(x)
}

/// Angle of the point (x, y) with the x axis [rad], in [−π, π].
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}

/// Cube root.
pub fn cbrt(x: f64) -> f64 {
    libm::cbrt(x)
}

/// Cosine of an angle [rad].
pub fn cos(x: f64) -> f64 {
    libm::cos(x)
}

/// Hyperbolic cosine.
pub fn cosh(x: f64) -> f64 {
    libm::cosh(x)
}

/// eˣ.
pub fn exp(x: f64) -> f64 {
    libm::exp(x)
}

/// eˣ − 1, accurate near zero.
pub fn exp_m1(x: f64) -> f64 {
    libm::expm1(x)
}

/// √(x² + y²) without overflow.
pub fn hypot(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}

/// Natural logarithm, for x > 0; NaN below zero.
pub fn ln(x: f64) -> f64 {
    libm::log(x)
}

/// Decimal logarithm, for x > 0; NaN below zero.
pub fn log10(x: f64) -> f64 {
    libm::log10(x)
}

/// xʸ.
pub fn pow(x: f64, y: f64) -> f64 {
    libm::pow(x, y)
}

/// Sine of an angle [rad].
pub fn sin(x: f64) -> f64 {
    libm::sin(x)
}

/// Sine and cosine of an angle [rad].
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Hyperbolic sine.
pub fn sinh(x: f64) -> f64 {
    libm::sinh(x)
}

/// Tangent of an angle [rad].
pub fn tan(x: f64) -> f64 {
    libm::tan(x)
}

/// Hyperbolic tangent.
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
    }
}
