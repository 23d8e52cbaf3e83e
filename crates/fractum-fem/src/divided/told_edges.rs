//! Edges of the blocks of other ranks of which this one has been told, where it has no more of these blocks.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::damage::edge::{EdgeDamage, EdgeField, Softens};

/// An edge that a rank tells others of.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct ToldEdge {
    /// Its cell in the block.
    pub(crate) cell: u32,
    /// Its number in the body.
    pub(crate) edge: u32,
    pub(crate) history: EdgeDamage,
    /// Strength [Pa].
    pub(crate) strength: f64,
    /// Characteristic length [m].
    pub(crate) length: f64,
}

/// The edges of a block of another rank of which this one has been told.
#[derive(Clone, Debug)]
pub(crate) struct ToldEdges {
    pub(crate) field: EdgeField,
    /// The cell of each of them in its block, ascending.
    cells: Vec<u32>,
    /// Energy dissipated in the block so far [J].
    pub(crate) dissipated: f64,
    /// Elastic energy of the last step, where it was told [J].
    pub(crate) energy: Option<f64>,
}

impl ToldEdges {
    pub(crate) fn new(softens: Arc<Softens>) -> Self {
        ToldEdges { field: EdgeField::of_none(softens), cells: Vec::new(), dissipated: 0.0, energy: None }
    }

    /// Place of a cell in the field; none where nothing was told of it.
    pub(crate) fn place(&self, cell: u32) -> Option<usize> {
        self.cells.binary_search(&cell).ok()
    }

    pub(crate) fn put(&mut self, told: &ToldEdge) {
        match self.cells.binary_search(&told.cell) {
            Ok(place) => self.field.put(place, told.history),
            Err(place) => {
                self.cells.insert(place, told.cell);
                self.field.insert(place, told);
            }
        }
    }

    /// Forgets what was told of edges.
    pub(crate) fn forget(&mut self) {
        self.field = EdgeField::of_none(Arc::clone(&self.field.softens));
        self.cells.clear();
    }
}

impl EdgeField {
    /// A field without edges.
    fn of_none(softens: Arc<Softens>) -> Self {
        EdgeField::of_edges(softens, Vec::new(), Vec::new(), Vec::new())
    }

    /// Adds an edge at a place.
    fn insert(&mut self, place: usize, told: &ToldEdge) {
        self.keep_histories();
        self.edges.insert(place, told.edge);
        self.strength.insert(place, told.strength);
        self.length.insert(place, told.length);
        self.state.insert(place, EdgeDamage::intact(told.strength));
        self.threshold.insert(place, told.strength);
        // Those that broke are named by their places.
        self.fresh.iter_mut().for_each(|fresh| *fresh += u32::from(*fresh as usize >= place));
        self.put(place, told.history);
    }

    /// What others are told of an edge of a block.
    pub(crate) fn told(&self, cell: usize) -> ToldEdge {
        let (edge, strength, length) = (self.edges[cell], self.strength[cell], self.length[cell]);
        ToldEdge { cell: cell as u32, edge, history: self.history(cell), strength, length }
    }

    /// Edges whose histories are no longer those of the start.
    pub(crate) fn changed(&self) -> impl Iterator<Item = usize> + '_ {
        let histories = self.state.iter().zip(&self.strength).enumerate();
        let changed = histories.filter(|(_, (history, strength))| **history != EdgeDamage::intact(**strength));
        changed.map(|(place, _)| place)
    }
}

#[cfg(test)]
mod tests {
    use fractum_math::Sym3;

    use super::*;
    use crate::body::{Body, ElementKind};
    use crate::material::{DamageLaw, Elastic};

    #[test]
    fn edges_stand_in_the_order_of_their_cells_whenever_they_are_told() {
        let elastic = Elastic { density: 2400.0, young_modulus: 30e9, poisson_ratio: 0.2 };
        let body = Body::new("edge", ElementKind::T4, vec![[0, 1, 2, 3]], elastic);
        let body = body.smoothed().with_damage(DamageLaw::rankine(3e6, 100.0));
        let softens = Softens::new(&body, body.damage.as_ref().unwrap());
        let mut told = ToldEdges::new(Arc::new(softens));
        let edge = |cell: u32, damage: f64| {
            let history = EdgeDamage { damage, broken: damage > 0.9, ..EdgeDamage::intact(3e6) };
            ToldEdge { cell, edge: 100 - cell, history, strength: 3e6, length: 0.01 }
        };
        told.put(&edge(7, 0.95));
        told.field.fresh.push(0);
        for (cell, damage) in [(2, 0.0), (9, 0.5), (7, 0.99), (2, 0.3)] {
            told.put(&edge(cell, damage));
        }
        assert_eq!(told.field.edges, [98, 93, 91]);
        assert_eq!(told.field.state.iter().map(|edge| edge.damage).collect::<Vec<_>>(), [0.3, 0.99, 0.5]);
        assert_eq!([2, 3, 9].map(|cell| told.place(cell)), [Some(0), None, Some(2)]);
        // What broke is found where it stands now.
        assert_eq!(told.field.fresh, [1]);
        assert_eq!(told.field.changed().collect::<Vec<_>>(), [0, 1, 2]);
        assert!(told.field.is_damaged() && told.field.state[0].strain == Sym3::ZERO);
        told.forget();
        assert!(told.field.edges.is_empty() && told.place(7).is_none());
    }
}
