//! Macroscopic quantities of a bonded body: stress, strain, the shape of its cracks, its fragments.

pub mod crack_shape;
mod fragment;
mod gauge;
pub mod strain;
pub mod stress;

pub use fragment::{Piece, pieces};
pub use gauge::{StrainGauge, StrainMeasure};
