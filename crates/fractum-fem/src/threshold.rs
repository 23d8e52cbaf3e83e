use fractum_math::{Ragged, Vec3};
use rayon::prelude::*;

use crate::body::{Body, BodyEdges, DamageZone, ElementKind, Formulation, Region};
use crate::element::regular_edge;
use crate::error::SolidError;
use crate::phase::PhaseLaw;

/// Element sizes in the length of a phase field by default: of one size motion leaves the family of solutions, more costs accuracy.
const SIZES_OF_LENGTH: f64 = 2.0;

/// Characteristic length that an edge of lowered or raised strength has at most, over the one at which softening snaps back.
const IN_RESERVE: f64 = 0.9;

/// Strength and characteristic length of the edges of a body.
pub(crate) struct Threshold {
    /// Strength of each edge [Pa]; infinite where damage may not occur.
    pub(crate) strength: Vec<f64>,
    /// Characteristic length of each edge [m].
    pub(crate) length: Vec<f64>,
    /// Edges whose strength was lowered to fit their length.
    pub(crate) reduced_edges: usize,
    /// Largest ratio of a characteristic length to the largest one that softening allows.
    pub(crate) largest_length_ratio: f64,
    /// Length of the phase field, where there is one, and mean size of the elements in which it may occur [m].
    pub(crate) phase_sizes: Option<[f64; 2]>,
}

impl Threshold {
    /// Characteristic lengths c · mean (regular edge of the sharing elements), and the guard against snap-back.
    pub(crate) fn new(
        body: &Body,
        zone: &DamageZone,
        edges: &BodyEdges,
        elements_of_edge: &Ragged,
        nodes: &[Vec3],
        volumes: &[f64],
    ) -> Result<Self, SolidError> {
        // Measured on the tension bars of the gallery (aligned, jittered and Delaunay meshes of two sizes), never on other
        // cases: the middle of the range in which all of them dissipate G_f times the area within 6 %.
        let factor = match (body.formulation, body.shape) {
            (Formulation::Smoothed, ElementKind::T4) => 1.09,
            (Formulation::Smoothed, ElementKind::T3) => 1.124,
            (Formulation::Standard, ElementKind::T4) => 1.11,
            (Formulation::Standard, ElementKind::T3) => 1.28,
        };
        let length = |edge: usize| {
            let elements = elements_of_edge.row(edge);
            let sum: f64 = elements.iter().map(|&e| regular_edge(body.shape, volumes[e as usize] / body.depth())).sum();
            factor * sum / elements.len() as f64
        };
        let count = edges.nodes.len();
        let length: Vec<f64> = (0..count).into_par_iter().map(length).collect();
        let phase_sizes = zone.regularisation.map(|regularisation| {
            let size = mean_size(body, zone, edges, volumes);
            [regularisation.length.unwrap_or(SIZES_OF_LENGTH * size), size]
        });
        let phase_length = phase_sizes.map(|[length, _]| length);
        let mut threshold = Threshold {
            strength: vec![f64::INFINITY; count],
            length,
            reduced_edges: 0,
            largest_length_ratio: 0.0,
            phase_sizes,
        };
        let mut worst: Option<(usize, f64, f64)> = None;
        for edge in 0..count {
            if matches!(&zone.region, Region::Edges(marked) if !marked[edge]) {
                continue;
            }
            let mut strength = zone.law.tensile_strength * zone.strength_factor.get(edge).copied().unwrap_or(1.0);
            let (modulus, energy) = (body.elastic.young_modulus, zone.law.fracture_energy);
            let limit_at = |strength| match phase_length {
                Some(_) => PhaseLaw::largest_length(modulus, energy, strength),
                None => zone.law.softening.largest_length(modulus, strength, energy),
            };
            let ratio = phase_length.unwrap_or(threshold.length[edge]) / limit_at(strength);
            if ratio >= 1.0 {
                threshold.reduced_edges += 1;
                if worst.is_none_or(|(_, r, _)| ratio > r) {
                    worst = Some((edge, ratio, limit_at(strength)));
                }
                // The limit goes with 1/f_t².
                strength *= (IN_RESERVE / ratio).sqrt();
            }
            threshold.largest_length_ratio = threshold.largest_length_ratio.max(ratio);
            threshold.strength[edge] = strength;
        }
        if let (Some((edge, _, limit)), false) = (worst, zone.reduce_strength_to_fit) {
            let [i, j] = edges.nodes[edge];
            let middle = (nodes[i as usize] + nodes[j as usize]) * 0.5;
            let [x, y, z] = middle.into();
            if let Some(length) = phase_length {
                return Err(SolidError::LengthTooLong { body: body.name.clone(), x, y, z, length, limit });
            }
            return Err(SolidError::ElementTooLarge {
                body: body.name.clone(),
                x,
                y,
                z,
                length: threshold.length[edge],
                limit,
                count: threshold.reduced_edges,
            });
        }
        Ok(threshold)
    }
}

/// Mean size of the elements in which damage may occur [m].
fn mean_size(body: &Body, zone: &DamageZone, edges: &BodyEdges, volumes: &[f64]) -> f64 {
    let count = body.shape.edge_count();
    let armed = |edge: u32| !matches!(&zone.region, Region::Edges(marked) if !marked[edge as usize]);
    let sizes = edges.of_element.iter().zip(volumes).filter(|(of, _)| of[..count].iter().any(|&edge| armed(edge)));
    let (mut sum, mut elements) = (0.0, 0);
    for (_, volume) in sizes {
        sum += regular_edge(body.shape, volume / body.depth());
        elements += 1;
    }
    sum / f64::from(elements.max(1))
}
