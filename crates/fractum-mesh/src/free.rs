//! Nodes that may be moved without a change of shape: those inside, between elements of the same groups.

use fractum_math::Ragged;

use crate::Mesh;
use crate::topology::{boundary_of_tetrahedra, boundary_of_triangles, elements_of_nodes};

/// Smallest radius ratio (1 for an equilateral element) that a moved node may leave to an element, unless it was smaller before.
pub(crate) const WORST_SHAPE: f64 = 0.3;

/// Whether a mesh is one of plane elements alone.
pub(crate) fn is_plane(mesh: &Mesh) -> bool {
    mesh.tetrahedra.is_empty()
}

/// The tetrahedra around every node; in the plane the triangles.
pub(crate) fn around_nodes(mesh: &Mesh) -> Ragged {
    if is_plane(mesh) {
        elements_of_nodes(mesh.nodes.len(), &mesh.triangles)
    } else {
        elements_of_nodes(mesh.nodes.len(), &mesh.tetrahedra)
    }
}

/// The groups of every tetrahedron, ascending; in the plane those of every triangle.
pub(crate) fn groups_of_elements(mesh: &Mesh) -> Ragged {
    if is_plane(mesh) {
        Ragged::inverse(mesh.triangles.len(), mesh.groups.iter().map(|group| &group.triangles[..]))
    } else {
        Ragged::inverse(mesh.tetrahedra.len(), mesh.groups.iter().map(|group| &group.tetrahedra[..]))
    }
}

/// Which nodes lie inside, between elements of the same groups alone, and on no line, point or surface of the mesh.
///
/// - `around`: the elements of every node
pub(crate) fn free_nodes(mesh: &Mesh, around: &Ragged) -> Vec<bool> {
    let mut free = vec![true; mesh.nodes.len()];
    let mut hold = |nodes: &[u32]| nodes.iter().for_each(|&node| free[node as usize] = false);
    mesh.points.iter().for_each(|nodes| hold(nodes));
    mesh.lines.iter().for_each(|nodes| hold(nodes));
    if is_plane(mesh) {
        boundary_of_triangles(&mesh.triangles).iter().for_each(|edge| hold(&edge.nodes));
    } else {
        mesh.triangles.iter().for_each(|nodes| hold(nodes));
        boundary_of_tetrahedra(&mesh.tetrahedra).iter().for_each(|facet| hold(&facet.nodes));
    }
    let groups = groups_of_elements(mesh);
    for (free, elements) in free.iter_mut().zip(around.rows()) {
        let alike = elements.windows(2).all(|pair| groups.row(pair[0] as usize) == groups.row(pair[1] as usize));
        *free &= alike && !elements.is_empty();
    }
    free
}
