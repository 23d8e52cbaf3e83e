//! Properties of elasticity, criteria, softening and degradation.

use fractum_kernels::material::{Criterion, CriterionKind, Degradation, Elastic, Hooke, Plane, Softening};
use fractum_kernels::{Mat3, Sym3};

use super::draw::{Draw, Held, hold};

/// A softening curve starts at the strength, falls, never gives stiffness back, and encloses the fracture energy.
pub(crate) fn softening(draw: &mut Draw, curve: Softening) -> Held {
    let (young, strength) = (draw.over_decades(1e6, 1e12), draw.over_decades(1e3, 1e9));
    let energy = draw.over_decades(1e-1, 1e5);
    let length = draw.between(0.001, 0.98) * curve.largest_length(young, strength, energy);
    // In units of the strength and of the strain at which it is reached.
    let brittleness = young * energy / (length * strength * strength);
    let ratio = |x: f64| curve.residual_ratio(x * strength, strength, length, young, energy);
    hold((ratio(1.0) - 1.0).abs() < 1e-9, || format!("{curve:?} starts at {}", ratio(1.0)))?;
    let end = match curve {
        Softening::Exponential => 1.0 + 40.0 * (brittleness - 0.5),
        Softening::Linear => 2.0 * brittleness + 1.0,
        Softening::Bilinear { stress, opening } => (2.0 - opening) / stress * brittleness + 1.0,
    };
    let steps = 20_000;
    let (mut area, mut last, mut x) = (0.5, 1.0, 1.0);
    for step in 1..=steps {
        let next = 1.0 + (end - 1.0) * f64::from(step) / f64::from(steps);
        let now = ratio(next);
        hold(now <= last * (1.0 + 1e-12) && now >= 0.0, || format!("{curve:?} rises to {now} from {last} at {next}"))?;
        hold(now / next <= last / x * (1.0 + 1e-12), || format!("{curve:?} heals at {next}"))?;
        area += 0.5 * (now + last) * (next - x);
        (last, x) = (now, next);
    }
    hold((area / brittleness - 1.0).abs() < 2e-3, || {
        format!("{curve:?} at b = {brittleness}: {} of its energy", area / brittleness)
    })
}

/// Stiffness falls from one to zero, the stress of a band that localises falls with it, and an unloaded point stays intact above the
/// least a₁ alone.
pub(crate) fn degradation(draw: &mut Draw, curve: Softening) -> Held {
    let law = Degradation::new(curve);
    let a1 = law.least_a1() * draw.over_decades(1.001, 1e5);
    hold((law.stiffness(a1, 0.0) - 1.0).abs() < 1e-15, || "not whole at first".into())?;
    hold(law.stiffness(a1, 1.0) < 1e-9, || format!("{} is left", law.stiffness(a1, 1.0)))?;
    let mut last = [1.0, f64::INFINITY];
    for d in (1..500).map(|i| f64::from(i) / 500.0) {
        let stiffness = law.stiffness(a1, d);
        // The square of the stress is in proportion to (2d - d²)/(1/ω - 1).
        let now = [stiffness, a1 * d * (2.0 - d) * stiffness / (1.0 - stiffness)];
        let falls = now[0] > 0.0 && now[0] < last[0] && now[1] < last[1] * (1.0 + 1e-9);
        hold(falls, || format!("{curve:?}, a1 = {a1}: {now:?} after {last:?} at {d}"))?;
        last = now;
    }
    // The energy of an unloaded point over f_t²/2E.
    let energy = |a1: f64, d: f64| law.stiffness(a1, d) + 0.5 * a1 * d * (2.0 - d);
    let lowest = |a1: f64| (1..2000).map(|i| energy(a1, f64::from(i) / 2000.0)).fold(f64::INFINITY, f64::min);
    hold(lowest(a1) > 1.0, || format!("{curve:?}, a1 = {a1}: an unloaded point falls to {}", lowest(a1)))?;
    let below = lowest(0.95 * law.least_a1());
    hold(below < 1.0, || format!("{curve:?}: below the least a1 an unloaded point has {below}"))
}

