use std::collections::BTreeSet;

use fractum_math::Vec3;

/// Nodes, straight-sided elements and named groups. Elements name nodes by their index in [`Mesh::nodes`].
#[derive(Clone, Debug, Default, PartialEq)]
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
    /// Four-node quadrilaterals, for tool surfaces.
    pub quads: Vec<[u32; 4]>,
    /// The file's tag of each quadrilateral.
    pub quad_tags: Vec<u64>,
    /// Four-node tetrahedra (T4) of positive volume.
    pub tetrahedra: Vec<[u32; 4]>,
    /// The file's tag of each tetrahedron.
    pub tetrahedron_tags: Vec<u64>,
    /// Physical groups, ascending by dimension and tag.
    pub groups: Vec<Group>,
    /// What the reader skipped, simplified or reoriented, in words for the user.
    pub notices: Vec<String>,
}

/// A physical group: elements of one dimension under one name. Each list holds ascending indices into the array of
/// the same name of the [`Mesh`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
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
    /// Quadrilaterals (dimension 2).
    pub quads: Vec<u32>,
    /// Tetrahedra (dimension 3).
    pub tetrahedra: Vec<u32>,
}

impl Group {
    /// Number of elements of all kinds.
    pub fn element_count(&self) -> usize {
        self.points.len() + self.lines.len() + self.triangles.len() + self.quads.len() + self.tetrahedra.len()
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

    /// The nodes of all elements in the groups of that name, ascending, each once.
    pub fn group_nodes(&self, name: &str) -> Vec<u32> {
        let mut nodes = Vec::new();
        for group in self.group(name) {
            push_nodes(&mut nodes, &self.points, &group.points);
            push_nodes(&mut nodes, &self.lines, &group.lines);
            push_nodes(&mut nodes, &self.triangles, &group.triangles);
            push_nodes(&mut nodes, &self.quads, &group.quads);
            push_nodes(&mut nodes, &self.tetrahedra, &group.tetrahedra);
        }
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Lowest and highest coordinates; zeros for a mesh without nodes.
    pub fn bounding_box(&self) -> (Vec3, Vec3) {
        bounding_box(&self.nodes)
    }

    /// Number of elements of all kinds.
    pub fn element_count(&self) -> usize {
        self.points.len() + self.lines.len() + self.triangles.len() + self.quads.len() + self.tetrahedra.len()
    }
}

/// Lowest and highest coordinates of a set of points; zeros for an empty set.
pub(crate) fn bounding_box(points: &[Vec3]) -> (Vec3, Vec3) {
    let Some(&first) = points.first() else { return (Vec3::zeros(), Vec3::zeros()) };
    points.iter().fold((first, first), |(low, high), point| (low.inf(point), high.sup(point)))
}

fn push_nodes<const N: usize>(nodes: &mut Vec<u32>, elements: &[[u32; N]], members: &[u32]) {
    for &member in members {
        nodes.extend_from_slice(&elements[member as usize]);
    }
}
