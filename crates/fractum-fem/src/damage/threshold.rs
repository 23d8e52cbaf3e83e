use std::sync::Arc;

use fractum_math::Vec3;
use fractum_parallel::{Exchange, gather};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::body::edges::BodyEdges;
use crate::body::rate::RateCurves;
use crate::body::{Body, DamageZone, ElementKind, Formulation, Region, Regularisation};
use crate::cells::cell::Geometry;
use crate::damage::phase::PhaseLaw;
use crate::error::SolidError;

/// Element sizes in the length of a phase field by default: of one size motion leaves the family of solutions, more costs accuracy.
const SIZES_OF_LENGTH: f64 = 2.0;

/// Largest size over the small ones that counts as the same: an irregular mesh of one size reaches 1.5 times its tenth percentile.
const ONE_SIZE: f64 = 1.5;

/// Characteristic length that an edge of lowered or raised strength has at most, over the one at which softening snaps back.
pub const IN_RESERVE: f64 = 0.9;

/// Strength and characteristic length of the edges of a body.
pub(crate) struct Threshold {
    /// Edges that it knows, ascending; none where it knows all.
    known: Option<Vec<u32>>,
    /// Strength of each of them [Pa]; infinite where damage may not occur.
    strength: Vec<f64>,
    /// Characteristic length of each of them [m].
    length: Vec<f64>,
    pub(crate) report: LengthReport,
    /// The law of the phase field, where there is one.
    pub(crate) phase: Option<PhaseLaw>,
    /// How edges grow stronger with the rate of strain, where they do.
    pub(crate) rate: Option<Arc<RateCurves>>,
}

/// How a body's elements suit its softening.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LengthReport {
    /// Edges whose strength was lowered to fit their length.
    pub reduced_edges: usize,
    /// Largest ratio of a length to the largest one possible: of a characteristic length to that at which softening snaps back, of that of a phase field to the
    /// longest it may be.
    pub largest_ratio: f64,
    /// Mean size of the elements where cracks are expected, the small ones of those that may be damaged [m].
    pub size: f64,
}

impl Threshold {
    /// Characteristic lengths c · mean (regular edge of the sharing elements), and the guard against snap-back.
    ///
    /// - `longest`: largest factor on a characteristic length, by the direction of beds
    /// - `known`: edges that it shall know, ascending, where several ranks know some each and all call it; none for all
    pub(crate) fn new(
        (body, longest): (&Body, f64),
        zone: &DamageZone,
        edges: &BodyEdges,
        nodes: &[Vec3],
        volumes: &[f64],
        known: Option<(&[u32], &dyn Exchange)>,
    ) -> Result<Self, SolidError> {
        let (known, exchange) = known.unzip();
        let geometry = Geometry { body, nodes };
        let of_edge = |edge| characteristic_length(&geometry, &edges.around(edge), |element| volumes[element as usize]);
        let length: Vec<f64> = match known {
            Some(known) => known.par_iter().map(|&edge| of_edge(edge)).collect(),
            None => (0..edges.len() as u32).into_par_iter().map(of_edge).collect(),
        };
        let size = size_where_cracks_go(&geometry, zone, edges, volumes);
        let law = |regularisation: Regularisation| {
            PhaseLaw::of(body, zone, [regularisation.length.unwrap_or(SIZES_OF_LENGTH * size), size])
        };
        let phase = zone.regularisation.map(law).transpose()?;
        let (mut lengths, mut strength) = (Lengths::default(), Vec::with_capacity(length.len()));
        for (place, &length) in length.iter().enumerate() {
            let edge = known.map_or(place as u32, |known| known[place]);
            strength.push(lengths.arm((body, longest), zone, edge, phase.as_ref().ok_or(length)));
        }
        if let Some(exchange) = exchange {
            lengths = gather(exchange, &lengths).into_iter().fold(Lengths::default(), Lengths::with);
        }
        let Lengths { reduced_edges, largest_ratio, worst } = lengths;
        if let Some(TooLong { edge, length, limit, .. }) = worst.filter(|_| !zone.reduce_strength_to_fit) {
            let [i, j] = edges.nodes(edge);
            let [x, y, z] = ((nodes[i as usize] + nodes[j as usize]) * 0.5).into();
            let body = body.name.clone();
            return Err(match &phase {
                Some(law) => SolidError::LengthTooLong { body, x, y, z, length, limit, size: law.size },
                None => SolidError::ElementTooLarge { body, x, y, z, length, limit, count: reduced_edges },
            });
        }
        let known = known.map(<[u32]>::to_vec);
        Ok(Threshold {
            known,
            strength,
            length,
            report: LengthReport { reduced_edges, largest_ratio, size },
            phase,
            rate: zone.rate.clone(),
        })
    }

