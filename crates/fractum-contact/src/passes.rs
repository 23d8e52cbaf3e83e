//! Passes between the contacts of a sphere with one surface, and hollows that they surround.

use fractum_math::Vec3;

use crate::foot::Foot;
use crate::surface::{FacetMesh, closest_on_segment};

/// Overlap at the bottom of a hollow over that at its last pass from which the hollow counts as shallow.
const SHALLOW: f64 = 0.5;

/// What a sphere reaches of a surface.
pub(crate) struct Patch<'a> {
    /// Closest places of the facets within the radius, ascending in distance.
    pub(crate) found: &'a [Foot],
    /// Facets that may be near.
    pub(crate) candidates: &'a [u32],
    pub(crate) surface: &'a FacetMesh,
    pub(crate) points: &'a [Vec3],
    pub(crate) centre: &'a Vec3,
    pub(crate) radius: f64,
}

/// An edge between two facets within the radius.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Distance from the centre [m].
    distance: f64,
    edge: u32,
    /// Places of its facets among those found.
    sides: [u32; 2],
}

/// Finds passes and hollows; keeps its working memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Passes {
    crossings: Vec<Crossing>,
    /// Facets found, ascending, with their places.
    order: Vec<(u32, u32)>,
    /// Trees of facets that have joined, and whether a contact lies on one of them.
    root: Vec<u32>,
    touched: Vec<bool>,
    /// Points within the radius, once for each facet there, and whether both sides of the facet fall from there towards the centre.
    summits: Vec<(u32, bool)>,
    /// Crossings that close a ring, ascending.
    closing: Vec<Crossing>,
    /// Ends of these, ascending, the trees of those that have joined, and the farthest point of each tree.
    ends: Vec<u32>,
    joined: Vec<u32>,
    bottom: Vec<(f64, u32)>,
}

impl Patch<'_> {
    fn place_on(&self, edge: u32) -> Vec3 {
        let [a, b] = self.surface.edge(edge).map(|p| &self.points[p as usize]);
        closest_on_segment(self.centre, a, b)
    }

    fn offset_of(&self, point: u32) -> Vec3 {
        self.points[point as usize] - self.centre
    }

    /// The place of an edge that is closest to the centre.
    fn pass(&self, crossing: &Crossing) -> Foot {
        let offset = self.place_on(crossing.edge);
        let facet = self.found[crossing.sides[0] as usize].facet;
        let ends = self.surface.edge(crossing.edge);
        let at_end = ends.iter().find(|&&end| self.offset_of(end) == offset);
        let feature = at_end.map_or(self.surface.edge_feature(crossing.edge), |&p| self.surface.point_feature(p));
        let weights = Foot { weight: -1.0, energy: -1.0, ..self.foot(feature, facet, offset) };
        Foot { distance: crossing.distance, ..weights }
    }

    fn foot(&self, feature: u32, facet: u32, offset: Vec3) -> Foot {
        let distance = offset.norm();
        let normal = if distance > 0.0 { offset / distance } else { offset };
        Foot::contact(feature, facet, offset, normal, distance)
    }
}

impl Passes {
    /// Adds to the contacts of a sphere what they share, see [`DoubleHierarchy`](crate::DoubleHierarchy).
    pub(crate) fn add_to(&mut self, feet: &mut Vec<Foot>, patch: &Patch) {
        let has_hollow = self.find_bottoms(patch);
        if feet.len() < 2 && !has_hollow {
            return;
        }
        self.find_crossings(patch);
        self.join(feet, patch, has_hollow);
        if has_hollow {
            self.fill(feet, patch);
        }
    }

    /// Finds out whether some point is the bottom of a hollow: farther than all places around it.
    fn find_bottoms(&mut self, patch: &Patch) -> bool {
        let summits = &mut self.summits;
        summits.clear();
        for foot in patch.found {
            let corners = patch.surface.corners(foot.facet);
            let count = corners.len();
            for (k, &corner) in corners.iter().enumerate() {
                let offset = patch.offset_of(corner);
                if offset.norm_squared() < patch.radius * patch.radius {
                    let falls =
                        |other: u32| (patch.points[other as usize] - patch.points[corner as usize]).dot(&offset) < 0.0;
                    summits.push((corner, falls(corners[(k + 1) % count]) && falls(corners[(k + count - 1) % count])));
                }
            }
        }
        summits.sort_unstable();
        let is_bottom = |same: &[(u32, bool)]| {
            same.iter().all(|(_, falls)| *falls)
                && !patch.surface.is_open_at(patch.surface.point_feature(same[0].0), patch.candidates)
        };
        summits.chunk_by(|a, b| a.0 == b.0).any(is_bottom)
    }

