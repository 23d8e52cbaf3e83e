//! How elements hang together that several ranks share.

use std::collections::BTreeMap;

use fractum_math::connected;
use fractum_parallel::{Exchange, gather};

use super::{BodyShare, ConnectedPieces, GivenToNodes, nodal_sums};

/// The pieces of a body. All ranks must call it.
///
/// - `elements`, `volumes` [m³]: those of this rank; `nodes`: how many there are
pub(crate) fn connected_pieces(
    exchange: &dyn Exchange,
    share: &BodyShare,
    elements: &[[u32; 4]],
    volumes: &[f64],
    nodes: usize,
) -> ConnectedPieces {
    let own = connected(nodes, elements.iter().flat_map(|&[a, b, c, d]| [[a, b], [a, c], [a, d]]));
    let joined: Vec<[u32; 2]> = (0..).zip(own).filter(|(node, first)| node != first).map(<[u32; 2]>::from).collect();
    let first = connected(nodes, gather(exchange, &joined).into_iter().flatten());
    let mut owned = BTreeMap::<u32, usize>::new();
    for (element, _) in elements.iter().zip(&share.is_owned).filter(|(_, is_owned)| **is_owned) {
        *owned.entry(first[element[0] as usize]).or_default() += 1;
    }
    let mut pieces = BTreeMap::<u32, usize>::new();
    for (node, elements) in gather(exchange, &owned).into_iter().flatten() {
        *pieces.entry(node).or_default() += elements;
    }
    let links = (0..).zip(first).filter(|(node, first)| node != first).map(<[u32; 2]>::from).collect();
    let values = volumes.iter().map(|volume| volume / 4.0).collect();
    let volumes = nodal_sums(exchange, nodes, &[GivenToNodes { share, elements, values }]);
    ConnectedPieces { links, pieces: pieces.into_iter().collect(), volumes }
}
