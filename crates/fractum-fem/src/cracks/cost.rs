//! What the damage of solids has taken, by where it lies: at cracks, ahead of them, beside them.

use fractum_math::{Vec3, numbered_parts};

use crate::cracks::crack::volume_of_edge;
use crate::cracks::crack_surface::{CrackFacet, CrackSurface};
use crate::cracks::separation::{OTHER_FACE, area_without_load, projected_facets};
use crate::solid::Solid;

/// Distance from the axis of a facet, in lengths of an edge, within which the edge lies behind it.
const BEHIND: f64 = 0.75;
/// Pairs of an edge and a facet that are looked at, at most; of more each edge of a few is.
const MOST_PAIRS: usize = 50_000_000;

/// Fracture energy of the cracks of a solid, and how much of it edges have spent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CrackCost {
    /// Fracture energy of the area that has separated [J].
    pub area: f64,
    /// The same of its faces as if each were as flat as its rim lets it be [J]: rough faces of few elements have more than their mean plane.
    pub flat: f64,
    /// Spent by edges of elements that are gone [J].
    pub at_cracks: f64,
    /// Spent by edges behind the faces of a crack, which it has unloaded [J].
    pub beside: f64,
    /// Spent by all others, such as those ahead of a crack [J].
    pub ahead: f64,
    /// Middle of the edge beside a crack that has spent most, without load [m].
    pub place: Vec3,
}

/// An edge with damage, all of whose elements are there.
struct Whole {
    middle: Vec3,
    length: f64,
    spent: f64,
}

/// What the cracks of a solid have cost; none without one, with a phase field, beds or cracks that rub, or where fracture energy grows with the rate of strain.
pub fn cost_of_cracks(solid: &Solid) -> Option<CrackCost> {
    let zones = || solid.bodies.iter().filter_map(|model| Some((model, model.body.damage.as_ref()?)));
    let has_one_energy = zones().all(|(model, zone)| {
        model.phase.is_none()
            && model.elasticity.bedded.is_none()
            && zone.law.friction.is_none()
            && zone.rate.as_ref().is_none_or(|rate| rate.energy.is_empty())
    });
    let surface = CrackSurface::of(solid);
    if !has_one_energy || surface.facets.is_empty() {
        return None;
    }
    let energy_of = |body: usize| solid.bodies[body].body.damage.as_ref().map_or(0.0, |zone| zone.law.fracture_energy);
    let projected = projected_facets(solid, &surface);
    let facets = || surface.facets.iter().zip(&projected);
    let area = facets().map(|(facet, (area, _))| 0.5 * area * energy_of(facet.removed.0)).sum();
    let flat = flat_faces(&surface, &projected, |facet| area_without_load(solid, facet) * energy_of(facet.removed.0));
    let faces: Vec<(Vec3, Vec3)> =
        facets().map(|(facet, (_, normal))| (middle_of(solid, &facet.nodes), *normal)).collect();
    let (mut at_cracks, mut whole) = (0.0, Vec::new());
    for (body, field) in solid.damaged_fields() {
        let model = &solid.bodies[body];
        let Some(edges) = &model.edges else { continue };
        for (at, state) in field.state.iter().enumerate().filter(|(_, state)| state.damage > 0.0) {
            let (edge, length) = (field.edges[at], field.length[at]);
            let part = field.softens.spent_ratio(state.kappa, field.strength[at], length);
            let spent = part * volume_of_edge(solid, body, edge) / length * energy_of(body);
            if edges.around(edge).iter().all(|&element| model.alive[element as usize]) {
                let [a, b] = edges.nodes(edge).map(|node| solid.reference[node as usize]);
                whole.push(Whole { middle: (a + b) * 0.5, length, spent });
            } else {
                at_cracks += spent;
            }
        }
    }
    let (beside, place) = beside(&whole, &faces);
    let ahead = (whole.iter().map(|edge| edge.spent).sum::<f64>() - beside).max(0.0);
    Some(CrackCost { area, flat, at_cracks, beside, ahead, place })
}

/// Half of the sizes of the sums of a vector over the facets of each face; the two faces of a crack face each other.
fn flat_faces(surface: &CrackSurface, projected: &[(f64, Vec3)], vector: impl Fn(&CrackFacet) -> Vec3) -> f64 {
    let around = |one: u32| surface.neighbours.row(one as usize).iter().map(move |&other| [one, other]);
    let is_face = |[one, other]: &[u32; 2]| projected[*one as usize].1.dot(&projected[*other as usize].1) > OTHER_FACE;
    let count = surface.facets.len();
    let (face, faces) = numbered_parts(count, (0..count as u32).flat_map(around).filter(is_face));
    let mut sums = vec![Vec3::zeros(); faces as usize];
    surface.facets.iter().zip(&face).for_each(|(facet, &face)| sums[face as usize] += vector(facet));
    sums.iter().map(|sum| 0.5 * sum.norm()).sum()
}

/// What edges behind faces have spent [J], and the middle of the one that has spent most [m].
fn beside(edges: &[Whole], faces: &[(Vec3, Vec3)]) -> (f64, Vec3) {
    let stride = (edges.len() * faces.len()).div_ceil(MOST_PAIRS).max(1);
    let is_behind = |edge: &Whole| {
        faces.iter().any(|(middle, normal)| {
            let away = edge.middle - middle;
            let depth = -away.dot(normal);
            depth > 0.0 && away.norm_squared() - depth * depth < (BEHIND * edge.length).powi(2)
        })
    };
    let (mut spent, mut looked_at, mut most, mut place) = (0.0, 0.0, 0.0, Vec3::zeros());
    for edge in edges.iter().step_by(stride) {
        looked_at += edge.spent;
        if is_behind(edge) {
            spent += edge.spent;
            if edge.spent > most {
                (most, place) = (edge.spent, edge.middle);
            }
        }
    }
    let all: f64 = edges.iter().map(|edge| edge.spent).sum();
    (if looked_at > 0.0 { spent / looked_at * all } else { 0.0 }, place)
}

/// Middle of a facet without load; in the plane a side repeats its second node.
fn middle_of(solid: &Solid, &[a, b, c]: &[u32; 3]) -> Vec3 {
    let at = |node: u32| solid.reference[node as usize];
    if b == c { (at(a) + at(b)) * 0.5 } else { (at(a) + at(b) + at(c)) / 3.0 }
}
