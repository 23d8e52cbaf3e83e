//! Orientation and size of the elements of a file.

use fractum_math::Vec3;

use super::error::{Fault, Problem};
use super::raw::Raw;
use super::table::{Table, Tables};
use crate::quality::{area_vector, signed_volume};

/// An element below this share of (longest edge)^dimension has no volume, area or length.
const FLAT: f64 = 1e-12;

/// Flips tetrahedra of negative volume and refuses those without.
pub(super) fn check_tetrahedra(
    raw: &Raw,
    table: &mut Table<4>,
    bytes: &[u8],
    notices: &mut Vec<String>,
) -> Result<(), Fault> {
    let mut flipped = 0;
    for element in 0..table.elements.len() {
        let nodes = table.elements[element];
        let corners = nodes.map(|node| raw.nodes[node as usize]);
        let volume = signed_volume(corners);
        if !has_volume(volume, &corners) {
            return Err(degenerate(raw, table, element, format!("has no volume ({volume:e})"), bytes));
        }
        if volume < 0.0 {
            let [a, b, c, d] = nodes;
            table.elements[element] = [a, b, d, c];
            flipped += 1;
        }
    }
    if flipped > 0 {
        notices.push(format!("{flipped} tetrahedra of negative volume were flipped (two nodes exchanged)"));
    }
    Ok(())
}

/// Refuses triangles without area; in a plane mesh, where they are the bodies, turns those seen from below.
pub(super) fn check_flat(raw: &Raw, tables: &mut Tables, bytes: &[u8], notices: &mut Vec<String>) -> Result<(), Fault> {
    let Tables { triangles, tetrahedra, .. } = tables;
    let plane = tetrahedra.elements.is_empty() && is_plane(raw, triangles);
    let mut flipped = 0;
    for element in 0..triangles.elements.len() {
        let [a, b, c] = triangles.elements[element];
        let corners = [a, b, c].map(|node| raw.nodes[node as usize]);
        let area = area_vector(corners);
        if !is_above(2.0 * area.norm(), longest_edge_squared(&corners)) {
            return Err(degenerate(raw, triangles, element, format!("has no area ({:e})", area.norm()), bytes));
        }
        if plane && area.z < 0.0 {
            triangles.elements[element] = [a, c, b];
            flipped += 1;
        }
    }
    if flipped > 0 {
        notices.push(format!("{flipped} clockwise element(s) of the plane mesh were flipped"));
    }
    Ok(())
}

/// Refuses lines whose ends coincide.
pub(super) fn check_lines(raw: &Raw, table: &Table<2>, bytes: &[u8]) -> Result<(), Fault> {
    for (element, nodes) in table.elements.iter().enumerate() {
        let [a, b] = nodes.map(|node| raw.nodes[node as usize]);
        if a == b {
            return Err(degenerate(raw, table, element, "has no length".to_owned(), bytes));
        }
    }
    Ok(())
}

/// Whether all triangles lie in one plane z = constant.
fn is_plane(raw: &Raw, triangles: &Table<3>) -> bool {
    let mut nodes = triangles.elements.as_flattened().iter();
    let Some(&first) = nodes.next() else { return false };
    let first = raw.nodes[first as usize];
    let (mut low, mut high) = (first, first);
    for &node in nodes {
        low = low.inf(&raw.nodes[node as usize]);
        high = high.sup(&raw.nodes[node as usize]);
    }
    let extent = high - low;
    extent.z <= 1e-9 * extent.x.max(extent.y)
}

/// Whether a tetrahedron is more than a rounding error thick.
pub(super) fn has_volume(volume: f64, corners: &[Vec3; 4]) -> bool {
    is_above(6.0 * volume.abs(), cube_of_longest_edge(corners))
}

/// False also where the numbers overflow.
fn is_above(size: f64, scale: f64) -> bool {
    size.is_finite() && size > FLAT * scale
}

fn cube_of_longest_edge(corners: &[Vec3]) -> f64 {
    let squared = longest_edge_squared(corners);
    squared * squared.sqrt()
}

fn longest_edge_squared(corners: &[Vec3]) -> f64 {
    let mut longest = 0.0f64;
    for (index, a) in corners.iter().enumerate() {
        for b in &corners[index + 1..] {
            longest = longest.max((b - a).norm_squared());
        }
    }
    longest
}

fn degenerate<const N: usize>(raw: &Raw, table: &Table<N>, element: usize, fact: String, bytes: &[u8]) -> Fault {
    let (tag, at) = table.locate(raw, element, bytes);
    let nodes = table.elements[element];
    let center = nodes.iter().map(|&node| raw.nodes[node as usize]).sum::<Vec3>() / N as f64;
    let tags = nodes.map(|node| raw.node_tags[node as usize]);
    let shape = ["", "point", "line", "triangle", "element"][N];
    let message = format!(
        "{shape} {tag} (nodes {tags:?}) at {:e} {:e} {:e} {fact}; mesh again or remove it",
        center.x, center.y, center.z
    );
    Fault { at, problem: Problem::Degenerate(message) }
}
