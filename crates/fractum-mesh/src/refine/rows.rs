//! Rows of elements broken up: inner nodes move at random, are smoothed, and in the plane edges are flipped to Delaunay's.

use fractum_math::Vec3;
use rayon::prelude::*;

use crate::Mesh;
use crate::free::{WORST_SHAPE, around_nodes, free_nodes, groups_of_elements, is_plane};
use crate::generate::unit_interval;
use crate::quality::{area_vector, signed_volume};
use crate::topology::{NO_ELEMENT, TETRAHEDRON_EDGES, TETRAHEDRON_FACETS, sides_of_triangles};

/// Largest move of a node along each axis over the mean of the edges at it.
const SHARE: f64 = 0.35;
/// Cotangent of 22 degrees: the smallest angle that a move may leave to a triangle, unless it was smaller before.
const WORST_COTANGENT: f64 = 2.475_086_853_416_295_6;
/// Cosine of 20 degrees: the same for the dihedral angles of tetrahedra.
const WORST_COSINE: f64 = 0.939_692_620_785_908_4;
/// Rounds of smoothing: a second one brings back half of the rows, for shapes that are hardly better.
const ROUNDS: usize = 1;
/// Sum of the cotangents of the angles opposite to an edge below which the other diagonal is Delaunay's, by more than rounding.
const FLIPPED: f64 = -1e-9;
/// Flips of an edge at most, in the mean.
const MOST_FLIPS: usize = 30;
/// Length over the size that is asked for, up to which moves and flips may draw out edges.
const DRAWN_OUT: f64 = 1.25;

/// Moves inner nodes where a size and a seed are given.
///
/// - returns how many moved
pub(super) fn broken_up(
    mesh: &mut Mesh,
    size: &(dyn Fn(Vec3) -> f64 + Sync),
    seed: &(dyn Fn(Vec3) -> Option<u64> + Sync),
) -> usize {
    let plane = is_plane(mesh);
    let is_flat = mesh.triangles.iter().flatten().all(|&node| {
        let first = mesh.triangles[0][0];
        mesh.nodes[node as usize].z == mesh.nodes[first as usize].z
    });
    if plane && !is_flat {
        return 0;
    }
    let mut around = around_nodes(mesh);
    let free = free_nodes(mesh, &around);
    let seed_at = |node: usize| {
        let at = mesh.nodes[node];
        if free[node] && size(at) < f64::INFINITY { seed(at) } else { None }
    };
    let seeds: Vec<Option<u64>> = (0..mesh.nodes.len()).into_par_iter().map(seed_at).collect();
    let count = seeds.iter().flatten().count();
    if count == 0 {
        return 0;
    }
    let marked: Vec<bool> = seeds.iter().map(Option::is_some).collect();
    let longest = |at: Vec3| DRAWN_OUT * size(at);
    if plane && flip(mesh, &marked, &longest) {
        around = around_nodes(mesh);
    }
    let mut others = Vec::new();
    for (node, seed) in seeds.iter().enumerate() {
        let Some(seed) = seed else { continue };
        let (elements, at) = (around.row(node), mesh.nodes[node]);
        neighbours(mesh, elements, node as u32, &mut others);
        let sum: f64 = others.iter().map(|&other| (mesh.nodes[other as usize] - at).norm()).sum();
        let random = |axis: usize| 2.0 * unit_interval(*seed, 3 * node as u64 + axis as u64) - 1.0;
        let step = Vec3::new(random(0), random(1), if plane { 0.0 } else { random(2) });
        let step = step * (SHARE * sum / others.len() as f64);
        let star = Star { node, elements, others: &others, longest: longest(at) };
        // A move that spoils an element is tried by half and by a quarter.
        let _ = [1.0, 0.5, 0.25].into_iter().any(|part| star.moved(mesh, at + step * part));
    }
    for _ in 0..ROUNDS {
        if plane && flip(mesh, &marked, &longest) {
            around = around_nodes(mesh);
        }
        for node in (0..marked.len()).filter(|&node| marked[node]) {
            let (elements, at) = (around.row(node), mesh.nodes[node]);
            neighbours(mesh, elements, node as u32, &mut others);
            let middle = others.iter().map(|&other| mesh.nodes[other as usize]).sum::<Vec3>() / others.len() as f64;
            Star { node, elements, others: &others, longest: longest(at) }.moved(mesh, middle);
        }
    }
    if plane {
        flip(mesh, &marked, &longest);
    }
    count
}

