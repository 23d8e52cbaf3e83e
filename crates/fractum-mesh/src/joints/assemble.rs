//! The mesh with what was cut into it: its groups, lines and faces.

use std::collections::{BTreeMap, BTreeSet};

use super::refill::Refilled;
use super::space::Block;
use super::{Disc, Grains, GrainsMade};
use crate::quality::signed_volume;
use crate::topology::{facets_of_tetrahedra, sides_of_triangles};
use crate::{Group, Mesh, Vec3};

/// Gives a mesh the groups of its grains.
///
/// - `owner`: grain of each element; none of the matrix and outside
pub(super) fn with_grains(mesh: &mut Mesh, grains: &Grains, owner: &[Option<usize>], inside: &[bool]) -> GrainsMade {
    let is_plane = mesh.tetrahedra.is_empty();
    let mut groups: Vec<Group> = grains
        .phases
        .iter()
        .map(|(name, _)| name)
        .chain([&grains.matrix])
        .map(|name| Group { name: name.clone(), dimension: if is_plane { 2 } else { 3 }, ..Group::default() })
        .collect();
    let matrix = groups.len() - 1;
    let mut sizes: BTreeMap<usize, f64> = BTreeMap::new();
    for (element, (owner, _)) in (0u32..).zip(owner.iter().zip(inside)).filter(|(_, (_, inside))| **inside) {
        let of = owner.map_or(matrix, |grain| grains.phase(grain).min(matrix));
        if owner.is_none() || !grains.phases.is_empty() {
            let members = if is_plane { &mut groups[of].triangles } else { &mut groups[of].tetrahedra };
            members.push(element);
        }
        if let Some(grain) = owner {
            let size = if is_plane {
                let [a, b, c] = mesh.triangles[element as usize].map(|n| mesh.nodes[n as usize]);
                0.5 * (b - a).cross(&(c - a)).norm()
            } else {
                signed_volume(mesh.tetrahedra[element as usize].map(|n| mesh.nodes[n as usize]))
            };
            *sizes.entry(*grain).or_default() += size;
        }
    }
    let differ = |[a, b]: [u32; 2]| {
        let [one, two] = [a, b].map(|element| owner.get(element as usize).copied());
        one != two && two.is_some() && inside[a as usize] && inside[b as usize]
    };
    let (mut length, mut boundary) = (0.0, Group { name: grains.boundary.clone(), ..Group::default() });
    if is_plane {
        boundary.dimension = 1;
        let sides = sides_of_triangles(&mesh.triangles).map(|sides| (sides.nodes, sides.elements)).unwrap_or_default();
        for (nodes, _) in sides.0.into_iter().zip(sides.1).filter(|(_, beside)| differ(*beside)) {
            let [a, b] = nodes.map(|n| mesh.nodes[n as usize]);
            length += (b - a).norm();
            boundary.lines.push(mesh.lines.len() as u32);
            mesh.lines.push(nodes);
        }
    } else {
        boundary.dimension = 2;
        let found = facets_of_tetrahedra(&mesh.tetrahedra).map(|facets| (facets.nodes, facets.elements));
        let (nodes, beside) = found.unwrap_or_default();
        for (nodes, _) in nodes.into_iter().zip(beside).filter(|(_, beside)| differ(*beside)) {
            let [a, b, c] = nodes.map(|n| mesh.nodes[n as usize]);
            length += 0.5 * (b - a).cross(&(c - a)).norm();
            boundary.triangles.push(mesh.triangles.len() as u32);
            mesh.triangles.push(nodes);
        }
    }
    groups.push(boundary);
    add_groups(mesh, groups);
    mesh.number();
    GrainsMade { count: sizes.len(), sizes: sizes.into_values().collect(), boundary: length, shift: 0.0 }
}

/// The mesh with the elements and faces of a cut block.
pub(super) fn with_faces(mesh: &mut Mesh, block: Block, discs: &[Disc], names: &[String]) {
    let Block { at, elements, label, labels, skin, lines, .. } = block;
    mesh.nodes = at;
    mesh.tetrahedra = elements;
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); mesh.triangles.len()];
    let mut triangles = Vec::new();
    let mut groups: Vec<Group> =
        names.iter().map(|name| Group { name: name.clone(), dimension: 2, ..Group::default() }).collect();
    for facet in skin.iter().filter(|facet| facet.triangle.is_some() || facet.joint.is_some()) {
        let number = triangles.len() as u32;
        triangles.push(facet.nodes);
        if let Some(of) = facet.triangle {
            children[of as usize].push(number);
        }
        if let Some(joint) = facet.joint {
            groups[discs[joint as usize].group as usize].triangles.push(number);
        }
    }
    mesh.triangles = triangles;
    let mut parts: Vec<Vec<u32>> = vec![Vec::new(); mesh.lines.len()];
    (0u32..).zip(&lines).for_each(|(number, (_, of))| parts[*of as usize].push(number));
    mesh.lines = lines.into_iter().map(|(ends, _)| ends).collect();
    for (number, group) in (0u32..).zip(&mut mesh.groups) {
        let own = |label: u32| labels[label as usize].contains(&number);
        group.tetrahedra = (0..).zip(&label).filter(|(_, label)| own(**label)).map(|(element, _)| element).collect();
        for (members, children) in [(&mut group.triangles, &children), (&mut group.lines, &parts)] {
            *members = members.iter().flat_map(|&member| children[member as usize].clone()).collect();
            members.sort_unstable();
        }
    }
    add_groups(mesh, groups);
    mesh.number();
}

