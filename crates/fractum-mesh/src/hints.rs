//! What a user should know of a mesh before a case names it.

use std::collections::BTreeSet;

use fractum_math::Vec3;

use crate::folds::{fold_of_tetrahedra, fold_of_triangles};
use crate::quality::{self, Summary};
use crate::{Group, Mesh, topology};

/// Radius ratio below which an element is a sliver.
const SLIVER: f64 = 0.1;

/// Hints on what keeps a mesh from being used as it was probably meant, each with its remedy: no groups, elements in none,
/// facets that lie inside of it, slivers, folds, thin bodies, and bodies that lie upon or within each other.
pub fn hints(mesh: &Mesh) -> Vec<String> {
    let mut hints = Vec::new();
    if mesh.groups.iter().all(|group| group.element_count() == 0) {
        hints.push(
            "no groups: a case names bodies, supports and loads by groups; in Gmsh: \
             Physical Surface(\"plate\") = {1}; in Abaqus: *ELSET, *SURFACE, *NSET"
                .to_owned(),
        );
    } else {
        hints.extend(in_no_group(mesh));
    }
    hints.extend(without_solids(mesh));
    hints.extend(mesh.groups.iter().filter_map(|group| inner_facets(mesh, group)));
    hints.extend(sliver(
        "tetrahedron",
        mesh,
        quality::summarize_tetrahedra(&mesh.nodes, &mesh.tetrahedra),
        |element| (mesh.tetrahedra[element].to_vec(), mesh.tetrahedron_tags[element]),
    ));
    if mesh.tetrahedra.is_empty() {
        hints.extend(sliver("triangle", mesh, quality::summarize_triangles(&mesh.nodes, &mesh.triangles), |element| {
            (mesh.triangles[element].to_vec(), mesh.triangle_tags[element])
        }));
    }
    hints.extend(folded(mesh));
    hints.extend(crate::bodies::hints(mesh));
    hints
}

/// Elements that lie on the same side of what they share.
fn folded(mesh: &Mesh) -> Option<String> {
    let (fold, tags, what) = if !mesh.tetrahedra.is_empty() {
        (fold_of_tetrahedra(&mesh.tetrahedra)?, &mesh.tetrahedron_tags, "tetrahedra")
    } else if mesh.is_in_plane() {
        (fold_of_triangles(&mesh.triangles)?, &mesh.triangle_tags, "triangles")
    } else {
        return None;
    };
    let [first, second] = fold.elements.map(|element| tags[element as usize]);
    Some(format!(
        "{what} {first} and {second} lie on the same side of what they share ({} such pairs): the mesh is folded, or has elements upon each other",
        fold.count
    ))
}

/// What a mesh of shells or beams is good for.
fn without_solids(mesh: &Mesh) -> Option<String> {
    let what = match (mesh.tetrahedra.is_empty(), mesh.triangles.is_empty()) {
        (false, _) => return None,
        (true, false) if mesh.is_in_plane() => return None,
        (true, false) => "the triangles are a surface in space, of which rigid bodies may be made",
        (true, true) => "lines and points are no bodies",
    };
    Some(format!(
        "no solids: {what}; a solid is of tetrahedra or hexahedra (C3D4, C3D8), or of triangles in one plane z = constant"
    ))
}

/// Elements of the highest dimension that no group has.
fn in_no_group(mesh: &Mesh) -> Option<String> {
    let spatial = !mesh.tetrahedra.is_empty();
    let (all, what) = if spatial { (mesh.tetrahedra.len(), "tetrahedra") } else { (mesh.triangles.len(), "triangles") };
    let members = |group: &Group| if spatial { group.tetrahedra.clone() } else { group.triangles.clone() };
    let grouped: BTreeSet<u32> = mesh.groups.iter().flat_map(members).collect();
    let left = all - grouped.len();
    (left > 0).then(|| format!("{left} of {all} {what} are in no group, so that no body can have them"))
}