/// Nodes that have an edge with a node, ascending, into `others`.
fn neighbours(mesh: &Mesh, elements: &[u32], node: u32, others: &mut Vec<u32>) {
    others.clear();
    if is_plane(mesh) {
        others.extend(elements.iter().flat_map(|&element| mesh.triangles[element as usize]));
    } else {
        others.extend(elements.iter().flat_map(|&element| mesh.tetrahedra[element as usize]));
    }
    others.retain(|&other| other != node);
    others.sort_unstable();
    others.dedup();
}

/// A node with what is around it.
struct Star<'a> {
    node: usize,
    elements: &'a [u32],
    others: &'a [u32],
    /// Length up to which edges may be drawn out.
    longest: f64,
}

impl Star<'_> {
    /// Moves the node unless that spoils an element at it.
    fn moved(&self, mesh: &mut Mesh, to: Vec3) -> bool {
        let from = mesh.nodes[self.node];
        let is_long = |&other: &u32| {
            let other = mesh.nodes[other as usize];
            (other - to).norm() > self.longest.max((other - from).norm())
        };
        if self.others.iter().any(is_long) {
            return false;
        }
        let before = self.worst(mesh);
        mesh.nodes[self.node] = to;
        let after = self.worst(mesh);
        let enough = if is_plane(mesh) { [0.0, -WORST_COTANGENT] } else { [WORST_SHAPE, -WORST_COSINE] };
        let fits = (0..2).all(|measure| after[measure] >= before[measure].min(enough[measure]));
        if !fits {
            mesh.nodes[self.node] = from;
        }
        fits
    }

    fn worst(&self, mesh: &Mesh) -> [f64; 2] {
        let shapes = self.elements.iter().map(|&element| shape(mesh, element));
        shapes.fold([f64::INFINITY; 2], |[a, b], [c, d]| [a.min(c), b.min(d)])
    }
}

/// Shape of an element by two numbers, the greater the better: its radius ratio and less the cosine of its smallest dihedral angle; of a triangle
/// less the cotangent of its smallest angle alone.
fn shape(mesh: &Mesh, element: u32) -> [f64; 2] {
    if is_plane(mesh) {
        return [1.0, -cotangent(mesh.triangles[element as usize].map(|node| mesh.nodes[node as usize]))];
    }
    let corners = mesh.tetrahedra[element as usize].map(|node| mesh.nodes[node as usize]);
    let volume = signed_volume(corners);
    if volume <= 0.0 {
        return [-1.0, -1.0];
    }
    let areas = TETRAHEDRON_FACETS.map(|facet| area_vector(facet.map(|corner| corners[corner])));
    let norms = areas.map(|area| area.norm());
    let [a, b, c] = [1, 2, 3].map(|corner| corners[corner] - corners[0]);
    let around = a.norm_squared() * b.cross(&c) + b.norm_squared() * c.cross(&a) + c.norm_squared() * a.cross(&b);
    let ratio = 108.0 * volume * volume / (norms.iter().sum::<f64>() * around.norm());
    let cosine = |[i, j]: [usize; 2]| -areas[i].dot(&areas[j]) / (norms[i] * norms[j]);
    [ratio, -TETRAHEDRON_EDGES.into_iter().map(cosine).fold(-1.0, f64::max)]
}

