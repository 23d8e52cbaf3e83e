//! The cells of a body in blocks, with their laws.

use std::sync::{Arc, OnceLock};

use fractum_math::{Ragged, Vec3};

use crate::body::{Body, BodyEdges, Formulation};
use crate::body_model::{BodyModel, Chosen};
use crate::cell::{Bundle, Class, Geometry};
use crate::damage::{EdgeField, Softens};
use crate::divided::{BodyShare, ELSEWHERE};
use crate::edges_in_step::EdgeCells;
use crate::error::SolidError;
use crate::evaluate::{Block, BlockLaw};
use crate::hooke::Hooke;
use crate::phase::PhaseField;
use crate::standard::{StandardCells, StandardDamage};
use crate::threshold::Threshold;

impl BodyModel {
    /// The body with its blocks, whose cells have no geometry yet; `first_block` is the index that its first block will have.
    ///
    /// - `chosen`: which cells are made
    pub(crate) fn new(
        body: Body,
        index: usize,
        nodes: &[Vec3],
        volumes: &[f64],
        chosen: Chosen,
        first_block: usize,
    ) -> Result<(Self, Vec<Block>), SolidError> {
        let hooke = Hooke::of(&body);
        let smoothed = body.formulation == Formulation::Smoothed;
        let geometry = Geometry { body: &body, nodes };
        let edges = (smoothed || body.damage.is_some()).then(|| body.edges());
        let edge_count = edges.as_ref().map_or(0, |e| e.nodes.len());
        let per_element = body.shape.edge_count();
        let elements_of_edge = edges.as_ref().map_or_else(Ragged::default, |edges| {
            Ragged::inverse(edge_count, edges.of_element.iter().map(|of| &of[..per_element]))
        });
        let threshold = match (&body.damage, &edges) {
            (Some(zone), Some(edges)) => Some(Threshold::new(&body, zone, edges, &elements_of_edge, nodes, volumes)?),
            _ => None,
        };
        let softens = body.damage.as_ref().map(|zone| Arc::new(Softens::new(zone, hooke, body.elastic.young_modulus)));
        let of_body = CellsOfBody {
            geometry,
            edges: edges.as_ref().filter(|_| smoothed),
            elements_of_edge: &elements_of_edge,
            chosen,
        };
        let bundles = of_body.blocks(|edge| threshold.as_ref().is_some_and(|t| t.strength[edge as usize].is_finite()));
        let mut location = vec![(ELSEWHERE, 0); if smoothed { edge_count } else { body.elements.len() }];
        let mut blocks = Vec::with_capacity(bundles.len());
        for bundle in bundles {
            for (cell, &item) in bundle.items.iter().enumerate() {
                location[item as usize] = ((first_block + blocks.len()) as u32, cell as u32);
            }
            let law = block_law(smoothed, softens.as_ref().zip(threshold.as_ref()), &bundle.items);
            let is_fine = of_body.is_fine(bundle.items[0]);
            blocks.push(Block::new(bundle, index, law, is_fine));
        }
        let (reduced_edges, largest_length_ratio) =
            threshold.as_ref().map_or((0, 0.0), |t| (t.reduced_edges, t.largest_length_ratio));
        let phase = match (&body.damage, threshold.as_ref().and_then(|t| t.phase_sizes)) {
            (Some(zone), Some(sizes)) => Some(Box::new(PhaseField::of(&body, zone, sizes, edge_count)?)),
            _ => None,
        };
        let standard = match (softens, threshold) {
            (Some(softens), Some(t)) if !smoothed => {
                let mut field = EdgeField::new(softens, (0..edge_count as u32).collect(), &t);
                field.keep_histories();
                Some(StandardDamage::new(field, body.shape, elements_of_edge.clone(), body.elements.len()))
            }
            _ => None,
        };
        let alive = vec![true; body.elements.len()];
        let model = BodyModel {
            body,
            hooke,
            viscosity: None,
            alive,
            is_told: Vec::new(),
            volumes: OnceLock::new(),
            edges,
            elements_of_edge,
            location,
            standard,
            phase,
            reduced_edges,
            largest_length_ratio,
            divided: None,
        };
        Ok((model, blocks))
    }
}

/// Law of the cells of a block; one that holds an edge that may be damaged holds such edges only.
fn block_law(smoothed: bool, damage: Option<(&Arc<Softens>, &Threshold)>, items: &[u32]) -> BlockLaw {
    match damage {
        Some((softens, threshold)) if smoothed && threshold.strength[items[0] as usize].is_finite() => {
            let field = EdgeField::new(softens.clone(), items.to_vec(), threshold);
            BlockLaw::Edges(EdgeCells { field, dissipated: 0.0, energy: None })
        }
        Some((softens, _)) if !smoothed => BlockLaw::Standard(StandardCells::new(softens.clone(), items.len())),
        _ => BlockLaw::Elastic { energy: None },
    }
}

/// What the cells of a body are made from.
struct CellsOfBody<'a> {
    geometry: Geometry<'a>,
    /// Edges, where these are the cells.
    edges: Option<&'a BodyEdges>,
    elements_of_edge: &'a Ragged,
    chosen: Chosen<'a>,
}

impl CellsOfBody<'_> {
    /// Whether a cell takes shorter steps: an edge with any fine element around it goes with that.
    fn is_fine(&self, item: u32) -> bool {
        let is_fine = |element: u32| self.chosen.fine.get(element as usize).copied().unwrap_or(false);
        match self.edges {
            Some(_) => self.elements_of_edge.row(item as usize).iter().any(|&element| is_fine(element)),
            None => is_fine(item),
        }
    }

    /// Cells in blocks.
    ///
    /// - `breaks`: whether an edge may be damaged
    fn blocks(&self, breaks: impl Fn(u32) -> bool) -> Vec<Bundle> {
        if let Some(share) = self.chosen.share {
            return self.blocks_of(share);
        }
        match self.edges {
            Some(edges) => self.geometry.edge_blocks(edges, self.elements_of_edge, |edge| Class {
                is_fine: self.is_fine(edge),
                is_sound: !breaks(edge),
            }),
            None => self.geometry.element_blocks(|element| Class { is_fine: self.is_fine(element), is_sound: false }),
        }
    }

    /// Cells of a rank that has no more of the body than it needs for these.
    fn blocks_of(&self, share: &BodyShare) -> Vec<Bundle> {
        let item = |nodes: &[u32; 2]| {
            let found = match self.edges {
                Some(edges) => edges.nodes.binary_search(nodes),
                None => share.numbers.binary_search(&nodes[0]),
            };
            found.expect("a rank has the elements of its cells") as u32
        };
        let runs: Vec<Vec<u32>> = share.runs.iter().map(|run| run.iter().map(item).collect()).collect();
        let runs: Vec<&[u32]> = runs.iter().map(Vec::as_slice).collect();
        self.geometry.bundles(&runs, self.edges.map(|edges| (edges, self.elements_of_edge)))
    }
}
