//! The small algebra that every kernel of fractum shares.
//!
//! Vectors and matrices are nalgebra's; this crate adds what the mechanics needs on top: symmetric tensors in Voigt
//! order xx yy zz xy yz zx with their principal values, ragged tables, connected parts, parallel sums whose result does
//! not depend on the number of threads, the largest eigenvalue of an operator, the volume of a sphere, and the account of a
//! step's work.
//!
//! ```
//! use fractum_math::{Sym3, Vec3};
//! let stress = Sym3::new(3.0, 1.0, -2.0, 0.0, 0.0, 0.0);
//! assert!((stress.principal_values()[0] - 3.0).abs() < 1e-14);
//! assert_eq!(stress * Vec3::x(), Vec3::new(3.0, 0.0, 0.0));
//! ```

mod connected;
pub mod elementary;
mod lanczos;
mod lane;
mod negative_part;
mod ragged;
mod reduce;
mod rotation;
mod sphere;
mod sym3;
mod widest;
mod work;

pub use connected::{Connected, connected, numbered_parts};
pub use lanczos::largest_eigenvalue;
pub use lane::{FOUR, Lane};
pub use negative_part::{by_component, negative_parts};
pub use ragged::Ragged;
pub use reduce::{CHUNK, sum_chunks};
pub use rotation::{angle_between, rotation_between, rotation_by, rotation_vector};
pub use sphere::sphere_volume;
pub use sym3::Sym3;
pub use work::{HalfSteps, Work};

/// A vector in space (SI units of the quantity it holds).
pub type Vec3 = nalgebra::Vector3<f64>;
/// A 3×3 matrix.
pub type Mat3 = nalgebra::Matrix3<f64>;
/// A rotation as a unit quaternion.
pub type Rotation = nalgebra::UnitQuaternion<f64>;