    fn place(&self, edge: u32) -> usize {
        self.known.as_ref().map_or(edge as usize, |known| known.binary_search(&edge).expect("one of those it knows"))
    }

    /// Strength of an edge [Pa]; infinite where damage may not occur.
    pub(crate) fn strength(&self, edge: u32) -> f64 {
        self.strength[self.place(edge)]
    }

    /// Characteristic length of an edge [m].
    pub(crate) fn length(&self, edge: u32) -> f64 {
        self.length[self.place(edge)]
    }
}

/// How long edges are for their fracture energy.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Lengths {
    /// Edges whose strength was lowered to fit their length.
    reduced_edges: usize,
    /// Largest ratio of a length to the largest one possible.
    largest_ratio: f64,
    /// The edge with that ratio, the first of several, where it is too large.
    worst: Option<TooLong>,
}

/// An edge that is too long for its fracture energy.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct TooLong {
    edge: u32,
    length: f64,
    /// Of its length to the largest one possible, which is the last [m].
    ratio: f64,
    limit: f64,
}

impl Lengths {
    /// Strength of an edge [Pa], lowered to fit its length; infinite where damage may not occur.
    ///
    /// - `over`: the phase field by which it softens, or without one its length [m]
    fn arm(
        &mut self,
        (body, longest): (&Body, f64),
        zone: &DamageZone,
        edge: u32,
        over: Result<&PhaseLaw, f64>,
    ) -> f64 {
        if matches!(&zone.region, Region::Edges(marked) if !marked[edge as usize]) {
            return f64::INFINITY;
        }
        let factor = |factors: &[f64]| factors.get(edge as usize).copied().unwrap_or(1.0);
        let given = zone.law.tensile_strength * factor(&zone.strength_factor);
        let mut strength = given * factor(&zone.strength_by_chance);
        let (modulus, energy) = (body.opening_modulus(), zone.law.fracture_energy);
        // The limit goes with 1/f_t²; that of a phase field has a reserve of its own.
        let (length, reserve) = over.map_or_else(|length| (length, IN_RESERVE), |law| (law.length, 1.0));
        let limit_of = |strength| match over {
            Ok(law) => law.largest_length(strength),
            Err(_) => zone.law.softening.largest_length(modulus, strength, energy) / longest,
        };
        let fits = |strength: f64| strength * (reserve / (length / limit_of(strength))).sqrt();
        if strength > given {
            strength = strength.min(fits(strength)).max(given);
        }
        // Elements must be small enough for the strength given: what chance adds is not asked of them.
        let limit = limit_of(strength.min(given));
        let ratio = length / limit;
        self.largest_ratio = self.largest_ratio.max(ratio);
        if ratio < 1.0 {
            return strength;
        }
        self.reduced_edges += 1;
        if self.worst.as_ref().is_none_or(|worst| ratio > worst.ratio) {
            self.worst = Some(TooLong { edge, length, ratio, limit });
        }
        fits(strength)
    }

    /// The same of other edges too.
    fn with(self, other: Self) -> Self {
        let order = |a: &TooLong, b: &TooLong| b.ratio.total_cmp(&a.ratio).then(a.edge.cmp(&b.edge));
        Lengths {
            reduced_edges: self.reduced_edges + other.reduced_edges,
            largest_ratio: self.largest_ratio.max(other.largest_ratio),
            worst: self.worst.into_iter().chain(other.worst).min_by(order),
        }
    }
}

