//! Edges of the blocks of other ranks that this one has received, where it has no more of these blocks.

use std::collections::BTreeMap;
use std::sync::Arc;

use fractum_kernels::damage::{EdgeDamage, Softens};
use serde::{Deserialize, Serialize};

use crate::damage::edge::EdgeField;

/// An edge that a rank sends to others.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct SentEdge {
    /// Its cell in the block.
    pub(crate) cell: u32,
    /// Its number in the body.
    pub(crate) edge: u32,
    history: EdgeDamage,
    /// Strength [Pa].
    strength: f64,
    /// Characteristic length [m].
    length: f64,
}

/// What a rank has of the cells of others of a body that may break and of which it has all elements: fields of their blocks with the edges
/// alone that it has received, in the order of their cells.
#[derive(Clone, Debug, Default)]
pub(crate) struct RemoteCells {
    /// Block and cell of the edges received.
    edges: BTreeMap<u32, (u32, u32)>,
    /// The cells received of each block, ascending.
    cells: BTreeMap<u32, Vec<u32>>,
}

impl RemoteCells {
    /// Block of an edge, and its place in the field of that; none where nothing was received of it.
    pub(crate) fn find(&self, edge: u32) -> Option<(usize, usize)> {
        let &(block, cell) = self.edges.get(&edge)?;
        Some((block as usize, self.place(block, cell)?))
    }

    /// Place of a cell in the field of its block; none where nothing was received of it.
    pub(crate) fn place(&self, block: u32, cell: u32) -> Option<usize> {
        self.cells.get(&block)?.binary_search(&cell).ok()
    }

    /// - `field`: that of the block
    pub(crate) fn put(&mut self, block: u32, field: &mut EdgeField, sent: &SentEdge) {
        self.edges.insert(sent.edge, (block, sent.cell));
        let cells = self.cells.entry(block).or_default();
        match cells.binary_search(&sent.cell) {
            Ok(place) => field.put(place, sent.history),
            Err(place) => {
                cells.insert(place, sent.cell);
                field.insert(place, sent);
            }
        }
    }

    /// Forgets all edges; the fields of their blocks must be [`EdgeField::of_none`] then.
    pub(crate) fn clear(&mut self) {
        (self.edges, self.cells) = Default::default();
    }
}

impl EdgeField {
    /// A field without edges.
    pub(crate) fn of_none(softens: Arc<Softens>) -> Self {
        EdgeField::of_edges(softens, Vec::new(), Vec::new(), Vec::new())
    }

    /// Adds an edge at a place.
    fn insert(&mut self, place: usize, sent: &SentEdge) {
        self.keep_histories();
        self.edges.insert(place, sent.edge);
        self.strength.insert(place, sent.strength);
        self.length.insert(place, sent.length);
        self.state.insert(place, EdgeDamage::intact(sent.strength));
        self.threshold.insert(place, sent.strength);
        // Those that broke are named by their places.
        self.fresh.iter_mut().for_each(|fresh| *fresh += u32::from(*fresh as usize >= place));
        self.put(place, sent.history);
    }

    /// What others are sent of an edge of a block.
    pub(crate) fn sent(&self, cell: usize) -> SentEdge {
        let (edge, strength, length) = (self.edges[cell], self.strength[cell], self.length[cell]);
        SentEdge { cell: cell as u32, edge, history: self.history(cell), strength, length }
    }

    /// Edges whose histories are no longer those of the start.
    pub(crate) fn changed(&self) -> impl Iterator<Item = usize> + '_ {
        let histories = self.state.iter().zip(&self.strength).enumerate();
        let changed = histories.filter(|(_, (history, strength))| **history != EdgeDamage::intact(**strength));
        changed.map(|(place, _)| place)
    }
}

impl SentEdge {
    /// Gives the edge its history in the field of all cells of its block.
    pub(crate) fn put_in(&self, field: &mut EdgeField) {
        field.put(self.cell as usize, self.history);
    }
}

#[cfg(test)]
mod tests {
    use fractum_kernels::material::{DamageLaw, Elastic};
    use fractum_math::Sym3;

    use super::*;
    use crate::body::{Body, ElementKind};

    #[test]
    fn edges_stand_in_the_order_of_their_cells_whenever_they_are_received() {
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body = Body::new("edge", ElementKind::T4, vec![[0, 1, 2, 3]], elastic);
        let body = body.smoothed().with_damage(DamageLaw::rankine(3e6, 100.0));
        let mut field = EdgeField::of_none(Arc::new(body.softens().unwrap()));
        let mut received = RemoteCells::default();
        let edge = |cell: u32, damage: f64| {
            let history = EdgeDamage { damage, broken: damage > 0.9, ..EdgeDamage::intact(3e6) };
            SentEdge { cell, edge: 100 - cell, history, strength: 3e6, length: 0.01 }
        };
        received.put(5, &mut field, &edge(7, 0.95));
        field.fresh.push(0);
        for (cell, damage) in [(2, 0.0), (9, 0.5), (7, 0.99), (2, 0.3)] {
            received.put(5, &mut field, &edge(cell, damage));
        }
        assert_eq!(field.edges, [98, 93, 91]);
        assert_eq!(field.state.iter().map(|edge| edge.damage).collect::<Vec<_>>(), [0.3, 0.99, 0.5]);
        assert_eq!([2, 3, 9].map(|cell| received.place(5, cell)), [Some(0), None, Some(2)]);
        assert_eq!([98, 97, 91].map(|edge| received.find(edge)), [Some((5, 0)), None, Some((5, 2))]);
        // What broke is found where it stands now.
        assert_eq!(field.fresh, [1]);
        assert_eq!(field.changed().collect::<Vec<_>>(), [0, 1, 2]);
        assert!(field.is_damaged() && field.state[0].strain == Sym3::ZERO);
        received.clear();
        assert!(received.place(5, 7).is_none() && received.find(93).is_none());
    }
}
