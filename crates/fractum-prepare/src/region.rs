//! The region of a solid that a bonded body takes the place of.

use std::collections::{BTreeMap, BTreeSet};

use fractum_mesh::{Mesh, topology};
use fractum_pack::{ClosedSurface, Domain};

use crate::asked::{At, Fault};

/// How far a node may lie outside the shape and still count as within, over the size of the mesh.
const OUTSIDE: f64 = 1e-9;
/// Difference of volumes at which a region is the box around it.
const BOX: f64 = 1e-9;

/// Elements of a solid, and the shape that they fill together.
pub(crate) struct Region {
    /// Tetrahedra of the mesh, ascending.
    pub elements: Vec<u32>,
    /// The space that they leave.
    pub domain: Domain,
}

/// What elements lie within.
pub(crate) enum Space<'a> {
    /// Those of a mesh group.
    Group(&'a str),
    /// A part of space.
    Domain(Domain),
}

/// The elements of a solid wholly within a space.
///
/// Those that hang on the others by less than a facet, or leave an edge where more than two facets meet, stay with the
/// solid, so that what is left has a closed surface; of separate parts the largest counts.
///
/// - `solid`: mesh group of the solid
///
/// # Errors
/// A solid that is not made of tetrahedra; a space that holds no element wholly.
pub(crate) fn region(mesh: &Mesh, solid: &str, space: &Space<'_>) -> Result<Region, Fault> {
    let refuse = |found: &dyn ToString, remedy| Fault::new(At::Replaced, found.to_string()).remedy(remedy);
    let of_group = |name: &str| -> BTreeSet<u32> {
        mesh.group(name).iter().flat_map(|group| group.tetrahedra.iter().copied()).collect()
    };
    let body = of_group(solid);
    if body.is_empty() {
        return Err(refuse(&"it is not made of tetrahedra", "only a solid in space can be bonded in part"));
    }
    let (low, high) = mesh.bounding_box();
    let slack = OUTSIDE * (high - low).norm();
    let mut inside: BTreeSet<u32> = match space {
        Space::Group(name) => of_group(name).intersection(&body).copied().collect(),
        Space::Domain(domain) => {
            let within: Vec<bool> = mesh.nodes.iter().map(|x| domain.depth(x) >= -slack).collect();
            let whole = |e: &u32| mesh.tetrahedra[*e as usize].iter().all(|&n| within[n as usize]);
            body.iter().copied().filter(whole).collect()
        }
    };
    loop {
        keep_largest_part(mesh, &mut inside);
        let bad = nodes_of_bad_edges(mesh, &inside);
        if bad.is_empty() {
            break;
        }
        inside.retain(|&e| {
            let nodes = mesh.tetrahedra[e as usize];
            !bad.iter().any(|edge| edge.iter().all(|n| nodes.contains(n)))
        });
    }
    if inside.is_empty() {
        let found = "the shape holds none of its elements wholly";
        return Err(refuse(&found, "make the shape larger than a few elements, or the mesh finer there"));
    }
    let elements: Vec<u32> = inside.into_iter().collect();
    let surface = closed_surface(mesh, &elements).map_err(|error| refuse(&error, "choose another shape"))?;
    let (lower, upper) = surface.bounds();
    let boxed = (upper - lower).product();
    let domain = if (surface.volume() / boxed - 1.0).abs() < BOX {
        Domain::Box { lower, upper }
    } else {
        Domain::Surface(surface)
    };
    Ok(Region { elements, domain })
}

fn closed_surface(mesh: &Mesh, elements: &[u32]) -> Result<ClosedSurface, fractum_pack::PackError> {
    let cells: Vec<[u32; 4]> = elements.iter().map(|&e| mesh.tetrahedra[e as usize]).collect();
    let triangles: Vec<[u32; 3]> = topology::boundary_of_tetrahedra(&cells).iter().map(|f| f.nodes).collect();
    // The surface's own points, so that its bounds are those of the region.
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    let place = |n: u32| used.binary_search(&n).map_or(u32::MAX, |place| place as u32);
    let points: Vec<_> = used.iter().map(|&n| mesh.nodes[n as usize]).collect();
    let triangles: Vec<[u32; 3]> = triangles.iter().map(|t| t.map(place)).collect();
    ClosedSurface::new(&points, &triangles)
}

/// Facets of elements: sorted nodes, with the elements that have them.
fn facets(mesh: &Mesh, elements: &BTreeSet<u32>) -> BTreeMap<[u32; 3], Vec<u32>> {
    let mut facets: BTreeMap<[u32; 3], Vec<u32>> = BTreeMap::new();
    for &element in elements {
        let nodes = mesh.tetrahedra[element as usize];
        for left_out in 0..4 {
            let mut facet = [0; 3];
            (0..4).filter(|&k| k != left_out).enumerate().for_each(|(at, k)| facet[at] = nodes[k]);
            facet.sort_unstable();
            facets.entry(facet).or_default().push(element);
        }
    }
    facets
}

/// Leaves the elements of the largest part that hangs together by facets, the first of equal ones.
fn keep_largest_part(mesh: &Mesh, elements: &mut BTreeSet<u32>) {
    let mut neighbours: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for of in facets(mesh, elements).into_values().filter(|of| of.len() == 2) {
        neighbours.entry(of[0]).or_default().push(of[1]);
        neighbours.entry(of[1]).or_default().push(of[0]);
    }
    let mut left = elements.clone();
    let mut largest = BTreeSet::new();
    while let Some(first) = left.pop_first() {
        let (mut part, mut open) = (BTreeSet::from([first]), vec![first]);
        while let Some(element) = open.pop() {
            for next in neighbours.get(&element).into_iter().flatten() {
                if left.remove(next) {
                    part.insert(*next);
                    open.push(*next);
                }
            }
        }
        if part.len() > largest.len() {
            largest = part;
        }
    }
    *elements = largest;
}

/// Edges of the boundary where more than two of its facets meet.
fn nodes_of_bad_edges(mesh: &Mesh, elements: &BTreeSet<u32>) -> Vec<[u32; 2]> {
    let mut edges: BTreeMap<[u32; 2], u32> = BTreeMap::new();
    for (facet, of) in facets(mesh, elements) {
        if of.len() == 1 {
            let [a, b, c] = facet;
            [[a, b], [a, c], [b, c]].into_iter().for_each(|edge| *edges.entry(edge).or_default() += 1);
        }
    }
    edges.into_iter().filter(|(_, count)| *count > 2).map(|(edge, _)| edge).collect()
}
