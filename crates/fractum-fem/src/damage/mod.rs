//! Damage of edges: their strengths and histories, and the phase field.

pub(crate) mod edge;
pub(crate) mod edges_in_step;
pub(crate) mod phase;
pub(crate) mod rate;
pub(crate) mod standard;
pub(crate) mod threshold;