/// The cotangent of the smallest angle; infinite for a triangle that is turned over.
fn cotangent([a, b, c]: [Vec3; 3]) -> f64 {
    let twice = 2.0 * area_vector([a, b, c]).z;
    if twice <= 0.0 {
        return f64::INFINITY;
    }
    let largest = (b - a).dot(&(c - a)).max((a - b).dot(&(c - b))).max((a - c).dot(&(b - c)));
    largest / twice
}

/// Makes edges Delaunay's where a node at them is marked: between triangles of the same groups, and not on lines.
///
/// - `longest`: length at a place up to which edges may be drawn out
/// - returns whether any was changed
fn flip(mesh: &mut Mesh, marked: &[bool], longest: &dyn Fn(Vec3) -> f64) -> bool {
    let Ok(mut sides) = sides_of_triangles(&mesh.triangles) else { return false };
    let groups = groups_of_elements(mesh);
    let mut lines: Vec<[u32; 2]> = mesh.lines.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    lines.sort_unstable();
    let is_open = |side: usize| {
        let [one, two] = sides.elements[side];
        two != NO_ELEMENT
            && [one, two].iter().any(|&t| mesh.triangles[t as usize].iter().any(|&node| marked[node as usize]))
            && groups.row(one as usize) == groups.row(two as usize)
            && lines.binary_search(&sides.nodes[side]).is_err()
    };
    let open: Vec<bool> = (0..sides.nodes.len()).map(is_open).collect();
    let mut waits = open.clone();
    let mut todo: Vec<u32> = (0..open.len() as u32).rev().filter(|&side| open[side as usize]).collect();
    let (mut flips, most) = (0, MOST_FLIPS * todo.len());
    while let Some(side) = todo.pop() {
        waits[side as usize] = false;
        let [one, two] = sides.elements[side as usize].map(|element| element as usize);
        let corner = |t: usize| sides.of_element[t].iter().position(|&own| own == side).unwrap_or(0);
        let (i, j) = (corner(one), corner(two));
        // Counter-clockwise: r, p, q and s, q, p.
        let [r, p, q] = [0, 1, 2].map(|step| mesh.triangles[one][(i + step) % 3]);
        let s = mesh.triangles[two][j];
        let [at_r, at_p, at_q, at_s] = [r, p, q, s].map(|node| mesh.nodes[node as usize]);
        let area = |a: Vec3, b: Vec3, c: Vec3| 2.0 * area_vector([a, b, c]).z;
        let (first, second) = (area(at_r, at_p, at_q), area(at_s, at_q, at_p));
        let opposite = (at_p - at_r).dot(&(at_q - at_r)) / first + (at_p - at_s).dot(&(at_q - at_s)) / second;
        let is_convex = area(at_r, at_p, at_s) > 0.0 && area(at_s, at_q, at_r) > 0.0;
        let most_long = longest(0.5 * (at_r + at_s)).max((at_q - at_p).norm());
        if !(opposite < FLIPPED && (at_s - at_r).norm() <= most_long && first > 0.0 && second > 0.0 && is_convex)
            || flips == most
        {
            continue;
        }
        flips += 1;
        let [side_qr, side_rp] = [1, 2].map(|step| sides.of_element[one][(i + step) % 3]);
        let [side_ps, side_sq] = [1, 2].map(|step| sides.of_element[two][(j + step) % 3]);
        mesh.triangles[one] = [r, p, s];
        mesh.triangles[two] = [s, q, r];
        sides.of_element[one] = [side_ps, side, side_rp];
        sides.of_element[two] = [side_qr, side, side_sq];
        sides.nodes[side as usize] = [r.min(s), r.max(s)];
        for (other, from, to) in [(side_ps, two, one), (side_qr, one, two)] {
            let elements = &mut sides.elements[other as usize];
            elements.iter_mut().filter(|element| **element == from as u32).for_each(|element| *element = to as u32);
        }
        for other in [side_qr, side_rp, side_ps, side_sq] {
            if open[other as usize] && !std::mem::replace(&mut waits[other as usize], true) {
                todo.push(other);
            }
        }
    }
    flips > 0
}
