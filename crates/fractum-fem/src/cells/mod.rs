//! Cells: patches of nodes with one displacement gradient, their blocks, and the kernel that they run through.

pub(crate) mod block;
pub(crate) mod cell;
pub(crate) mod kernel;
pub(crate) mod law;
pub(crate) mod thermal_strain;
pub(crate) mod viscosity;
