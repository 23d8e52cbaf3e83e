//! Sharp edges of solids on sharp edges of other solids: where two of them cross, no node is near, and the bodies touch all the same.

use fractum_contact::close_pairs;
use fractum_contact::law::{ContactLaw, ContactMemory, Linear, PairMotion, Rolling};
use fractum_fem::Solid;
use fractum_math::{Vec3, Work};
use serde::{Deserialize, Serialize};

use super::nodes_on_surface::frequency_square;
use super::solid_surface::SolidSurface;
use crate::coupling::Debris;

/// Cosine of the angle between the normals of the facets at an edge below which it is sharp: 20 degrees. Where facets of one size turn by
/// less, a node is late by less than 0.05 of their edges.
const SHARP: f64 = 0.94;
/// Skin of the search over the mean length of the edges.
const SKIN: f64 = 0.25;
/// Largest overlap of two edges over the shorter one's length.
const DEPTH: f64 = 0.5;
/// Sines below which a contact fades out: of the angle between two edges, and of that between their common normal and a facet's.
const FADES: f64 = 0.1;
/// Sine of the angle between two edges below which they are parallel.
const PARALLEL: f64 = 1e-3;
/// What an edge counts beyond its ends, over its length: more than rounding, so that crossings at nodes are found.
const BEYOND: f64 = 1e-9;
/// Distance over the skin within which crossings of several pairs are one: edges that meet at a node.
const ONE_PLACE: f64 = 1e-6;

/// A sharp edge of a solid.
#[derive(Clone, Debug)]
struct Edge {
    /// Its ends.
    nodes: [u32; 2],
    /// Nodes of its facets, counter-clockwise from outside.
    facets: [[u32; 3]; 2],
    /// Its solid, by the place among the surfaces, and its facets there.
    ground: usize,
    sides: [u32; 2],
    gone: bool,
}

/// Two edges that overlap.
#[derive(Clone, Copy, Debug)]
struct Crossing {
    /// Unit vector out of the first body, along the shortest way between both lines.
    normal: Vec3,
    overlap: f64,
    /// Shares of the second ends.
    along: [f64; 2],
    /// Part of the force that acts.
    weight: f64,
    /// Middle of the shortest way [m].
    place: Vec3,
}

/// What a contact remembers. Its stiffness lasts as it slides from edge to edge, so that its energy is one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Known {
    memory: ContactMemory,
    /// Normal stiffness [N/m].
    stiffness: f64,
    /// Part of the force that acted.
    weight: f64,
}

/// Two edges that are near each other.
#[derive(Clone, Copy, Debug)]
struct Pair {
    edges: [u32; 2],
    /// That of the last step, if they touched.
    known: Option<Known>,
    found: Option<Crossing>,
}

/// A contact of two edges at the last step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeTouch {
    /// Bodies of the solid.
    pub(crate) bodies: [usize; 2],
    /// Ends of both edges.
    pub(crate) nodes: [[u32; 2]; 2],
    /// Where [m].
    pub(crate) place: Vec3,
    /// Force on the second body [N].
    pub(crate) force: Vec3,
}

/// Contacts of sharp edges; nothing where fewer than two solids that may meet have any.
#[derive(Clone, Debug)]
pub(crate) struct EdgeContacts {
    edges: Vec<Edge>,
    skin: f64,
    searched_at: Vec<[Vec3; 2]>,
    /// Ascending by edges.
    pairs: Vec<Pair>,
    /// Places among the pairs of those that overlap.
    crossed: Vec<usize>,
    touches: Vec<EdgeTouch>,
    frequency_square: f64,
}

/// Contacts for a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct EdgeContactsState(Vec<([u32; 2], Known)>);

impl EdgeContacts {
    /// The sharp edges of surfaces that others may meet.
    pub(super) fn new(solids: &[SolidSurface]) -> Option<Self> {
        let mut edges = Vec::new();
        for (ground, surface) in solids.iter().enumerate().filter(|(_, surface)| surface.visitors().is_some()) {
            let (mesh, nodes) = (surface.mesh(), surface.nodes());
            let scene = |point: u32| nodes[point as usize];
            for edge in 0..mesh.edge_count() as u32 {
                let sides = mesh.sides(edge);
                let facets = sides.map(|side| [0, 1, 2].map(|k| mesh.corners(side)[k]));
                let [first, second] = facets.map(|facet| normal_of(facet.map(|c| surface.point(c))));
                let beyond = facets[1].iter().find(|c| !facets[0].contains(c));
                let falls = |&c: &u32| (surface.point(c) - surface.point(facets[0][0])).dot(&first) < 0.0;
                if first.dot(&second) < SHARP && beyond.is_some_and(falls) {
                    let (nodes, facets) = (mesh.edge(edge).map(scene), facets.map(|facet| facet.map(scene)));
                    edges.push(Edge { nodes, facets, ground, sides, gone: false });
                }
            }
        }
        let length = |edge: &Edge| {
            let [a, b] = mesh_ends(&solids[edge.ground], edge);
            (b - a).norm()
        };
        let meet = edges.iter().any(|edge: &Edge| edge.ground != edges[0].ground);
        meet.then(|| EdgeContacts {
            skin: SKIN * edges.iter().map(length).sum::<f64>() / edges.len() as f64,
            edges,
            searched_at: Vec::new(),
            pairs: Vec::new(),
            crossed: Vec::new(),
            touches: Vec::new(),
            frequency_square: 0.0,
        })
    }