/// Uniaxial strengths, degree one, the same in turned axes, convex, and no cheap bound that hides a stress.
pub(crate) fn criterion(draw: &mut Draw, kind: CriterionKind) -> Held {
    let angle = draw.between(1.0, 60.0).to_radians();
    let least = kind.least_strength_ratio(angle);
    let (strength_ratio, poisson_ratio) = (least * draw.over_decades(1.001, 50.0), draw.between(0.0, 0.49));
    let criterion = Criterion::new(kind, angle, strength_ratio, poisson_ratio);
    let law = format!("angle {:.2} deg, ratio {strength_ratio:.3}, nu {poisson_ratio:.3}", angle.to_degrees());
    let q = |stress: Sym3| criterion.equivalent_stress(stress);
    let along = |size: f64| Sym3::new(size, 0.0, 0.0, 0.0, 0.0, 0.0);
    hold((q(along(1.0)) - 1.0).abs() < 1e-6, || format!("{law}: tension 1 is {}", q(along(1.0))))?;
    if kind.uses_compressive_strength() {
        let crushed = q(along(-strength_ratio));
        hold((crushed - 1.0).abs() < 1e-6 * strength_ratio, || {
            format!("{law}: the strength in compression is {crushed}")
        })?;
    }
    let mut stress = || Sym3(std::array::from_fn(|_| draw.between(-10.0, 10.0)));
    let (one, two) = (stress(), stress());
    let (turn, factor) = (draw.turn(), draw.over_decades(1e-3, 1e3));
    // The closed form of the principal values is exact to about 1e-8 of the norm.
    let norm = one.to_matrix().norm() + two.to_matrix().norm();
    hold((q(one * factor) - factor * q(one)).abs() < 1e-6 * factor * norm, || format!("{law}: not of degree one"))?;
    let turned = Sym3::symmetric_part(&(turn * one.to_matrix() * turn.transpose()));
    hold((q(turned) - q(one)).abs() < 1e-6 * norm, || format!("{law}: {} turned, {}", q(turned), q(one)))?;
    let mean = q((one + two) * 0.5);
    let bound = 0.5 * (q(one) + q(two));
    hold(mean <= bound + 1e-6 * norm, || format!("{law}: not convex, {mean} between, {bound}: {one:?} {two:?}"))?;
    let threshold = draw.between(0.1, 20.0);
    let hidden = criterion.surely_below(one, threshold) && q(one) > threshold * (1.0 + 1e-7);
    hold(!hidden, || format!("{law}: the bound hides {} above {threshold}", q(one)))
}

