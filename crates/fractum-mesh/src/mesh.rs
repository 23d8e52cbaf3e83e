use std::collections::BTreeSet;

use fractum_math::Vec3;
use serde::{Deserialize, Serialize};

/// Nodes, straight-sided elements and named groups. Elements name nodes by their index in [`Mesh::nodes`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Coordinates (m, or the unit of the file), in file order; only nodes that some element uses.
    pub nodes: Vec<Vec3>,
    /// The file's tag of each node.
    pub node_tags: Vec<u64>,
    /// Point elements.
    pub points: Vec<[u32; 1]>,
    /// The file's tag of each point element.
    pub point_tags: Vec<u64>,
    /// Two-node lines.
    pub lines: Vec<[u32; 2]>,
    /// The file's tag of each line.
    pub line_tags: Vec<u64>,
    /// Three-node triangles (T3). Counter-clockwise when the mesh is plane; otherwise as oriented in the file.
    pub triangles: Vec<[u32; 3]>,
    /// The file's tag of each triangle.
    pub triangle_tags: Vec<u64>,
    /// Four-node tetrahedra (T4) of positive volume.
    pub tetrahedra: Vec<[u32; 4]>,
    /// The file's tag of each tetrahedron.
    pub tetrahedron_tags: Vec<u64>,
    /// Physical groups, ascending by dimension and tag.
    pub groups: Vec<Group>,
    /// What the reader skipped, simplified or reoriented, in words for the user.
    pub notices: Vec<String>,
    /// What is known of the whole mesh where this one lacks some of its tetrahedra; none where it is whole.
    pub whole: Option<Box<WholeMesh>>,
    /// Faces along which its nodes have been doubled, see [`Mesh::cut`].
    pub cuts: Vec<CutFace>,
}

/// A face along which a mesh was cut: its corners on both sides are nodes of their own, but for those at a tip of the cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct CutFace {
    /// Which cut it belongs to.
    pub cut: u32,
    /// Corners on the first and on the second side, in the same places; sides of triangles repeat the second one. The normal of the
    /// right-hand rule, or (Δy, -Δx) in a plane, points from the first side to the second.
    pub sides: [[u32; 3]; 2],
    /// Elements on both sides: tetrahedra, or triangles where there are none.
    pub elements: [u32; 2],
}

/// What one of several processes that share a mesh knows of the tetrahedra that others have. Nodes and all other elements are whole.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WholeMesh {
    /// Number of tetrahedra.
    pub tetrahedra: usize,
    /// Of each group the number of its tetrahedra and their nodes, ascending.
    pub groups: Vec<(usize, Vec<u32>)>,
}

/// A physical group: elements of one dimension under one name. Each list holds ascending indices into the array of
/// the same name of the [`Mesh`].
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Group {
    /// The user's name, or `physical-TAG` where the file gives none.
    pub name: String,
    /// Dimension of the elements, 0 to 3.
    pub dimension: u8,
    /// Physical tag, unique within a dimension.
    pub tag: i32,
    /// Point elements (dimension 0).
    pub points: Vec<u32>,
    /// Lines (dimension 1).
    pub lines: Vec<u32>,
    /// Triangles (dimension 2).
    pub triangles: Vec<u32>,
    /// Tetrahedra (dimension 3).
    pub tetrahedra: Vec<u32>,
}

impl Group {
    /// Number of elements of all kinds.
    pub fn element_count(&self) -> usize {
        self.points.len() + self.lines.len() + self.triangles.len() + self.tetrahedra.len()
    }
}

impl Mesh {
    /// The groups of that name: none, or one per dimension in which the name occurs.
    pub fn group(&self, name: &str) -> Vec<&Group> {
        self.groups.iter().filter(|group| group.name == name).collect()
    }

    /// The distinct names of the groups, in the order of [`Mesh::groups`].
    pub fn group_names(&self) -> Vec<&str> {
        let mut seen = BTreeSet::new();
        self.groups.iter().map(|group| group.name.as_str()).filter(|name| seen.insert(*name)).collect()
    }

    /// Adds a group of all tetrahedra, or of all triangles where there are none.
    pub fn add_group_of_all(&mut self, name: &str) {
        let all = |count: usize| (0..count as u32).collect();
        let mut group = Group { name: name.to_owned(), dimension: 3, tag: i32::MAX, ..Group::default() };
        if self.tetrahedra.is_empty() {
            (group.dimension, group.triangles) = (2, all(self.triangles.len()));
        } else {
            group.tetrahedra = all(self.tetrahedra.len());
        }
        self.groups.push(group);
    }

