use crate::Lane;

use super::Softening;

/// Stiffness that a cohesive phase field leaves at its value d, ω(d) = (1-d)^p / ((1-d)^p + a₁ d (1 + a₂ d + a₃ d²)).
///
/// The shape of the softening curve lies in p, a₂ and a₃; a₁ = 4 E G_f/(π b f_t²) in the strength and the length b. Its
/// curve in one dimension does not depend on b.
///
/// Wu, *J. Mech. Phys. Solids* 103 (2017) 72-99, eqs. (4.11) to (4.15); the a₃ of the source is ours over a₂.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Degradation {
    /// p = 2.5 instead of 2: an opening without end.
    endless: bool,
    a2: f64,
    a3: f64,
}

/// d above which ω is that of this value: an edge that has parted keeps a stiffness of rounding size.
const PARTED: f64 = 1.0 - 1e-7;

impl Degradation {
    /// The constants whose curve begins with the slope and ends at the opening of a softening curve.
    pub fn new(softening: Softening) -> Self {
        // Slope at the start over -f_t²/G_f, and last opening over G_f/f_t.
        let (slope, end) = match softening {
            Softening::Exponential => (1.0, None),
            Softening::Linear => (0.5, Some(2.0)),
            Softening::Bilinear { stress, opening } => ((1.0 - stress) / opening, Some((2.0 - opening) / stress)),
        };
        let p = if end.is_some() { 2.0 } else { 2.5 };
        let a2 = 2.0 * crate::elementary::cbrt(4.0 * slope * slope) - (p + 0.5);
        let a3 = end.map_or(0.0, |end| 0.125 * end * end - (1.0 + a2));
        Degradation { endless: end.is_none(), a2, a3 }
    }

    /// a₁ above which an unloaded point stays intact, so that b must be below 4/(π a₁) E G_f/f_t².
    ///
    /// With Y at its floor f_t²/2E the energy of a point without gradient, over f_t²/2E, is F(d) = ω(d) + ½ a₁ (2d - d²). With
    /// P = 1 + a₂ d + a₃ d², F(d) ≥ F(0) where a₁ ≥ B(d) = \[2P/(2 - d) - (1 - d)^p\]/(d P). Were some F(d) lower, a front of
    /// damage would run from any crack through the body without load. B(0) = a₂ + p + ½ = 2 (2 s)^(2/3) with the initial
    /// slope s of the softening curve over f_t²/G_f, and B(1) = 2; curves with a late kink have the largest B in between.
    pub fn least_a1(&self) -> f64 {
        const PARTS: u32 = 4096;
        let bound = |d: f64| {
            let (shape, [power, ..]) = (1.0 + d * (self.a2 + d * self.a3), self.powers(Lane::splat(d)));
            (2.0 * shape / (2.0 - d) - power.0[0]) / (d * shape)
        };
        let p = if self.endless { 2.5 } else { 2.0 };
        (1..=PARTS).map(|i| bound(f64::from(i) / f64::from(PARTS))).fold(self.a2 + p + 0.5, f64::max)
    }

    /// (1-d)^p and its derivatives.
    #[inline(always)]
    fn powers(&self, d: Lane) -> [Lane; 3] {
        let x = Lane::splat(1.0) - d;
        if self.endless {
            let root = x.sqrt();
            [x * x * root, Lane::splat(-2.5) * x * root, Lane::splat(3.75) * root]
        } else {
            [x * x, Lane::splat(-2.0) * x, Lane::splat(2.0)]
        }
    }

    /// ω.
    #[inline(always)]
    pub fn stiffness(&self, a1: f64, d: f64) -> f64 {
        let d = d.min(PARTED);
        let q = self.powers(Lane::splat(d))[0].0[0];
        q / (q + a1 * d * (1.0 + d * (self.a2 + d * self.a3)))
    }

