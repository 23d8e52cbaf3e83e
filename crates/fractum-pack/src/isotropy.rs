use fractum_math::elementary::atan2;
use std::f64::consts::PI;

use fractum_math::Vec3;
use serde::Serialize;

/// How evenly contacts point in all directions, counted on a geode of 320 faces.
#[derive(Clone, Debug, Serialize)]
pub struct Isotropy {
    /// Contacts counted (each once).
    pub contacts: usize,
    /// rms(f_i / p_i − 1), weighted by solid angle: f_i the share of directions in face i, p_i its share of the sphere.
    pub deviation: f64,
    /// The same for that many random directions.
    pub shot_noise: f64,
    /// Σ (f_i − 1/320)²/320, the measure as Jebahi et al. (2015), eq. (2.8), print it.
    pub mean_square: f64,
    /// Counts per face, for a histogram.
    pub histogram: Vec<u32>,
}

/// Deviation beyond shot noise of directions that are ordered. A share c of contacts along the 12 directions of a dense crystal adds
/// c √(320/12), or 5 c.
const ORDERED: f64 = 0.15;

impl Isotropy {
    /// Whether the deviation is within 20 % of that of random directions.
    pub fn isotropic(&self) -> bool {
        self.deviation <= 1.2 * self.shot_noise
    }

    /// Whether directions deviate by what order brings. Walls make those of large packings uneven by more than their shot noise, which
    /// falls with the number of contacts, and by less than this.
    pub fn ordered(&self) -> bool {
        !self.isotropic() && self.excess() > ORDERED
    }

    /// Deviation beyond shot noise.
    fn excess(&self) -> f64 {
        (self.deviation.powi(2) - self.shot_noise.powi(2)).max(0.0).sqrt()
    }

    /// Counts directions; each falls on its face and on the opposite one.
    pub fn of(directions: impl Iterator<Item = Vec3>) -> Self {
        let geode = Geode::new();
        let mut histogram = vec![0u32; geode.solid_angle.len()];
        let mut contacts = 0;
        for direction in directions {
            histogram[geode.face(&direction)] += 1;
            histogram[geode.face(&-direction)] += 1;
            contacts += 1;
        }
        let total = 2.0 * contacts as f64;
        let faces = histogram.len() as f64;
        let (mut square, mut plain) = (0.0, 0.0);
        for (&count, &angle) in histogram.iter().zip(&geode.solid_angle) {
            let share = angle / (4.0 * PI);
            let f = f64::from(count) / total;
            square += share * (f / share - 1.0).powi(2);
            plain += (f - 1.0 / faces).powi(2) / faces;
        }
        // A face and its opposite hold the same counts: `faces`/2 independent bins of share 2p, each with relative
        // variance (1 − 2p)/(2p n); weighted by 2p this sums to (faces/2 − 1)/n.
        let shot_noise = ((faces / 2.0 - 1.0) / contacts as f64).sqrt();
        Isotropy { contacts, deviation: square.sqrt(), shot_noise, mean_square: plain, histogram }
    }
}

/// An icosahedron whose faces are split twice and projected on the sphere: 20 × 4 × 4 faces.
struct Geode {
    /// Corner triples, level by level: 20, then 80, then 320; the children of face k are 4k..4k+4.
    levels: [Vec<[Vec3; 3]>; 3],
    solid_angle: Vec<f64>,
}

