//! Gas in a network of cells: one balance of mass and one of energy per cell, flow through the slits between them.
//!
//! A cell is a volume that somebody else changes: a hole, a piece of a crack. Its gas follows an equation of state
//! ([`EquationOfState`], a file per law). Between cells gas flows as in a slit with rough walls, at most at the speed of
//! sound ([`SlitFlow`]), and carries the enthalpy of the cell it leaves. Mass and energy are conserved to round-off: what
//! leaves a cell arrives in another one or is counted as leaked, and what work takes is what the caller says.
//!
//! Left out on purpose: inertia of the gas between cells, heat to the walls, reactions. A perfect gas throttled between two
//! large cells keeps its enthalpy and so its temperature (Shapiro, *The Dynamics and Thermodynamics of Compressible Fluid
//! Flow* (1953), chapter 6): slow flow through a long slit is isothermal without any heat from the walls.
//!
//! ```
//! use fractum_gas::{Amount, EquationOfState, Network, Passage, PerfectGas, SlitFlow};
//! let air = PerfectGas { heat_ratio: 1.4, gas_constant: 287.0 };
//! let slits = SlitFlow { viscosity: 1.8e-5, roughness: 0.0 };
//! let mut network = Network::new(EquationOfState::PerfectGas(air), slits, 1e5);
//! let (mass, energy) = network.law().contents(1e-3, 1e6, 300.0).unwrap();
//! network.push_cell(Amount { mass, energy });
//! network.push_cell(Amount::default());
//! let slit = Passage { cells: [0, 1], length: 0.01, width: 0.1, opening: 1e-4 };
//! network.flow(1e-3, &[1e-3, 1e-3], &[slit]);
//! assert!(network.pressure(1, 1e-3) > 0.0);
//! assert!((network.total().mass / mass - 1.0).abs() < 1e-12);
//! ```

#![forbid(unsafe_code)]

mod law;
mod network;
mod slit;

pub use law::{EquationOfState, Explosive, Jwl, Law, NobleAbel, PerfectGas, PressureLine};
pub use network::{Amount, Contents, Network};
pub use slit::{Passage, SlitFlow, Upstream};