/// The mesh with its new triangles and lines.
pub(super) fn with_joints(
    mesh: &mut Mesh,
    filled: Refilled,
    labels: &[Vec<u32>],
    group: &dyn Fn(u32) -> u32,
    names: &[String],
) {
    let Refilled { at, triangles, joints, parts } = filled;
    let z = mesh.nodes.first().map_or(0.0, |node| node.z);
    mesh.nodes = at.iter().map(|at| Vec3::new(at[0], at[1], z)).collect();
    mesh.triangles = triangles.iter().map(|(t, _)| *t).collect();
    // Lines that are divided have their first part in their place.
    let mut children: Vec<Vec<u32>> = (0..mesh.lines.len() as u32).map(|line| vec![line]).collect();
    let mut seen = BTreeSet::new();
    for (ends, line) in parts {
        if seen.insert(line) {
            mesh.lines[line as usize] = ends;
        } else {
            children[line as usize].push(mesh.lines.len() as u32);
            mesh.lines.push(ends);
        }
    }
    for (number, group) in (0u32..).zip(&mut mesh.groups) {
        if group.dimension == 2 && !group.triangles.is_empty() {
            let own = |label: u32| labels[label as usize].contains(&number);
            group.triangles = (0..).zip(&triangles).filter(|(_, (_, label))| own(*label)).map(|(t, _)| t).collect();
        }
        group.lines = group.lines.iter().flat_map(|&line| children[line as usize].clone()).collect();
        group.lines.sort_unstable();
    }
    let mut groups: Vec<Group> =
        names.iter().map(|name| Group { name: name.clone(), dimension: 1, ..Group::default() }).collect();
    for (ends, joint) in joints {
        groups[group(joint) as usize].lines.push(mesh.lines.len() as u32);
        mesh.lines.push(ends);
    }
    add_groups(mesh, groups);
    drop_unused(mesh);
    mesh.number();
}

/// Adds groups with new tags, those without elements left out, in order of dimension and tag.
fn add_groups(mesh: &mut Mesh, groups: Vec<Group>) {
    for mut group in groups.into_iter().filter(|group| group.element_count() > 0) {
        let same =
            mesh.groups.iter_mut().find(|other| (other.dimension, &other.name) == (group.dimension, &group.name));
        if let Some(same) = same {
            same.lines.append(&mut group.lines);
            same.triangles.append(&mut group.triangles);
            continue;
        }
        let own = mesh.groups.iter().filter(|other| other.dimension == group.dimension);
        group.tag = own.map(|other| other.tag).filter(|&tag| tag < i32::MAX).max().unwrap_or(0) + 1;
        mesh.groups.push(group);
    }
    mesh.groups.sort_by_key(|group| (group.dimension, group.tag));
}

/// Drops nodes that no element has.
fn drop_unused(mesh: &mut Mesh) {
    let mut used = vec![false; mesh.nodes.len()];
    let elements = [mesh.points.as_flattened(), mesh.lines.as_flattened(), mesh.triangles.as_flattened()];
    elements.into_iter().flatten().chain(mesh.tetrahedra.as_flattened()).for_each(|&node| used[node as usize] = true);
    let mut new = vec![0u32; used.len()];
    (0..used.len()).filter(|&node| used[node]).zip(0..).for_each(|(node, number)| new[node] = number);
    let mut keep = used.iter();
    mesh.nodes.retain(|_| keep.next() == Some(&true));
    let rename = |node: &mut u32| *node = new[*node as usize];
    mesh.points.as_flattened_mut().iter_mut().for_each(rename);
    mesh.lines.as_flattened_mut().iter_mut().for_each(rename);
    mesh.triangles.as_flattened_mut().iter_mut().for_each(rename);
    mesh.tetrahedra.as_flattened_mut().iter_mut().for_each(rename);
}
