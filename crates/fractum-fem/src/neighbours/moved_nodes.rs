//! Which of some nodes one of several ranks moves, and values of nodes that each receives from the rank that knows them.

use fractum_parallel::gather;

use super::subdomain;
use super::subdomain::Nodes;
use crate::solid::Solid;

/// Places among some nodes of those that a rank moves, as long as that does not change.
#[derive(Clone, Debug, Default)]
pub struct MovedNodes {
    /// When they were found, in changes of what the rank moves.
    found_at: Option<u64>,
    /// In steps like any other, and in those with sums over all nodes.
    places: [Vec<u32>; 2],
    /// Those that it sends, once it has.
    sent: Option<Vec<u32>>,
}

/// Places among some nodes of those that this rank moves in this step, ascending; none where it moves all.
///
/// - `found`: those of the same nodes in the step before
pub fn moved_among<'a>(solid: &Solid, nodes: &[u32], found: &'a mut MovedNodes) -> Option<&'a [u32]> {
    let own = subdomain(solid)?;
    if found.found_at.replace(own.changes()) != Some(own.changes()) {
        found.places = [false, true].map(|sums| {
            let places = (0..).zip(nodes).filter(|(_, node)| own.moves(**node, sums));
            places.map(|(place, _)| place).collect()
        });
    }
    match own.needs.now {
        Nodes::Own => Some(&found.places[0]),
        Nodes::Summed => Some(&found.places[1]),
        Nodes::All => None,
    }
}

/// Gives every rank the values of some nodes (ascending), each by a rank that moves the node in every step. All ranks must name
/// the same nodes.
///
/// - `found`: those of the same nodes
pub fn exchange_node_values(solid: &Solid, nodes: &[u32], found: &mut MovedNodes, values: &mut [f64]) {
    let Some(own) = subdomain(solid).filter(|_| !nodes.is_empty()) else { return };
    let sent = found.sent.get_or_insert_with(|| {
        let mut sent = own.sent_nodes().to_vec();
        sent.sort_unstable();
        (0..).zip(nodes).filter(|(_, node)| sent.binary_search(node).is_ok()).map(|(place, _)| place).collect()
    });
    let mine: Vec<(u32, f64)> = sent.iter().map(|&place| (place, values[place as usize])).collect();
    for (place, value) in gather(&*own.exchange, &mine).into_iter().flatten() {
        values[place as usize] = value;
    }
}
