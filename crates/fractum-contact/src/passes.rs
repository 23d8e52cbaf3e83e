use fractum_math::Vec3;

use crate::foot::Foot;
use crate::surface::{FacetMesh, closest_on_segment};

/// Passes between the contacts of a sphere with one surface, and the weights that follow from them; keeps its working
/// memory.
#[derive(Clone, Debug, Default)]
pub(crate) struct Passes {
    /// Edges between facets that were found: distance from the centre, and the places of both facets.
    edges: Vec<(f64, u32, u32)>,
    /// Facets found, ascending, with their places.
    order: Vec<(u32, u32)>,
    /// Trees of facets that have joined.
    root: Vec<u32>,
    /// Places of the facets of the feet.
    place: Vec<u32>,
    /// Pass between each two feet, at most the radius.
    pass: Vec<f64>,
    standing: Vec<f64>,
}

impl Passes {
    /// Sets the weights of contacts that are partly one, see [`DoubleHierarchy`](crate::DoubleHierarchy).
    pub(crate) fn weigh(
        &mut self,
        feet: &mut [Foot],
        found: &[Foot],
        surface: &FacetMesh,
        points: &[Vec3],
        centre: &Vec3,
        radius: f64,
    ) {
        let count = feet.len();
        self.find(feet, found, surface, points, centre, radius);
        let Passes { pass, standing, .. } = self;
        if pass.iter().all(|&p| p >= radius) {
            return;
        }
        let others = |i: usize| (0..count).filter(move |&j| j != i);
        standing.clear();
        for i in 0..count {
            let against = |j: usize| {
                let p = pass[i * count + j];
                let (own, other) = (p - feet[i].distance, p - feet[j].distance);
                if own + other > 1e-13 * radius { 2.0 * own / (own + other) } else { 1.0 }
            };
            standing.push(others(i).map(against).fold(1.0, f64::min).max(0.0));
        }
        for i in 0..count {
            let unity = |j: usize| {
                let near = feet[i].distance.min(feet[j].distance);
                (radius - pass[i * count + j]) / (radius - near)
            };
            let shared: f64 = others(i).map(|j| unity(j) * standing[j]).sum();
            let weight = if standing[i] + shared > 0.0 { standing[i] / (standing[i] + shared) } else { 1.0 };
            let twin = others(i).filter(|&j| unity(j) > 0.0).max_by(|&a, &b| unity(a).total_cmp(&unity(b)));
            (feet[i].weight, feet[i].twin) = (weight, twin.map(|j| j as u32));
        }
    }

    /// Finds the passes: from the lowest edge on, facets join; two feet meet over the edge that joins their facets. The
    /// part of a facet within a distance of the centre is convex, so that edges are all there is to cross.
    fn find(
        &mut self,
        feet: &[Foot],
        found: &[Foot],
        surface: &FacetMesh,
        points: &[Vec3],
        centre: &Vec3,
        radius: f64,
    ) {
        let Passes { edges, order, root, place, pass, .. } = self;
        let count = feet.len();
        pass.clear();
        pass.resize(count * count, radius);
        order.clear();
        order.extend(found.iter().zip(0..).map(|(f, place)| (f.facet, place)));
        order.sort_unstable();
        let place_of = |facet: u32| order.binary_search_by_key(&facet, |(f, _)| *f).map(|k| order[k].1);
        place.clear();
        place.extend(feet.iter().map(|foot| place_of(foot.facet).expect("feet are places that were found")));
        edges.clear();
        for (own, foot) in (0..).zip(found) {
            for (edge, other) in surface.neighbours(foot.facet).filter(|(_, other)| *other > foot.facet) {
                if let Ok(beyond) = place_of(other) {
                    let [a, b] = surface.edge(edge).map(|p| &points[p as usize]);
                    let distance = closest_on_segment(centre, a, b).norm();
                    if distance < radius {
                        edges.push((distance, own, beyond));
                    }
                }
            }
        }
        edges.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        root.clear();
        root.extend(0..found.len() as u32);
        let find = |root: &[u32], mut k: u32| {
            while root[k as usize] != k {
                k = root[k as usize];
            }
            k
        };
        for &(distance, a, b) in edges.iter() {
            let (a, b) = (find(root, a), find(root, b));
            if a == b {
                continue;
            }
            for i in 0..count {
                for j in 0..i {
                    let sets = (find(root, place[i]), find(root, place[j]));
                    if sets == (a, b) || sets == (b, a) {
                        let p = distance.max(feet[i].distance).max(feet[j].distance);
                        (pass[i * count + j], pass[j * count + i]) = (p, p);
                    }
                }
            }
            root[a.max(b) as usize] = a.min(b);
        }
    }
}