impl Geode {
    fn new() -> Self {
        let g = 0.5 * (1.0 + 5f64.sqrt());
        let mut corners = Vec::new();
        for s in [-1.0, 1.0] {
            for t in [-g, g] {
                corners.extend([Vec3::new(0.0, s, t), Vec3::new(s, t, 0.0), Vec3::new(t, 0.0, s)]);
            }
        }
        let mut first = Vec::new();
        let near = |a: &Vec3, b: &Vec3| (a - b).norm() < 2.01;
        for i in 0..12 {
            for j in i + 1..12 {
                for k in j + 1..12 {
                    let (a, b, c) = (corners[i], corners[j], corners[k]);
                    if near(&a, &b) && near(&b, &c) && near(&c, &a) {
                        let outward = (b - a).cross(&(c - a)).dot(&a) > 0.0;
                        first.push(if outward { [a, b, c] } else { [a, c, b] }.map(|p| p.normalize()));
                    }
                }
            }
        }
        let second: Vec<_> = first.iter().flat_map(split).collect();
        let third: Vec<_> = second.iter().flat_map(split).collect();
        // Van Oosterom and Strackee (1983).
        let angle = |[a, b, c]: &[Vec3; 3]| 2.0 * atan2(a.dot(&b.cross(c)), 1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let solid_angle = third.iter().map(angle).collect();
        Geode { levels: [first, second, third], solid_angle }
    }

    /// The face that a direction passes through: at each level the child whose least edge distance is largest.
    fn face(&self, direction: &Vec3) -> usize {
        let inside = |[a, b, c]: &[Vec3; 3]| {
            a.cross(b).dot(direction).min(b.cross(c).dot(direction)).min(c.cross(a).dot(direction))
        };
        let best = |range: std::ops::Range<usize>, level: &[[Vec3; 3]]| {
            let mut best = (f64::NEG_INFINITY, range.start);
            for k in range {
                let value = inside(&level[k]);
                if value > best.0 {
                    best = (value, k);
                }
            }
            best.1
        };
        let mut face = best(0..20, &self.levels[0]);
        for level in &self.levels[1..] {
            face = best(4 * face..4 * face + 4, level);
        }
        face
    }
}

fn split([a, b, c]: &[Vec3; 3]) -> [[Vec3; 3]; 4] {
    let (ab, bc, ca) = ((a + b).normalize(), (b + c).normalize(), (c + a).normalize());
    [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;

    fn random_directions(count: usize, seed: u64) -> Vec<Vec3> {
        let mut random = Random::new(seed);
        let mut directions = Vec::new();
        while directions.len() < count {
            let v = Vec3::from_fn(|_, _| random.between(-1.0, 1.0));
            if (0.01..1.0).contains(&v.norm()) {
                directions.push(v.normalize());
            }
        }
        directions
    }

    #[test]
    fn geode_covers_the_sphere_with_320_slightly_unequal_faces() {
        let geode = Geode::new();
        assert_eq!(geode.solid_angle.len(), 320);
        let total: f64 = geode.solid_angle.iter().sum();
        assert!((total - 4.0 * PI).abs() < 1e-12);
        let mean = total / 320.0;
        let (low, high) =
            geode.solid_angle.iter().fold((9.0f64, 0.0f64), |(l, h), &a| (l.min(a / mean), h.max(a / mean)));
        assert!(low > 0.85 && high < 1.25 && high > 1.1, "{low} {high}");
    }

    #[test]
    fn random_directions_show_their_shot_noise() {
        for (count, seed) in [(5_000, 1), (60_000, 2)] {
            let isotropy = Isotropy::of(random_directions(count, seed).into_iter());
            let ratio = isotropy.deviation / isotropy.shot_noise;
            assert!((0.8..1.2).contains(&ratio), "{ratio}");
            assert!(isotropy.isotropic());
        }
    }

    #[test]
    fn a_preferred_direction_is_seen() {
        for (share, isotropic, ordered) in [(0.0, true, false), (0.015, false, false), (0.05, false, true)] {
            let crystal = |at: usize| [Vec3::x(), Vec3::y(), Vec3::z()][at % 3];
            let count = (20_000.0 * share) as usize;
            let directions = random_directions(20_000, 3).into_iter().chain((0..count).map(crystal));
            let isotropy = Isotropy::of(directions);
            assert_eq!((isotropy.isotropic(), isotropy.ordered()), (isotropic, ordered), "{isotropy:?}");
        }
    }
}
