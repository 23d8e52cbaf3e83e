//! What a step in motion does with a solid: time integration, stable step, growth of phase fields, viscosity, expansion, and bodies that begin to turn.

pub(crate) mod central_difference;
pub(crate) mod expansion;
pub(crate) mod inverted;
pub(crate) mod phase_damage;
pub(crate) mod phase_edges;
pub(crate) mod subcycled_solid;
pub(crate) mod time_step;
pub(crate) mod turning;
pub(crate) mod viscous_solid;
