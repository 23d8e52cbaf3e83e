//! A solid that several processes have together: what they tell each other of nodes, cells and the saved state.

pub(crate) mod divided_solid;
pub(crate) mod moved_nodes;
pub(crate) mod shared_solid;
pub(crate) mod state_part;
