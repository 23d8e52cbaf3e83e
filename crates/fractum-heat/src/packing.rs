//! Conduction in a packing of spheres that stands for a continuum.

use std::f64::consts::PI;

use fractum_math::{Vec3, sphere_volume};
use fractum_sparse::{Preconditioner, SparseError};

use crate::implicit::{matrix, solve};
use crate::network::HeatNetwork;

/// Regular solids around a sphere of radius 1: number of faces, area of a face, and the volume fraction of the crystal whose
/// spheres have that many neighbours.
const SOLIDS: [(f64, f64, f64); 4] = [
    (4.0, 10.392_304_845_413_264, 0.340_087_380_793_915_8),
    (6.0, 4.0, PI / 6.0),
    (8.0, 2.598_076_211_353_316, 0.680_174_761_587_831_6),
    (12.0, 1.387_572_757_128_877_2, 0.740_480_489_693_060_9),
];
/// The icosahedron, for the areas of spheres of more than twelve neighbours.
const TWENTY: (f64, f64) = (20.0, 0.758_108_421_539_835_5);

/// What a sphere of a packing is to conduction, by its number of neighbours: the regular solid around it gives area and
/// volume.
///
/// Terreros, Iordanoff and Charles, *Comput. Mater. Sci.* 69 (2013) 46-52; Jebahi, André, Terreros and Iordanoff, *Discrete
/// Element Method to Model 3D Continuous Materials* (2015), Table 3.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PackedSphere {
    /// Area S̃ through which heat passes to each neighbour, over the square of the radius [-].
    pub area: f64,
    /// Share f of the volume that the sphere stands for that is its own [-].
    pub fraction: f64,
}

impl PackedSphere {
    /// By the number of neighbours: linear between the regular solids, with the outermost slopes below and above.
    pub fn of(neighbours: usize) -> Self {
        let n = neighbours as f64;
        let line = |(n0, v0): (f64, f64), (n1, v1): (f64, f64)| v0 + (n - n0) * (v1 - v0) / (n1 - n0);
        let upper = SOLIDS[1..3].iter().position(|solid| n <= solid.0).map_or(3, |i| i + 1);
        let [first, second] = [SOLIDS[upper - 1], SOLIDS[upper]];
        let last = (SOLIDS[3].0, SOLIDS[3].1);
        let area = match n > last.0 {
            // Beyond the icosahedron no less than the share of a sphere's own surface.
            true => line(last, TWENTY).max(4.0 * PI / n),
            false => line((first.0, first.1), (second.0, second.1)),
        };
        let fraction = match n < SOLIDS[0].0 {
            true => SOLIDS[0].2 * n / SOLIDS[0].0,
            false => line((first.0, first.2), (second.0, second.2)).min(1.0),
        };
        PackedSphere { area, fraction }
    }

    /// Conductance between two spheres [W/K]: λ √(S₁ S₂)/l.
    ///
    /// - `radius` of both [m]; `length`: distance of their centres [m]; `conductivity` λ [W/(m K)]
    pub fn conductance(spheres: [Self; 2], radius: [f64; 2], length: f64, conductivity: f64) -> f64 {
        let area = |k: usize| spheres[k].area * radius[k] * radius[k];
        (area(0) * area(1)).sqrt() * conductivity / length
    }

    /// Volume that a sphere stands for [m³]; none without neighbours.
    pub fn volume(&self, radius: f64) -> Option<f64> {
        (self.fraction > 0.0).then(|| sphere_volume(radius) / self.fraction)
    }
}

