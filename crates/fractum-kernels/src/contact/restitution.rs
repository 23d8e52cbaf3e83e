use core::f64::consts::PI;

use crate::elementary::{asin, exp, ln, tan};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Restitution of a contact with damping ratio ζ whose force never pulls: the contact ends where spring and damper
/// balance.
///
/// For the linear spring (c = 2 ζ √(m k)) it follows from the damped oscillator cut off at zero force (Schwager and
/// Pöschel 2007, eq. 21), which with ζ = sin α is e = exp(-(π - 2 α) tan α). Hertz' law with c = √5 ζ √(m k_h) δ^¼ has
/// the very same e(ζ): with u ∝ δ^(5/4) as coordinate its motion is that of the linear oscillator, zero force included.
/// Strictly decreasing from 1 at ζ = 0; e⁻² at ζ = 1; valid for every ζ ≥ 0.
#[inline]
pub fn restitution_of_damping(ratio: f64) -> f64 {
    if ratio < 1.0 - 1e-9 {
        let alpha = asin(ratio);
        exp(-(PI - 2.0 * alpha) * tan(alpha))
    } else if ratio > 1.0 + 1e-9 {
        let w = (ratio * ratio - 1.0).sqrt();
        // ln((ζ + w)/(ζ - w)) = 2 ln(ζ + w), since (ζ + w)(ζ - w) = 1.
        exp(-2.0 * ratio / w * ln(ratio + w))
    } else {
        exp(-2.0)
    }
}

/// Damping ratio ζ that gives a restitution in (0, 1]: the inverse of [`restitution_of_damping`].
///
/// Restitutions below 1e-6 count as 1e-6; values above 1 as 1.
#[inline]
pub fn damping_of_restitution(restitution: f64) -> f64 {
    let target = restitution.clamp(1e-6, 1.0);
    if target == 1.0 {
        return 0.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    while restitution_of_damping(high) > target {
        (low, high) = (high, 2.0 * high);
    }
    // Bisection to the last bit.
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return middle;
        }
        if restitution_of_damping(middle) > target {
            low = middle;
        } else {
            high = middle;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_gives_back_every_restitution() {
        for k in 1..=100 {
            let e = 0.01 * k as f64;
            let back = restitution_of_damping(damping_of_restitution(e));
            assert!((back - e).abs() < 1e-9, "{e} came back as {back}");
        }
        assert_eq!(damping_of_restitution(1.0), 0.0);
    }

    #[test]
    fn it_is_continuous_through_critical_damping() {
        for ratio in [0.9999999, 1.0, 1.0000001] {
            assert!((restitution_of_damping(ratio) - (-2.0f64).exp()).abs() < 1e-6);
        }
    }
}