    /// The nodes of all elements in the groups of that name, ascending, each once.
    pub fn group_nodes(&self, name: &str) -> Vec<u32> {
        let mut nodes = Vec::new();
        for (index, group) in self.groups.iter().enumerate().filter(|(_, group)| group.name == name) {
            push_nodes(&mut nodes, &self.points, &group.points);
            push_nodes(&mut nodes, &self.lines, &group.lines);
            push_nodes(&mut nodes, &self.triangles, &group.triangles);
            match &self.whole {
                Some(whole) => nodes.extend(&whole.groups[index].1),
                None => push_nodes(&mut nodes, &self.tetrahedra, &group.tetrahedra),
            }
        }
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Nodes of the tetrahedra of a group that are in this mesh, ascending, each once.
    pub fn group_nodes_of_tetrahedra(&self, group: &Group) -> Vec<u32> {
        let mut nodes = Vec::new();
        push_nodes(&mut nodes, &self.tetrahedra, &group.tetrahedra);
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Says anew which groups have no elements, once all parts of a mesh are known.
    pub fn note_empty_groups(&mut self) {
        self.notices.retain(|notice| !notice.starts_with(EMPTY_GROUPS));
        let in_whole = |index: usize| self.whole.as_ref().map_or(0, |whole| whole.groups[index].0);
        let is_empty = |(index, group): &(usize, &Group)| group.element_count() == 0 && in_whole(*index) == 0;
        let empty = self.groups.iter().enumerate().filter(is_empty).map(|(_, group)| group);
        self.notices.extend(empty_groups(empty));
    }

    /// Tags in the order of nodes and elements, from 1.
    pub fn number(&mut self) {
        self.node_tags = (1..=self.nodes.len() as u64).collect();
        let mut next = 1;
        let mut tags = |count: usize| {
            let first = next;
            next += count as u64;
            (first..next).collect()
        };
        self.point_tags = tags(self.points.len());
        self.line_tags = tags(self.lines.len());
        self.triangle_tags = tags(self.triangles.len());
        self.tetrahedron_tags = tags(self.tetrahedra.len());
    }

    /// Highest tag of a node or element; 0 of an empty mesh.
    pub fn highest_tag(&self) -> u64 {
        let Mesh { node_tags, point_tags, line_tags, triangle_tags, tetrahedron_tags, .. } = self;
        let all = [node_tags, point_tags, line_tags, triangle_tags, tetrahedron_tags];
        all.into_iter().flatten().copied().max().unwrap_or(0)
    }

    /// Number of tetrahedra of the whole mesh.
    pub fn tetrahedron_count(&self) -> usize {
        self.whole.as_ref().map_or(self.tetrahedra.len(), |whole| whole.tetrahedra)
    }

    /// Number of tetrahedra in the groups of that name, in the whole mesh.
    pub fn group_tetrahedra(&self, name: &str) -> usize {
        let of_group = |(index, group): (usize, &Group)| {
            self.whole.as_ref().map_or(group.tetrahedra.len(), |whole| whole.groups[index].0)
        };
        self.groups.iter().enumerate().filter(|(_, group)| group.name == name).map(of_group).sum()
    }

    /// Whether all nodes lie in one plane z = constant.
    pub(crate) fn is_in_plane(&self) -> bool {
        let (low, high) = self.bounding_box();
        let extent = high - low;
        extent.z <= 1e-9 * extent.x.max(extent.y)
    }

    /// Lowest and highest coordinates; zeros for a mesh without nodes.
    pub fn bounding_box(&self) -> (Vec3, Vec3) {
        bounding_box(&self.nodes)
    }

    /// Number of elements of all kinds.
    pub fn element_count(&self) -> usize {
        self.points.len() + self.lines.len() + self.triangles.len() + self.tetrahedra.len()
    }
}

/// Lowest and highest coordinates of a set of points; zeros for an empty set.
pub(crate) fn bounding_box(points: &[Vec3]) -> (Vec3, Vec3) {
    let Some(&first) = points.first() else { return (Vec3::zeros(), Vec3::zeros()) };
    points.iter().fold((first, first), |(low, high), point| (low.inf(point), high.sup(point)))
}

/// How the notice of [`empty_groups`] begins.
const EMPTY_GROUPS: &str = "group(s) without elements: ";

/// A notice of groups without elements; none of none.
pub(crate) fn empty_groups<'a>(groups: impl Iterator<Item = &'a Group>) -> Option<String> {
    let empty = groups.map(|group| format!("\"{}\" of dimension {}", group.name, group.dimension));
    let empty: Vec<String> = empty.collect();
    (!empty.is_empty()).then(|| format!("{EMPTY_GROUPS}{}", list(&empty)))
}

/// The first few of many.
pub(crate) fn list(items: &[String]) -> String {
    const SHOWN: usize = 8;
    let more = if items.len() > SHOWN { format!(" and {} more", items.len() - SHOWN) } else { String::new() };
    format!("{}{more}", items[..items.len().min(SHOWN)].join(", "))
}

fn push_nodes<const N: usize>(nodes: &mut Vec<u32>, elements: &[[u32; N]], members: &[u32]) {
    for &member in members {
        nodes.extend_from_slice(&elements[member as usize]);
    }
}
