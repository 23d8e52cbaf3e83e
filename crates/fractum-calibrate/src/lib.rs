//! Virtual laboratory and calibration of bonded bodies: a material in, micro-parameters out.

mod error;
pub mod lab;
mod sample;

pub use error::CalibrateError;
pub use sample::{Micro, Sample};
