//! The weak spots of a body: what flaws do to the edges around them.

use fractum_math::Vec3;
use fractum_parallel::{Exchange, gather};
use rayon::prelude::*;

use super::Edges;
use super::flaws::{Flaw, Reach};
use super::places::measure;

/// What a body has on all ranks.
pub(super) struct Total {
    /// Volume or area in which flaws can weaken it.
    pub(super) measure: f64,
    /// Elements that they lie in, at least one.
    pub(super) elements: f64,
    /// Mean volume of them (area in the plane).
    pub(super) size: f64,
}

/// Sums over the elements of all ranks, whatever their order: in whole numbers.
///
/// - `shares`: volume or area of each element; `is_owned`: elements that this rank counts
pub(super) fn total(
    exchange: Option<&dyn Exchange>,
    edges: &Edges<'_>,
    shares: &[f64],
    is_owned: impl Fn(usize) -> bool,
) -> Total {
    let edge_count = edges.body.shape.edge_count() as f64;
    let of_element = |element: usize| {
        let armed = edges.of_element(element).count() as f64 / edge_count;
        (armed > 0.0).then(|| [armed * shares[element], measure(edges, element)])
    };
    let told = (0..shares.len()).filter(|&element| is_owned(element) && shares[element] > 0.0);
    let values: Vec<[f64; 2]> = told.filter_map(of_element).collect();
    let larger = |a: [f64; 2], b: &[f64; 2]| [a[0].max(b[0]), a[1].max(b[1])];
    let own = values.iter().fold([0.0; 2], larger);
    let largest = exchange.map_or(own, |exchange| gather(exchange, &own).iter().fold([0.0; 2], larger));
    // Of one in 10²⁴ of the largest: far below rounding, wherever the body lies, and 10¹⁴ elements stay within 128 bits.
    let unit = largest.map(|value| value * 1e-24);
    let mut sums = [0, 0, values.len() as u128];
    for value in &values {
        (0..2).for_each(|k| sums[k] += (value[k] / unit[k]) as u128);
    }
    if let Some(exchange) = exchange {
        let all = gather(exchange, &sums);
        sums = std::array::from_fn(|k| all.iter().map(|sums| sums[k]).sum());
    }
    let elements = (sums[2] as f64).max(1.0);
    let [measure, size] = [0, 1].map(|k| sums[k] as f64 * unit[k]);
    Total { measure, elements, size: size / elements }
}

/// Level of the weakest flaw that reaches each edge: of those in its elements, and of those that reach its middle;
/// at most `most`.
///
/// - `flaws`: with the elements in which they are; `is_owned`: elements that this rank owns
/// - returns the weakest flaw of all ranks too
pub(super) fn weakest_of_edges(
    exchange: Option<&dyn Exchange>,
    edges: &Edges<'_>,
    flaws: &[(u32, Flaw)],
    (reach, most): (Reach, f64),
    is_owned: impl Fn(usize) -> bool,
) -> (Vec<f64>, Option<Flaw>) {
    let told = flaws.iter().filter(|(element, _)| is_owned(*element as usize));
    let told: Vec<[f64; 4]> = told.map(|(_, flaw)| flaw.numbers()).collect();
    let all = match exchange {
        Some(exchange) => gather(exchange, &told).concat(),
        None => told,
    };
    let near = Near::new(all, reach);
    let mut levels: Vec<f64> =
        (0..edges.ends.len()).into_par_iter().map(|edge| near.weakest(edges.middle(edge), most)).collect();
    for (element, flaw) in flaws {
        for edge in edges.of_element(*element as usize) {
            levels[edge] = levels[edge].min(flaw.level);
        }
    }
    (levels, near.weakest)
}

/// The same of particles: of flaws in them, and of those that reach their centres.
pub(super) fn weakest_of_particles(
    centres: &[Vec3],
    flaws: &[(u32, Flaw)],
    (reach, most): (Reach, f64),
) -> (Vec<f64>, Option<Flaw>) {
    let near = Near::new(flaws.iter().map(|(_, flaw)| flaw.numbers()).collect(), reach);
    let mut levels: Vec<f64> = centres.par_iter().map(|centre| near.weakest(*centre, most)).collect();
    for (particle, flaw) in flaws {
        levels[*particle as usize] = levels[*particle as usize].min(flaw.level);
    }
    (levels, near.weakest)
}

/// Flaws by how far they reach, each class twice as far as the next; the weakest reach farthest.
struct Near {
    reach: Reach,
    classes: Vec<Class>,
    weakest: Option<Flaw>,
}

/// Flaws by the cells of a grid as wide as the farthest of them reaches.
struct Class {
    width: f64,
    /// Ascending by cell.
    flaws: Vec<([i64; 3], [f64; 4])>,
}

impl Near {
    fn new(mut flaws: Vec<[f64; 4]>, reach: Reach) -> Self {
        flaws.par_sort_unstable_by(|a, b| a[3].total_cmp(&b[3]));
        let weakest = flaws.first().map(|[x, y, z, level]| Flaw { place: Vec3::new(*x, *y, *z), level: *level });
        let mut classes = Vec::new();
        let mut rest = &flaws[..];
        while let Some([.., level]) = rest.first() {
            let width = reach.at(*level);
            let count = rest.partition_point(|flaw| reach.at(flaw[3]) > 0.5 * width);
            classes.push(Class::new(&rest[..count], width));
            rest = &rest[count..];
        }
        Near { reach, classes, weakest }
    }

    /// Level of the weakest flaw that reaches a place; at most `most`.
    fn weakest(&self, place: Vec3, most: f64) -> f64 {
        // Flaws of later classes are stronger.
        let found = self.classes.iter().find_map(|class| class.weakest(place, &self.reach));
        found.unwrap_or(most)
    }
}

impl Class {
    fn new(flaws: &[[f64; 4]], width: f64) -> Self {
        let cell = |x: f64| (x / width).floor() as i64;
        let mut flaws: Vec<_> = flaws.iter().map(|f| ([cell(f[0]), cell(f[1]), cell(f[2])], *f)).collect();
        flaws.par_sort_unstable_by(|(a, f), (b, g)| a.cmp(b).then(f[3].total_cmp(&g[3])));
        Class { width, flaws }
    }

    fn weakest(&self, place: Vec3, reach: &Reach) -> Option<f64> {
        let [i, j, k] = [place.x, place.y, place.z].map(|x| (x / self.width).floor() as i64);
        let mut weakest = f64::INFINITY;
        for (i, j) in (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| (i, j))) {
            let first = self.flaws.partition_point(|(cell, _)| *cell < [i, j, k - 1]);
            for (_, [x, y, z, level]) in self.flaws[first..].iter().take_while(|(cell, _)| *cell <= [i, j, k + 1]) {
                if *level < weakest && (Vec3::new(*x, *y, *z) - place).norm() <= reach.at(*level) {
                    weakest = *level;
                }
            }
        }
        weakest.is_finite().then_some(weakest)
    }
}