/// Characteristic length of an edge [m].
///
/// - `around`: its elements; `volume`: of an element [m³]
pub(crate) fn characteristic_length(geometry: &Geometry, around: &[u32], volume: impl Fn(u32) -> f64) -> f64 {
    // Measured on tension bars of the gallery (aligned, jittered and Delaunay meshes of two sizes) and on bars without lateral
    // contraction, never on other cases: the middle of the range in which all of them dissipate G_f times the area.
    let factor = match (geometry.body.formulation, geometry.body.shape) {
        (Formulation::Smoothed, ElementKind::T4) => 1.2,
        (Formulation::Smoothed, ElementKind::T3) => 1.124,
        (Formulation::Standard, ElementKind::T4) => 1.2,
        (Formulation::Standard, ElementKind::T3) => 1.28,
    };
    let sum: f64 = around.iter().map(|&element| geometry.size(element, volume(element))).sum();
    factor * sum / around.len() as f64
}

/// Mean size of the elements where cracks are expected [m]: of those that may be damaged the small ones, up to
/// [`ONE_SIZE`] times the size that a tenth of them stays below. Whoever grades a mesh makes elements small where it will crack.
fn size_where_cracks_go(geometry: &Geometry, zone: &DamageZone, edges: &BodyEdges, volumes: &[f64]) -> f64 {
    let count = geometry.body.shape.edge_count();
    let armed = |edge: u32| !matches!(&zone.region, Region::Edges(marked) if !marked[edge as usize]);
    let may_break = |element| edges.of_element(element)[..count].iter().any(|&edge| armed(edge));
    let sizes = (0..).zip(volumes).filter(|(element, _)| may_break(*element));
    let mut sizes: Vec<f64> = sizes.map(|(element, &volume)| geometry.size(element, volume)).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let Some(small) = sizes.get(sizes.len() / 10) else { return 0.0 };
    let taken = &sizes[..sizes.partition_point(|size| *size <= ONE_SIZE * small)];
    taken.iter().sum::<f64>() / taken.len() as f64
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic};
    use fractum_mesh::generate::{Jitter, structured_rectangle};

    use super::*;
    use crate::solid::Solid;

    /// Length and element size of a plate of 40 x 10 cells of 10 mm, whose points are moved along x.
    fn sizes(jitter: Option<Jitter>, moved: impl Fn(f64) -> f64) -> [f64; 2] {
        let mesh = structured_rectangle([40, 10], [0.4, 0.1], jitter);
        let nodes = mesh.nodes.iter().map(|p| Vec3::new(moved(p.x), p.y, p.z)).collect();
        let elements = mesh.triangles.iter().map(|t| [t[0], t[1], t[2], t[2]]).collect();
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let mut body = Body::new("plate", ElementKind::T3, elements, elastic).smoothed();
        body = body.with_damage(DamageLaw::rankine(3e6, 1000.0));
        body.damage.as_mut().unwrap().regularisation = Some(Regularisation { length: None });
        crate::motion::phase_sizes(&Solid::new(nodes, vec![body]).unwrap(), 0).unwrap()
    }

    #[test]
    fn length_of_a_phase_field_is_two_elements_of_the_refined_part() {
        let one = 0.01 * (2.0 / 3f64.sqrt()).sqrt();
        for seed in 1..4 {
            let [length, size] = sizes(Some(Jitter { fraction: 0.15, seed }), |x| x);
            assert!((size / one - 1.0).abs() < 0.02 && (length / size - 2.0).abs() < 1e-12, "{size} of {one}");
            // Four times as long outside the middle fifth: 1.96 times the refined size in the mean of all.
            let graded = |x: f64| x + 3.0 * ((x - 0.24).max(0.0) - (0.16 - x).max(0.0));
            let [_, size] = sizes(Some(Jitter { fraction: 0.15, seed }), graded);
            assert!((size / one - 1.0).abs() < 0.05, "{size} of {one}");
        }
    }
}
