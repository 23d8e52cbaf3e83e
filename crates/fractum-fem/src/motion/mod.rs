//! What a step in motion does with a solid: internal forces, time integration, stable step, growth of phase fields, viscosity, expansion, stress from the start, and
//! bodies that begin to turn.

pub(crate) mod central_difference;
pub(crate) mod expansion;
pub(crate) mod initial_stress;
pub(crate) mod internal_forces;
pub(crate) mod inverted;
pub(crate) mod phase_damage;
pub(crate) mod phase_edges;
pub(crate) mod subcycled_solid;
pub(crate) mod time_step;
pub(crate) mod turning;
pub(crate) mod viscous_solid;

pub use central_difference::{LocalDamping, WholeStep};
pub use expansion::{
    begin_expansion, element_conduction, expand_to, expansion_work, find_expansion_work, set_expansion, start_expanded,
    starting_work,
};
pub use initial_stress::{begin_strained, stressed_areas};
pub use inverted::{crushed_element, inverted_element};
pub use phase_damage::{element_phase, has_phase_fields, phase_sizes};
pub use phase_edges::wake_phase_fields;
pub use subcycled_solid::{
    Prescribe, advance_in_parts, fine_shares, own_acceleration, restore_short_steps, set_copies_off, set_short_steps,
    short_steps, with_copies,
};
pub use time_step::{StableStep, fine_stable_step, motion_frequency, stable_step_bound};
pub use turning::{let_spin, let_turn};
pub use viscous_solid::{bulk_damping_ratio, set_viscosity};
