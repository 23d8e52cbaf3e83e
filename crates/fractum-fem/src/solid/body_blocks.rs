//! The cells of a body in blocks, with their laws.

use std::sync::{Arc, OnceLock};

use fractum_kernels::damage::Softens;
use fractum_math::Vec3;

use crate::body::edges::BodyEdges;
use crate::body::elasticity::Elasticity;
use crate::body::{Body, Formulation};
use crate::cells::cell::{Bundle, Class, Geometry};
use crate::damage::edge::EdgeField;
use crate::damage::phase::PhaseField;
use crate::damage::standard::{StandardCells, StandardDamage};
use crate::damage::threshold::{LengthReport, Threshold};
use crate::divided::places::Places;
use crate::divided::{BodyShare, Replication};
use crate::error::SolidError;
use crate::solid::body_model::{BodyModel, Chosen};
use crate::solid::evaluate::{Block, BlockLaw};

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
        if let Some([found, expected]) = body.against_beds() {
            return Err(SolidError::BeddedDamage { body: body.name, found, expected });
        }
        let elasticity = Elasticity::new(&body);
        let smoothed = body.formulation == Formulation::Smoothed;
        let geometry = Geometry { body: &body, nodes };
        let known = chosen.share.filter(|share| share.replication == Replication::Elements);
        let edges = (smoothed || body.damage.is_some()).then(|| match known {
            Some(share) => BodyEdges::sought(&body, nodes.len(), share.own_cells()),
            None => BodyEdges::tables(&body),
        });
        let edge_count = edges.as_ref().map_or(0, BodyEdges::len);
        let softens = body.softens().map(Arc::new);
        let of_body = CellsOfBody { geometry, edges: edges.as_ref().filter(|_| smoothed), chosen };
        let bundles_of_share = chosen.share.map(|share| of_body.blocks_of(share));
        let own = bundles_of_share.as_ref().filter(|_| known.is_some()).map(|bundles| items_of(bundles));
        let threshold = match (&body.damage, &edges) {
            (Some(zone), Some(edges)) => {
                let longest =
                    softens.as_ref().and_then(|softens| softens.beds.as_ref()).map_or(1.0, |beds| beds.longest);
                let known = own.as_deref().zip(chosen.exchange);
                Some(Threshold::new((&body, longest), zone, edges, nodes, volumes, known)?)
            }
            _ => None,
        };
        let breaks = |edge| threshold.as_ref().is_some_and(|t: &Threshold| t.strength(edge).is_finite());
        let bundles = bundles_of_share.unwrap_or_else(|| of_body.blocks(breaks));
        let mut location = Places::new(own, if smoothed { edge_count } else { body.elements.len() });
        let mut blocks = Vec::with_capacity(bundles.len());
        for bundle in bundles {
            for (cell, &item) in bundle.items.iter().enumerate() {
                location.put(item, ((first_block + blocks.len()) as u32, cell as u32));
            }
            let law = block_law(smoothed, softens.as_ref().zip(threshold.as_ref()), &bundle.items);
            let is_fine = of_body.is_fine(bundle.items[0]);
            blocks.push(Block::new(bundle, index, law, is_fine));
        }
        let lengths = threshold.as_ref().map_or_else(LengthReport::default, |t| t.report);
        let phase = threshold.as_ref().and_then(|t| t.phase).map(|law| Box::new(PhaseField::new(law, edge_count)));
        let around = edges.as_ref().and_then(BodyEdges::table_of_elements);
        let standard = match (softens.clone(), threshold, around) {
            (Some(softens), Some(t), Some(around)) if !smoothed => {
                let mut field = EdgeField::new(softens, (0..edge_count as u32).collect(), &t);
                field.keep_histories();
                Some(StandardDamage::new(field, body.shape, around.clone(), body.elements.len()))
            }
            _ => None,
        };
        let alive = vec![true; body.elements.len()];
        let model = BodyModel {
            body,
            elasticity,
            softens,
            viscosity: None,
            alive,
            volumes: OnceLock::new(),
            edges,
            location,
            standard,
            phase,
            lengths,
        };
        Ok((model, blocks))
    }
}

/// Cells of some blocks, ascending.
fn items_of(bundles: &[Bundle]) -> Vec<u32> {
    let mut items: Vec<u32> = bundles.iter().flat_map(|bundle| &bundle.items).copied().collect();
    items.sort_unstable();
    items
}

/// Law of the cells of a block; one that holds an edge that may be damaged holds such edges only.
fn block_law(smoothed: bool, damage: Option<(&Arc<Softens>, &Threshold)>, items: &[u32]) -> BlockLaw {
    match damage {
        Some((softens, threshold)) if smoothed && threshold.strength(items[0]).is_finite() => {
            BlockLaw::Edges(EdgeField::new(softens.clone(), items.to_vec(), threshold))
        }
        Some((softens, _)) if !smoothed => BlockLaw::Standard(StandardCells::new(softens.clone(), items.len())),
        _ => BlockLaw::Elastic,
    }
}

/// What the cells of a body are made from.
struct CellsOfBody<'a> {
    geometry: Geometry<'a>,
    /// Edges, where these are the cells.
    edges: Option<&'a BodyEdges>,
    chosen: Chosen<'a>,
}

impl CellsOfBody<'_> {
    /// Whether a cell takes shorter steps: an edge with any fine element around it goes with that.
    fn is_fine(&self, item: u32) -> bool {
        let is_fine = |element: u32| self.chosen.fine.get(element as usize).copied().unwrap_or(false);
        match self.edges {
            Some(edges) => edges.around(item).iter().any(|&element| is_fine(element)),
            None => is_fine(item),
        }
    }

    /// Cells in blocks.
    ///
    /// - `breaks`: whether an edge may be damaged
    fn blocks(&self, breaks: impl Fn(u32) -> bool) -> Vec<Bundle> {
        match self.edges {
            Some(edges) => {
                self.geometry.edge_blocks(edges, |edge| Class { is_fine: self.is_fine(edge), is_sound: !breaks(edge) })
            }
            None => self.geometry.element_blocks(|element| Class { is_fine: self.is_fine(element), is_sound: false }),
        }
    }

    /// Cells of a rank that has no more of the body than it needs for these.
    fn blocks_of(&self, share: &BodyShare) -> Vec<Bundle> {
        let item = |nodes: &[u32; 2]| {
            let found = match self.edges {
                Some(edges) => edges.find(*nodes),
                None => share.numbers.binary_search(&nodes[0]).ok().map(|element| element as u32),
            };
            found.expect("a rank has the elements of its cells")
        };
        let runs: Vec<Vec<u32>> = share.runs.iter().map(|run| run.iter().map(item).collect()).collect();
        let runs: Vec<&[u32]> = runs.iter().map(Vec::as_slice).collect();
        self.geometry.bundles(&runs, self.edges)
    }
}
