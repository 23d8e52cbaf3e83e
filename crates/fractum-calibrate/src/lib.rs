//! Virtual laboratory and calibration of bonded bodies: a material in, micro-parameters out.
//!
//! A [`Sample`] is a bonded packing. [`lab`] tests it in tension, compression, bending, torsion and shear, each by one
//! static solve. [`invert`] finds the beams that give it a Young's modulus and a Poisson's ratio; [`laws`] holds fits
//! over many such tests; [`published`] the numbers of the literature; [`calibrate`] goes the whole way and checks the
//! result on a packing not used before; [`prepare`] makes a body ready to move.
//!
//! ```
//! use fractum_calibrate::{Sample, invert};
//! use fractum_pack::{Convention, Domain, PackSpec, pack};
//! let packing = pack(&PackSpec::new(Domain::cuboid(1.0, 1.0, 1.0), 500, 1))?;
//! let mut sample = Sample::new(packing, 9.0, Convention::Interior)?;
//! let found = invert(&mut sample, 72e9, 0.23, 0.4)?;
//! assert!((found.poisson_ratio - 0.23).abs() < 1e-3);
//! # Ok::<(), fractum_calibrate::CalibrateError>(())
//! ```

#![forbid(unsafe_code)]

mod calibrate;
pub mod crushing;
mod error;
mod inversion;
pub mod lab;
pub mod laws;
mod prepare;
pub mod published;
mod pull;
mod sample;
pub mod strength;
pub mod strength_law;

pub use calibrate::{Calibration, Request, calibrate, suitable_coordination};
pub use error::CalibrateError;
pub use inversion::{Inverted, RADIUS_RATIOS, invert};
pub use prepare::{Beams, BondedBody, BondedMaterial, prepare, prepare_sample};
pub use pull::StrengthCriterion;
pub use sample::{Micro, Sample};
pub use strength::Strength;