    /// Leaves out edges whose facets have gone.
    pub(super) fn remove(&mut self, solids: &[SolidSurface]) {
        for edge in &mut self.edges {
            edge.gone |= edge.sides.iter().any(|&side| solids[edge.ground].mesh().is_gone(side));
        }
        self.searched_at.clear();
    }

    /// Looks up which edges are near each other if the skin is used up.
    fn search(&mut self, solid: &Solid, solids: &[SolidSurface]) {
        let ends = |edge: &Edge| edge.nodes.map(|n| solid.position(n as usize));
        let limit = 0.25 * self.skin * self.skin;
        let moved = |(edge, at): (&Edge, &[Vec3; 2])| {
            let now = ends(edge);
            !edge.gone && (0..2).any(|k| (now[k] - at[k]).norm_squared() > limit)
        };
        let known = self.searched_at.len() == self.edges.len();
        if known && !self.edges.iter().zip(&self.searched_at).any(moved) {
            return;
        }
        self.searched_at.clear();
        self.searched_at.extend(self.edges.iter().map(ends));
        let edges = &self.edges;
        let centres: Vec<Vec3> = self.searched_at.iter().map(|[a, b]| (a + b) * 0.5).collect();
        // What has gone is left out by a negative radius.
        let reach = |(edge, [a, b]): (&Edge, &[Vec3; 2])| if edge.gone { -1.0 } else { 0.5 * (b - a).norm() };
        let reach: Vec<f64> = edges.iter().zip(&self.searched_at).map(reach).collect();
        let meets = |&[i, j]: &[u32; 2]| {
            let [a, b] = [i, j].map(|k| edges[k as usize].ground);
            solids[a].meets(solids[b].body())
        };
        self.pairs.retain(|pair| pair.known.is_some());
        let touching = self.pairs.len();
        for edges in close_pairs(&centres, &reach, self.skin).into_iter().filter(meets) {
            if self.pairs[..touching].binary_search_by_key(&edges, |pair| pair.edges).is_err() {
                self.pairs.push(Pair { edges, known: None, found: None });
            }
        }
        self.pairs.sort_unstable_by_key(|pair| pair.edges);
    }

    /// Finds where edges overlap as they stand. Where edges meet at a node several pairs cross at one place; one of them counts.
    fn find(&mut self, solid: &Solid) {
        self.crossed.clear();
        for k in 0..self.pairs.len() {
            let found = self.crossing(self.pairs[k].edges, solid);
            self.pairs[k].found = found;
            let Some(found) = found else { continue };
            let same = |&at: &usize| {
                let other = self.pairs[at].found;
                other.is_some_and(|other| (other.place - found.place).norm() < ONE_PLACE * self.skin)
            };
            let Some(place) = self.crossed.iter().position(same) else {
                self.crossed.push(k);
                continue;
            };
            let keeps_first = self.pairs[self.crossed[place]].known.is_some() || self.pairs[k].known.is_none();
            let leaves = if keeps_first { k } else { std::mem::replace(&mut self.crossed[place], k) };
            self.pairs[leaves].found = None;
        }
    }

    fn crossing(&self, edges: [u32; 2], solid: &Solid) -> Option<Crossing> {
        let edges = edges.map(|k| &self.edges[k as usize]);
        let at = |n: u32| solid.position(n as usize);
        let [first, second] = edges.map(|edge| (edge.nodes.map(at), edge.facets.map(|facet| facet.map(at))));
        if edges.iter().any(|edge| edge.gone) { None } else { crossing(first, second) }
    }

    /// Hands what ended contacts remember to those that continue them along the same edges, or on edges that join them.
    fn pass_on(&mut self) {
        for &k in &self.crossed {
            if self.pairs[k].known.is_some() {
                continue;
            }
            let joins = |a: u32, b: u32| {
                let [a, b] = [a, b].map(|e| self.edges[e as usize].nodes);
                a.iter().any(|n| b.contains(n))
            };
            let pair = self.pairs[k].edges;
            let ended = self.pairs.iter().position(|other| {
                other.known.is_some() && other.found.is_none() && (0..2).all(|i| joins(other.edges[i], pair[i]))
            });
            if let Some(ended) = ended {
                self.pairs[k].known = self.pairs[ended].known.take();
            }
        }
    }

