//! Several crates against theory, without files. One test program: a new file is a line here.

mod bars;
mod bedding;
mod closed_cracks;
mod crack_pressure;
mod element;
mod excavation;
mod fracture_balance;
mod gas;
mod interfaces;
mod laws;
mod leaving;
mod meeting;
mod modes;
mod phase_field;
mod plane;
mod ranks;
mod ranks_divided;
mod ranks_particles;
mod rate;
mod rigid_contact;
mod scene;
mod statics;
mod stressed_modes;
mod subcycling;
mod tied_modes;
