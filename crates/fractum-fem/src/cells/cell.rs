//! From the elements of a body to its cells, in blocks.

use std::collections::BTreeMap;

use fractum_math::Vec3;
use rayon::prelude::*;

use crate::body::Body;
use crate::body::edges::BodyEdges;
use crate::cells::block::{BLOCK_NODES, Cells, Run};
use crate::element::{measure_and_gradients, regular_edge};
use crate::error::SolidError;

/// Cells per block: its displacements, forces and geometry fit the second-level cache.
pub(crate) const BLOCK_CELLS: usize = 2048;

/// Blocks of cells with short steps, which are few and evaluated by themselves, so that all threads find work: as many as this, unless
/// they become as small as [`FEWEST_CELLS`].
const FINE_BLOCKS: usize = 64;
const FEWEST_CELLS: usize = 256;

/// Cells of different classes never share a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Class {
    /// Whether they take shorter steps than others.
    pub(crate) is_fine: bool,
    /// Whether they cannot be damaged where others can.
    pub(crate) is_sound: bool,
}

/// What a body needs to build and rebuild its cells.
pub(crate) struct Geometry<'a> {
    pub(crate) body: &'a Body,
    pub(crate) nodes: &'a [Vec3],
}

impl Geometry<'_> {
    /// Corner positions of an element.
    fn corners(&self, element: usize) -> [Vec3; 4] {
        self.body.elements[element].map(|node| self.nodes[node as usize])
    }

    /// Volume [m³] and gradients of an element.
    pub(crate) fn element(&self, element: usize) -> (f64, [Vec3; 4]) {
        let corners = self.corners(element);
        let (measure, gradients) = measure_and_gradients(self.body.shape, &corners);
        (measure * self.body.depth_of(&corners), gradients)
    }

    /// Edge of the regular element of the measure of an element of this volume [m].
    pub(crate) fn size(&self, element: u32, volume: f64) -> f64 {
        regular_edge(self.body.shape, volume / self.body.depth_of(&self.corners(element as usize)))
    }

    /// Inverse radius of the middle of an element of an axisymmetric body, else 0 [1/m]: times the mean displacement away from the axis it is
    /// the hoop strain.
    pub(crate) fn hoop(&self, element: usize) -> f64 {
        if !self.body.is_axisymmetric() {
            return 0.0;
        }
        let [a, b, c, _] = self.corners(element);
        3.0 / (a.x + b.x + c.x)
    }

    /// Volumes of all elements [m³].
    pub(crate) fn volumes(&self) -> Result<Vec<f64>, SolidError> {
        let volumes: Vec<f64> = (0..self.body.elements.len()).into_par_iter().map(|e| self.element(e).0).collect();
        match volumes.iter().position(|&v| !(v > 0.0 && v.is_finite())) {
            Some(element) => {
                Err(SolidError::DegenerateElement { body: self.body.name.clone(), element, volume: volumes[element] })
            }
            None => Ok(volumes),
        }
    }

    fn element_nodes(&self, element: usize) -> &[u32] {
        &self.body.elements[element][..self.body.shape.node_count()]
    }

    /// Nodes of the cell of an edge: its two ends, then the ring around it in ascending order.
    fn edge_nodes(&self, ends: [u32; 2], elements: &[u32]) -> Vec<u32> {
        let mut ring: Vec<u32> = elements.iter().flat_map(|&e| self.element_nodes(e as usize)).copied().collect();
        ring.retain(|node| !ends.contains(node));
        ring.sort_unstable();
        ring.dedup();
        [ends.as_slice(), &ring].concat()
    }

    /// Volume of the domain of an edge, its [`Cells::hoop`], and the gradients of its nodes, from the elements that are alive.
    ///
    /// `gradients` gets one entry per node of `nodes` after the first.
    pub(crate) fn edge_domain(
        &self,
        nodes: &[u32],
        elements: &[u32],
        alive: impl Fn(u32) -> bool,
        gradients: &mut [[f64; 3]],
    ) -> [f64; 2] {
        gradients.fill([0.0; 3]);
        let share = 1.0 / self.body.shape.edge_count() as f64;
        let (mut total, mut hoop) = (0.0, 0.0);
        for &element in elements.iter().filter(|&&e| alive(e)) {
            let (volume, g) = self.element_weights(element);
            let volume = volume * share;
            total += volume;
            hoop += volume * self.hoop(element as usize);
            for (node, g) in self.element_nodes(element as usize).iter().zip(g) {
                let place = nodes.iter().position(|n| n == node).expect("the cell of an edge holds its elements");
                if place > 0 {
                    let sum = &mut gradients[place - 1];
                    *sum = [sum[0] + volume * g.x, sum[1] + volume * g.y, sum[2] + volume * g.z];
                }
            }
        }
        if total > 0.0 {
            gradients.iter_mut().for_each(|g| *g = g.map(|c| c / total));
            hoop /= total;
        }
        [total, hoop]
    }

    /// Cells of some items, which touch at most [`BLOCK_NODES`] nodes.
    ///
    /// - `edges`: where these are the cells; elements are without
    /// - `is_alive`: whether an element is still there
    pub(crate) fn cells(
        &self,
        items: &[u32],
        edges: Option<&BodyEdges>,
        is_alive: impl Fn(u32) -> bool + Copy,
    ) -> Cells {
        let rows: Vec<Vec<u32>> = items.iter().map(|&item| self.row(item, edges)).collect();
        let mut hoop = Vec::new();
        let mut cells = build_block(&rows, |cell, nodes, gradients| match edges {
            Some(edges) => {
                let [volume, own] = self.edge_domain(nodes, &edges.around(items[cell]), is_alive, gradients);
                hoop.push(own);
                volume
            }
            None => {
                let volume = self.element_cell(items[cell], gradients);
                hoop.push(self.hoop(items[cell] as usize));
                if is_alive(items[cell]) { volume } else { 0.0 }
            }
        });
        cells.hoop = self.body.is_axisymmetric().then(|| hoop.into());
        cells
    }

    /// Nodes of the cell of an item.
    fn row(&self, item: u32, edges: Option<&BodyEdges>) -> Vec<u32> {
        match edges {
            Some(edges) => self.edge_nodes(edges.nodes(item), &edges.around(item)),
            None => self.element_nodes(item as usize).to_vec(),
        }
    }

    /// Volume of an element [m³], and the gradients of its shape functions with those for the hoop strain, see [`Cells::hoop`].
    fn element_weights(&self, element: u32) -> (f64, [Vec3; 4]) {
        let (volume, mut gradients) = self.element(element as usize);
        if self.body.is_axisymmetric() {
            gradients[..3].iter_mut().for_each(|g| g.z = self.hoop(element as usize) / 3.0);
        }
        (volume, gradients)
    }

    /// Volume [m³] and gradients of the cell of an element.
    fn element_cell(&self, element: u32, gradients: &mut [[f64; 3]]) -> f64 {
        let (volume, g) = self.element_weights(element);
        for (stored, g) in gradients.iter_mut().zip(&g[1..]) {
            *stored = [g.x, g.y, g.z];
        }
        volume
    }

    /// Blocks of element cells; see [`Class`].
    pub(crate) fn element_blocks(&self, class: impl Fn(u32) -> Class) -> Vec<Bundle> {
        let centres: Vec<Vec3> = (0..self.body.elements.len())
            .into_par_iter()
            .map(|e| self.element_nodes(e).iter().map(|&n| self.nodes[n as usize]).sum::<Vec3>())
            .collect();
        let groups = by_class(fractum_mesh::renumber::hilbert_order(&centres), class);
        self.bundles(&chunks(&groups), None)
    }

    /// Blocks of edge cells; see [`Class`].
    pub(crate) fn edge_blocks(&self, edges: &BodyEdges, class: impl Fn(u32) -> Class) -> Vec<Bundle> {
        let middle = |edge| edges.nodes(edge).map(|node| self.nodes[node as usize]).into_iter().sum();
        let middles: Vec<Vec3> = (0..edges.len() as u32).into_par_iter().map(middle).collect();
        let groups = by_class(fractum_mesh::renumber::hilbert_order(&middles), class);
        self.bundles(&chunks(&groups), Some(edges))
    }

    /// Runs of cells as blocks.
    ///
    /// - `edges`: where these are the cells; elements are without
    pub(crate) fn bundles(&self, runs: &[&[u32]], edges: Option<&BodyEdges>) -> Vec<Bundle> {
        let row = |item: u32| self.row(item, edges);
        let sorted = |mut bundle: Bundle| {
            if edges.is_some() {
                // Cells of one size side by side: the loops over their nodes become predictable.
                bundle.items.sort_by_cached_key(|&edge| (row(edge).len(), edge));
            }
            bundle
        };
        runs.par_iter().flat_map(|items| split_to_fit(items, row)).map(sorted).collect()
    }
}