    /// Finds the contacts of the moment and adds their forces to the nodes.
    ///
    /// - `dt` [s]: the step that led here
    pub(super) fn add_forces(
        &mut self,
        solid: &mut Solid,
        debris: &mut Debris,
        solids: &[SolidSurface],
        dt: f64,
    ) -> Work {
        self.search(solid, solids);
        self.find(solid);
        self.pass_on();
        self.touches.clear();
        let mut work = Work::default();
        for k in 0..self.pairs.len() {
            let Pair { edges, known, found } = self.pairs[k];
            if let Some(found) = found {
                work += self.add_force(k, &found, solid, debris, solids, dt);
            } else if let Some(known) = known {
                // What springs still hold of a contact that slid off is lost.
                self.pairs[k].known = None;
                let ending = self.ended(edges, known, solid, debris, solids, dt);
                work += ending;
            }
        }
        work
    }

    /// The law of two edges, of which the smallest node gives the size, and how far a force moves them against each other [1/kg].
    fn law(
        &self,
        edges: [u32; 2],
        along: [f64; 2],
        solid: &Solid,
        debris: &Debris,
        solids: &[SolidSurface],
    ) -> (Linear, f64) {
        let [a, b] = edges.map(|k| &self.edges[k as usize]);
        let share = |edge: &Edge, t: f64| {
            (1.0 - t).powi(2) / solid.mass[edge.nodes[0] as usize] + t * t / solid.mass[edge.nodes[1] as usize]
        };
        let mobility = share(a, along[0]) + share(b, along[1]);
        let ends = a.nodes.iter().map(|n| (*n, b.ground)).chain(b.nodes.iter().map(|n| (*n, a.ground)));
        let smaller = |x: (u32, usize), y: (u32, usize)| if debris.radius(y.0) < debris.radius(x.0) { y } else { x };
        let (node, other) = ends.reduce(smaller).unwrap_or((a.nodes[0], b.ground));
        let law =
            debris.facet_law(node, 1.0 / mobility, (solids[other].elastic(), 0.0), solids[other].body_and_surface());
        (Linear { rolling: Rolling::default(), ..law }, mobility)
    }

    fn add_force(
        &mut self,
        place: usize,
        found: &Crossing,
        solid: &mut Solid,
        debris: &mut Debris,
        solids: &[SolidSurface],
        dt: f64,
    ) -> Work {
        let Pair { edges, known, .. } = self.pairs[place];
        let (law, mobility) = self.law(edges, found.along, solid, debris, solids);
        let law = known.map_or(law, |known| law.with_stiffness(known.stiffness));
        self.frequency_square = self.frequency_square.max(frequency_square(&law, mobility));
        let nodes = edges.map(|k| self.edges[k as usize].nodes);
        let shares = found.along.map(|t| [1.0 - t, t]);
        let mean =
            |edge: usize, of: &[Vec3]| -> Vec3 { (0..2).map(|k| of[nodes[edge][k] as usize] * shares[edge][k]).sum() };
        // The force acts on the line of the second edge; the first feels it there, a little beside its own.
        let arm = found.normal * -found.overlap;
        let turning = debris.turning_at(solid, nodes[0][0]);
        let velocity = mean(1, &solid.velocity) - mean(0, &solid.velocity) - turning.cross(&arm);
        let mut memory = known.map_or_else(ContactMemory::default, |known| known.memory);
        if known.is_none() {
            // What came from beside the end of an edge was within already: it gives no force for that.
            let before = found.overlap + velocity.dot(&found.normal) * dt;
            Linear::add_overlap_offset(&mut memory, before.max(0.0));
        }
        let spin = Vec3::zeros();
        let motion = PairMotion { normal: found.normal, overlap: found.overlap, velocity, spin, dt };
        let force = law.force(&motion, &mut memory);
        let (on_second, weight) = (force.on_second * found.weight, found.weight);
        for k in 0..2 {
            solid.force[nodes[0][k] as usize] -= on_second * shares[0][k];
            solid.force[nodes[1][k] as usize] += on_second * shares[1][k];
        }
        debris.add_torque_at(solid, nodes[0][0], arm.cross(&-on_second));
        let bodies = edges.map(|k| solids[self.edges[k as usize].ground].body());
        self.touches.push(EdgeTouch { bodies, nodes, place: found.place, force: on_second });
        self.pairs[place].known = Some(Known { memory, stiffness: law.normal_stiffness, weight });
        Work::contact(force.stored * weight, force.friction * weight, force.damping * weight)
    }

