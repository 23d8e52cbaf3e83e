//! What one of several ranks has of a body that it does not have whole.

use fractum_mesh::topology::TETRAHEDRON_FACETS;
use fractum_parallel::Exchange;

use super::remote_cells::RemoteCells;
use crate::body::Formulation;
use crate::divided::{ALONE, BodyShare, DividedBody, ELSEWHERE, EdgeValues, Replication, connected_pieces};
use crate::solid::BodyModel;

/// What a rank has of a body.
#[derive(Clone, Debug, Default)]
pub(crate) struct BodySubdomain {
    /// Which elements it owns; empty where it owns all.
    pub(super) is_owned: Vec<bool>,
    /// What it knows of the whole body, where it has only the elements around its cells.
    pub(super) divided: Option<Box<DividedBody>>,
    /// What it has of the cells of others, where it has all elements and no more cells than its own.
    pub(super) remote: Option<RemoteCells>,
}

impl BodySubdomain {
    /// What a rank remembers of the whole body, once its cells are made.
    ///
    /// - `nodes`: of all bodies
    pub(super) fn new(
        model: &mut BodyModel,
        exchange: &dyn Exchange,
        share: &BodyShare,
        volumes: &[f64],
        nodes: usize,
    ) -> Self {
        let is_owned = share.is_owned.clone();
        match share.replication {
            Replication::Whole => return BodySubdomain { is_owned, ..BodySubdomain::default() },
            Replication::Elements => {
                if let Some(zone) = &mut model.body.damage {
                    // Every edge of this rank has its strength.
                    zone.strength_factor = Vec::new();
                }
                return BodySubdomain { is_owned, remote: Some(RemoteCells::default()), divided: None };
            }
            Replication::Part => {}
        }
        let smoothed = model.body.formulation == Formulation::Smoothed;
        let values = match model.edges.as_ref().filter(|_| smoothed) {
            Some(edges) => {
                let (values, places) = EdgeValues::new(exchange, share, &model.body.elements, edges);
                places.into_iter().for_each(|(edge, place)| model.location.put(edge, (ELSEWHERE, place)));
                values
            }
            None => EdgeValues::default(),
        };
        for &element in &share.measured {
            let own = [element];
            let of = model.edges.as_ref().filter(|_| smoothed).map(|edges| edges.of_element(element));
            for &cell in of.as_ref().map_or(&own[..], |of| of) {
                // Others send values of frames alone.
                if model.location.of(cell).0 == ELSEWHERE {
                    model.location.put(cell, (ALONE, cell));
                }
            }
        }
        let pieces = connected_pieces(exchange, share, &model.body.elements, volumes, nodes);
        let volume = pieces.volumes.iter().sum();
        let (numbers, count) = (share.numbers.clone(), share.count);
        let divided = DividedBody { numbers, count, volume, pieces, values, skin: Vec::new() };
        BodySubdomain { is_owned, divided: Some(Box::new(divided)), remote: None }
    }

    /// Whether this rank has no more of the cells of others than what it receives.
    pub(super) fn has_own_cells_alone(&self) -> bool {
        self.divided.is_some() || self.remote.is_some()
    }

    /// Notes which facets of the body are seen from outside, of the elements that this rank owns.
    ///
    /// - `elements`: of this rank; `facets`: those of the whole body
    pub(super) fn note_skin(&mut self, elements: &[[u32; 4]], facets: &[[u32; 3]]) {
        let Some(divided) = &mut self.divided else { return };
        let sorted = |mut facet: [u32; 3]| {
            facet.sort_unstable();
            facet
        };
        let mut outer: Vec<[u32; 3]> = facets.iter().map(|&facet| sorted(facet)).collect();
        outer.sort_unstable();
        divided.skin.clear();
        for (element, nodes) in elements.iter().enumerate().filter(|(e, _)| self.is_owned[*e]) {
            let sides = TETRAHEDRON_FACETS.map(|side| side.map(|corner| nodes[corner]));
            let seen = sides.into_iter().filter(|&side| outer.binary_search(&sorted(side)).is_ok());
            divided.skin.extend(seen.map(|side| (side, element as u32)));
        }
    }
}