/// The cells of a block before they have a geometry.
pub(crate) struct Bundle {
    /// Elements or edges.
    pub(crate) items: Vec<u32>,
    /// Nodes that they touch, ascending.
    pub(crate) nodes: Vec<u32>,
    /// Gradients of all cells.
    pub(crate) gradients: usize,
}

/// Items of each class, in the order that they have.
fn by_class(items: Vec<u32>, class: impl Fn(u32) -> Class) -> BTreeMap<Class, Vec<u32>> {
    let mut groups = BTreeMap::<Class, Vec<u32>>::new();
    items.into_iter().for_each(|item| groups.entry(class(item)).or_default().push(item));
    groups
}

/// Runs of items that make a block each, if they fit into it.
fn chunks(groups: &BTreeMap<Class, Vec<u32>>) -> Vec<&[u32]> {
    let size = |class: &Class, items: &[u32]| match class.is_fine {
        true => (items.len() / FINE_BLOCKS).clamp(FEWEST_CELLS, BLOCK_CELLS),
        false => BLOCK_CELLS,
    };
    groups.iter().flat_map(|(class, items)| items.chunks(size(class, items))).collect()
}

/// Halves a run of cells until each part touches at most [`BLOCK_NODES`] nodes.
fn split_to_fit(items: &[u32], row: impl Fn(u32) -> Vec<u32> + Copy) -> Vec<Bundle> {
    let mut nodes: Vec<u32> = items.iter().flat_map(|&item| row(item)).collect();
    let gradients = nodes.len() - items.len();
    nodes.sort_unstable();
    nodes.dedup();
    if nodes.len() <= BLOCK_NODES || items.len() == 1 {
        nodes.shrink_to_fit();
        return vec![Bundle { items: items.to_vec(), nodes, gradients }];
    }
    let (left, right) = items.split_at(items.len() / 2);
    let mut bundles = split_to_fit(left, row);
    bundles.extend(split_to_fit(right, row));
    bundles
}

