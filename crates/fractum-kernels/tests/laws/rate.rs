//! Properties of an edge whose strength grows with the rate of strain.

use fractum_kernels::Sym3;
use fractum_kernels::damage::{EdgeRate, RateLaw, Waiting, rate_factor};

use super::draw::{Draw, Held, hold};

/// A rising curve of some points: rate and factor.
fn curve(draw: &mut Draw) -> Vec<[f64; 2]> {
    let (mut rate, mut factor) = (draw.over_decades(1e-9, 1e-3), draw.between(0.8, 1.0));
    let count = 1 + draw.bits() % 6;
    let next = |_| {
        let point = [rate, factor];
        rate *= draw.over_decades(1.1, 400.0);
        factor *= draw.between(1.0, 1.8);
        point
    };
    (0..count).map(next).collect()
}

/// Under a steady rate the strength is that of the curve at this rate, whatever the step and an earlier wave; no faster load finds a weaker edge; the strength
/// never exceeds what the elements permit, and says so where it would.
pub(crate) fn onset(draw: &mut Draw) -> Held {
    let (strength, compressive, energy) = (curve(draw), curve(draw), curve(draw));
    let ratio = draw.over_decades(1.5, 50.0);
    let is_compression = draw.bits().is_multiple_of(2);
    let watched = 0.5 * strength.iter().chain(&compressive).map(|p| p[1]).fold(1.0, f64::min);
    let compression = (!draw.bits().is_multiple_of(3)).then_some((&compressive[..], ratio));
    let law = RateLaw { strength: &strength, compression, energy: &energy, watched };
    let (modulus, at_rest) = (draw.over_decades(1e6, 1e12), draw.over_decades(1e3, 1e9));
    let length_ratio = [draw.over_decades(1e-6, 0.9), 0.9];
    // Below the least factor of any curve.
    let wave = draw.between(0.0, 0.75);
    let loaded = |rate: f64, steps: f64| {
        let mut edge = EdgeRate::intact(at_rest);
        let dt = at_rest / modulus / rate / steps;
        // A wave that leaves the edge intact comes first.
        let stress = |step: f64| if step < 10.0 { wave * at_rest } else { modulus * rate * dt * (step - 12.0) };
        for step in 1.. {
            let (now, q) = (f64::from(step) * dt, stress(f64::from(step)));
            let pull = if is_compression { -ratio * q } else { q };
            let edge_now = Waiting { strength: at_rest, modulus, length_ratio, now, dt };
            let stress = Sym3([pull, 0.0, 0.0, 0.0, 0.0, 0.0]);
            if q > watched * at_rest && edge.begins(&law, &edge_now, stress, q) {
                return edge;
            }
        }
        unreachable!()
    };
    let rate = draw.over_decades(1e-9, 1e5);
    let edge = loaded(rate, draw.over_decades(30.0, 200.0));
    let (curve, seen) = match compression {
        Some((curve, ratio)) if is_compression => (curve, ratio * rate),
        _ => (&strength[..], rate),
    };
    hold((edge.rate / seen - 1.0).abs() < 1e-6, || format!("measures {} of {seen} /s", edge.rate))?;
    let factor = rate_factor(curve, seen);
    let possible = (rate_factor(&energy, seen) * length_ratio[1] / length_ratio[0]).sqrt();
    let expected = factor.min(possible);
    hold((edge.strength / at_rest / expected - 1.0).abs() < 1e-6, || format!("{edge:?} instead of {expected}"))?;
    hold(edge.is_limited == (factor > possible) || (factor / possible - 1.0).abs() < 1e-6, || format!("{edge:?}"))?;
    let [first, last] = [curve[0], curve[curve.len() - 1]].map(|point| point[1]);
    hold((first * (1.0 - 1e-12)..=last * (1.0 + 1e-12)).contains(&factor), || format!("{factor} is off the curve"))?;
    let faster = loaded(rate * draw.over_decades(1.0, 1e3), 40.0);
    hold(faster.strength >= edge.strength.min(at_rest * possible) * (1.0 - 1e-6) || faster.is_limited, || {
        format!("{faster:?} is weaker than {edge:?}")
    })
}