/// Conductivity of a prismatic body of points along its axis [W/(m K)]: temperatures grow by 1 K/m from one end to the other,
/// and what conducts in between is ∑ G ΔT² = λ V.
///
/// - `axis`: 0 to 2; `end` [m]: points this close to an end have its temperatures; `volume` of the body [m³]
///
/// # Errors
/// A system that was not solved.
pub fn effective_conductivity(
    network: &HeatNetwork,
    places: &[Vec3],
    axis: usize,
    end: f64,
    volume: f64,
) -> Result<f64, SparseError> {
    let along = |i: usize| places[i][axis];
    let low = (0..places.len()).map(along).fold(f64::INFINITY, f64::min);
    let high = (0..places.len()).map(along).fold(f64::NEG_INFINITY, f64::max);
    let lone = |i: usize| network.sums(i).1 == 0.0;
    let held: Vec<bool> = (0..places.len()).map(|i| along(i) < low + end || along(i) > high - end || lone(i)).collect();
    let mut temperature: Vec<f64> = (0..places.len()).map(along).collect();
    let mut flow = vec![0.0; places.len()];
    network.flows(&temperature, &mut flow);
    let right: Vec<[f64; 1]> = flow.iter().zip(&held).map(|(f, held)| [if *held { 0.0 } else { *f }]).collect();
    let matrix = matrix(network, 1.0, |_| 0.0, &held);
    let change = solve(&matrix, &mut Preconditioner::new(&matrix, None)?, &right)?;
    temperature.iter_mut().zip(change).for_each(|(t, [change])| *t += change);
    let dissipated = |(pair, &[i, j]): (usize, &[u32; 2])| {
        network.conductance(pair) * (temperature[i as usize] - temperature[j as usize]).powi(2)
    };
    Ok(network.pairs().iter().enumerate().map(dissipated).sum::<f64>() / volume)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every number of Table 3.1.
    #[test]
    #[allow(clippy::approx_constant)] // as printed
    fn the_published_table_is_reproduced() {
        let table = [
            (1, 19.98076, 0.08502),
            (2, 16.78460, 0.17004),
            (3, 13.58845, 0.25506),
            (4, 10.39230, 0.34008),
            (5, 7.19615, 0.43184),
            (6, 4.0, 0.52359),
            (7, 3.29903, 0.60188),
            (8, 2.59807, 0.68017),
            (9, 2.29545, 0.69525),
            (10, 1.99282, 0.71032),
            (11, 1.69019, 0.72540),
            (12, 1.38757, 0.74048),
            (13, 1.30888, 0.75555),
            (14, 1.23020, 0.77063),
            (15, 1.15152, 0.78570),
            (16, 1.07284, 0.80078),
            (17, 0.99415, 0.81586),
            (18, 0.91547, 0.83093),
            (19, 0.83679, 0.84601),
            (20, 0.75810, 0.86109),
        ];
        for (neighbours, area, fraction) in table {
            let found = PackedSphere::of(neighbours);
            assert!((found.area - area).abs() < 2e-5 && (found.fraction - fraction).abs() < 2e-5, "{found:?}");
        }
        assert!((20..200).all(|n| PackedSphere::of(n).area > 0.0 && PackedSphere::of(n).fraction <= 1.0));
    }

    #[test]
    fn a_simple_cubic_packing_conducts_as_its_continuum() {
        // Six neighbours: S = 4 R², l = 2 R, one cube of side 2 R per sphere. Surface spheres count as inner ones here.
        let (n, radius, conductivity) = (8usize, 0.5, 3.0);
        let at = |i: usize, j: usize, k: usize| (i + n * (j + n * k)) as u32;
        let mut pairs = Vec::new();
        let mut places = Vec::new();
        for (k, j, i) in (0..n).flat_map(|k| (0..n).flat_map(move |j| (0..n).map(move |i| (k, j, i)))) {
            places.push(Vec3::new(i as f64, j as f64, k as f64));
            let ends = [(i + 1, j, k), (i, j + 1, k), (i, j, k + 1)].into_iter().filter(|p| p.0.max(p.1).max(p.2) < n);
            pairs.extend(ends.map(|(a, b, c)| [at(i, j, k), at(a, b, c)]));
        }
        let sphere = PackedSphere::of(6);
        let own = PackedSphere::conductance([sphere; 2], [radius; 2], 1.0, conductivity);
        let network = HeatNetwork::new(vec![1.0; places.len()], &pairs, &vec![own; pairs.len()]);
        // Between the middles of the first and last spheres there are n - 1 cubes.
        let volume = (n * n * (n - 1)) as f64;
        let found = effective_conductivity(&network, &places, 0, 0.5, volume).unwrap();
        assert!((found / conductivity - 1.0).abs() < 1e-10, "{found}");
        assert!((sphere.volume(radius).unwrap() - 1.0).abs() < 1e-12);
    }
}
