//! The double hierarchy: which of the facets near a sphere it really touches.

use fractum_math::Vec3;

use crate::foot::Foot;
use crate::passes::{Passes, Patch};
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
/// 3. *Energy*: the energy of a sphere is ∫ F(r - s) n(s) ds from 0 to r, with the force F of the law at an overlap and the number
///    n(s) of separate pieces that a ball of radius s about the centre cuts out of the surface. A piece begins at a contact and two become one at the pass
///    between them, the place at which one has to cross the surface from one to the other: each contact adds its energy U(r - d), each
///    pass that joins two contacts takes U(r - p). The force is the derivative: each distance acts at its own place, with the
///    sign of its energy. A contact that appears on a concave edge does so together with its pass, at one place, so that both cancel; two walls
///    that the sphere cannot cross between are two, a plane is one however it is cut or bent by rounding.
/// 4. *Hollows*: pieces may close to a ring around the bottom of a hollow, over a last pass at p; from the bottom at q on the ring is filled. Which of
///    the passes of a ring is the last changes with the place of the sphere, and the force would jump there. Where the hollow is shallow, r - q above half of r - p, the
///    energy is less by U(r - p) - U(r - q), which sets all passes of the ring equal; of deeper ones, and of holes, none of it is taken, and between both
///    a part (see `Passes`).
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
                found.push(Foot::contact(feature, facet, offset, normal, distance));
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
        if found.len() > 1 {
            passes.add_to(feet, &Patch { found, candidates, surface, points, centre, radius });
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
