//! One mesh of several files that hold a part each, as Gmsh writes partitions.

use std::collections::BTreeMap;

use fractum_math::Vec3;

use crate::{Group, Mesh};

/// Why parts do not make one mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JoinError {
    /// A node that lies elsewhere in another part.
    #[error("node {tag} lies at ({}, {}, {}) in one part and at ({}, {}, {}) in another; expected the parts of one mesh", at[0].x, at[0].y, at[0].z, at[1].x, at[1].y, at[1].z)]
    OtherPlace {
        /// The file's tag of the node.
        tag: u64,
        /// Where it lies.
        at: [Vec3; 2],
    },
    /// A group that has another name in another part.
    #[error("physical group {tag} of dimension {dimension} is \"{}\" in one part and \"{}\" in another; expected the parts of one mesh", names[0], names[1])]
    OtherName {
        /// Dimension of the group.
        dimension: u8,
        /// Its physical tag.
        tag: i32,
        /// Its names.
        names: [String; 2],
    },
    /// An element that two parts hold.
    #[error("tetrahedron {tag} is in two parts; expected each part once")]
    Doubled {
        /// The file's tag of the element.
        tag: u64,
    },
}

/// The mesh of some parts: nodes in the order of their tags, elements in the order of the parts.
///
/// Points, lines and triangles are taken once where several parts list them, and those of no group are left out: Gmsh adds such
/// where parts meet. Joining parts that were joined of others gives the same as joining all of these at once.
///
/// # Errors
/// [`JoinError`] for parts of different meshes.
pub fn joined(parts: &[Mesh]) -> Result<Mesh, JoinError> {
    let mut groups = joined_groups(parts)?;
    let (node_tags, nodes) = joined_nodes(parts)?;
    let mut join = Join { parts, node_tags: &node_tags, groups: &mut groups };
    let (points, point_tags) =
        join.once(|mesh| (&mesh.points, &mesh.point_tags), |group| &group.points, |group| &mut group.points);
    let (lines, line_tags) =
        join.once(|mesh| (&mesh.lines, &mesh.line_tags), |group| &group.lines, |group| &mut group.lines);
    let (triangles, triangle_tags) = join.once(
        |mesh| (&mesh.triangles, &mesh.triangle_tags),
        |group| &group.triangles,
        |group| &mut group.triangles,
    );
    let (tetrahedra, tetrahedron_tags) = join.all();
    refuse_doubled(&tetrahedron_tags)?;
    let mut notices: Vec<String> = Vec::new();
    for notice in parts.iter().flat_map(|part| &part.notices) {
        if !notices.contains(notice) {
            notices.push(notice.clone());
        }
    }
    let mut mesh = Mesh {
        nodes,
        node_tags,
        points,
        point_tags,
        lines,
        line_tags,
        triangles,
        triangle_tags,
        tetrahedra,
        tetrahedron_tags,
        groups,
        notices,
        whole: None,
        cuts: Vec::new(),
    };
    mesh.note_empty_groups();
    Ok(mesh)
}

/// Elements of space belong to one part each.
fn refuse_doubled(tags: &[u64]) -> Result<(), JoinError> {
    let mut sorted = tags.to_vec();
    sorted.sort_unstable();
    let doubled = sorted.windows(2).find(|pair| pair[0] == pair[1]);
    doubled.map_or(Ok(()), |pair| Err(JoinError::Doubled { tag: pair[0] }))
}

/// The groups of all parts, without elements.
fn joined_groups(parts: &[Mesh]) -> Result<Vec<Group>, JoinError> {
    let mut groups = BTreeMap::<(u8, i32), Group>::new();
    for Group { name, dimension, tag, .. } in parts.iter().flat_map(|part| &part.groups) {
        let empty = || Group { name: name.clone(), dimension: *dimension, tag: *tag, ..Group::default() };
        let known = groups.entry((*dimension, *tag)).or_insert_with(empty);
        if known.name != *name {
            let names = [known.name.clone(), name.clone()];
            return Err(JoinError::OtherName { dimension: *dimension, tag: *tag, names });
        }
    }
    Ok(groups.into_values().collect())
}

/// The nodes of all parts by their tags.
fn joined_nodes(parts: &[Mesh]) -> Result<(Vec<u64>, Vec<Vec3>), JoinError> {
    let nodes = parts.iter().flat_map(|part| part.node_tags.iter().copied().zip(part.nodes.iter().copied()));
    let mut nodes: Vec<(u64, Vec3)> = nodes.collect();
    nodes.sort_by_key(|&(tag, _)| tag);
    if let Some(other) = nodes.windows(2).find(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1) {
        return Err(JoinError::OtherPlace { tag: other[0].0, at: [other[0].1, other[1].1] });
    }
    nodes.dedup_by_key(|&mut (tag, _)| tag);
    Ok(nodes.into_iter().unzip())
}

/// Elements of a mesh and their tags.
type Tagged<'m, const N: usize> = (&'m [[u32; N]], &'m [u64]);

/// Elements of parts on their way into one mesh.
struct Join<'a> {
    parts: &'a [Mesh],
    /// Tags of its nodes, ascending.
    node_tags: &'a [u64],
    groups: &'a mut [Group],
}

