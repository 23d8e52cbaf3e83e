//! The shape of a clump: the union of spheres that may overlap.

use std::f64::consts::TAU;

use fractum_math::elementary::{cos, sin};
use fractum_math::{Mat3, Vec3, connected};

use crate::DemError;

/// Spheres that a clump may have.
pub const CLUMP_SPHERES: std::ops::RangeInclusive<usize> = 1..=100;

/// Parts of the radius in the quadrature over the section of a sphere, with three points of Gauss each.
const PARTS: usize = 32;
/// Rays of the quadrature, over the whole turn.
const RAYS: usize = 192;

/// Spheres that make a rigid grain, about their centre of mass.
#[derive(Clone, Debug, PartialEq)]
pub struct ClumpShape {
    /// Centres from the centre of mass [m], and radii [m].
    spheres: Vec<(Vec3, f64)>,
    volume: f64,
    inertia: Mat3,
    radius: f64,
}

/// Moments of a part of space at unit density.
#[derive(Clone, Copy, Debug)]
struct Moments {
    volume: f64,
    first: Vec3,
    /// ∫ x xᵀ dV.
    second: Mat3,
}

impl ClumpShape {
    /// The shape of these spheres, in any frame. Space that several of them cover counts once.
    ///
    /// - `spheres`: centres [m] and radii [m] > 0; [`CLUMP_SPHERES`] of them
    ///
    /// Volume, centre of mass and moments of inertia are integrals over the chords of the spheres along one axis: exact for
    /// spheres that are apart. Where two overlap the volume is within 2e-4 and moments of inertia are within 5e-4 of closed forms.
    ///
    /// # Errors
    /// [`DemError::BadClump`] for too many spheres, radii or centres that are none, or spheres that do not hang together.
    pub fn new(spheres: &[(Vec3, f64)]) -> Result<Self, DemError> {
        let bad = |reason: String| Err(DemError::BadClump { reason });
        if !CLUMP_SPHERES.contains(&spheres.len()) {
            let (least, most) = (CLUMP_SPHERES.start(), CLUMP_SPHERES.end());
            return bad(format!("has {} spheres; expected {least} to {most}", spheres.len()));
        }
        let is_sphere = |(x, r): &(Vec3, f64)| r.is_finite() && *r > 0.0 && x.iter().all(|x| x.is_finite());
        if let Some(number) = spheres.iter().position(|sphere| !is_sphere(sphere)) {
            return bad(format!("has no radius above 0 or no place for sphere {number}"));
        }
        // Those that just touch are joined in spite of rounding.
        let meets = |a: &(Vec3, f64), b: &(Vec3, f64)| (a.0 - b.0).norm() <= (a.1 + b.1) * (1.0 + 1e-9);
        let numbers = 0..spheres.len();
        let pairs = numbers.clone().flat_map(|i| (0..i).map(move |j| [j as u32, i as u32]));
        let joined = pairs.filter(|[i, j]| meets(&spheres[*i as usize], &spheres[*j as usize]));
        let part = connected(spheres.len(), joined);
        if let Some(apart) = part.iter().position(|part| *part != 0) {
            return bad(format!("does not hang together: sphere {apart} touches none of those that hang on sphere 0"));
        }
        if let Some(number) = numbers.clone().find(|&i| spheres[..i].contains(&spheres[i])) {
            return bad(format!("has sphere {number} twice"));
        }
        let moments = numbers.map(|i| own_part(spheres, i)).fold(Moments::none(), Moments::with);
        // A single sphere turns about its own centre, to the last bit.
        let centre = if let [(centre, _)] = spheres { *centre } else { moments.first / moments.volume };
        let second = moments.second - centre * centre.transpose() * moments.volume;
        let inertia = Mat3::identity() * second.trace() - second;
        if !moments.volume.is_normal()
            || inertia.try_inverse().is_none_or(|inverse| inverse.iter().any(|x| !x.is_finite()))
        {
            return bad("has a size whose volume or moments of inertia are no numbers".to_owned());
        }
        let spheres: Vec<(Vec3, f64)> = spheres.iter().map(|(x, r)| (x - centre, *r)).collect();
        let radius = spheres.iter().map(|(x, r)| x.norm() + r).fold(0.0, f64::max);
        Ok(ClumpShape { volume: moments.volume, inertia, radius, spheres })
    }

