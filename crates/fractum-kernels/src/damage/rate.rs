//! Strength and fracture energy that grow with the rate of strain.

use serde::{Deserialize, Serialize};

use crate::Sym3;
use crate::elementary::{exp, ln};
#[cfg(not(feature = "std"))]
use crate::exact::Exact as _;

/// Part of the strength by which an equivalent stress that stays within it counts as held.
const HELD: f64 = 0.05;

/// Factor at a rate of strain: a power of the rate between points, and constant before the first and after the last.
///
/// - `points`: rates [1/s], above zero and ascending, and the factors there; without points the factor is 1
pub fn rate_factor(points: &[[f64; 2]], rate: f64) -> f64 {
    let next = points.partition_point(|point| point[0] <= rate);
    match (points.get(next.wrapping_sub(1)), points.get(next)) {
        // Ratios, so that no unit of time has a part in it.
        (Some([r0, f0]), Some([r1, f1])) => f0 * exp(ln(f1 / f0) * (ln(rate / r0) / ln(r1 / r0))),
        (Some([_, factor]), None) | (None, Some([_, factor])) => *factor,
        (None, None) => 1.0,
    }
}

/// How a material grows stronger with the rate of strain; curves as in [`rate_factor`].
#[derive(Clone, Copy, Debug)]
pub struct RateLaw<'a> {
    /// Factor on the tensile strength.
    pub strength: &'a [[f64; 2]],
    /// Factor on the compressive strength, and this strength over the tensile one; none where the criterion has no strength in compression.
    pub compression: Option<(&'a [[f64; 2]], f64)>,
    /// Factor on the fracture energy.
    pub energy: &'a [[f64; 2]],
    /// Part of the strength from which on the rate is measured: half, or less where a curve begins lower.
    pub watched: f64,
}

/// An edge without damage in a step of motion.
#[derive(Clone, Copy, Debug)]
pub struct Waiting {
    /// Strength at rest [Pa].
    pub strength: f64,
    /// Modulus that turns its equivalent stress into a strain [Pa].
    pub modulus: f64,
    /// Characteristic length over the one at which softening at rest snaps back, and the largest such ratio that rate may bring about.
    pub length_ratio: [f64; 2],
    /// The clock, which began at zero [s].
    pub now: f64,
    /// Last step [s].
    pub dt: f64,
}

/// What an edge keeps of its loading until damage begins, and from then on of the strength with which it began.
///
/// The rate is the mean growth of the equivalent stress over Young's modulus, from the last instant at which the stress was within a twentieth of the
/// strength above its least value beyond the watched part, to the present. It decides when the strength is reached, and stays as it was then.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct EdgeRate {
    /// When its stress was last beyond the watched part of the strength [s]; −∞ before.
    seen: f64,
    /// Least stress since it has been so [Pa].
    low: f64,
    /// When the stress began to grow [s], and that stress [Pa].
    grows: [f64; 2],
    /// Strength [Pa]: at rest until damage begins.
    pub strength: f64,
    /// Factor on the fracture energy.
    pub energy: f64,
    /// Rate of strain at the onset of damage [1/s]; negative before.
    pub rate: f64,
    /// Whether it would be stronger if its elements were smaller.
    pub is_limited: bool,
}

impl EdgeRate {
    /// An edge that nothing has happened to yet.
    ///
    /// - `strength`: at rest [Pa]
    pub fn intact(strength: f64) -> Self {
        EdgeRate {
            seen: f64::NEG_INFINITY,
            low: 0.0,
            grows: [0.0; 2],
            strength,
            energy: 1.0,
            rate: -1.0,
            is_limited: false,
        }
    }

