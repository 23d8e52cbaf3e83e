//! How cracks lie about an axis: the angle of a helix, the angle of a cone.

use fractum_math::elementary::{atan2, exp, hypot, sin, sin_cos, tan};
use std::f64::consts::FRAC_PI_2;

use fractum_math::Vec3;

/// A straight line that a crack lies about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// A point of it; for a cone the one in the surface that the cone goes down from [m].
    pub point: Vec3,
    /// Unit direction; for a cone out of the surface.
    pub direction: Vec3,
}

impl Axis {
    /// Distance from the axis [m], angle about it from some direction [rad], and position along it [m].
    pub fn cylindrical(&self, x: Vec3) -> (f64, f64, f64) {
        let Axis { point, direction: n } = self;
        // Any frame across the axis: only differences of angles matter.
        let start = if n.x.abs() < 0.9 { Vec3::x() } else { Vec3::y() };
        let first = n.cross(&start).normalize();
        let second = n.cross(&first);
        let d = x - point;
        let (a, b) = (d.dot(&first), d.dot(&second));
        (hypot(a, b), atan2(b, a), d.dot(n))
    }
}

/// Points that a crack must have at least before its shape is asked.
const LEAST: usize = 10;
/// Part of the radius beyond which a crack runs on the surface.
const SURFACE: f64 = 0.67;
/// Steps of the search for an angle over a right angle, and of its refinement over one of these.
const STEPS: [i32; 2] = [90, 10];

/// Angle between an axis and the helix that a crack follows on the surface of a cylinder [rad], 0 to π/2 of either hand:
/// the slope θ = θ₀ + s x with the largest |Σ w exp(i(θ − s x))| over the points of the outer third.
///
/// - `points`: place [m] and weight of each
/// - `radius`: of the cylinder [m]
/// - returns none for fewer than ten points near the surface
pub fn helix_angle(points: &[(Vec3, f64)], axis: &Axis, radius: f64) -> Option<f64> {
    let outer: Vec<(f64, f64, f64)> = points
        .iter()
        .filter_map(|&(x, weight)| {
            let (r, theta, along) = axis.cylindrical(x);
            (r > SURFACE * radius).then_some((theta, along, weight))
        })
        .collect();
    if outer.len() < LEAST {
        return None;
    }
    let strength = |angle: f64| {
        let slope = tan(angle) / radius;
        let (c, s) = outer.iter().fold((0.0, 0.0), |(c, s), (theta, along, weight)| {
            let (sine, cosine) = sin_cos(theta - slope * along);
            (c + weight * cosine, s + weight * sine)
        });
        c * c + s * s
    };
    let [coarse, fine] = STEPS;
    let step = FRAC_PI_2 / f64::from(coarse);
    // Nearly along the axis or nearly across it everything lines up: from 5° to 85° of either hand.
    let angles = (5..=coarse - 5).flat_map(|k| [f64::from(k), -f64::from(k)]).map(|k| k * step);
    let near = best(angles, strength)?;
    let around = (-fine..=fine).map(|k| near + step * f64::from(k) / f64::from(fine));
    best(around, strength).map(f64::abs)
}

/// The argument with the largest value, the first of equal ones.
fn best(arguments: impl Iterator<Item = f64>, value: impl Fn(f64) -> f64) -> Option<f64> {
    let mut found: Option<(f64, f64)> = None;
    for x in arguments {
        let v = value(x);
        if found.is_none_or(|(most, _)| v > most) {
            found = Some((v, x));
        }
    }
    found.map(|(_, x)| x)
}

/// The cone that most of a crack lies on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Angle between its flank and the surface [rad], 0 to π/2; the cone widens with depth.
    pub angle: f64,
    /// Its radius at the surface [m]; may be negative where it has its tip below.
    pub radius: f64,
    /// Part of the crack's weight within the width of the crack from its flank.
    pub share: f64,
}