/// Lays out the cells of a block; `fill` returns the volume of a cell and writes its gradients.
fn build_block(rows: &[Vec<u32>], mut fill: impl FnMut(usize, &[u32], &mut [[f64; 3]]) -> f64) -> Cells {
    let mut nodes: Vec<u32> = rows.concat();
    nodes.sort_unstable();
    nodes.dedup();
    let count: usize = rows.iter().map(Vec::len).sum();
    let mut cells = Cells {
        nodes,
        starts: Vec::with_capacity(rows.len() + 1),
        local: Vec::with_capacity(count),
        gradients: Vec::with_capacity(count - rows.len()),
        volume: Vec::with_capacity(rows.len()),
        ..Cells::default()
    };
    cells.starts.push(0);
    for (cell, row) in rows.iter().enumerate() {
        for node in row {
            let local = cells.nodes.binary_search(node).expect("the block holds the nodes of its cells");
            cells.local.push(local as u16);
        }
        let start = cells.gradients.len();
        cells.gradients.resize(start + row.len() - 1, [0.0; 3]);
        cells.volume.push(fill(cell, row, &mut cells.gradients[start..]));
        cells.starts.push(cells.gradients.len() as u32);
    }
    let mut begin = 0;
    for rows in rows.chunk_by(|a, b| a.len() == b.len()) {
        cells.runs.push(Run { begin, end: begin + rows.len(), gradients: rows[0].len() - 1 });
        begin += rows.len();
    }
    cells
}
