//! The small algebra that every kernel of fractum shares.
//!
//! Vectors and matrices are nalgebra's; vectors, symmetric tensors, elementary functions and the account of a step's work are
//! those of [`fractum_kernels`], under their names here. This crate adds what needs memory or threads: ragged tables, connected
//! parts, parallel sums whose result does not depend on the number of threads, the largest eigenvalue of an operator, and
//! rotations and the volume of a sphere.
//!
//! ```
//! use fractum_math::{Sym3, Vec3};
//! let stress = Sym3::new(3.0, 1.0, -2.0, 0.0, 0.0, 0.0);
//! assert!((stress.principal_values()[0] - 3.0).abs() < 1e-14);
//! assert_eq!(stress * Vec3::x(), Vec3::new(3.0, 0.0, 0.0));
//! ```

mod connected;
mod lanczos;
mod ragged;
mod reduce;
mod rotation;
mod sphere;

pub use fractum_kernels::{
    FOUR, HalfSteps, Lane, Mat3, Rotation, Sym3, Vec3, Work, by_component, elementary, negative_parts, widest,
};

pub use connected::{Connected, connected, numbered_parts};
pub use lanczos::{Operator, largest_eigenvalue};
pub use ragged::Ragged;
pub use reduce::{CHUNK, sum_chunks};
pub use rotation::{angle_between, rotation_between, rotation_by, rotation_vector};
pub use sphere::sphere_volume;