/// Finds the cone about an axis on which most of a crack lies.
///
/// Points are seen in the half plane of radius and depth, where the flank is a line; the outer flank, which has more of the
/// area, counts for more than what lies near the axis. The line is the one with the largest sum of Gaussians of the distances,
/// as wide as a point of the crack (the root of the mean weight), and then the one of least squares with weights that vanish
/// beyond two and a half widths: single cracks beside the flank do not draw it.
///
/// - `points`: place [m] and area of each [m²]
/// - returns none for fewer than ten points, and for points of no area
pub fn cone(points: &[(Vec3, f64)], axis: &Axis) -> Option<Cone> {
    let total: f64 = points.iter().map(|p| p.1).sum();
    if points.len() < LEAST || !(total.is_finite() && total > 0.0) {
        return None;
    }
    let width = (total / points.len() as f64).sqrt();
    let profile: Vec<[f64; 3]> = points
        .iter()
        .map(|&(x, area)| {
            let (r, _, along) = axis.cylindrical(x);
            [r, -along, area]
        })
        .collect();
    let mut sums = Vec::new();
    let [coarse, _] = STEPS;
    let mut found: Option<(f64, Line)> = None;
    for k in 1..coarse {
        let angle = FRAC_PI_2 * f64::from(k) / f64::from(coarse);
        let (strength, offset) = densest(&profile, angle, width, &mut sums);
        if found.is_none_or(|(most, _)| strength > most) {
            found = Some((strength, Line { angle, offset }));
        }
    }
    let (_, mut line) = found?;
    for _ in 0..ROUNDS {
        line = line.drawn_to(&profile, REACH * width).unwrap_or(line);
    }
    let near: f64 = profile.iter().zip(points).filter(|(p, _)| line.distance(p).abs() <= width).map(|(_, p)| p.1).sum();
    Some(Cone { angle: line.angle, radius: line.offset / sin(line.angle), share: near / total })
}

/// Distance beyond which a point has no say about the flank, over the width of a crack.
const REACH: f64 = 2.5;
/// Rounds of weighted least squares.
const ROUNDS: usize = 10;

/// The line r sin α − depth cos α = c.
#[derive(Clone, Copy)]
struct Line {
    angle: f64,
    offset: f64,
}

impl Line {
    fn distance(&self, [r, depth, _]: &[f64; 3]) -> f64 {
        let (sine, cosine) = sin_cos(self.angle);
        r * sine - depth * cosine - self.offset
    }

    /// The line of least squares of the distances, with weights (1 − (d/reach)²)²; none where points leave no direction, or
    /// one that is no cone.
    fn drawn_to(&self, profile: &[[f64; 3]], reach: f64) -> Option<Line> {
        let weight = |p: &[f64; 3]| {
            let share = self.distance(p) / reach;
            if share.abs() < 1.0 { p[2] * (1.0 - share * share).powi(2) } else { 0.0 }
        };
        let sum = |f: &dyn Fn(&[f64; 3]) -> f64| profile.iter().map(|p| weight(p) * f(p)).sum::<f64>();
        let mass = sum(&|_| 1.0);
        let (r, d) = (sum(&|p| p[0]) / mass, sum(&|p| p[1]) / mass);
        let (rr, dd) = (sum(&|p| (p[0] - r).powi(2)), sum(&|p| (p[1] - d).powi(2)));
        let rd = sum(&|p| (p[0] - r) * (p[1] - d));
        // Direction of the larger moment, from the axis of radii.
        let angle = 0.5 * atan2(2.0 * rd, rr - dd);
        let (sine, cosine) = sin_cos(angle);
        (angle > 0.0 && angle < FRAC_PI_2).then_some(Line { angle, offset: r * sine - d * cosine })
    }
}