/// Uniaxial stress gives Young's modulus and Poisson's ratio back; energy is positive and symmetric; turned axes change nothing.
pub(crate) fn elasticity(draw: &mut Draw, plane: Option<Plane>) -> Held {
    let (young, nu) = (draw.over_decades(1e6, 1e12), draw.between(-0.9, 0.49));
    let elastic = Elastic { density: draw.between(500.0, 20e3), young_modulus: young, poisson_ratio: nu };
    let hooke = Hooke::new(&elastic, plane);
    let words = format!("{plane:?}, nu {nu:.3}");
    // Strain of a pull along x, and the modulus that is seen.
    let (strain, modulus) = match plane {
        None | Some(Plane::Axisymmetric) => ([1.0, -nu, -nu], young),
        Some(Plane::Stress) => ([1.0, -nu, 0.0], young),
        Some(Plane::Strain) => ([1.0, -nu / (1.0 - nu), 0.0], young / (1.0 - nu * nu)),
    };
    let [xx, yy, zz, ..] = hooke.stress(Sym3([strain[0], strain[1], strain[2], 0.0, 0.0, 0.0])).0;
    // Close to the ends of Poisson's ratio the terms cancel.
    let rounding = 1e-12 / (0.5 - nu).min(1.0 + nu);
    hold((xx / modulus - 1.0).abs() < rounding, || format!("{words}: {xx} of {modulus}"))?;
    hold(yy.abs() < rounding * modulus, || format!("{words}: {yy} across"))?;
    let thick = match plane {
        None | Some(Plane::Stress | Plane::Axisymmetric) => 0.0,
        Some(Plane::Strain) => nu * xx,
    };
    hold((zz - thick).abs() < rounding * modulus, || format!("{words}: {zz} through the thickness, {thick}"))?;

    let in_plane = plane.is_some();
    let mut strain = || {
        let [xx, yy, zz, xy, yz, zx] = std::array::from_fn(|_| draw.between(-1e-3, 1e-3));
        if in_plane { Sym3([xx, yy, 0.0, xy, 0.0, 0.0]) } else { Sym3([xx, yy, zz, xy, yz, zx]) }
    };
    let (one, two) = (strain(), strain());
    let scale = young * one.dot(one).max(two.dot(two)) / (0.5 - nu).min(1.0 + nu);
    let stored = hooke.stress(one).dot(one);
    hold(stored > 0.0, || format!("{words}: stores {stored}"))?;
    let both = [hooke.stress(one).dot(two), hooke.stress(two).dot(one)];
    hold((both[0] - both[1]).abs() < 1e-12 * scale, || format!("{words}: not symmetric, {both:?}"))?;
    let turn = if in_plane { draw.turn_in_plane() } else { draw.turn() };
    let turned = |tensor: Sym3| Sym3::symmetric_part(&(turn * tensor.to_matrix() * turn.transpose()));
    let off = turned(hooke.stress(one)) - hooke.stress(turned(one));
    hold(off.dot(off).sqrt() < 1e-12 * scale / one.dot(one).sqrt(), || format!("{words}: turned axes change {off:?}"))
}

/// The negative part of a tensor has no positive principal value, what is left no negative one, both are apart, and turned axes change
/// nothing; also beside equal values, on the axes and in the plane.
pub(crate) fn negative_part(draw: &mut Draw) -> Held {
    let size = draw.over_decades(1e-12, 1e12);
    let kind = draw.one_of(&[0, 1, 2, 3]);
    let any: [f64; 6] = std::array::from_fn(|_| draw.between(-1.0, 1.0));
    let close = draw.one_of(&[0.0, 1e-12, 1e-9, 1e-6, 1e-3]);
    let turn = draw.turn();
    let tensor = size
        * match kind {
            0 => Sym3(any).to_matrix(),
            1 => Sym3([any[0], any[1], 0.0, any[3], 0.0, 0.0]).to_matrix(),
            2 => Mat3::from_diagonal(&[any[0], any[0] + close, any[2]].into()),
            _ => turn * Mat3::from_diagonal(&[any[0], any[0] + close, any[2]].into()) * turn.transpose(),
        };
    let tensor = Sym3::symmetric_part(&tensor);
    let norm = tensor.dot(tensor).sqrt();
    let part = tensor.negative_part();
    let rest = tensor - part;
    let [highest, ..] = part.eigen().0;
    let [.., lowest] = rest.eigen().0;
    hold(highest <= 1e-7 * norm && lowest >= -1e-7 * norm, || format!("{tensor:?}: {highest} and {lowest} are left"))?;
    hold(part.dot(rest).abs() <= 1e-7 * norm * norm, || format!("{tensor:?}: the parts share {}", part.dot(rest)))?;
    let turned = |tensor: Sym3| Sym3::symmetric_part(&(turn * tensor.to_matrix() * turn.transpose()));
    let off = turned(part) - turned(tensor).negative_part();
    hold(off.dot(off).sqrt() <= 2e-7 * norm, || format!("{tensor:?}: turned axes change {off:?}"))
}