    fn find_crossings(&mut self, patch: &Patch) {
        let Passes { crossings, order, .. } = self;
        order.clear();
        order.extend(patch.found.iter().zip(0..).map(|(f, place)| (f.facet, place)));
        order.sort_unstable();
        crossings.clear();
        for (own, foot) in (0..).zip(patch.found) {
            for (edge, other) in patch.surface.neighbours(foot.facet).filter(|(_, other)| *other > foot.facet) {
                if let Ok(beyond) = order.binary_search_by_key(&other, |(facet, _)| *facet) {
                    let distance = patch.place_on(edge).norm();
                    if distance < patch.radius {
                        crossings.push(Crossing { distance, edge, sides: [own, order[beyond].1] });
                    }
                }
            }
        }
        crossings.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.edge.cmp(&b.edge)));
    }

    /// Joins facets from the nearest crossing on. The part of a facet within a distance of the centre is convex, so that edges are all there is to cross.
    fn join(&mut self, feet: &mut Vec<Foot>, patch: &Patch, has_hollow: bool) {
        let Passes { crossings, order, root, touched, closing, .. } = self;
        root.clear();
        root.extend(0..patch.found.len() as u32);
        touched.clear();
        touched.resize(patch.found.len(), false);
        for foot in feet.iter() {
            let place = order.binary_search_by_key(&foot.facet, |(facet, _)| *facet);
            touched[order[place.expect("contacts are places that were found")].1 as usize] = true;
        }
        closing.clear();
        for crossing in crossings.iter() {
            let [a, b] = crossing.sides.map(|side| tree(root, side));
            if a == b {
                closing.extend(Some(*crossing).filter(|_| has_hollow));
                continue;
            }
            if touched[a as usize] && touched[b as usize] {
                feet.push(patch.pass(crossing));
            }
            let (kept, gone) = (a.min(b), a.max(b));
            root[gone as usize] = kept;
            touched[kept as usize] |= touched[gone as usize];
        }
    }

    /// Finds the hollow that each closing crossing surrounds, from the farthest on: its bottom is the nearer one of the farthest
    /// points on both sides. Points on the border, and those out of reach, are bottomless.
    fn fill(&mut self, feet: &mut Vec<Foot>, patch: &Patch) {
        let Passes { closing, ends, joined, bottom, .. } = self;
        ends.clear();
        ends.extend(closing.iter().flat_map(|crossing| patch.surface.edge(crossing.edge)));
        ends.sort_unstable();
        ends.dedup();
        joined.clear();
        joined.extend(0..ends.len() as u32);
        bottom.clear();
        bottom.extend(ends.iter().map(|&point| {
            let distance = patch.offset_of(point).norm();
            let is_open = || patch.surface.is_open_at(patch.surface.point_feature(point), patch.candidates);
            (if distance >= patch.radius || is_open() { f64::INFINITY } else { distance }, point)
        }));
        for crossing in closing.iter().rev() {
            let [a, b] = patch.surface.edge(crossing.edge).map(|end| {
                let place = ends.binary_search(&end).expect("ends of closing edges are listed");
                tree(joined, place as u32)
            });
            if a == b {
                continue;
            }
            let (far, near) = if bottom[a as usize].0 >= bottom[b as usize].0 { (a, b) } else { (b, a) };
            joined[near as usize] = far;
            let (distance, point) = bottom[near as usize];
            if distance.is_finite() && distance > crossing.distance {
                let pass = Foot { elastic: true, ..patch.pass(crossing) };
                let at_bottom = patch.foot(patch.surface.point_feature(point), pass.facet, patch.offset_of(point));
                add_hollow(feet, pass, Foot { elastic: true, ..at_bottom }, patch.radius);
            }
        }
    }
}

/// Takes U(δ_p) of the last pass of a ring, and adds U(δ) at the overlap δ = δ_q + λ (δ_p - δ_q), with λ = 0 for δ_q of the bottom above half of
/// δ_p, λ = 1 out of reach, and a cubic between; its derivatives by δ_p and δ_q act at pass and bottom.
fn add_hollow(feet: &mut Vec<Foot>, pass: Foot, bottom: Foot, radius: f64) {
    let (at_pass, at_bottom) = (radius - pass.distance, radius - bottom.distance);
    feet.push(pass);
    let ratio = at_bottom / at_pass;
    let z = ratio / SHALLOW;
    if z >= 1.0 {
        feet.push(bottom);
        return;
    }
    let (share, slope) = (1.0 - z * z * (3.0 - 2.0 * z), -6.0 * z * (1.0 - z) / SHALLOW);
    let distance = radius - (at_bottom + share * (at_pass - at_bottom));
    let by_pass = share - (1.0 - ratio) * ratio * slope;
    let by_bottom = 1.0 - share + (1.0 - ratio) * slope;
    feet.push(Foot { distance, weight: by_pass, energy: share, ..pass });
    feet.push(Foot { distance, weight: by_bottom, energy: 1.0 - share, ..bottom });
}

fn tree(root: &[u32], mut k: u32) -> u32 {
    while root[k as usize] != k {
        k = root[k as usize];
    }
    k
}