/// The offset at which lines of an angle meet most of the profile, and how much.
fn densest(profile: &[[f64; 3]], angle: f64, width: f64, sums: &mut Vec<f64>) -> (f64, f64) {
    let line = Line { angle, offset: 0.0 };
    let (low, high) = profile
        .iter()
        .map(|p| line.distance(p))
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
    // Cells of half a width, four of which on either side make up the Gaussian.
    const AROUND: usize = 4;
    let cell = 0.5 * width;
    // What lies farther out than ten thousand widths is no crack of this size.
    let cells = (((high - low) / cell).min(2e4)) as usize + 1;
    sums.clear();
    sums.resize(cells + 2 * AROUND, 0.0);
    for p in profile {
        let index = ((line.distance(p) - low) / cell) as usize;
        sums[index.min(cells - 1) + AROUND] += p[2];
    }
    let kernel: [f64; 2 * AROUND + 1] = std::array::from_fn(|k| {
        let apart = (k as f64 - AROUND as f64) * cell / width;
        exp(-0.5 * apart * apart)
    });
    let mut most = (0.0, low);
    for (k, window) in sums.windows(kernel.len()).enumerate() {
        let value: f64 = window.iter().zip(&kernel).map(|(s, k)| s * k).sum();
        if value > most.0 {
            most = (value, low + (k as f64 + 0.5) * cell);
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// A sequence of numbers in −1 … 1 without order.
    fn noise(k: usize) -> f64 {
        let x = (k as f64 * 12.9898).sin() * 43_758.545;
        2.0 * (x - x.floor()) - 1.0
    }

    /// Points of a cone of an angle to the surface z = 2, from a ring of radius 1, with noise of one width (0.1).
    fn flank(degrees: f64, count: usize) -> Vec<(Vec3, f64)> {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let at = |k: usize| {
            let along = 2.0 * k as f64 / count as f64;
            let theta = k as f64 * 2.399_963;
            let r = 1.0 + along * cosine + 0.1 * noise(k);
            Vec3::new(3.0 + r * theta.cos(), -1.0 + r * theta.sin(), 2.0 - along * sine + 0.1 * noise(k + 7_777))
        };
        (0..count).map(|k| (at(k), 0.01)).collect()
    }

    const BLOCK: Axis = Axis { point: Vec3::new(3.0, -1.0, 2.0), direction: Vec3::new(0.0, 0.0, 1.0) };

    #[test]
    fn a_drawn_cone_is_found_with_its_angle_in_noise() {
        for degrees in [15.0, 22.0, 30.0, 45.0, 68.0] {
            let found = cone(&flank(degrees, 300), &BLOCK).unwrap();
            assert!((found.angle.to_degrees() - degrees).abs() < 1.5, "{degrees}: {}", found.angle.to_degrees());
            assert!((found.radius - 1.0).abs() < 0.1 && found.share > 0.7, "{found:?}");
        }
    }

    #[test]
    fn median_cracks_and_a_crushed_core_beside_the_flank_do_not_draw_it() {
        let mut points = flank(22.0, 400);
        // A median crack down the axis, and points all over a half ball under the contact.
        points.extend((0..150).map(|k| (Vec3::new(3.0, -1.0 + 1.5 * noise(k), 1.0 + 0.8 * noise(k + 99)), 0.01)));
        let ball = |k: usize| {
            let x = Vec3::new(noise(k + 1), noise(k + 5_001), -noise(k + 9_001).abs()) * 0.8;
            (BLOCK.point + x, 0.01)
        };
        points.extend((0..150).map(ball));
        let found = cone(&points, &BLOCK).unwrap();
        assert!((found.angle.to_degrees() - 22.0).abs() < 2.5, "{}", found.angle.to_degrees());
        assert!(found.share > 0.35 && found.share < 0.75, "{}", found.share);
    }

    #[test]
    fn a_crushed_zone_has_little_on_any_cone() {
        let at = |k: usize| {
            let x = Vec3::new(noise(k), noise(k + 10_001), -noise(k + 20_001).abs()) * 3.0;
            (BLOCK.point + x, 0.01)
        };
        let points: Vec<_> = (0..3000).map(at).collect();
        assert!(cone(&points, &BLOCK).unwrap().share < 0.2);
    }

    #[test]
    fn a_drawn_helix_is_found_with_its_angle_in_noise_and_among_strays() {
        let (radius, axis) = (2.0, Axis { point: Vec3::new(0.0, 1.0, 0.0), direction: Vec3::x() });
        for (degrees, hand) in [(30.0f64, 1.0), (45.0, -1.0), (70.0, 1.0)] {
            // Three quarters of a turn, with jitter across it, and a fifth of the points anywhere.
            let slope = hand * degrees.to_radians().tan() / radius;
            let at = |k: usize| {
                let theta = k as f64 / 250.0 * 1.5 * PI;
                let (theta, along) =
                    if k.is_multiple_of(5) { (PI * noise(k), 3.0 * noise(k + 31)) } else { (theta, theta / slope) };
                let r = 0.9 * radius;
                (Vec3::new(along + 0.1 * noise(k + 77), 1.0 + r * theta.cos(), r * theta.sin()), 1.0)
            };
            let points: Vec<_> = (0..250).map(at).collect();
            let angle = helix_angle(&points, &axis, radius).unwrap().to_degrees();
            assert!((angle - degrees).abs() < 2.0, "{degrees}: {angle}");
        }
    }

    #[test]
    fn few_points_have_no_shape() {
        let points = flank(22.0, LEAST - 1);
        assert_eq!(cone(&points, &BLOCK), None);
        assert_eq!(helix_angle(&points, &BLOCK, 1.0), None);
        let nowhere: Vec<_> = flank(22.0, 20).into_iter().map(|(x, _)| (x, 0.0)).collect();
        assert_eq!(cone(&nowhere, &BLOCK), None);
    }
}
