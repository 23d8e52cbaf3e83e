//! Which of some nodes one of several ranks moves, and values of nodes that each is told by the rank that knows them.

use fractum_parallel::gather;

use crate::solid::Solid;

/// Places among some nodes of those that a rank moves, as long as that does not change.
#[derive(Clone, Debug, Default)]
pub struct MovedNodes {
    /// When they were found, in changes of what the rank moves.
    found_at: Option<u64>,
    /// In steps like any other, and in those with sums over all nodes.
    places: [Vec<u32>; 2],
    /// Those that it tells of, once it has.
    told: Option<Vec<u32>>,
}

impl Solid {
    /// Places among some nodes of those that this rank moves in this step, ascending; none where it moves all.
    ///
    /// - `found`: those of the same nodes in the step before
    pub fn moved_among<'a>(&self, nodes: &[u32], found: &'a mut MovedNodes) -> Option<&'a [u32]> {
        let part = self.part.as_ref()?;
        if found.found_at.replace(part.changes()) != Some(part.changes()) {
            found.places = [false, true].map(|sums| {
                let places = (0..).zip(nodes).filter(|(_, node)| part.moves(**node, sums));
                places.map(|(place, _)| place).collect()
            });
        }
        (!part.is_all).then_some(&found.places[usize::from(part.sums)])
    }

    /// Gives every rank the values of some nodes (ascending), each by a rank that moves the node in every step. All ranks must call it with
    /// the same nodes.
    ///
    /// - `found`: those of the same nodes
    pub fn tell_of_nodes(&self, nodes: &[u32], found: &mut MovedNodes, values: &mut [f64]) {
        let Some(part) = self.part.as_ref().filter(|_| !nodes.is_empty()) else { return };
        let told = found.told.get_or_insert_with(|| {
            let mut told = part.told_nodes().to_vec();
            told.sort_unstable();
            (0..).zip(nodes).filter(|(_, node)| told.binary_search(node).is_ok()).map(|(place, _)| place).collect()
        });
        let own: Vec<(u32, f64)> = told.iter().map(|&place| (place, values[place as usize])).collect();
        for (place, value) in gather(&*part.exchange(), &own).into_iter().flatten() {
            values[place as usize] = value;
        }
    }
}