/// Facets of a group that are no part of the boundary of the body.
fn inner_facets(mesh: &Mesh, group: &Group) -> Option<String> {
    // The boundary of a whole mesh is dear.
    let facets = if mesh.tetrahedra.is_empty() { &group.lines } else { &group.triangles };
    if facets.is_empty() {
        return None;
    }
    let sorted = |mut nodes: Vec<u32>| {
        nodes.sort_unstable();
        nodes
    };
    let (of_group, boundary, what): (Vec<Vec<u32>>, BTreeSet<Vec<u32>>, _) = if mesh.tetrahedra.is_empty() {
        let lines = group.lines.iter().map(|&line| sorted(mesh.lines[line as usize].to_vec())).collect();
        let sides = topology::boundary_of_triangles(&mesh.triangles);
        (lines, sides.into_iter().map(|side| sorted(side.nodes.to_vec())).collect(), "lines")
    } else {
        let facets = group.triangles.iter().map(|&facet| sorted(mesh.triangles[facet as usize].to_vec())).collect();
        let sides = topology::boundary_of_tetrahedra(&mesh.tetrahedra);
        (facets, sides.into_iter().map(|side| sorted(side.nodes.to_vec())).collect(), "triangles")
    };
    let inner = of_group.iter().filter(|facet| !boundary.contains(*facet)).count();
    let (name, all) = (&group.name, of_group.len());
    (inner > 0 && !boundary.is_empty()).then(|| {
        format!(
            "group \"{name}\": {inner} of {all} {what} are not on the surface of the meshed bodies: pressure, gas and contact \
             need facets of the surface; supports and forces on nodes do not"
        )
    })
}

/// The worst element, where it is one that limits the time step for nothing.
fn sliver(
    what: &str,
    mesh: &Mesh,
    summary: Option<Summary>,
    element: impl Fn(usize) -> (Vec<u32>, u64),
) -> Option<String> {
    let worst = summary?.worst_radius_ratio;
    let (nodes, tag) = element(worst.element as usize);
    let middle = nodes.iter().map(|&node| mesh.nodes[node as usize]).sum::<Vec3>() / nodes.len() as f64;
    let [x, y, z] = [middle.x, middle.y, middle.z];
    (worst.value < SLIVER).then(|| {
        format!(
            "{what} {tag} at {x:.4} {y:.4} {z:.4} is nearly flat (radius ratio {:.3}): slivers shorten the time step; in Gmsh \
             set Mesh.OptimizeNetgen = 1, and look for short edges of the geometry",
            worst.value
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::{structured_box, structured_rectangle};

    fn said(mesh: &Mesh) -> String {
        hints(mesh).join("\n")
    }

    #[test]
    fn a_good_mesh_needs_no_hint() {
        assert_eq!(hints(&structured_box([2, 2, 2], Vec3::new(1.0, 1.0, 1.0), None)), Vec::<String>::new());
        assert_eq!(hints(&structured_rectangle([3, 2], [1.0, 1.0], None)), Vec::<String>::new());
    }

    #[test]
    fn groups_inner_facets_and_slivers_are_told() {
        let good = structured_box([2, 2, 2], Vec3::new(1.0, 1.0, 1.0), None);
        assert!(said(&Mesh { groups: Vec::new(), ..good.clone() }).starts_with("no groups: "));
        let mut mesh = good.clone();
        let body = mesh.groups.iter_mut().find(|group| group.dimension == 3).unwrap();
        body.tetrahedra.truncate(40);
        assert_eq!(said(&mesh), "8 of 48 tetrahedra are in no group, so that no body can have them");
        let mut mesh = good.clone();
        let [a, b, c, _] = mesh.tetrahedra[0];
        let boundary: BTreeSet<[u32; 3]> = topology::boundary_of_tetrahedra(&mesh.tetrahedra)
            .into_iter()
            .map(|mut facet| {
                facet.nodes.sort_unstable();
                facet.nodes
            })
            .collect();
        let facets = mesh.tetrahedra.iter().flat_map(|t| topology::TETRAHEDRON_FACETS.map(|f| f.map(|i| t[i])));
        let inner = facets
            .map(|mut facet| {
                facet.sort_unstable();
                facet
            })
            .find(|facet| !boundary.contains(facet))
            .unwrap_or([a, b, c]);
        mesh.triangles[0] = inner;
        assert!(said(&mesh).contains("1 of 8 triangles are not on the surface"), "{}", said(&mesh));
        let mut mesh = good;
        let [a, b, c, d] = mesh.tetrahedra[5].map(|node| node as usize);
        mesh.nodes[d] = (mesh.nodes[a] + mesh.nodes[b] + mesh.nodes[c]) / 3.0 + 0.001 * mesh.nodes[d];
        assert!(said(&mesh).contains("is nearly flat (radius ratio 0.0"), "{}", said(&mesh));
    }
}
