//! The laws of fractum as functions of plain values: numbers, four or eight of them side by side, vectors and symmetric tensors.
//!
//! A law sees one point, one edge or one pair with its history, and returns stress, force or energy. Loops, populations and
//! files are elsewhere: every solver calls these functions, so that a law is written once. The crate builds without the standard
//! library (`--no-default-features`), with the same bits.
//!
//! ```
//! use fractum_kernels::{Sym3, Vec3};
//! let stress = Sym3::new(3.0, 1.0, -2.0, 0.0, 0.0, 0.0);
//! assert!((stress.principal_values()[0] - 3.0).abs() < 1e-14);
//! assert_eq!(stress * Vec3::x(), Vec3::new(3.0, 0.0, 0.0));
//! ```

#![cfg_attr(not(any(feature = "std", test)), no_std)]

pub mod bond;
pub mod contact;
pub mod damage;
pub mod elementary;
#[cfg(not(feature = "std"))]
mod exact;
pub mod interface;
mod lane;
pub mod lanes;
pub mod liquid;
pub mod material;
mod negative_part;
mod number;
mod prefetch;
mod sym3;
mod widest;
mod work;

pub use lane::{FOUR, Lane};
pub use negative_part::{by_component, negative_parts};
pub use number::Number;
pub use prefetch::prefetch;
pub use sym3::Sym3;
pub use widest::has_wide_vectors;
pub use work::{HalfSteps, Work};

/// A vector in space (SI units of the quantity it holds).
pub type Vec3 = nalgebra::Vector3<f64>;
/// A 3×3 matrix.
pub type Mat3 = nalgebra::Matrix3<f64>;
/// A rotation as a unit quaternion.
pub type Rotation = nalgebra::UnitQuaternion<f64>;
