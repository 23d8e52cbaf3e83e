//! Several processes: each has a subdomain of a solid, and exchanges what lies on its boundary with the others.
//!
//! A solid knows the seam alone, its trait `Neighbours`, and does the same whoever is behind it. What is here holds several *ranks* (processes of MPI, or
//! threads in tests) together. Every function that takes an exchange, gathers or exchanges must be called by all ranks, in the same order.

mod block_state;
mod body_subdomain;
mod events;
mod exchanges;
mod halo;
mod messages;
mod moved_nodes;
mod node_sums;
mod phase;
mod remote_cells;
mod seam;
mod set_up;
mod state_part;
mod subdomain;
mod whole_body;

use std::any::Any;

pub use exchanges::{exchange_sums, follow_nodes, gather_all, gather_damage, gather_nodes, move_all_nodes_next};
pub use moved_nodes::{MovedNodes, exchange_node_values, moved_among};
pub use set_up::{distribute, divided_solid, shared_solid};
pub use state_part::{SolidPart, each_history, each_viscous_block, joined, state_beside_parts, state_part};
pub use subdomain::SubdomainSize;
pub use whole_body::{
    block_count, connected_pieces, element_count, element_number, element_of_number, is_distributed, is_divided,
    nodes_of, note_skin, owned_edges, shared_nodes, skin, steps, subdomain_size, volume,
};

use crate::solid::Solid;
use crate::solid::neighbours::Neighbours;
use subdomain::Subdomain;

/// What this rank has of a solid; none where one process has everything.
fn subdomain(solid: &Solid) -> Option<&Subdomain> {
    let neighbours: &dyn Any = &*solid.neighbours;
    neighbours.downcast_ref()
}

fn subdomain_mut(neighbours: &mut Box<dyn Neighbours>) -> Option<&mut Subdomain> {
    let neighbours: &mut dyn Any = &mut **neighbours;
    neighbours.downcast_mut()
}