    /// What is left of a contact that ended: its springs relax.
    fn ended(
        &self,
        edges: [u32; 2],
        known: Known,
        solid: &Solid,
        debris: &Debris,
        solids: &[SolidSurface],
        dt: f64,
    ) -> Work {
        let (law, _) = self.law(edges, [0.5; 2], solid, debris, solids);
        let (law, mut memory) = (law.with_stiffness(known.stiffness), known.memory);
        let still = Vec3::zeros();
        let motion = PairMotion { normal: Vec3::x(), overlap: 0.0, velocity: still, spin: still, dt };
        let force = law.force(&motion, &mut memory);
        Work::contact(0.0, force.friction * known.weight, force.damping * known.weight)
    }

    /// Takes all contacts as they stand, without force; they touch no nearer until they have parted. Tells a node, the overlap [m] and the
    /// surface that it is in.
    pub(super) fn accept_initial_overlap(&mut self, solid: &Solid, solids: &[SolidSurface]) -> Vec<(u32, f64, usize)> {
        self.search(solid, solids);
        self.find(solid);
        let overlap = |pair: &Pair| {
            let [a, b] = pair.edges.map(|k| &self.edges[k as usize]);
            pair.found.map(|found| (a.nodes[0], found.overlap, b.ground))
        };
        // The first step finds them without memory, and at rest: all of their overlap was there before.
        self.pairs.iter().filter_map(overlap).collect()
    }

    /// Contacts of the last step.
    pub(super) fn touches(&self) -> &[EdgeTouch] {
        &self.touches
    }

    /// Largest squared frequency that the contacts so far give to a node [1/s²].
    pub(super) fn frequency_square(&self) -> f64 {
        self.frequency_square
    }

    pub(super) fn state(&self) -> EdgeContactsState {
        EdgeContactsState(self.pairs.iter().filter_map(|pair| Some((pair.edges, pair.known?))).collect())
    }

    pub(super) fn restore(&mut self, state: EdgeContactsState, solids: &[SolidSurface]) {
        self.remove(solids);
        let pair = |(edges, known)| Pair { edges, known: Some(known), found: None };
        self.pairs = state.0.into_iter().map(pair).collect();
    }
}

/// Ends of an edge as its mesh stands [m].
fn mesh_ends(surface: &SolidSurface, edge: &Edge) -> [Vec3; 2] {
    let at =
        |node: u32| surface.nodes().binary_search(&node).map_or_else(|_| Vec3::zeros(), |p| surface.point(p as u32));
    edge.nodes.map(at)
}

/// Outward normal of a facet.
fn normal_of([a, b, c]: [Vec3; 3]) -> Vec3 {
    (b - a).cross(&(c - a)).normalize()
}

/// Where two edges overlap, each given by its ends and its facets.
///
/// They overlap along their common normal, where that lies between the normals of the facets of both: outside, facets or
/// nodes are nearer.
fn crossing(first: ([Vec3; 2], [[Vec3; 3]; 2]), second: ([Vec3; 2], [[Vec3; 3]; 2])) -> Option<Crossing> {
    let ([p, p1], [q, q1]) = (first.0, second.0);
    let (u, v, w) = (p1 - p, q1 - q, p - q);
    let (a, b, c, d, e) = (u.norm_squared(), u.dot(&v), v.norm_squared(), u.dot(&w), v.dot(&w));
    let across = u.cross(&v);
    let sine = across.norm() / (a * c).sqrt();
    if sine < PARALLEL {
        return None;
    }
    let along = [(b * e - c * d) / across.norm_squared(), (a * e - b * d) / across.norm_squared()];
    if along.iter().any(|t| !(-BEYOND..=1.0 + BEYOND).contains(t)) {
        return None;
    }
    let out: Vec3 = first.1.iter().map(|&facet| normal_of(facet)).sum();
    let normal = across.normalize() * across.dot(&out).signum();
    let [on_first, on_second] = [p + u * along[0], q + v * along[1]];
    let overlap = (on_first - on_second).dot(&normal);
    if !(overlap > 0.0 && overlap < DEPTH * a.min(c).sqrt()) {
        return None;
    }
    let mut weight = fade(sine);
    for ((ends, facets), outward) in [(first, normal), (second, -normal)] {
        let way = (ends[1] - ends[0]).normalize();
        for facet in facets {
            // Into the facet, away from the edge.
            let middle: Vec3 = facet.iter().sum::<Vec3>() / 3.0 - ends[0];
            let inward = (middle - way * middle.dot(&way)).normalize();
            weight *= fade(-outward.dot(&inward));
        }
    }
    let place = (on_first + on_second) * 0.5;
    (weight > 0.0).then_some(Crossing { normal, overlap, along, weight, place })
}

/// Rises from 0 at 0 to 1 at `FADES`.
fn fade(sine: f64) -> f64 {
    let z = (sine / FADES).clamp(0.0, 1.0);
    z * z * (3.0 - 2.0 * z)
}
