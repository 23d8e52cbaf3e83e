//! Smaller elements where they are asked for.

mod bisect;
mod rows;
mod simplices;

use fractum_math::Vec3;
use rayon::prelude::*;

use crate::coincident::same_places;
use crate::free::is_plane;
use crate::quality::{Summary, area_vector, signed_volume, summarize_tetrahedra, summarize_triangles};
use crate::topology::{edges_of_tetrahedra, edges_of_triangles};
use crate::{Group, Mesh};
use bisect::Bisection;
use simplices::parts;

/// Area of a triangle over the square of the size that it is refined to, and volume of a tetrahedron over the cube, in the mean.
const OF_SIZE: [f64; 2] = [0.22, 0.022];
/// Elements at most, where nothing else is said.
const MOST: usize = 50_000_000;
/// Estimates beyond this multiple of the most are refused before an element is made.
const FAR_BEYOND: f64 = 4.0;
/// Memory that an element takes while a mesh is refined [bytes].
const OF_ELEMENT: f64 = 300.0;

/// What is asked beside the size of elements.
#[derive(Clone, Copy)]
pub struct RefineOptions<'a> {
    /// Where inner nodes move at random, which breaks up rows of elements: the seed of their moves; none where they stay.
    pub seed: &'a (dyn Fn(Vec3) -> Option<u64> + Sync),
    /// Elements at most.
    pub most: usize,
}

impl Default for RefineOptions<'_> {
    fn default() -> Self {
        RefineOptions { seed: &|_| None, most: MOST }
    }
}

/// A mesh with smaller elements, and what was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Refined {
    /// The mesh.
    pub mesh: Mesh,
    /// Tetrahedra (in the plane triangles) before and after.
    pub elements: [usize; 2],
    /// The longest edge where smaller ones were asked for, before and after.
    pub longest: [f64; 2],
    /// Mean length of edges there, afterwards.
    pub mean: f64,
    /// Nodes that were moved to break up rows.
    pub moved: usize,
    /// Size and shape of all elements, before and after.
    pub quality: [Summary; 2],
}

/// Why a mesh was not refined.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RefineError {
    /// It has no elements.
    #[error("the mesh has neither triangles nor tetrahedra")]
    Empty,
    /// It is a part of one, or cut already.
    #[error("the mesh is a part of another one, or has doubled nodes already")]
    NotWhole,
    /// A size that is none.
    #[error("a size of elements is {0}; it must be above 0")]
    Size(f64),
    /// No element lies where a size is asked for.
    #[error("no element lies where smaller ones are asked for")]
    Nowhere,
    /// More elements than allowed.
    #[error("more than {0} elements would come of it")]
    TooMany(usize),
}

/// The mesh with elements cut in two until no edge is longer than the size that is asked for along it, or in the middle of an element that
/// it is the longest edge of. Elements beside them are cut as far as conformity asks.
///
/// An element is cut at its longest edge alone, so that the smallest angle of a triangle is never less than half of what it was in the file
/// (Rosenberg and Stenger, *Math. Comput.* 29 (1975)). Groups of every dimension keep their names and places. Both sides of a face whose nodes
/// are doubled, such as that between two bodies, are cut alike.
///
/// Then, where a seed is given, inner nodes move at random, are smoothed, and in the plane the edges between them become Delaunay's.
///
/// - `size`: the longest edge at a place; infinite where none is asked for
///
/// # Errors
/// [`RefineError`].
pub fn refined(
    mesh: &Mesh,
    size: &(dyn Fn(Vec3) -> f64 + Sync),
    options: RefineOptions<'_>,
) -> Result<Refined, RefineError> {
    if mesh.whole.is_some() || !mesh.cuts.is_empty() {
        return Err(RefineError::NotWhole);
    }
    let before = summary(mesh).ok_or(RefineError::Empty)?;
    // Those that are far beyond the bound would fill the memory before they are counted.
    if estimated(mesh, size) > FAR_BEYOND * options.most as f64 {
        return Err(RefineError::TooMany(options.most));
    }
    let mut bisection = Bisection::new(mesh, same_places(mesh), size, options.most)?;
    let is_done = bisection.is_done();
    bisection.run()?;
    let mut fine = if is_done { mesh.clone() } else { assembled(mesh, bisection) };
    let moved = rows::broken_up(&mut fine, size, options.seed);
    let count = |mesh: &Mesh| if is_plane(mesh) { mesh.triangles.len() } else { mesh.tetrahedra.len() };
    let asks = |at: Vec3| size(at) < f64::INFINITY;
    let [longest, _] = edges_within(mesh, &asks).ok_or(RefineError::Nowhere)?;
    let [after, mean] = edges_within(&fine, &asks).ok_or(RefineError::Nowhere)?;
    Ok(Refined {
        elements: [count(mesh), count(&fine)],
        longest: [longest, after],
        mean,
        moved,
        quality: [before, summary(&fine).ok_or(RefineError::Empty)?],
        mesh: fine,
    })
}

/// About how much memory [`refined`] takes [bytes]; none where it refuses to make so many elements.
pub fn bytes_to_refine(mesh: &Mesh, size: &dyn Fn(Vec3) -> f64) -> u64 {
    let count = estimated(mesh, size);
    if count > FAR_BEYOND * MOST as f64 { 0 } else { (OF_ELEMENT * count) as u64 }
}