    /// Lets an edge without damage see an equivalent stress `q` beyond the watched part of its strength [Pa]; whether its damage begins.
    ///
    /// - `stress`: of the edge, whose parts in tension and compression tell which strength counts [Pa]
    pub fn begins(&mut self, law: &RateLaw<'_>, edge: &Waiting, stress: Sym3, q: f64) -> bool {
        let &Waiting { strength, modulus, now, dt, .. } = edge;
        let is_new = now - self.seen > 1.5 * dt;
        self.seen = now;
        self.low = if is_new { q } else { self.low.min(q) };
        let is_held = q <= self.low + HELD * strength;
        let growth = match (is_new, is_held) {
            // The step came from below the watched part.
            (true, _) if dt > 0.0 => (q - law.watched * strength) / dt,
            (false, false) if now > self.grows[0] => (q - self.grows[1]) / (now - self.grows[0]),
            // Held, or at rest.
            _ => 0.0,
        };
        if is_held {
            self.grows = [now, q];
        }
        let rate = growth / modulus;
        let (factor, rate) = match law.compression {
            None => (rate_factor(law.strength, rate), rate),
            Some((curve, ratio)) => {
                let tension = share_in_tension(stress);
                let rate = rate * (tension + (1.0 - tension) * ratio);
                (tension * rate_factor(law.strength, rate) + (1.0 - tension) * rate_factor(curve, rate), rate)
            }
        };
        let energy = rate_factor(law.energy, rate);
        // The length at which softening snaps back goes with the energy over the square of the strength.
        let [ratio, most] = edge.length_ratio;
        let possible = (energy * most / ratio).sqrt();
        let counted = factor.min(possible);
        if q <= counted * strength {
            return false;
        }
        (self.strength, self.energy, self.rate, self.is_limited) =
            (counted * strength, energy, rate, factor > possible);
        true
    }
}