    /// ω' and ω'' of four edges.
    #[inline(always)]
    pub fn derivatives(&self, a1: Lane, d: Lane) -> [Lane; 2] {
        let (a2, a3, of) = (Lane::splat(self.a2), Lane::splat(self.a3), Lane::splat);
        let d = d.min(of(PARTED));
        let [q, q1, q2] = self.powers(d);
        let r = a1 * d * (of(1.0) + d * (a2 + d * a3));
        let r1 = a1 * (of(1.0) + d * (of(2.0) * a2 + of(3.0) * d * a3));
        let r2 = a1 * (of(2.0) * a2 + of(6.0) * d * a3);
        let (sum, slope) = (q + r, q1 * r - q * r1);
        let square = sum * sum;
        [slope / square, (q2 * r - q * r2) / square - of(2.0) * slope * (q1 + r1) / (square * sum)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curve(softening: Softening) -> Degradation {
        Degradation::new(softening)
    }

    const ALL: [Softening; 3] = [Softening::Exponential, Softening::Linear, Softening::PETERSSON];

    /// Stress over f_t and opening over G_f/f_t of a bar that has localised to the largest value `top` of d.
    ///
    /// w = σ/E ∫ (1/ω - 1) dx along the profile of d, with the first integral b² (d')² = α(d) - φ(d) α(top)/φ(top),
    /// α = 2d - d² and φ = 1/ω - 1; d = top (1 - s²) takes the root out of the end.
    fn bar(law: Degradation, top: f64) -> (f64, f64) {
        let a1 = 20.0;
        let alpha = |d: f64| 2.0 * d - d * d;
        let phi = |d: f64| 1.0 / law.stiffness(a1, d) - 1.0;
        let lambda = alpha(top) / phi(top);
        let stress = (lambda * a1 / 2.0).sqrt();
        let steps = 4000;
        let term = |i: i32| {
            let s = (f64::from(i) + 0.5) / f64::from(steps);
            let d = top * (1.0 - s * s);
            phi(d) / (alpha(d) - phi(d) * lambda).sqrt() * 2.0 * top * s / f64::from(steps)
        };
        let integral: f64 = (0..steps).map(term).sum();
        // σ/E · 2 b ∫ over G_f/f_t, with b = 4 E G_f/(π a₁ f_t²).
        (stress, stress * 8.0 / (std::f64::consts::PI * a1) * integral)
    }

    #[test]
    fn exponential_curve_follows_the_exponential_law() {
        for (top, error) in [(0.02, 1e-3), (0.05, 1e-3), (0.1, 1e-3), (0.2, 1e-3), (0.3, 1.2e-3)] {
            let (stress, opening) = bar(curve(Softening::Exponential), top);
            if opening < 0.5 {
                assert!((stress / (-opening).exp() - 1.0).abs() < error, "{top}: {stress} at {opening}");
            }
        }
        let (stress, opening) = bar(curve(Softening::Exponential), 0.8);
        assert!(opening > 1.0 && (stress / (-opening).exp() - 1.0).abs() < 0.06, "{stress} at {opening}");
    }

    #[test]
    fn straight_curves_follow_their_lines() {
        for top in [0.05, 0.2, 0.5, 0.8] {
            let (stress, opening) = bar(curve(Softening::Linear), top);
            assert!((stress - (1.0 - 0.5 * opening)).abs() < 0.01, "{top}: {stress} at {opening}");
            let (stress, opening) = bar(curve(Softening::PETERSSON), top);
            let line = if opening < 0.8 { 1.0 - opening / 1.2 } else { (3.6 - opening) / 2.8 / 3.0 };
            assert!((stress - line).abs() < 0.1, "{top}: {stress} at {opening}");
        }
    }

    #[test]
    fn area_under_every_curve_is_the_fracture_energy() {
        for softening in ALL {
            let points: Vec<(f64, f64)> = (1..400).map(|i| bar(curve(softening), f64::from(i) / 400.0)).collect();
            let mut area = points[0].1 * 0.5 * (1.0 + points[0].0);
            area += points.windows(2).map(|p| 0.5 * (p[0].0 + p[1].0) * (p[1].1 - p[0].1)).sum::<f64>();
            assert!((area - 1.0).abs() < 0.01, "{softening:?}: {area}");
        }
    }

    #[test]
    fn least_a1_follows_from_the_initial_slope() {
        for (softening, slope, length) in [
            (Softening::Exponential, 1.0f64, 0.401),
            (Softening::PETERSSON, 5.0 / 6.0, 0.453),
            (Softening::Linear, 0.5, 0.637),
        ] {
            let least = curve(softening).least_a1();
            assert!((least / (2.0 * (2.0 * slope).powf(2.0 / 3.0)) - 1.0).abs() < 1e-9, "{softening:?}: {least}");
            assert!((4.0 / (std::f64::consts::PI * least) - length).abs() < 5e-4, "{softening:?}");
        }
    }

    proptest! {
        #[test]
        fn stiffness_falls_and_its_derivatives_are_those_of_differences(d in 1e-4f64..0.999, a1 in 1.5f64..500.0) {
            for softening in ALL {
                let law = curve(softening);
                prop_assert!((law.stiffness(a1, 0.0) - 1.0).abs() < 1e-15);
                let derivatives = |d| law.derivatives(Lane::splat(a1), Lane::splat(d)).map(|lane| lane.0[0]);
                let [first, second] = derivatives(d);
                let h = 1e-5 * d.min(1.0 - d);
                let [up, down] = [d + h, d - h].map(|d| (law.stiffness(a1, d), derivatives(d)[0]));
                prop_assert!(up.0 < down.0);
                prop_assert!((first - (up.0 - down.0) / (2.0 * h)).abs() < 1e-4 * first.abs());
                prop_assert!((second - (up.1 - down.1) / (2.0 * h)).abs() < 1e-4 * (second.abs() + first.abs() / d));
            }
        }
    }
}
