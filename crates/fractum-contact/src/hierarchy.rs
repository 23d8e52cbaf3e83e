//! The double hierarchy: which of the facets near a sphere it really touches.

use fractum_math::Vec3;

use crate::foot::Foot;
use crate::passes::Passes;
use crate::surface::{FacetMesh, Feature};

/// Distance between two places, over the radius, below which they are one; it only has to be above rounding.
const SAME: f64 = 1e-11;

/// Finds the feet of spheres on a surface; keeps its working memory between calls.
///
/// 1. *Type*: of each facet only its closest place counts, on its inside, an edge or a point. A place on an edge or a point
///    is a contact only if no facet there comes nearer elsewhere (a facet goes before its edge, an edge before its ends):
///    what is left are the least distances along the surface. This is one contact on a smooth surface however it is cut
///    into facets, and all in a corner.
/// 2. *Distance*: contacts are taken from the nearest on; between parts that share no edge, one that does not rise above
///    the tangent plane of a nearer one is covered by it (Santasusana 2016; Oñate et al. 2017).
/// 3. *Weight*: where the surface is concave a further contact appears at a finite overlap if the edge is so shallow that
///    the sphere reaches it. Contacts i and j of a part are separated by a pass: the distance p at which one would have to
///    cross the surface between them, over the lowest edges on the way. Each counts with s_i/(s_i + Σ φ_ij s_j); its
///    standing s is the least of 2 (p - d_i)/((p - d_i) + (p - d_j)), at most 1: zero where it appears. The unity
///    φ_ij = (r - p)/(r - d), with the nearer of both distances, is one in a plane and zero where the sphere does not reach
///    the pass. So the force has no jump and does not depend on the cut of the surface, and a plane that is bent by
///    rounding is one plane.
#[derive(Clone, Debug, Default)]
pub struct DoubleHierarchy {
    found: Vec<Foot>,
    passes: Passes,
}

impl DoubleHierarchy {
    /// Feet of a sphere in ascending distance.
    ///
    /// - `points` [m]: of the surface now; `candidates`: facets that may be near, each once
    pub fn feet(
        &mut self,
        surface: &FacetMesh,
        points: &[Vec3],
        candidates: &[u32],
        centre: &Vec3,
        radius: f64,
        feet: &mut Vec<Foot>,
    ) {
        let DoubleHierarchy { found, passes } = self;
        found.clear();
        feet.clear();
        for &facet in candidates {
            let (feature, offset) = surface.closest(facet, points, centre);
            let square = offset.norm_squared();
            if square < radius * radius {
                let distance = square.sqrt();
                let normal = if distance > 0.0 { offset / distance } else { offset };
                found.push(Foot { feature, facet, offset, normal, distance, curvature: 0.0, weight: 1.0, twin: None });
            }
        }
        if found.len() > 1 {
            // No two are equal, so that an unstable sort has one result; it does not allocate.
            found.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.facet.cmp(&b.facet)));
        }
        for foot in found.iter() {
            let part = surface.part(foot.facet);
            let covered = |near: &Foot| {
                let same_place = (near.offset - foot.offset).norm_squared() <= (SAME * radius).powi(2);
                same_place || (surface.part(near.facet) != part && height(foot, near) <= SAME * radius)
            };
            if !feet.iter().any(covered) && is_least(foot, found, surface) {
                feet.push(*foot);
            }
        }
        if feet.len() > 1 {
            passes.weigh(feet, found, surface, points, centre, radius);
        }
    }
}

/// Whether no facet at the edge or point of a foot comes nearer to the centre elsewhere. Places a lateral distance s apart
/// differ by s²/2d only: where rounding makes them equal, a facet goes before its edge and an edge before its ends.
fn is_least(foot: &Foot, found: &[Foot], surface: &FacetMesh) -> bool {
    let rank = |foot: &Foot| match surface.feature(foot.feature) {
        Feature::Facet(_) => 0,
        Feature::Edge(_) => 1,
        Feature::Point(_) => 2,
    };
    let own = rank(foot);
    let (below, level) = (foot.distance * (1.0 - 1e-12), foot.distance * (1.0 + 1e-14));
    let beats = |k: &&Foot| k.distance < below || rank(k) < own;
    let mut near = found.iter().take_while(|k| k.distance <= level).filter(beats);
    own == 0 || !near.any(|k| surface.touches(k.facet, foot.feature))
}

/// Height of a foot over the tangent plane of another, towards the centre [m].
fn height(foot: &Foot, over: &Foot) -> f64 {
    (over.offset - foot.offset).dot(&over.normal)
}