/// Part of the principal stresses that is tension, 0 to 1.
fn share_in_tension(stress: Sym3) -> f64 {
    let (mut tension, mut all) = (0.0, 0.0);
    for value in stress.principal_values() {
        tension += value.max(0.0);
        all += value.abs();
    }
    if all > 0.0 { tension / all } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const E: f64 = 30e9;
    const STRENGTH: f64 = 3e6;

    /// (rate/1e-6)^0.1 to 1e4 /s.
    const CURVE: [[f64; 2]; 2] = [[1e-6, 1.0], [1e4, 10.0]];

    fn law() -> RateLaw<'static> {
        RateLaw { strength: &CURVE, compression: None, energy: &[], watched: 0.5 }
    }

    fn curve(rate: f64) -> f64 {
        (rate / 1e-6).powf(0.1)
    }

    fn at(now: f64, dt: f64) -> Waiting {
        Waiting { strength: STRENGTH, modulus: E, length_ratio: [1e-3, 0.9], now, dt }
    }

    /// Strength and rate at onset of an edge whose stress [Pa] is a function of time.
    fn onset(stress: impl Fn(f64) -> f64, dt: f64) -> (f64, f64) {
        let (mut edge, law) = (EdgeRate::intact(STRENGTH), law());
        for step in 1.. {
            let now = f64::from(step) * dt;
            let q = stress(now);
            if q > 0.5 * STRENGTH && edge.begins(&law, &at(now, dt), Sym3([q, 0.0, 0.0, 0.0, 0.0, 0.0]), q) {
                return (edge.strength, edge.rate);
            }
        }
        unreachable!()
    }

    #[test]
    fn a_steady_rate_gives_the_strength_of_the_curve_at_any_step() {
        for rate in [1e-4, 1.0, 30.0, 1000.0] {
            for steps in [20.0, 200.0, 2000.0] {
                let dt = STRENGTH / E / rate / steps;
                let (strength, found) = onset(|t| E * rate * t, dt);
                assert!((found / rate - 1.0).abs() < 1e-9, "{found} at {rate}, {steps}");
                assert!((strength / STRENGTH / curve(rate) - 1.0).abs() < 1e-9, "{strength} at {rate}");
            }
        }
    }

    #[test]
    fn ripples_waits_and_blows_before_leave_the_rate_as_it_is() {
        let (rate, dt) = (10.0, 1e-8);
        let ripple = |t: f64| E * rate * t + 0.02 * STRENGTH * (t * 6e6).sin();
        let (_, found) = onset(ripple, dt);
        assert!((found / rate - 1.0).abs() < 0.05, "{found}");
        // Held long beyond half of the strength, with noise; then pulled.
        let held = |t: f64| match t {
            t if t < 1e-4 => 0.53 * STRENGTH * (t / 1e-6).min(1.0) * (1.0 + 0.01 * (t * 1e7).sin()),
            _ => 0.53 * STRENGTH + E * rate * (t - 1e-4),
        };
        let (_, found) = onset(held, dt);
        assert!((found / rate - 1.0).abs() < 0.1, "{found}");
        // A blow that leaves it intact, and a slow pull after it.
        let slow = 0.01;
        let blow = |t: f64| if t < 1e-5 { 0.9 * STRENGTH * (t / 1e-6).min(1.0) } else { E * slow * (t - 1e-5) };
        let (_, found) = onset(blow, 1e-7);
        assert!((found / slow - 1.0).abs() < 1e-3, "{found}");
    }

    #[test]
    fn what_passes_its_strength_in_one_step_has_the_rate_of_that_step() {
        let dt = 1e-7;
        let (strength, rate) = onset(|t| if t < 1.5 * dt { 0.0 } else { 20.0 * STRENGTH }, dt);
        assert!((rate / (19.5 * STRENGTH / E / dt) - 1.0).abs() < 1e-12);
        assert_eq!(strength, STRENGTH * rate_factor(&CURVE, rate));
    }

    #[test]
    fn a_load_at_rest_and_one_that_stays_break_at_the_first_strength() {
        let mut edge = EdgeRate::intact(STRENGTH);
        let stress = |q: f64| Sym3([q, 0.0, 0.0, 0.0, 0.0, 0.0]);
        for share in [0.6, 0.9, 0.999] {
            assert!(!edge.begins(&law(), &at(0.0, 0.0), stress(share * STRENGTH), share * STRENGTH));
        }
        assert!(edge.begins(&law(), &at(0.0, 0.0), stress(1.001 * STRENGTH), 1.001 * STRENGTH));
        assert_eq!((edge.strength, edge.rate, edge.energy), (STRENGTH, 0.0, 1.0));
    }

    #[test]
    fn large_elements_limit_the_strength_and_say_so() {
        let (mut edge, dt) = (EdgeRate::intact(STRENGTH), 1e-6);
        let waiting = |now| Waiting { length_ratio: [0.45, 0.9], ..at(now, dt) };
        let q = 1.42 * STRENGTH;
        assert!(edge.begins(&law(), &waiting(1.0), Sym3([q, 0.0, 0.0, 0.0, 0.0, 0.0]), q));
        assert!((edge.strength / STRENGTH - 2f64.sqrt()).abs() < 1e-12 && edge.is_limited);
    }

    #[test]
    fn compression_has_the_curve_and_the_rate_of_compression() {
        let flat = [[1.0, 1.6]];
        let law = RateLaw { compression: Some((&flat, 10.0)), ..law() };
        let (mut edge, q, dt) = (EdgeRate::intact(STRENGTH), 40.0 * STRENGTH, 1e-6);
        let mut crushed = edge;
        assert!(crushed.begins(&law, &at(1.0, dt), Sym3([-10.0 * q, 0.0, 0.0, 0.0, 0.0, 0.0]), q));
        assert!((crushed.strength / STRENGTH - 1.6).abs() < 1e-12);
        assert!(edge.begins(&law, &at(1.0, dt), Sym3([q, 0.0, 0.0, 0.0, 0.0, 0.0]), q));
        assert!(
            (crushed.rate / edge.rate - 10.0).abs() < 1e-12
                && edge.strength == STRENGTH * rate_factor(&CURVE, edge.rate)
        );
    }

    #[test]
    fn curves_are_power_laws_between_their_points_and_level_outside() {
        for (rate, factor) in
            [(-1.0, 1.0), (0.0, 1.0), (1e-9, 1.0), (1e-6, 1.0), (1.0, curve(1.0)), (1e4, 10.0), (1e9, 10.0)]
        {
            assert!((rate_factor(&CURVE, rate) / factor - 1.0).abs() < 1e-12, "{rate}");
        }
        assert_eq!(rate_factor(&[], 5.0), 1.0);
    }
}