    /// Centres from the centre of mass [m] and radii [m].
    pub fn spheres(&self) -> &[(Vec3, f64)] {
        &self.spheres
    }

    /// Volume of the union of the spheres [m³].
    pub fn volume(&self) -> f64 {
        self.volume
    }

    /// Moments of inertia of the union about its centre of mass, at unit density [m⁵].
    pub fn inertia(&self) -> &Mat3 {
        &self.inertia
    }

    /// Radius of the sphere around the centre of mass that just holds the clump [m].
    pub fn radius(&self) -> f64 {
        self.radius
    }
}

impl Moments {
    fn none() -> Self {
        Moments { volume: 0.0, first: Vec3::zeros(), second: Mat3::zeros() }
    }

    fn with(mut self, other: Moments) -> Self {
        self.volume += other.volume;
        self.first += other.first;
        self.second += other.second;
        self
    }

    /// Adds a piece of a line along z.
    ///
    /// - `at`: x and y of the line [m]; `area`: what it stands for [m²]; `from`, `to`: z of its ends [m]
    fn add_piece(&mut self, [x, y]: [f64; 2], area: f64, [from, to]: [f64; 2]) {
        let length = to - from;
        if length <= 0.0 {
            return;
        }
        let (volume, z) = (area * length, 0.5 * (from + to));
        let at = Vec3::new(x, y, z);
        self.volume += volume;
        self.first += at * volume;
        self.second += at * at.transpose() * volume;
        self.second[(2, 2)] += volume * length * length / 12.0;
    }
}

