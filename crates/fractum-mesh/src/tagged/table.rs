use std::ops::Range;

use super::element_type::Shape;
use super::error::Fault;
use super::raw::{Raw, Run};
use super::tags::NodeIndex;

/// The elements of one shape while the mesh is built.
pub(super) struct Table<const N: usize> {
    /// Node indices.
    pub(super) elements: Vec<[u32; N]>,
    /// For each element, its index in the file ([`Raw::element_tags`]), ascending.
    pub(super) kept: Vec<u32>,
    /// From the order of the file (this shape only) to `elements`; none while the two are the same.
    new_index: Option<Vec<u32>>,
}

/// The elements of all shapes that a mesh holds.
pub(super) struct Tables {
    pub(super) points: Table<1>,
    pub(super) lines: Table<2>,
    pub(super) triangles: Table<3>,
    pub(super) tetrahedra: Table<4>,
}

impl Tables {
    /// [`Table::merge_duplicates`] for each shape.
    pub(super) fn merge_duplicates(&mut self, node_count: usize) -> usize {
        self.points.merge_duplicates(node_count)
            + self.lines.merge_duplicates(node_count)
            + self.triangles.merge_duplicates(node_count)
            + self.tetrahedra.merge_duplicates(node_count)
    }

    /// [`Table::kept`] of each shape, in the order of [`Shape`].
    pub(super) fn kept(&self) -> [&[u32]; 5] {
        let Tables { points, lines, triangles, tetrahedra } = self;
        [&points.kept, &lines.kept, &triangles.kept, &[], &tetrahedra.kept]
    }
}

impl<const N: usize> Table<N> {
    /// Collects the elements of a shape and turns their node tags into indices.
    pub(super) fn collect(raw: &Raw, index: &NodeIndex, shape: Shape, bytes: &[u8]) -> Result<Self, Fault> {
        let runs = || raw.runs.iter().filter(move |run| run.kind.shape == shape);
        let count = runs().map(|run| run.count).sum();
        let mut table = Table { elements: Vec::with_capacity(count), kept: Vec::with_capacity(count), new_index: None };
        for run in runs() {
            let corners = &raw.corners[run.first_corner..run.first_corner + N * run.count];
            for (element, tags) in corners.as_chunks::<N>().0.iter().enumerate() {
                let nodes = tags.map(|tag| index.find(tag).unwrap_or(u32::MAX));
                if nodes.contains(&u32::MAX) {
                    return Err(missing_node(raw, index, run, element, tags, bytes));
                }
                table.elements.push(nodes);
                table.kept.push((run.first + element) as u32);
            }
        }
        Ok(table)
    }

    /// Merges elements of equal nodes, in any order, into the first of them; returns how many went.
    ///
    /// MSH 2.2 lists an element once per physical group.
    pub(super) fn merge_duplicates(&mut self, node_count: usize) -> usize {
        let (owners, offsets) = self.by_lowest_node(node_count);
        let mut original: Vec<u32> = Vec::new(); // for each element the one that stands for it, once there is any
        let mut bucket: Vec<([u32; N], u32)> = Vec::new();
        for bounds in offsets.windows(2) {
            let members = &owners[bounds[0] as usize..bounds[1] as usize];
            if members.len() < 2 {
                continue;
            }
            bucket.clear();
            bucket.extend(members.iter().map(|&element| (sorted(self.elements[element as usize]), element)));
            bucket.sort_unstable();
            for run in bucket.chunk_by(|a, b| a.0 == b.0).filter(|run| run.len() > 1) {
                if original.is_empty() {
                    original = (0..self.elements.len() as u32).collect();
                }
                for other in &run[1..] {
                    original[other.1 as usize] = run[0].1;
                }
            }
        }
        if original.is_empty() {
            return 0;
        }
        let mut new_index = vec![0u32; original.len()];
        let mut next = 0;
        for element in 0..original.len() {
            if original[element] as usize == element {
                new_index[element] = next;
                self.elements[next as usize] = self.elements[element];
                self.kept[next as usize] = self.kept[element];
                next += 1;
            } else {
                new_index[element] = new_index[original[element] as usize];
            }
        }
        let merged = original.len() - next as usize;
        self.elements.truncate(next as usize);
        self.kept.truncate(next as usize);
        self.new_index = Some(new_index);
        merged
    }

    /// The elements sorted by their lowest node, and where those of each node start.
    fn by_lowest_node(&self, node_count: usize) -> (Vec<u32>, Vec<u32>) {
        let lowest = |nodes: &[u32; N]| nodes.iter().copied().min().unwrap_or(0) as usize;
        let mut offsets = vec![0u32; node_count + 1];
        for nodes in &self.elements {
            offsets[lowest(nodes) + 1] += 1;
        }
        for node in 0..node_count {
            offsets[node + 1] += offsets[node];
        }
        let mut next = offsets.clone();
        let mut owners = vec![0u32; self.elements.len()];
        for (element, nodes) in self.elements.iter().enumerate() {
            let slot = &mut next[lowest(nodes)];
            owners[*slot as usize] = element as u32;
            *slot += 1;
        }
        (owners, offsets)
    }

    /// Appends the indices of elements given by their place among those of this shape in the file.
    pub(super) fn push_members(&self, range: Range<usize>, members: &mut Vec<u32>) {
        match &self.new_index {
            None => members.extend(range.map(|element| element as u32)),
            Some(new_index) => members.extend_from_slice(&new_index[range]),
        }
    }

    /// The tags of the elements.
    pub(super) fn tags(&self, element_tags: &[u64]) -> Vec<u64> {
        self.kept.iter().map(|&index| element_tags[index as usize]).collect()
    }

    /// Tag of an element and where it lies in the file.
    pub(super) fn locate(&self, raw: &Raw, element: usize, bytes: &[u8]) -> (u64, usize) {
        let index = self.kept[element] as usize;
        let run = &raw.runs[raw.runs.partition_point(|run| run.first <= index) - 1];
        (raw.element_tags[index], run.locate(bytes, index - run.first))
    }
}

fn sorted<const N: usize>(mut nodes: [u32; N]) -> [u32; N] {
    nodes.sort_unstable();
    nodes
}

/// An element that names a node that is not there.
pub(super) fn missing_node(
    raw: &Raw,
    index: &NodeIndex,
    run: &Run,
    element: usize,
    tags: &[u64],
    bytes: &[u8],
) -> Fault {
    let missing = tags.iter().find(|&&tag| index.find(tag).is_none()).expect("one tag is not a node");
    let message = format!(
        "element {} ({}) names node {missing}, which $Nodes does not list",
        raw.element_tags[run.first + element],
        run.kind.shape.singular()
    );
    Fault::inconsistent(run.locate(bytes, element), message)
}