/// About how many elements come of a mesh; a third more or less.
fn estimated(mesh: &Mesh, size: &dyn Fn(Vec3) -> f64) -> f64 {
    fn parts<const N: usize>(corners: [Vec3; N], whole: f64, size: &dyn Fn(Vec3) -> f64) -> f64 {
        let middle = corners.iter().sum::<Vec3>() / N as f64;
        let places = corners.iter().map(|corner| 0.5 * (corner + middle)).chain([middle]);
        let of = |at: Vec3| {
            let size = size(at);
            let power = if N == 3 { size * size } else { size * size * size };
            // A size that is none is refused later.
            if size > 0.0 { (whole / (OF_SIZE[N - 3] * power)).max(1.0) } else { 1.0 }
        };
        places.map(of).sum::<f64>() / (N + 1) as f64
    }
    let at = |node: u32| mesh.nodes[node as usize];
    if is_plane(mesh) {
        let all = mesh.triangles.iter().map(|nodes| nodes.map(at));
        return all.map(|corners| parts(corners, area_vector(corners).norm(), size)).sum();
    }
    let all = mesh.tetrahedra.iter().map(|nodes| nodes.map(at));
    all.map(|corners| parts(corners, signed_volume(corners).abs(), size)).sum()
}

fn summary(mesh: &Mesh) -> Option<Summary> {
    if is_plane(mesh) {
        summarize_triangles(&mesh.nodes, &mesh.triangles)
    } else {
        summarize_tetrahedra(&mesh.nodes, &mesh.tetrahedra)
    }
}

/// The longest edge along which, or in the middle of whose element, a condition holds at a place that is looked at; none where it holds nowhere.
pub fn longest_edge(mesh: &Mesh, holds: &(dyn Fn(Vec3) -> bool + Sync)) -> Option<f64> {
    edges_within(mesh, holds).map(|[longest, _]| longest)
}

/// The longest and the mean of these edges.
fn edges_within(mesh: &Mesh, holds: &(dyn Fn(Vec3) -> bool + Sync)) -> Option<[f64; 2]> {
    let at = |node: u32| mesh.nodes[node as usize];
    let edges = if is_plane(mesh) {
        edges_of_triangles(&mesh.triangles).nodes
    } else {
        edges_of_tetrahedra(&mesh.tetrahedra).nodes
    };
    let length = |edge: &[u32; 2]| -> Option<f64> {
        let [a, b] = edge.map(at);
        along(a, b).any(holds).then(|| (b - a).norm())
    };
    let lengths: Vec<Option<f64>> = edges.par_iter().map(length).collect();
    let (mut longest, mut sum, mut count) = (0.0f64, 0.0, 0.0);
    for length in lengths.into_iter().flatten() {
        (longest, sum, count) = (longest.max(length), sum + length, count + 1.0);
    }
    fn within<const N: usize>(corners: [Vec3; N], holds: &(dyn Fn(Vec3) -> bool + Sync)) -> Option<f64> {
        let middle = corners.iter().sum::<Vec3>() / N as f64;
        let lengths = |a: &Vec3| corners.map(|b| (b - a).norm());
        holds(middle).then(|| corners.iter().flat_map(lengths).fold(0.0, f64::max))
    }
    let middles: Vec<Option<f64>> = if is_plane(mesh) {
        mesh.triangles.par_iter().map(|nodes| within(nodes.map(at), holds)).collect()
    } else {
        mesh.tetrahedra.par_iter().map(|nodes| within(nodes.map(at), holds)).collect()
    };
    let longest = middles.into_iter().flatten().fold(longest, f64::max);
    (longest > 0.0).then(|| [longest, if count > 0.0 { sum / count } else { longest }])
}

/// The places along an edge at which it is asked how long it may be.
fn along(a: Vec3, b: Vec3) -> impl Iterator<Item = Vec3> {
    /// Parts of the edge, at whose ends they lie.
    const PARTS: usize = 8;
    (0..=PARTS).map(move |part| a + (b - a) * (part as f64 / PARTS as f64))
}

/// The mesh of the parts of its elements.
fn assembled(mesh: &Mesh, bisection: Bisection<'_>) -> Mesh {
    let Bisection { nodes, lines, triangles, tetrahedra, .. } = bisection;
    let (lines, of_lines) = lines.in_order(mesh.lines.len());
    let (triangles, of_triangles) = triangles.in_order(mesh.triangles.len());
    let (tetrahedra, of_tetrahedra) = tetrahedra.in_order(mesh.tetrahedra.len());
    let group = |group: &Group| Group {
        lines: parts(&group.lines, &of_lines),
        triangles: parts(&group.triangles, &of_triangles),
        tetrahedra: parts(&group.tetrahedra, &of_tetrahedra),
        ..group.clone()
    };
    let mut fine = Mesh {
        nodes,
        points: mesh.points.clone(),
        lines,
        triangles,
        tetrahedra,
        groups: mesh.groups.iter().map(group).collect(),
        notices: mesh.notices.clone(),
        ..Mesh::default()
    };
    fine.number();
    fine
}
