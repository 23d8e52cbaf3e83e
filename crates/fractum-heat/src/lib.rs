//! Conduction of heat on a network of points: heat capacities at the points, conductances between pairs of them.
//!
//! Nodes of finite elements and particles that are bonded are such points alike, so that one field serves both: for linear
//! simplices with lumped capacities the conductances are -∫ λ ∇Nᵢ·∇Nⱼ dV, for packings those of [`PackedSphere`]. What one
//! point of a pair gives the other one takes, so that heat is conserved to round-off whatever the conductances are.
//!
//! Left out on purpose: radiation, conductivities that depend on temperature, change of phase, heat through contacts.
//!
//! ```
//! use fractum_heat::{HeatField, HeatNetwork};
//! use fractum_math::Vec3;
//! // Two bodies of 1 J/K, joined by 1 W/K.
//! let network = HeatNetwork::new(vec![1.0; 2], &[[0, 1]], &[1.0]);
//! let mut field = HeatField::new(network, vec![Vec3::zeros(); 2], vec![300.0, 400.0], Vec::new());
//! for _ in 0..1000 {
//!     field.step(0.01);
//! }
//! assert!((field.temperature()[0] - 350.0).abs() < 1e-6);
//! assert!(field.ledger().residual().abs() < 1e-10);
//! ```

#![forbid(unsafe_code)]

mod condition;
mod field;
mod implicit;
mod ledger;
mod network;
mod packing;

pub use condition::{HeatCondition, HeatFunction};
pub use field::{HeatField, HeatFieldState};
pub use implicit::ImplicitHeat;
pub use ledger::HeatLedger;
pub use network::HeatNetwork;
pub use packing::{PackedSphere, effective_conductivity};