impl Join<'_> {
    /// Nodes of an element of a part by their numbers in the joined mesh.
    fn nodes<const N: usize>(&self, part: &Mesh, element: &[u32; N]) -> [u32; N] {
        let number = |node: u32| self.node_tags.binary_search(&part.node_tags[node as usize]);
        element.map(|node| number(node).expect("the nodes of all parts") as u32)
    }

    /// Adds members to the groups of a part, by the numbers that its elements have now.
    fn add_members(
        &mut self,
        part: &Mesh,
        numbers: &[u32],
        of: fn(&Group) -> &Vec<u32>,
        into: fn(&mut Group) -> &mut Vec<u32>,
    ) {
        for group in &part.groups {
            let known =
                self.groups.iter_mut().find(|known| (known.dimension, known.tag) == (group.dimension, group.tag));
            let known = into(known.expect("the groups of all parts"));
            known.extend(of(group).iter().map(|&member| numbers[member as usize]));
            known.sort_unstable();
            known.dedup();
        }
    }

    /// Elements of groups, each once.
    fn once<const N: usize>(
        &mut self,
        elements: fn(&Mesh) -> Tagged<N>,
        of: fn(&Group) -> &Vec<u32>,
        into: fn(&mut Group) -> &mut Vec<u32>,
    ) -> (Vec<[u32; N]>, Vec<u64>) {
        let (mut joined, mut tags, mut known) = (Vec::new(), Vec::new(), BTreeMap::new());
        for part in self.parts {
            let (elements, of_file) = elements(part);
            let mut is_member = vec![false; elements.len()];
            part.groups.iter().flat_map(of).for_each(|&member| is_member[member as usize] = true);
            let mut numbers = vec![u32::MAX; elements.len()];
            for (element, _) in is_member.iter().enumerate().filter(|(_, is_member)| **is_member) {
                numbers[element] = *known.entry(of_file[element]).or_insert_with(|| {
                    joined.push(self.nodes(part, &elements[element]));
                    tags.push(of_file[element]);
                    joined.len() as u32 - 1
                });
            }
            self.add_members(part, &numbers, of, into);
        }
        (joined, tags)
    }

    /// All tetrahedra.
    fn all(&mut self) -> (Vec<[u32; 4]>, Vec<u64>) {
        let (mut joined, mut tags) = (Vec::new(), Vec::new());
        for part in self.parts {
            let numbers: Vec<u32> = (joined.len() as u32..).take(part.tetrahedra.len()).collect();
            joined.extend(part.tetrahedra.iter().map(|element| self.nodes(part, element)));
            tags.extend(&part.tetrahedron_tags);
            self.add_members(part, &numbers, |group| &group.tetrahedra, |group| &mut group.tetrahedra);
        }
        (joined, tags)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate::structured_box;

    /// A box in parts by thirds of its elements, with the nodes that each of them uses.
    fn parts() -> (Mesh, Vec<Mesh>) {
        let mesh = structured_box([3, 2, 2], Vec3::new(3.0, 2.0, 2.0), None);
        let part = |third: u64| {
            let keeps = |tag: u64| tag % 3 == third;
            let mut part = mesh.clone();
            let mut new = vec![u32::MAX; mesh.tetrahedra.len()];
            let kept: Vec<usize> = (0..new.len()).filter(|&e| keeps(mesh.tetrahedron_tags[e])).collect();
            (0..).zip(&kept).for_each(|(number, &element)| new[element] = number);
            part.tetrahedra = kept.iter().map(|&e| mesh.tetrahedra[e]).collect();
            part.tetrahedron_tags = kept.iter().map(|&e| mesh.tetrahedron_tags[e]).collect();
            for group in &mut part.groups {
                group.tetrahedra.retain(|&e| new[e as usize] != u32::MAX);
                group.tetrahedra.iter_mut().for_each(|e| *e = new[*e as usize]);
            }
            part
        };
        let parts = (0..3).map(part).collect();
        (mesh, parts)
    }

    #[test]
    fn parts_make_the_mesh_that_they_are_of_whatever_is_joined_first() {
        let (mesh, parts) = parts();
        let whole = joined(&parts).unwrap();
        assert_eq!(whole.nodes, mesh.nodes);
        assert_eq!(whole.triangles.len(), mesh.triangles.len());
        let mut tags = whole.tetrahedron_tags.clone();
        tags.sort_unstable();
        assert_eq!(tags, mesh.tetrahedron_tags);
        for name in mesh.group_names() {
            assert_eq!(whole.group_nodes(name), mesh.group_nodes(name), "{name}");
        }
        let first = joined(&parts[..2]).unwrap();
        assert_eq!(joined(&[first, parts[2].clone()]).unwrap(), whole);
    }

    #[test]
    fn parts_of_other_meshes_are_refused() {
        let (_, mut parts) = parts();
        parts[1].nodes[3].x += 1.0;
        let error = joined(&parts).unwrap_err().to_string();
        assert!(error.starts_with("node 4 lies at"), "{error}");
        parts[1].nodes[3].x -= 1.0;
        parts[2].groups[0].name = "other".to_owned();
        let error = joined(&parts).unwrap_err().to_string();
        assert!(error.contains("is \"") && error.contains("\"other\" in another"), "{error}");
        let (_, parts) = self::parts();
        let error = joined(&[parts[0].clone(), parts[1].clone(), parts[0].clone()]).unwrap_err().to_string();
        assert!(error.starts_with("tetrahedron") && error.contains("is in two parts"), "{error}");
    }
}