/// Moments of what a sphere covers and none before it.
fn own_part(spheres: &[(Vec3, f64)], own: usize) -> Moments {
    let (centre, radius) = spheres[own];
    let meets = |(x, r): &&(Vec3, f64)| (x - centre).norm() < r + radius;
    let before: Vec<(Vec3, f64)> = spheres[..own].iter().filter(meets).copied().collect();
    let mut moments = Moments::none();
    // With u, half the chord over the radius, the section is r² ∫ u du dφ, and moments of a whole sphere are polynomials of u.
    let gauss = [(0.5 - 0.5 * 0.6f64.sqrt(), 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.5 + 0.5 * 0.6f64.sqrt(), 5.0 / 18.0)];
    let mut covered: Vec<[f64; 2]> = Vec::new();
    for ray in 0..RAYS {
        let angle = TAU * (ray as f64 + 0.5) / RAYS as f64;
        let (c, s) = (cos(angle), sin(angle));
        for (part, (at, weight)) in (0..PARTS).flat_map(|part| gauss.iter().map(move |point| (part, *point))) {
            let u = (part as f64 + at) / PARTS as f64;
            let area = radius * radius * u * (weight / PARTS as f64) * (TAU / RAYS as f64);
            let (out, half) = (radius * (1.0 - u * u).sqrt(), radius * u);
            let [x, y] = [centre.x + out * c, centre.y + out * s];
            covered.clear();
            covered.extend(before.iter().filter_map(|(other, r)| {
                let square = r * r - (x - other.x).powi(2) - (y - other.y).powi(2);
                (square > 0.0).then(|| [other.z - square.sqrt(), other.z + square.sqrt()])
            }));
            covered.sort_by(|a, b| a[0].total_cmp(&b[0]));
            let (mut from, end) = (centre.z - half, centre.z + half);
            for [low, high] in &covered {
                moments.add_piece([x, y], area, [from, low.min(end)]);
                from = from.max(*high);
            }
            moments.add_piece([x, y], area, [from, end]);
        }
    }
    moments
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn close(found: f64, expected: f64, tolerance: f64) {
        assert!((found / expected - 1.0).abs() < tolerance, "{found}, expected {expected}");
    }

    #[test]
    fn one_sphere_is_a_sphere() {
        let shape = ClumpShape::new(&[(Vec3::new(3.0, -1.0, 2.0), 0.7)]).unwrap();
        close(shape.volume(), fractum_math::sphere_volume(0.7), 1e-12);
        let expected = 0.4 * fractum_math::sphere_volume(0.7) * 0.49;
        assert!((shape.inertia() - Mat3::identity() * expected).norm() < 1e-11 * expected, "{}", shape.inertia());
        assert_eq!((shape.radius(), shape.spheres()[0].0), (0.7, Vec3::zeros()));
    }

    #[test]
    fn spheres_that_just_touch_add_up() {
        let [a, b] = [1.0f64, 0.5];
        let axis = Vec3::new(1.0, 2.0, -2.0) / 3.0;
        let shape = ClumpShape::new(&[(Vec3::zeros(), a), (axis * (a + b), b)]).unwrap();
        let (va, vb) = (fractum_math::sphere_volume(a), fractum_math::sphere_volume(b));
        close(shape.volume(), va + vb, 1e-6);
        let centre = vb * (a + b) / (va + vb);
        assert!((shape.spheres()[0].0 + axis * centre).norm() < 1e-5, "{}", shape.spheres()[0].0);
        let along = 0.4 * (va * a * a + vb * b * b);
        let across = along + va * centre.powi(2) + vb * (a + b - centre).powi(2);
        close(axis.dot(&(shape.inertia() * axis)), along, 1e-5);
        let other = axis.cross(&Vec3::x()).normalize();
        close(other.dot(&(shape.inertia() * other)), across, 1e-5);
    }

    /// Volume of the lens of two spheres of radius r whose centres are d apart: π (4 r + d) (2 r − d)²/12. Each half of the dumbbell
    /// is a sphere cut by a plane at d/2: ∫ π (r² − s²) sᵏ ds.
    #[test]
    fn a_dumbbell_has_the_lens_once() {
        for axis in [Vec3::x(), Vec3::z(), Vec3::new(0.6, 0.0, 0.8), Vec3::new(1.0, 1.0, 1.0).normalize()] {
            let (r, d) = (1.0f64, 1.2f64);
            let shape = ClumpShape::new(&[(-axis * (0.5 * d), r), (axis * (0.5 * d), r)]).unwrap();
            let lens = PI * (4.0 * r + d) * (2.0 * r - d).powi(2) / 12.0;
            let volume = 2.0 * fractum_math::sphere_volume(r) - lens;
            close(shape.volume(), volume, 2e-4);
            let h = 0.5 * d;
            // s from −h to r, with the origin in the middle of the sphere: at x = s + h.
            let integral = |f: fn(f64, f64) -> f64| {
                let count = 20_000;
                let step = (r + h) / f64::from(count);
                (0..count).map(|k| f(-h + (f64::from(k) + 0.5) * step, h) * step).sum::<f64>()
            };
            let axial = 2.0 * integral(|s, h| PI * (1.0 - s * s) * (s + h) * (s + h));
            let radial = 2.0 * integral(|s, _| 0.25 * PI * (1.0 - s * s).powi(2));
            close(axis.dot(&(shape.inertia() * axis)), 2.0 * radial, 5e-4);
            let other = axis.cross(&Vec3::y()).normalize();
            close(other.dot(&(shape.inertia() * other)), axial + radial, 5e-4);
            assert!(shape.spheres().iter().map(|(x, _)| x).sum::<Vec3>().norm() < 2e-4);
        }
    }

    #[test]
    fn a_sphere_within_another_adds_nothing() {
        let shape = ClumpShape::new(&[(Vec3::zeros(), 1.0), (Vec3::new(0.2, 0.1, 0.3), 0.4)]).unwrap();
        close(shape.volume(), fractum_math::sphere_volume(1.0), 1e-9);
        let other = ClumpShape::new(&[(Vec3::new(0.2, 0.1, 0.3), 0.4), (Vec3::zeros(), 1.0)]).unwrap();
        close(other.volume(), fractum_math::sphere_volume(1.0), 1e-4);
    }

    #[test]
    fn what_does_not_hang_together_is_refused() {
        let said = |spheres: &[(Vec3, f64)]| ClumpShape::new(spheres).unwrap_err().to_string();
        assert!(said(&[(Vec3::zeros(), 1.0), (Vec3::x() * 2.5, 1.0)]).contains("sphere 1 touches none"));
        assert!(said(&[(Vec3::zeros(), 1.0), (Vec3::zeros(), 1.0)]).contains("sphere 1 twice"));
        assert!(said(&vec![(Vec3::zeros(), 1.0); 101]).contains("1 to 100"));
        assert!(said(&[(Vec3::zeros(), 1e120)]).contains("no numbers"));
    }
}
